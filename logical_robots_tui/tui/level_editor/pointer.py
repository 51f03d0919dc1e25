"""The mouse and the cursor keys in the level editor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.tui.level_editor.tools import Tool

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.editing.strokes import Point
    from logical_robots_tui.tui.labyrinth.view import LabyrinthView
    from logical_robots_tui.tui.level_editor.editor import LevelEditor

__all__ = ["Pointer"]

_FAR = 8  # cursor steps with shift
_WAYS = {"left": (-1, 0), "right": (1, 0), "up": (0, -1), "down": (0, 1)}


class Pointer:
    """Moves the editor's cursor.

    Args:
        editor: The level editor.
        picture: The view that draws the level.
        moved: Called after every move.
        released: Called at the end of a stroke.
        opened: Called when a thing is double-clicked.
    """

    def __init__(
        self,
        editor: LevelEditor,
        picture: LabyrinthView,
        *,
        moved: Callable[[], None],
        released: Callable[[], None],
        opened: Callable[[], None],
    ) -> None:
        self._editor, self._picture = editor, picture
        self._moved, self._released, self._opened = moved, released, opened

    # -- the mouse -----------------------------------------------------------------------------

    def press(self, x: float, y: float) -> None:
        """Press the button at a point of the map."""
        editor = self._editor
        editor.finish()
        editor.cursor = (x, y)
        editor.press(x, y, self._units)
        self._moved()

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        """Move the mouse to a point of the map."""
        editor = self._editor
        editor.cursor = (x, y)
        if is_held:
            editor.drag(x, y)
        self._moved()

    def release(self) -> None:
        """Release the button."""
        self._editor.release()
        self._released()
        self._moved()

    def open(self) -> None:
        """Double-click a thing."""
        editor = self._editor
        if editor.settings.tool is Tool.HAND and editor.thing is not None:
            self._opened()

    # -- keys ----------------------------------------------------------------------------------

    def move(self, key: str) -> None:
        """Move the cursor by an arrow key, and the view with it."""
        editor, view = self._editor, self._picture.view
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
        self._moved()

    def use(self) -> None:
        """Press or release the button at the cursor."""
        editor = self._editor
        if editor.stroke is None:
            editor.press(*editor.cursor, self._units)
        else:
            editor.release()
            self._released()

    def go_to(self, point: Point) -> None:
        """Move the cursor to a point."""
        self._editor.cursor = point
        self._keep_in_sight(point)

    @property
    def _units(self) -> float:
        view = self._picture.view
        return view.units if view else 1.0

    def _keep_in_sight(self, point: Point) -> None:
        view = self._picture.view
        if view is None:
            return
        columns = _beyond((point[0] - view.left) / view.units, view.columns)
        rows = _beyond((point[1] - view.top) / (view.units * CELL_ASPECT), view.rows)
        if columns or rows:
            self._picture.pan(columns, rows)


def _beyond(place: float, length: int) -> float:
    """Return by how many cells a view must move so that a place is well inside; 0 if it is."""
    if 0 <= place < length:
        return 0.0
    return place - length * (0.25 if place < 0 else 0.75)
