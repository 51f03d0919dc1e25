"""The widget that shows a level and a frame of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from rich.color import Color
from rich.style import Style
from textual.geometry import Region
from textual.message import Message
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from logical_robots_tui.tui.drawing.glyphs import Drawing
from logical_robots_tui.tui.drawing.look import Look
from logical_robots_tui.tui.drawing.palette import DARK, LIGHT, Palette
from logical_robots_tui.tui.drawing.picture import Picture
from logical_robots_tui.tui.drawing.viewport import CELL_ASPECT, Viewport
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from textual import events

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.world.level import Level

__all__ = ["LabyrinthView"]

_PICK_REACH = 2.5
"""Columns beside a robot at which a click still means it."""


class LabyrinthView(Widget):
    """Shows one frame of a level.

    Only what changed since the last frame is repainted.

    Attributes:
        rays: Whether the robots' radar is shown as light.
        marks: Whether the ends of rays are marked.
        names: Whether names are shown.
        drawing: Which characters draw the labyrinth.
        selected: Name of the robot to bring out, or None.
        viewport: The part of the map to show, whatever its number of cells; None is all of it.
        palette: Colours, or None for those that suit the theme.
    """

    DEFAULT_CSS = """
    LabyrinthView {
        width: 1fr;
        height: 1fr;
    }
    """
    ALLOW_SELECT: ClassVar[bool] = False

    rays: reactive[bool] = reactive(True, repaint=False)
    marks: reactive[bool] = reactive(True, repaint=False)
    names: reactive[bool] = reactive(True, repaint=False)
    drawing: reactive[Drawing] = reactive(Drawing.QUADRANTS, repaint=False)
    selected: reactive[str | None] = reactive[str | None](None, repaint=False)
    viewport: reactive[Viewport | None] = reactive[Viewport | None](None, repaint=False)
    palette: reactive[Palette | None] = reactive[Palette | None](None, repaint=False)

    class RobotPicked(Message):
        """A robot was clicked.

        Attributes:
            view: Where.
            name: The robot's name.
        """

        def __init__(self, view: LabyrinthView, name: str) -> None:
            super().__init__()
            self.view = view
            self.name = name

        @property
        def control(self) -> LabyrinthView:
            """The view, for handlers that select by it."""
            return self.view

    def __init__(
        self,
        *,
        name: str | None = None,
        id: str | None = None,  # noqa: A002 - the name that Textual gives it
        classes: str | None = None,
    ) -> None:
        super().__init__(name=name, id=id, classes=classes)
        self._level: Level | None = None
        self._frame: Frame | None = None
        self._hurried = False
        self._picture = Picture()
        self._strips: dict[int, Strip] = {}

    @property
    def view(self) -> Viewport | None:
        """What is shown at present; None before the first frame."""
        level, (columns, rows) = self._level, self.size
        if level is None:
            return None
        if self.viewport is None:
            return Viewport.fit(level.width, level.height, columns, rows)
        wanted = self.viewport
        x, y = wanted.left + wanted.width / 2, wanted.top + wanted.height / 2
        return replace(wanted, columns=columns, rows=rows).centred(x, y)

    def show(self, level: Level, frame: Frame, *, hurried: bool = False) -> None:
        """Show a frame.

        Args:
            level: The level that it belongs to.
            frame: What to show.
            hurried: Whether the next frame follows at once, so that less need be sent.
        """
        self._level, self._frame, self._hurried = level, frame, hurried
        self._redraw()

    def robot_at(self, column: int, row: int) -> str | None:
        """Return the name of the robot nearest to a cell of this widget, if one is near."""
        view, frame = self.view, self._frame
        if view is None or frame is None:
            return None
        x, y = view.position(row, column)
        reach = max(_PICK_REACH * view.units, ROBOT_RADIUS + CELL_ASPECT * view.units / 2)
        found = [
            (distance, robot.name)
            for robot in frame.after.robots
            if (distance := math.hypot(robot.x - x, robot.y - y)) <= reach
        ]
        return min(found)[1] if found else None

    def render_line(self, y: int) -> Strip:
        """Return a line of the picture.

        Args:
            y: Its row.
        """
        columns, rows = self.size
        if self._picture.cells.text.shape != (rows, columns):
            self._draw()
        strip = self._strips.get(y)
        if strip is None:
            if self._frame is None or not 0 <= y < self._picture.cells.text.shape[0]:
                void = Color.from_rgb(*self._palette.void)
                return Strip.blank(columns, Style(color=void, bgcolor=void))
            strip = self._strips[y] = self._picture.cells.strip(y)
        return strip

    @property
    def _palette(self) -> Palette:
        return self.palette or (DARK if self.app.current_theme.dark else LIGHT)

    def _draw(self) -> list[Region]:
        """Draw the frame and return where the picture changed."""
        view = self.view
        if view is None or self._level is None or self._frame is None:
            return []
        look = Look(
            drawing=self.drawing,
            palette=self._palette,
            rays=self.rays,
            marks=self.marks,
            names=self.names,
            selected=self.selected,
        )
        changes = self._picture.draw(self._level, self._frame, view, look, hurried=self._hurried)
        for row, _, _ in changes:
            self._strips.pop(row, None)
        return [Region(first, row, stop - first, 1) for row, first, stop in changes]

    def _redraw(self) -> None:
        if not self.is_mounted or not self.size:
            return
        regions = self._draw()
        if regions:
            self.refresh(*regions)

    def on_mount(self) -> None:
        """Follow the theme."""
        self.app.theme_changed_signal.subscribe(self, lambda _: self._redraw())

    def on_resize(self) -> None:
        """Fit the picture to the new size."""
        self._strips.clear()
        self._draw()
        self.refresh()

    def on_click(self, event: events.Click) -> None:
        """Tell which robot was clicked."""
        offset = event.get_content_offset(self)
        name = None if offset is None else self.robot_at(offset.x, offset.y)
        if name is not None:
            event.stop()
            self.post_message(self.RobotPicked(self, name))

    def watch_rays(self) -> None:
        """Show it."""
        self._redraw()

    watch_marks = watch_names = watch_drawing = watch_selected = watch_rays
    watch_viewport = watch_palette = watch_rays
