"""The main screen at the start and after some ticks, compared with what it is meant to be.

``pytest --update-snapshots tests/snapshots`` accepts what is on the screen now.
"""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.snapshots.picture import cells_of, differences, picture, read_picture
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
STEPS = 20
LOOKS = {
    "light": {},
    "16-colours": {"TERM": "xterm", "COLORTERM": ""},
    "no-colours": {"NO_COLOR": "1"},
}


@contextmanager
def opened(folder: Path, size: tuple[int, int], look: str = "") -> Iterator[Terminal]:
    """The game at tick 0, by default in a terminal with all colours."""
    config = folder / "config" / "logical-robots"
    config.mkdir(parents=True)
    if look == "light":
        (config / "config.toml").write_text('theme = "textual-light"\n', encoding="utf-8")
    level, program = HERE / "snapshot.toml", HERE / "snapshot.l"
    command = [sys.executable, "-m", "logical_robots_tui", "play", level, program]
    env = {"XDG_CONFIG_HOME": str(config.parent)} | LOOKS.get(look, {})
    with Terminal([*command, "--data-dir", folder], size=size, env=env) as terminal:
        terminal.wait_for("tick 0")
        terminal.wait_for("· applied")
        yield terminal


@pytest.fixture(params=[(80, 24), (120, 40)], ids=["80x24", "120x40"])
def game(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Terminal]:
    with opened(tmp_path, request.param) as terminal:
        yield terminal


@pytest.mark.sampled
def test_at_the_start(game: Terminal, pytestconfig: pytest.Config) -> None:
    assert_looks_like("start", game, pytestconfig)


@pytest.mark.sampled
@pytest.mark.parametrize("look", LOOKS)
def test_in_other_colours(look: str, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    with opened(tmp_path, (80, 24), look) as game:
        assert_looks_like(f"start-{look}", game, pytestconfig)
        game.send("w")
        game.wait_for("Robot")
        assert_looks_like(f"why-{look}", game, pytestconfig)
        game.send("3")
        assert_looks_like(f"inspector-{look}", game, pytestconfig)
        game.send("1M")
        game.wait_for("editing")
        assert_looks_like(f"editor-{look}", game, pytestconfig)


@pytest.mark.sampled
def test_the_level_editor(game: Terminal, pytestconfig: pytest.Config) -> None:
    game.send("M")
    game.wait_for("editing")
    assert_looks_like("editor", game, pytestconfig)


def test_a_wide_inspector(tmp_path: Path, pytestconfig: pytest.Config) -> None:
    with opened(tmp_path, (160, 30)) as game:
        game.send("n")
        game.wait_for("tick 1 ")
        game.wait_for("Decision of Ada")
        assert_looks_like("inspector", game, pytestconfig)


@pytest.mark.sampled
def test_after_some_steps(game: Terminal, pytestconfig: pytest.Config) -> None:
    for tick in range(1, STEPS + 1):
        game.send("n")
        game.wait_for(f"tick {tick} ")
    assert_looks_like(f"tick-{STEPS}", game, pytestconfig)


def assert_looks_like(name: str, game: Terminal, config: pytest.Config) -> None:
    """Wait until the screen is the stored picture of that name, or store it."""
    path = HERE / f"{name}.{game.screen.columns}x{game.screen.lines}.txt"
    if config.getoption("--update-snapshots"):
        game.wait_for_quiet()
        path.write_text(picture(cells_of(game.screen)), encoding="utf-8")
        return
    wanted = read_picture(path.read_text(encoding="utf-8"))
    try:
        game.wait_for(lambda: cells_of(game.screen) == wanted)
    except AssertionError:
        told = [
            f"the screen differs from {path.name}:",
            *differences(wanted, cells_of(game.screen)),
        ]
        pytest.fail("\n".join(told), pytrace=False)
