"""What the README says is so."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui import Program, list_levels, load_level
from logical_robots_tui.cli.main import main
from logical_robots_tui.cli.main import parser as command_parser
from logical_robots_tui.tui.app.settings import read_settings
from logical_robots_tui.tui.commands.table import COMMANDS
from tests.installed import CHECKOUT

if TYPE_CHECKING:
    from pathlib import Path

README = CHECKOUT / "README.md"
KEYS = ("<!-- keys: made from the commands of the game -->\n", "<!-- end of keys -->\n")
LEVELS = ("<!-- levels: made from the files of the levels -->\n", "<!-- end of levels -->\n")


def blocks(language: str) -> list[str]:
    """The code blocks of a language."""
    every = re.finditer(r"^```(\w*)\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)
    return [block[2] for block in every if block[1] == language]


def keys_table() -> str:
    """The commands that are offered at the bottom of the screen, as a table."""
    rows = [
        f"| {' '.join(f'`{name}`' for name in entry.key_names.split(', '))} | {entry.help} |"
        for entry in COMMANDS
        if entry.bar
    ]
    return "\n".join(["", "| key | what it does |", "|---|---|", *rows, "", ""])


def levels_table() -> str:
    """Our levels with their ideas, as a table."""
    rows = [
        f"| {level.name.partition('-')[0].lstrip('0')} | {level.title} | {len(level.robots)} "
        f"| {level.idea.rstrip('.')} |"
        for level in map(load_level, list_levels())
    ]
    return "\n".join(["", "| | level | robots | what is new |", "|---|---|---|---|", *rows, "", ""])


@pytest.mark.parametrize(
    ("marks", "wanted"), [(KEYS, keys_table()), (LEVELS, levels_table())], ids=["keys", "levels"]
)
def test_a_table_is_what_the_game_has(
    marks: tuple[str, str], wanted: str, pytestconfig: pytest.Config
) -> None:
    before, begin, rest = README.read_text().partition(marks[0])
    table, end, after = rest.partition(marks[1])
    assert begin
    assert end
    if pytestconfig.getoption("--update-snapshots"):
        README.write_text(before + begin + wanted + end + after)
    else:
        assert table == wanted


@pytest.mark.parametrize("line", [line for b in blocks("") for line in b.splitlines()])
def test_every_command_exists(line: str) -> None:
    name, *arguments = shlex.split(line)
    if name == "make":
        assert re.search(rf"^{arguments[0]}:", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
    else:
        assert name == "logical-robots"
        command_parser().parse_args(arguments)


def test_the_run_that_is_shown_wins(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (run, *_) = re.findall(r"^logical-robots (run .*)$", README.read_text(), re.MULTILINE)
    assert main(run.split()) == 0


def test_the_program_compiles() -> None:
    (text,) = blocks("prolog")
    assert Program.compile(text).predicate("Robot")


def test_the_settings_can_be_used(tmp_path: Path) -> None:
    _, text = blocks("toml")
    path = tmp_path / "config.toml"
    path.write_text(text)
    found = read_settings(path)
    assert not found.complaints
    assert found.keys == {"run": ("space", "f9"), "restart": (), "brush": ("n",)}


def test_the_level_loads(tmp_path: Path) -> None:
    text, _ = blocks("toml")
    path = tmp_path / "level.toml"
    path.write_text(text)
    assert load_level(path).areas[0].victory_robots == ("Ada",)


def test_the_python_runs() -> None:
    text, *_ = blocks("python")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(text, "README.md", "exec"), {})
    assert re.match(r"10 [\d.]+ \{'Ada': 10\} False\n", out.getvalue())


@pytest.mark.parametrize("document", sorted(path.name for path in CHECKOUT.glob("*.md")))
def test_links_to_files_lead_somewhere(document: str) -> None:
    text = (CHECKOUT / document).read_text()
    for target in re.findall(r"\]\((?!https?://)([^)#]+)", text):
        assert (CHECKOUT / target).exists(), target
