"""A room to edit, and pointing at places of it."""

from __future__ import annotations

from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest
from textual import events

from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from tests.short import AHEAD
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from logical_robots_tui.editing.editor import LevelEditor
    from logical_robots_tui.tui.level_editor.controller import LevelController
    from logical_robots_tui.world import Level
    from tests.tui.conftest import Opened

ROOM = """\
# A room that is mine.
title = "A room"
cell = 10
walls = '''
############################
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
############################
'''

[[robots]]
name = "Pip"
x = 40
y = 50 # in the middle

[[beacons]]
name = "Lamp"
x = 200
y = 30

[[areas]]
name = "Door"
x = 240
y = 50
radius = 15
goal_for = ["Pip"]
"""


@dataclass(frozen=True)
class Studio:
    """A game in which a level is edited."""

    game: Opened
    file: Path

    @property
    def controller(self) -> LevelController:
        return self.game.main.editing

    @property
    def editor(self) -> LevelEditor:
        return self.controller.editor

    @property
    def level(self) -> Level:
        return self.editor.level

    @property
    def live(self) -> Level:
        """The level that the game runs in."""
        return self.game.session.level

    def is_wall(self, x: int, y: int) -> bool:
        return bool(self.level.walls[y, x])

    async def press(self, *keys: str) -> None:
        await self.game.press(*keys)

    async def settled(self) -> None:
        await self.game.settled()

    async def drag(self, *points: tuple[float, float]) -> None:
        """Drag with the left button along points of the map; one point is a click."""
        await self._mouse(events.MouseDown, points[0])
        for point in points[1:]:
            await self._mouse(events.MouseMove, point)
        await self._mouse(events.MouseUp, points[-1])

    async def _mouse(self, kind: type[events.MouseEvent], point: tuple[float, float]) -> None:
        """Move the mouse as a terminal reports it; the pilot would wait for an idle processor."""
        view = self.game.main.labyrinth.view
        assert view.view is not None
        cell = view.view.cell(*point)
        assert cell is not None, f"{point} is out of sight"
        x, y = view.region.x + cell[1], view.region.y + cell[0]
        button = int(kind is not events.MouseMove)
        self.game.app.post_message(kind(None, x, y, 0, 0, button, False, False, False, x, y))
        await self.game.handled()

    @property
    def units(self) -> float:
        """Map units by which the mouse may be off."""
        view = self.game.main.labyrinth.view.view
        assert view is not None
        return view.units * CELL_ASPECT


@pytest.fixture
def room_file(tmp_path: Path) -> Path:
    path = tmp_path / "room.toml"
    path.write_text(ROOM, "utf-8")
    return path


@asynccontextmanager
async def studio(data_dir: Path, file: Path, **more: Any) -> AsyncIterator[Studio]:
    """Open a level and begin to edit it."""
    async with opened(data_dir, level=file, text=AHEAD, **more) as game:
        await game.ready()
        await game.press("M")
        await game.until(lambda: game.main.editing.is_on)
        yield Studio(game, file)


def replace_in(file: Path, old: str, new: str) -> None:
    file.write_text(file.read_text("utf-8").replace(old, new), "utf-8")
