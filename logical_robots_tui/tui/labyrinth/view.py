"""The widget that shows a level and a frame of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

from rich.color import Color
from rich.style import Style
from textual import events, on
from textual.filter import ANSIToTruecolor, LineFilter
from textual.geometry import Offset, Region
from textual.message import Message
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.tui.labyrinth.drawing.cells import Palette
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas, Drawing, Highlight, Look
from logical_robots_tui.tui.labyrinth.drawing.picture import Picture, draw_senses
from logical_robots_tui.tui.labyrinth.drawing.rays import Traces
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Camera, Sight, Viewport
from logical_robots_tui.tui.terminal.diff_app import paint_target_of
from logical_robots_tui.tui.terminal.textual_internals import mark_rendered_stale
from logical_robots_tui.tui.theme.themes import palette_of
from logical_robots_tui.world import RobotState
from logical_robots_tui.world.level import Level, alike
from logical_robots_tui.world.sensing import ROBOT_RADIUS
from logical_robots_tui.world.world import Pose

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.ghost import Ghost


_PICK_REACH = 2.5  # columns beside a robot within which it is picked


class RobotPointed(Message):
    """The mouse points at another robot than before, or at none."""


@dataclass
class RobotPut(Message):
    name: str
    pose: Pose


class Grip(NamedTuple):
    """How a robot is held: `dx` and `dy` are map units from its centre to the pointer."""

    name: str
    dx: float
    dy: float
    is_turned: bool

    def put(self, robot: RobotState, x: float, y: float) -> RobotPut:
        """Return the robot's pose when the pointer is at a point in map units."""
        if self.is_turned:
            angle = math.atan2(y - robot.y, x - robot.x)
            return RobotPut(robot.name, (robot.x, robot.y, angle))
        return RobotPut(robot.name, (x - self.dx, y - self.dy, robot.angle))


class Overlay(Protocol):
    """Draws over the picture, and receives mouse and arrow keys; points are map units.

    `cursor` is kept in place by zooming; `step` are arrow keys, `far` with shift; `hover` tells
    whether the left button is held, `open` is a double click.
    """

    @property
    def cursor(self) -> tuple[float, float]: ...
    def paint(self, canvas: Canvas) -> None: ...
    def press(self, x: float, y: float) -> None: ...
    def hover(self, x: float, y: float, *, is_held: bool) -> None: ...
    def release(self) -> None: ...
    def open(self) -> None: ...
    def step(self, across: int, down: int, *, far: bool) -> None: ...


_CROWD = 30  # robots from which their light is left out while an overlay is drawn
_BEAT = 0.35  # seconds between changes of a beacon's brightness while the robots run


class LabyrinthView(Widget):
    """Shows one frame of a level, repainting only changes.

    `camera` is what to show; ``view`` is the resulting part of the map, and converts cells to
    map units and back.
    """

    DEFAULT_CSS = "LabyrinthView { width: 1fr; height: 1fr; }"
    ALLOW_SELECT = False

    rays: reactive[bool] = reactive(True, repaint=False)
    marks: reactive[bool] = reactive(True, repaint=False)
    lines: reactive[bool] = reactive(False, repaint=False)
    trails: reactive[bool] = reactive(True, repaint=False)
    drawing: reactive[Drawing] = reactive(Drawing.QUADRANTS, repaint=False)
    selected: reactive[str | None] = reactive[str | None](None, repaint=False)
    camera: reactive[Camera] = reactive(Camera(), repaint=False)
    palette: reactive[Palette | None] = reactive[Palette | None](None, repaint=False)
    ghost: reactive[Ghost | None] = reactive["Ghost | None"](None, repaint=False)

    class Looked(Message):
        """The player has changed the view."""

    @dataclass
    class RobotPicked(Message):
        name: str

    def __init__(self, clock: Clock = CLOCK) -> None:
        super().__init__(id="picture")
        self._clock = clock
        self._level: Level | None = None
        self._frame: Frame | None = None
        self._hurried = False
        self._picture = Picture()
        self._traces = Traces()
        self._cells = self._picture.cells
        self._strips: dict[int, Strip] = {}
        self.overlay: Overlay | None = None
        self.drags_robots = True
        self._highlight: tuple[Highlight, Frame] | None = None
        self._held: Offset | None = None
        self._is_dragged = self._is_drawing = False
        self._grip: Grip | None = None
        self.pointed: str | None = None

    @property
    def view(self) -> Viewport | None:
        return None if self._level is None else self.camera.viewport(self._level, *self.size)

    def show(self, level: Level, frame: Frame, *, hurried: bool = False) -> None:
        """Show a frame; if `hurried`, the next one follows at once, so less must be sent."""
        if self._level is None or _place_of(level) != _place_of(self._level):
            self._look(Camera())
            self._traces.forget()
        self._traces.record(frame)
        self._level, self._frame, self._hurried = level, frame, hurried
        self._look(self._following_camera())
        self.redraw()

    def highlight(self, highlight: Highlight | None, frame: Frame) -> None:
        self._highlight = None if highlight is None else (highlight, frame)
        self.redraw()

    @property
    def highlighted(self) -> Highlight | None:
        highlight, frame = self._highlight or (None, None)
        return highlight if frame is self._frame else None

    def look_at_next(self) -> None:
        """Switch to the next view: all, one robot, what robots sense, and all again."""
        self.camera = self.camera.next_sight()
        if self.camera.sight is Sight.FOLLOW:
            if self.selected is None:
                self.select_next()
            self.camera = self._following_camera(at_once=True)

    def zoom(self, steps: int, point: tuple[float, float] | None = None) -> None:
        """Zoom (out if negative) around a map point, by default the cursor or followed robot."""
        if self.view is None:
            return
        if self.overlay is not None:
            point = point or self.overlay.cursor
        if point is None and steps > 0 and self.selected and self.camera.sight is Sight.WHOLE:
            self._look(Camera(Sight.FOLLOW, steps))
            self.camera = self._following_camera(at_once=True)
        else:
            self.camera = self.camera.zoomed(steps, self.view, point)

    def pan(self, columns: float, rows: float) -> None:
        if self.view is not None and self._level is not None:
            self.camera = self.camera.panned(columns, rows, self.view, self._level)

    def select_next(self) -> None:
        if self._level is None:
            return
        names = [robot.name for robot in self._level.robots]
        index = names.index(self.selected) + 1 if self.selected in names else 0
        self.selected = names[index % len(names)]
        self.post_message(self.RobotPicked(self.selected))

    def _following_camera(self, *, at_once: bool = False) -> Camera:
        robot = self._robot(self.selected)
        if self.view is None or robot is None or not math.isfinite(robot.x + robot.y):
            return self.camera
        return self.camera.following(robot.x, robot.y, self.view, at_once=at_once)

    def _look(self, camera: Camera) -> None:
        if camera != self.camera:
            self.set_reactive(LabyrinthView.camera, camera)
            self.post_message(self.Looked())

    def robot_at(self, column: int, row: int) -> str | None:
        """Return the name of the robot nearest to a cell of this widget, if it is close."""
        view, frame = self.view, self._frame
        if view is None or frame is None or self.camera.sight is Sight.SENSES:
            return None
        x, y = view.position(row, column)
        reach = max(_PICK_REACH * view.units, ROBOT_RADIUS + CELL_ASPECT * view.units / 2)
        robots = frame.after.robots
        away = [(math.hypot(robot.x - x, robot.y - y), n) for n, robot in enumerate(robots)]
        distance, nearest = min(away, default=(math.inf, 0))
        return robots[nearest].name if distance <= reach else None

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return all filters except the conversion to true colour, which cells already have."""
        return [f for f in super().get_line_filters() if not isinstance(f, ANSIToTruecolor)]

    def render_line(self, y: int) -> Strip:
        columns, rows = self.size
        if self._cells.text.shape != (rows, columns):
            self._draw()
        strip = self._strips.get(y)
        if strip is None:
            if self._frame is None or not 0 <= y < self._cells.text.shape[0]:
                void = Color.from_rgb(*self._palette.void)
                return Strip.blank(columns, Style(color=void, bgcolor=void))
            strip = self._strips[y] = self._cells.strip(y)
        return strip

    @property
    def _palette(self) -> Palette:
        return self.palette or palette_of(self.app.current_theme)

    def _draw(self) -> list[tuple[int, int, int]]:
        """Draw, and return (row, first column, column after the last) of changes."""
        view = self.view
        if view is None or self._level is None or self._frame is None:
            return []
        # A brush must be faster than the light of a crowd.
        is_calm = self.overlay is not None and len(self._level.robots) > _CROWD
        look = Look(
            drawing=self.drawing,
            palette=self._palette,
            rays=self.rays and not is_calm,
            marks=self.marks and not is_calm,
            lines=self.lines,
            trails=self.trails and not is_calm,
            selected=self.selected,
            highlight=self.highlighted,
            pulse=int(self._clock.now() / _BEAT) if self._hurried else 0,
        )
        if self.camera.sight is Sight.SENSES:
            cells = draw_senses(self._level, self._frame, *self.size, look)
        else:
            frame, traces = self._frame, self._traces
            race, ghosts = self.ghost, None
            if race is not None and self.overlay is None and alike(race.level, self._level):
                ghosts = race.poses_at(frame.tick)
            cells = self._picture.draw(
                self._level, frame, view, look, traces, ghosts=ghosts, hurried=self._hurried
            )
            if self.overlay is not None:
                cells = cells.copy()
                self.overlay.paint(Canvas(cells, view, look))
        changes = cells.changes(self._cells)
        self._cells = cells
        for row, _, _ in changes:
            self._strips.pop(row, None)
        return changes

    def redraw(self) -> None:
        if not self.is_mounted or not self.size:
            return
        changes = self._draw()
        if not changes:
            return
        regions = [Region(first, row, stop - first, 1) for row, first, stop in changes]
        spot = None if self.get_line_filters() else paint_target_of(self)
        if spot is None:
            self.refresh(*regions)
        else:
            spot.put(self._cells, changes)
            mark_rendered_stale(self, regions)

    def on_mount(self) -> None:
        self.app.theme_changed_signal.subscribe(self, lambda _: self.redraw())

    def on_resize(self) -> None:
        self._strips.clear()
        self._draw()
        self.refresh()

    def on_click(self, event: events.Click) -> None:
        if self.overlay is not None:
            if event.chain == 2 and event.button == 1:
                self.overlay.open()
            return
        offset = event.get_content_offset(self)
        name = None if offset is None or self._is_dragged else self.robot_at(offset.x, offset.y)
        if name is not None:
            event.stop()
            self.post_message(self.RobotPicked(name))

    def on_mouse_down(self, event: events.MouseDown) -> None:
        if self.overlay is not None and event.button == 1 and (point := self._point(event)):
            self._is_drawing = True
            self.capture_mouse()
            self.overlay.press(*point)
            return
        self._held, self._is_dragged = event.screen_offset, False
        self._grip = None
        name = self.robot_at(event.x, event.y) if self.drags_robots else None
        if (robot := self._robot(name)) and (point := self._point(event)):
            is_turned = event.button != 1 or event.ctrl
            self._grip = Grip(robot.name, point[0] - robot.x, point[1] - robot.y, is_turned)
        self.capture_mouse()

    def on_mouse_up(self) -> None:
        self._held = self._grip = None
        self.release_mouse()
        if self._is_drawing and self.overlay is not None:
            self.overlay.release()
        self._is_drawing = False

    def on_mouse_move(self, event: events.MouseMove) -> None:
        if self._held is None:
            self._point_at(self.robot_at(event.x, event.y))
            if self.overlay is not None and (point := self._point(event)):
                self.overlay.hover(*point, is_held=self._is_drawing)
            return
        if event.screen_offset == self._held:
            return
        moved = self._held - event.screen_offset
        self._held, self._is_dragged = event.screen_offset, True
        if self._grip is None:
            self.pan(moved.x, moved.y)
        elif (robot := self._robot(self._grip.name)) and (point := self._point(event)):
            self.post_message(self._grip.put(robot, *point))

    def on_leave(self) -> None:
        self._point_at(None)

    def _point_at(self, name: str | None) -> None:
        if name != self.pointed:
            self.pointed = name
            self.post_message(RobotPointed())

    def _robot(self, name: str | None) -> RobotState | None:
        robots = self._frame.after.robots if self._frame else ()
        return next((robot for robot in robots if robot.name == name), None)

    def _point(self, event: events.MouseEvent) -> tuple[float, float] | None:
        """Return the pointer's map position; while a button is held, it may be off the picture."""
        view = self.view
        if view is None or self.camera.sight is Sight.SENSES:
            return None
        return view.position(event.y, event.x)

    @on(events.MouseScrollUp)
    @on(events.MouseScrollDown)
    def _wheel(self, event: events.MouseEvent) -> None:
        steps = 1 if isinstance(event, events.MouseScrollUp) else -1
        offset = event.get_content_offset(self)
        if offset is not None and self.view is not None:
            event.stop()
            self.zoom(steps, self.view.position(offset.y, offset.x))

    def watch_camera(self) -> None:
        self.redraw()
        self.post_message(self.Looked())

    watch_ghost = watch_camera

    def watch_selected(self) -> None:
        self._look(self._following_camera(at_once=True))
        self.redraw()

    def watch_rays(self) -> None:
        self.redraw()

    watch_marks = watch_lines = watch_trails = watch_drawing = watch_palette = watch_rays


def _place_of(level: Level) -> tuple[str, str, int, int]:
    """Return what identifies a level during editing; only a change of its size changes it."""
    return level.name, level.source, level.width, level.height
