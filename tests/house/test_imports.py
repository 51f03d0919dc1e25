"""Each part loads only what it may know, and no two files import each other."""

import ast
import json
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import logical_robots_tui
from tests.import_graph import modules_imported
from tests.installed import CHECKOUT
from tests.processes import run_command

SCREEN = {"textual", "rich"}
PARTS = (
    *("world", "language", "mind", "explain", "progress", "editing", "game", "player", "lab"),
    *("tui", "cli"),
)
WORLD, LANGUAGE, MIND, EXPLAIN, PROGRESS, EDITING, GAME, PLAYER, LAB, TUI, CLI = (
    f"logical_robots_tui.{part}" for part in PARTS
)
EXTRAS = {"distributed", "plotext", "pyarrow", "pygal"}

MUST_NOT_LOAD = {
    "logical_robots_tui": {WORLD, MIND, GAME, TUI, CLI, "numpy", "logica", "sqlite3"} | SCREEN,
    WORLD: {MIND, PROGRESS, EDITING, GAME, TUI, CLI, "logica", "sqlite3"} | SCREEN,
    f"{LANGUAGE}.adapter": {WORLD, MIND, EXPLAIN, GAME, TUI, CLI, "numpy", "sqlite3"} | SCREEN,
    MIND: {WORLD, EXPLAIN, PROGRESS, GAME, TUI, CLI, "numpy", "logica", "sqlglot"} | SCREEN,
    EXPLAIN: {WORLD, PROGRESS, GAME, TUI, CLI, "numpy", "logica", "sqlglot"} | SCREEN,
    PROGRESS: {WORLD, MIND, GAME, TUI, CLI, "numpy", "logica"} | SCREEN,
    f"{EDITING}.edits": {MIND, PROGRESS, GAME, TUI, CLI, "logica", "sqlite3"} | SCREEN,
    GAME: {PLAYER, TUI, CLI, "logica", "sqlglot"} | SCREEN,
    **{
        f"{PLAYER}.{part}": {TUI, CLI, LAB, "logica", "sqlglot"} | SCREEN
        for part in ("session", "library", "recorder", "recovery", "settings")
    },
    LAB: {WORLD, MIND, GAME, TUI, CLI, "msgspec", "multiprocessing", "numpy"} | SCREEN | EXTRAS,
    **{
        f"{LAB}.{part}": {TUI, CLI, EDITING, "logica", "sqlglot", "textual", "rich"} | EXTRAS
        for part in ("coordinating", "engines", "reporting", "submissions", "sweeping")
    },
    "logical_robots_tui.tui.app.app": {CLI, LAB, f"{MIND}.sqlite"},
    f"{CLI}.play": {LAB, "msgspec", "multiprocessing"},
    "logical_robots_tui.lsp.features": {CLI, TUI, LAB, WORLD, "numpy", "logica", "sqlglot"}
    | SCREEN,
    f"{CLI}.plain": {TUI, LAB, "logica", "sqlglot"} | SCREEN,
    f"{CLI}.lab": {LAB, WORLD, MIND, GAME, "msgspec", "multiprocessing"} | SCREEN | EXTRAS,
    **{
        f"{TUI}.{part}": {CLI, f"{TUI}.app.main_screen"} | SCREEN
        for part in (
            "library.controller",
            "labyrinth.victory",
            "level_editor.controller",
            "timeline.controller",
        )
    },
    "logical_robots_tui.cli.main": {WORLD, MIND, GAME, TUI, "numpy", "logica", "sqlite3"} | SCREEN,
}

PUBLIC_NAMES = [name for name in logical_robots_tui.__all__ if name != "__version__"]


def modules_after(statement: str) -> set[str]:
    """Names of all modules that a fresh interpreter has loaded after a statement."""
    script = f"{statement}\nimport json, sys\nprint(json.dumps(sorted(sys.modules)))"
    return set(json.loads(run_command([sys.executable, "-c", script], check=True).stdout))


@pytest.mark.sampled
@pytest.mark.parametrize("part", MUST_NOT_LOAD)
def test_a_part_loads_nothing_it_must_not_know(part: str) -> None:
    loaded = modules_after(f"import {part}")
    assert part in loaded
    assert loaded & MUST_NOT_LOAD[part] == set()


def test_the_world_can_be_used_through_the_public_names_without_loading_the_mind() -> None:
    loaded = modules_after("from logical_robots_tui import World, load_level, list_levels, Desire")
    assert WORLD in loaded
    assert loaded & {MIND, GAME, TUI, CLI, "logica", "sqlite3", *SCREEN} == set()


def test_a_run_without_a_screen_never_loads_textual() -> None:
    loaded = modules_after(
        "from logical_robots_tui.cli.main import main\n"
        "import contextlib, io\n"
        "with contextlib.redirect_stdout(io.TextIOWrapper(io.BytesIO())):\n"
        "    main(['levels'])"
    )
    assert WORLD in loaded
    assert loaded & {"textual", TUI} == set()


def test_only_the_app_and_the_commands_know_the_main_screen_even_for_types() -> None:
    package = Path(logical_robots_tui.__file__).parent
    knowing = {
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if "main_screen" in (text := path.read_text("utf-8")) or "MainScreen" in text
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.ImportFrom)
        and {"MainScreen", "main_screen"} & {name.name for name in node.names}
    }
    assert "tui/app/app.py" in knowing
    assert {path for path in knowing if not path.startswith("tui/commands/")} == {"tui/app/app.py"}


@pytest.mark.parametrize("name", PUBLIC_NAMES)
def test_every_public_name_can_be_imported_and_documents_itself(name: str) -> None:
    assert getattr(logical_robots_tui, name).__doc__


def test_public_names_are_listed_and_unknown_ones_refused() -> None:
    assert set(logical_robots_tui.__all__) <= set(dir(logical_robots_tui))
    with pytest.raises(AttributeError, match="no attribute 'Wrld'"):
        logical_robots_tui.Wrld  # noqa: B018 - reading the name is what is tested


def test_a_circle_is_found_wherever_the_imports_stand(tmp_path: Path) -> None:
    texts = {
        "__init__": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n  from p.a import f",
        "a": "import p.b",
        "b": "def g():\n  from p import c",
        "c": "if 0:\n  from p.a import f",
        "d": "import p.a, os",
    }
    (tmp_path / "p").mkdir()
    for name, text in texts.items():
        (tmp_path / "p" / f"{name}.py").write_text(text, encoding="utf-8")
    with pytest.raises(CycleError) as error:
        TopologicalSorter(modules_imported(tmp_path, ["p"])).prepare()
    assert set(error.value.args[1]) == {"p.a", "p.b", "p.c"}


def test_no_circle_of_files() -> None:
    TopologicalSorter(modules_imported(CHECKOUT, ["logical_robots_tui"])).prepare()
