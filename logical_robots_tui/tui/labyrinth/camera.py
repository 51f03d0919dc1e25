"""The part of the labyrinth that is shown, how it changes, and what is drawn over it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple, Protocol

from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Viewport
from logical_robots_tui.world.level import Level

ZOOMS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0)
"""Zoom factors; at 1 the whole labyrinth fits."""

_NEAR = 3  # the default zoom for following a robot

_CALM = 0.22
"""The share of the view, on each side of its middle, in which a robot moves without scrolling."""


class Sight(Enum):
    """What the camera shows."""

    WHOLE = "whole"
    """The whole labyrinth."""
    FOLLOW = "follow"
    """A part around the selected robot."""
    SENSES = "senses"
    """What robots sense, one picture per robot."""
    FREE = "free"
    """A part that the player chose."""


class Overlay(Protocol):
    """Draws over the picture, and receives mouse and arrow keys; points are map units."""

    @property
    def cursor(self) -> tuple[float, float]:
        """The player's cursor; zooming keeps it in place."""

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture."""

    def press(self, x: float, y: float) -> None:
        """The left button was pressed."""

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        """The mouse moved, perhaps with the button held."""

    def release(self) -> None:
        """The button was released."""

    def open(self) -> None:
        """There was a double click."""

    def step(self, across: int, down: int, *, far: bool) -> None:
        """An arrow key was pressed, perhaps with shift."""


class Camera(NamedTuple):
    """The player's view: index into ``ZOOMS``, and its middle in map units."""

    sight: Sight = Sight.WHOLE
    step: int = 0
    x: float = 0.0
    y: float = 0.0

    @property
    def zoom(self) -> float:
        return ZOOMS[self.step]

    def viewport(self, level: Level, columns: int, rows: int) -> Viewport:
        whole = Viewport.fit(level.width, level.height, columns, rows)
        if self.sight not in (Sight.FOLLOW, Sight.FREE):
            return whole
        view = whole.zoomed(self.zoom)
        if self.sight is Sight.FREE:
            return view.centred(self.x, self.y)
        x = _beside_rim(self.x, view.width, level.width)
        return view.centred(x, _beside_rim(self.y, view.height, level.height))

    def next_sight(self) -> Camera:
        if self.sight is Sight.WHOLE:
            return self._replace(sight=Sight.FOLLOW, step=self.step or _NEAR)
        return self._replace(sight=Sight.SENSES if self.sight is Sight.FOLLOW else Sight.WHOLE)

    def following(self, x: float, y: float, view: Viewport, *, at_once: bool = False) -> Camera:
        """Centre a robot (map units) that has left the view's middle; always if `at_once`.

        A view that moved with every step would change every cell in every picture.
        """
        if self.sight is not Sight.FOLLOW:
            return self
        middle_x, middle_y = view.left + view.width / 2, view.top + view.height / 2
        is_calm_x = not at_once and abs(x - middle_x) <= _CALM * view.width
        is_calm_y = not at_once and abs(y - middle_y) <= _CALM * view.height
        if is_calm_x and is_calm_y:
            return self
        return self._replace(x=self.x if is_calm_x else x, y=self.y if is_calm_y else y)

    def zoomed(self, steps: int, view: Viewport, at: tuple[float, float] | None = None) -> Camera:
        """Zoom (out if negative) around a point in map units, or around a followed robot."""
        if self.sight is Sight.SENSES:
            return self
        step = min(max((self.step if self.sight is not Sight.WHOLE else 0) + steps, 0), _LAST)
        if step == 0 and self.sight is not Sight.FOLLOW:
            return Camera()
        if self.sight is Sight.FOLLOW:
            return self._replace(step=step)
        now = ZOOMS[self.step] if self.sight is Sight.FREE else 1.0
        middle = view.left + view.width / 2, view.top + view.height / 2
        x, y = at or middle
        share = now / ZOOMS[step]
        return Camera(Sight.FREE, step, x + (middle[0] - x) * share, y + (middle[1] - y) * share)

    def panned(self, columns: float, rows: float, view: Viewport, level: Level) -> Camera:
        if self.sight is Sight.SENSES:
            return self
        x = view.left + view.width / 2 + columns * view.units
        y = view.top + view.height / 2 + rows * view.units * CELL_ASPECT
        step = self.step if self.sight is not Sight.WHOLE else 0
        return Camera(
            Sight.FREE, step, min(max(x, 0.0), level.width), min(max(y, 0.0), level.height)
        )


def _beside_rim(middle: float, length: float, whole: float) -> float:
    """Return the closest middle that shows as little as possible beyond the map."""
    if length >= whole:
        return whole / 2
    return min(max(middle, length / 2), whole - length / 2)


_LAST = len(ZOOMS) - 1
