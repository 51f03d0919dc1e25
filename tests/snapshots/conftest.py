"""The game on a screen in memory, drawn into a terminal as it would be into a real one."""

from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import Protocol

import pyte
import pytest
from pyte.modes import DECAWM
from textual.drivers.headless_driver import HeadlessDriver
from textual.widget import Widget

from logical_robots_tui.player.settings import Settings
from logical_robots_tui.tui.inspector import pane as inspector_pane
from logical_robots_tui.tui.terminal import diff_app
from tests.snapshots.picture import Cell, cells_of, differences, picture, read_picture
from tests.tui.conftest import (
    Opened,
    _no_trials,
    _time_of_the_loop,
    opened,
    pytest_asyncio_loop_factories,
)

__all__ = ["_no_trials", "_time_of_the_loop", "pytest_asyncio_loop_factories"]

HERE = Path(__file__).parent
LOOKS = {
    "light": {},
    "256-colours": {"COLORTERM": ""},
    "16-colours": {"TERM": "xterm", "COLORTERM": ""},
    "no-colours": {"NO_COLOR": "1"},
}
ALL_COLOURS = {"TERM": "xterm-256color", "COLORTERM": "truecolor"}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Draw all snapshots anew, not a tenth of them."""
    for item in items:
        if config.getoption("--update-snapshots") and item.path.parent == HERE:
            item.own_markers = [mark for mark in item.own_markers if mark.name != "sampled"]


class Shown:
    """A game and the terminal in which it is shown; notes where that differs from snapshots."""

    def __init__(self, game: Opened, sent: list[str], look: str, is_to_be_kept: bool) -> None:
        self.game = game
        self._sent, self._look, self._is_to_be_kept = sent, look, is_to_be_kept
        screen = pyte.Screen(*game.app.size)
        screen.reset_mode(DECAWM)
        self._screen, self._stream = screen, pyte.Stream(screen)
        self.told: list[str] = []

    async def resize(self, columns: int, lines: int) -> None:
        """Give the terminal another size; what was shown in it is sent anew."""
        await self.game.pilot.resize_terminal(columns, lines)
        self._screen.resize(lines, columns)

    async def compare(self, name: str, *widgets: Widget) -> None:
        """Compare what is shown of widgets, one below the other, or of everything, or keep it."""
        await self.game.later(1)  # until nothing is pending
        self._stream.feed("".join(self._sent))
        self._sent.clear()
        cells = _part(cells_of(self._screen), *widgets)
        size = "x".join(map(str, self.game.app.size))
        path = HERE / f"{'-'.join(filter(None, (name, self._look)))}.{size}.txt"
        if self._is_to_be_kept:
            path.write_text(picture(cells), encoding="utf-8")
        elif told := list(differences(read_picture(path.read_text(encoding="utf-8")), cells)):
            self.told += [f"{path.name} is not what is shown:", *told]


def _part(lines: list[list[Cell]], *widgets: Widget) -> list[list[Cell]]:
    regions = [widget.region for widget in widgets]
    if not regions:
        return lines
    return [lines[y][region.x : region.right] for region in regions for y in region.line_range]


class Show(Protocol):
    def __call__(
        self, size: tuple[int, int], look: str = ""
    ) -> AbstractAsyncContextManager[Shown]: ...


@pytest.fixture
def show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pytestconfig: pytest.Config) -> Show:
    """Opens the game at tick 0 in a terminal of some size, by default with all colours.

    What differs from the snapshots is told at the end.
    """
    sent: list[str] = []
    monkeypatch.setattr(inspector_pane, "_LOADING_DELAY", 0.0)
    monkeypatch.setattr(diff_app, "ListeningDriver", HeadlessDriver)
    monkeypatch.setattr(HeadlessDriver, "write", lambda _, data: sent.append(data))
    monkeypatch.setattr(HeadlessDriver, "ask", lambda *_: None, raising=False)

    @asynccontextmanager
    async def show(size: tuple[int, int], look: str = "") -> AsyncIterator[Shown]:
        monkeypatch.delenv("NO_COLOR", raising=False)
        for name, value in (ALL_COLOURS | LOOKS.get(look, {})).items():
            monkeypatch.setenv(name, value)
        async with opened(
            tmp_path / "data",
            level=HERE / "snapshot.toml",
            text=(HERE / "snapshot.l").read_text(encoding="utf-8"),
            name="snapshot",
            size=size,
            settings=Settings(theme="textual-light" if look == "light" else None),
        ) as game:
            game.app.suit_terminal()
            await game.ready()
            shown = Shown(game, sent, look, pytestconfig.getoption("--update-snapshots"))
            yield shown
        if shown.told:
            pytest.fail("\n".join(shown.told), pytrace=False)

    return show
