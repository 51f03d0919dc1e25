"""The README is short and true, and so are the pages for players."""

import json
import re
import shlex
from functools import cache
from pathlib import Path

import pytest

from logical_robots_tui import list_levels, load_level
from logical_robots_tui.cli.main import parser as command_parser
from logical_robots_tui.game import reference_for
from logical_robots_tui.game.measuring import patience_for
from logical_robots_tui.player.settings import read_settings
from logical_robots_tui.tui.commands.command import Command, Scope, key_name
from logical_robots_tui.tui.commands.keymap import KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from tests.house.examples import PAGES, blocks
from tests.installed import CHECKOUT
from tests.levels.playing import ticks_to_win

README = CHECKOUT / "README.md"
DOCS = CHECKOUT / "docs"
PLAYING = DOCS / "playing.md"
KEYS = ("<!-- keys: made from the commands of the game -->\n", "<!-- end of keys -->\n")
LEVELS = ("<!-- levels: made from the files of the levels -->\n", "<!-- end of levels -->\n")


def keys_table(scope: Scope) -> str:
    """The commands that have a key, as a table for each heading of the help, and the others."""
    lines = [""]
    groups: dict[str, list[Command]] = {}
    available = KeyMap(COMMANDS, has=["board", "class"]).available
    for entry in available:
        if entry.keys and entry.scope == scope:
            groups.setdefault(entry.group, []).append(entry)
    for group, entries in groups.items():
        lines += [f"### {group}", ""] if len(groups) > 1 else []
        lines += ["| key | what it does |", "|---|---|"]
        for entry in entries:
            keys = " ".join(f"`{key_name(key)}`" for key in entry.keys)
            lines.append(f"| {keys} | {entry.help} |")
        lines.append("")
    titles = [entry.title for entry in available if not entry.keys and entry.scope == scope]
    lines += [f"In the palette only: {', '.join(titles)}.", ""] if titles else []
    return "\n".join([*lines, ""])


def levels_table() -> str:
    rows = [
        f"| {level.name.partition('-')[0].lstrip('0')} | {level.title} | {len(level.robots)} "
        f"| {level.idea.rstrip('.')} |"
        for level in map(load_level, list_levels())
    ]
    return "\n".join(["", "| | level | robots | what is new |", "|---|---|---|---|", *rows, "", ""])


@pytest.mark.parametrize(
    ("page", "marks", "wanted"),
    [
        (PLAYING, KEYS, keys_table("screen")),
        (DOCS / "editor.md", KEYS, keys_table("text")),
        (PLAYING, LEVELS, levels_table()),
    ],
    ids=["keys", "keys of the editor", "levels"],
)
def test_a_table_is_what_the_game_has(
    page: Path, marks: tuple[str, str], wanted: str, pytestconfig: pytest.Config
) -> None:
    before, begin, rest = page.read_text().partition(marks[0])
    table, end, after = rest.partition(marks[1])
    assert begin
    assert end
    if pytestconfig.getoption("--update-snapshots"):
        page.write_text(before + begin + wanted + end + after)
    else:
        assert table == wanted


def code(page: Path, language: str) -> list[str]:
    return [block.text for block in blocks(page) if block.language == language]


def test_the_readme_is_short() -> None:
    assert len(README.read_text().splitlines()) <= 90


def test_a_page_that_is_written_by_hand_is_not_long() -> None:
    lengths = {page.stem: len(page.read_text().splitlines()) for page in PAGES[1:]}
    assert {page for page, length in lengths.items() if length > 250} <= {"learn", "solutions"}


def test_every_command_in_the_readme_exists() -> None:
    makefile = (CHECKOUT / "Makefile").read_text()
    for line in "".join(code(README, "")).splitlines():
        name, *arguments = shlex.split(line)
        if name == "make":
            assert re.search(rf"^{arguments[0]}:", makefile, re.MULTILINE), line
        else:
            assert name == "logical-robots"
            command_parser().parse_args(arguments)


def test_the_program_that_is_shown_wins() -> None:
    (program,) = code(README, "prolog")
    level = load_level(list_levels()[0])
    reference = reference_for(level)
    assert reference is not None
    assert ticks_to_win(level, program, patience_for(reference.ticks))


def test_the_settings_can_be_used(tmp_path: Path) -> None:
    (text,) = code(DOCS / "settings.md", "toml")
    path = tmp_path / "config.toml"
    path.write_text(text)
    found = read_settings(path, KeyMap(COMMANDS).read)
    assert not found.complaints
    assert found.keys == {"run": ("space", "f9"), "restart": (), "brush": ("n",)}


@pytest.mark.slow
def test_the_notebook_runs() -> None:
    cells = json.loads((DOCS / "simulation.ipynb").read_text())["cells"]
    names: dict[str, object] = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), "simulation.ipynb", "exec"), names)
    assert "<svg" in names["sim"]._repr_html_()  # type: ignore[attr-defined] # a Simulation
    steps = names["results"].to_pandas()["steps"]  # type: ignore[attr-defined] # of a sweep
    assert list(steps) == sorted(steps)
    assert names["env"].unwrapped.simulation().tick > 0  # type: ignore[attr-defined] # a RobotEnv


@cache
def anchors(page: Path) -> set[str]:
    """What a link can name in a page: its headings, as GitHub spells them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_links_to_files_lead_somewhere() -> None:
    for page in (*sorted(CHECKOUT.glob("*.md")), *PAGES[1:]):
        for target, anchor in re.findall(r"\]\((?!https?://)([^)#]*)#?([^)]*)\)", page.read_text()):
            there = page.parent / target if target else page
            assert there.exists(), (page.name, target)
            assert not anchor or anchor in anchors(there), (page.name, anchor)


def test_the_index_lists_every_page() -> None:
    index = (DOCS / "README.md").read_text()
    for page in PAGES[1:]:
        assert page.name == "README.md" or f"]({page.name})" in index, page.name
