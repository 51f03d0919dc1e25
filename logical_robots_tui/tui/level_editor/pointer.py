"""The mouse and the cursor keys while a level is edited."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.tui.level_editor.tools import Tool

if TYPE_CHECKING:
    from logical_robots_tui.editing.strokes import Point
    from logical_robots_tui.tui.level_editor.mode import EditMode

__all__ = ["Pointer"]

_FAR = 8  # steps of the cursor with shift
_WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}


class Pointer:
    """Tells the editor where the player points.

    Args:
        mode: What edits.
    """

    def __init__(self, mode: EditMode) -> None:
        self._mode = mode

    # -- the mouse -----------------------------------------------------------------------------

    def press(self, x: float, y: float) -> None:
        """A button was pressed at a point of the map."""
        editor = self._mode.editor
        editor.finish()
        editor.cursor = (x, y)
        editor.press(x, y, self._units)
        self._mode.redraw()

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        """The mouse is at a point of the map."""
        editor = self._mode.editor
        editor.cursor = (x, y)
        if is_held:
            editor.drag(x, y)
        self._mode.redraw()

    def release(self) -> None:
        """The button was let go."""
        self._mode.editor.release()
        self._mode.live.flush()
        self._mode.redraw()

    def open(self) -> None:
        """A thing was clicked twice."""
        editor = self._mode.editor
        if editor.settings.tool is Tool.HAND and editor.thing is not None:
            self._mode.do("properties")

    # -- keys ----------------------------------------------------------------------------------

    def move(self, key: str) -> None:
        """Move the cursor by an arrow key, and the view with it."""
        editor, view = self._mode.editor, self._mode.screen.labyrinth.view.view
        if view is None:
            return
        across, down = _WAYS[key.removeprefix("shift+")]
        times = _FAR if key.startswith("shift+") else 1
        grid = editor.settings.grid
        wide = math.ceil(view.units / grid) * grid
        high = math.ceil(view.units * CELL_ASPECT / grid) * grid
        level = editor.level
        x = min(max(editor.cursor[0] + across * times * wide, 0.0), level.width - 1.0)
        y = min(max(editor.cursor[1] + down * times * high, 0.0), level.height - 1.0)
        editor.cursor = (x, y)
        editor.drag(x, y)
        self._keep_in_sight((x, y))
        self._mode.redraw()

    def use(self) -> None:
        """Do at the cursor what pressing a button does, or what letting it go does."""
        editor = self._mode.editor
        if editor.stroke is None:
            editor.press(*editor.cursor, self._units)
        else:
            editor.release()
            self._mode.live.flush()

    def go_to(self, point: Point) -> None:
        """Put the cursor somewhere."""
        self._mode.editor.cursor = point
        self._keep_in_sight(point)

    @property
    def _units(self) -> float:
        view = self._mode.screen.labyrinth.view.view
        return view.units if view else 1.0

    def _keep_in_sight(self, point: Point) -> None:
        labyrinth = self._mode.screen.labyrinth.view
        view = labyrinth.view
        if view is None:
            return
        columns = _beyond((point[0] - view.left) / view.units, view.columns)
        rows = _beyond((point[1] - view.top) / (view.units * CELL_ASPECT), view.rows)
        if columns or rows:
            labyrinth.pan(columns, rows)


def _beyond(place: float, length: int) -> float:
    """By how many cells a view has to move so that a place is well inside; 0 if it is inside."""
    if 0 <= place < length:
        return 0.0
    return place - length * (0.25 if place < 0 else 0.75)
