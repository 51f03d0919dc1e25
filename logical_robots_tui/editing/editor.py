"""The level editor without its widgets: tools, strokes and the selection."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING, Any

from logical_robots_tui.editing import things
from logical_robots_tui.editing.level_text import KINDS, Thing
from logical_robots_tui.editing.strokes import Point, fill, paint, paint_rectangle
from logical_robots_tui.editing.things import Poses, Ref, as_it_stands
from logical_robots_tui.world import Area, Beacon, Level, LevelError, Robot, WorldState
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS

if TYPE_CHECKING:
    from logical_robots_tui.editing.edits import Edits


class Tool(Enum):
    """What the mouse button does; the values are command names."""

    HAND = "hand"
    BRUSH = "brush"
    LINE = "line"
    RECTANGLE = "rectangle"
    FILL = "fill"
    ERASER = "eraser"
    ROBOT = "robot"
    BEACON = "beacon"
    AREA = "area"


PAINTING = (Tool.BRUSH, Tool.LINE, Tool.RECTANGLE, Tool.ERASER)
"""Tools with a width."""

PLACING = (Tool.ROBOT, Tool.BEACON, Tool.AREA)
"""Tools that place something."""

WIDTHS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 40)
"""Choices for the width of brush and border, in grid squares."""

GRIDS = (1, 2, 5, 10, 20, 50)
"""Choices for the size of a grid square, in map units."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the tools: `width` in grid squares, `grid` in map units."""

    tool: Tool = Tool.HAND
    width: int = 1
    grid: int = 5
    is_grid_shown: bool = True
    is_wall: bool = True
    is_filled: bool = False

    @property
    def paints_wall(self) -> bool:
        return self.is_wall and self.tool is not Tool.ERASER


TURN = math.radians(15)
_NEW_RADIUS = 30.0  # map units, of an area that is placed without dragging
_LEAST_RADIUS = 2.0
_REACH = 1.5  # columns beside a thing within which it is picked


@dataclass(slots=True)
class Stroke:
    """A stroke between pressing and releasing.

    `what` is its name for undo, "" before any change; `grip` the offset from a thing's
    position.
    """

    what: str
    start: Point
    end: Point
    grip: Point = (0.0, 0.0)
    is_handle: bool = False
    has_done: bool = False


class LevelEditor:
    """A level, tool, cursor and selection; an invalid change is reported without effect."""

    def __init__(
        self,
        edits: Edits,
        state: Callable[[], WorldState],
        changed: Callable[[], None],
        complain: Callable[[str], None],
    ) -> None:
        self.edits = edits
        self.poses = Poses()
        self.settings = Settings()
        self.selected: Ref | None = None
        self.cursor: Point = (float(edits.level.width // 2), float(edits.level.height // 2))
        self.stroke: Stroke | None = None
        self._state, self._tell_changed, self._complain = state, changed, complain

    @property
    def level(self) -> Level:
        return self.edits.level

    @property
    def standing(self) -> Level:
        """The level with its robots at their current places."""
        return as_it_stands(self.level, self._state())

    @property
    def is_under_way(self) -> bool:
        """Whether the robots have left their starts."""
        return self._state().tick > 0

    @property
    def thing(self) -> Thing | None:
        return None if self.selected is None else things.thing(self.standing, self.selected)

    def configure(self, **values: Any) -> None:
        self.finish()
        self.settings = replace(self.settings, **values)

    def widen(self, steps: int) -> None:
        width = self.settings.width
        at = min(range(len(WIDTHS)), key=lambda place: abs(WIDTHS[place] - width))
        wider = WIDTHS[min(max(at + steps, 0), len(WIDTHS) - 1)]
        self.settings = replace(self.settings, width=wider)

    def choose_next_grid(self) -> None:
        later = [grid for grid in GRIDS if grid > self.settings.grid]
        self.settings = replace(self.settings, grid=later[0] if later else GRIDS[0])

    def toggle_grid(self) -> None:
        self.settings = replace(self.settings, is_grid_shown=not self.settings.is_grid_shown)

    def press(self, x: float, y: float, units: float) -> None:
        """Start a stroke with the current tool, at map units.

        `units` is map units per column: a thing can be picked from a little further away.
        """
        tool = self.settings.tool
        self.stroke = Stroke("", (x, y), (x, y))
        if tool is Tool.HAND:
            self._take(x, y, units)
        elif tool in (Tool.BRUSH, Tool.ERASER):
            self.stroke.what = "brush" if tool is Tool.BRUSH else "eraser"
            self._paint((x, y), (x, y))
        elif tool is Tool.FILL:
            self.stroke = None
            self.do("fill", lambda level: fill(level, x, y, wall=self.settings.is_wall))
        elif tool in PLACING:
            self._place(tool, x, y)

    def drag(self, x: float, y: float) -> None:
        stroke, tool = self.stroke, self.settings.tool
        if stroke is None or (x, y) == stroke.end:
            return
        before, stroke.end = stroke.end, (x, y)
        if tool in (Tool.BRUSH, Tool.ERASER):
            self._paint(before, (x, y))
        elif tool in PLACING or tool is Tool.HAND:
            self._drag_thing(stroke, x, y)

    def release(self) -> None:
        stroke, self.stroke = self.stroke, None
        if stroke is None:
            return
        tool, wall = self.settings.tool, self.settings.is_wall
        width, grid = self.settings.width, self.settings.grid
        if tool is Tool.LINE:
            points = [stroke.start, stroke.end]
            self.do("line", partial(paint, points=points, width=width, grid=grid, wall=wall))
        elif tool is Tool.RECTANGLE:
            corner, opposite = stroke.start, stroke.end
            border = 0 if self.settings.is_filled else width
            work = partial(paint_rectangle, corner=corner, opposite=opposite, border=border)
            self.do("rectangle", partial(work, grid=grid, wall=wall))

    def finish(self) -> None:
        """End the stroke before another action: keep its changes, but drop an unfinished line."""
        self.stroke = None

    def cancel(self) -> bool:
        stroke, self.stroke = self.stroke, None
        if stroke is not None and stroke.has_done:
            self.undo()
        return stroke is not None

    def do(self, what: str, work: Callable[[Level], Level], *, goes_on: bool = False) -> bool:
        """Change the level; return whether anything changed."""
        try:
            level = work(self.level)
        except LevelError as error:
            self._complain(error.message)
            return False
        if not self.edits.do(what, level, goes_on=goes_on):
            return False
        self._changed()
        return True

    def adopt(self, what: str, level: Level) -> None:
        self.selected = None
        self.edits.do(what, level)

    def undo(self) -> str:
        return self._noted(self.edits.undo())

    def redo(self) -> str:
        return self._noted(self.edits.redo())

    def _noted(self, what: str) -> str:
        if what:
            self._changed()
        return what

    def set_values(self, ref: Ref, values: dict[str, Any]) -> None:
        """Set properties, leaving a robot under way in place, or raise LevelError."""
        self._note_pose(ref)
        level = things.change(self.level, ref, **values)
        if ref.kind == "robots" and self.is_under_way:
            self.poses.note(level.robots[ref.index], self.standing.robots[ref.index])
        if self.edits.do("properties", level):
            self._changed()

    def change_level(self, what: str, level: Level) -> None:
        """Replace the level as an undo step; robots that it moves start where they are."""
        standing = {robot.name: robot for robot in self.standing.robots}
        starts = {robot.name: robot for robot in self.level.robots}
        for robot in level.robots:
            if (now := standing.get(robot.name)) is not None:
                start = starts[robot.name]
                self.poses.note(start, now)
                x, y = now.x + robot.x - start.x, now.y + robot.y - start.y
                self.poses.note(robot, replace(now, x=x, y=y))
        self.do(what, lambda _: level)

    def turn(self, steps: int) -> None:
        ref, robot = self.selected, self.thing
        if ref is None or not isinstance(robot, Robot):
            self._complain("Select a robot first.")
            return
        self._note_pose(ref)
        angle = (round(robot.angle / TURN) + steps) % round(math.tau / TURN) * TURN
        work = partial(things.change, ref=ref, x=robot.x, y=robot.y, angle=angle)
        self.do(f"turn {robot.name}", work, goes_on=True)

    def duplicate(self) -> None:
        ref, thing = self.selected, self.thing
        if ref is None or thing is None:
            self._complain("Select something to duplicate first.")
            return
        beside = 2 * reach_of(thing) + 4
        room = self.level.width - reach_of(thing)
        across = beside if thing.x + beside < room else -beside

        def work(level: Level) -> Level:
            changed, self.selected = things.duplicate(level, ref, across, 0.0)
            return changed

        self.do("duplicate", work)

    def delete(self) -> None:
        ref = self.selected
        if ref is None or self.thing is None:
            self._complain("Select something to delete first.")
        elif self.do("delete", lambda level: things.remove(level, ref)):
            self.selected = None

    def select_next(self, steps: int) -> None:
        level = self.level
        refs = [Ref(kind, i) for kind in KINDS for i in range(len(getattr(level, kind)))]
        start = refs.index(self.selected) if self.selected in refs else (-1 if steps > 0 else 0)
        self.selected = refs[(start + steps) % len(refs)]
        thing = self.thing
        if thing is not None:
            self.cursor = (thing.x, thing.y)

    def _changed(self) -> None:
        ref = self.selected
        if ref is not None and ref.index >= len(getattr(self.level, ref.kind)):
            self.selected = None
        self._tell_changed()

    def _take(self, x: float, y: float, units: float) -> None:
        thing, stroke = self.thing, self.stroke
        if stroke is None:
            return
        reach = _REACH * units
        handle = None if thing is None else handle_of(thing, units)
        if handle and math.hypot(x - handle[0], y - handle[1]) <= max(reach, 3.0):
            stroke.is_handle = True
            return
        self.selected = things.ref_at(self.standing, x, y, reach)
        thing = self.thing
        if thing is None:
            self.stroke = None
        else:
            stroke.grip = x - thing.x, y - thing.y

    def _place(self, tool: Tool, x: float, y: float) -> None:
        new: Thing
        level, at = self.level, (round(x), round(y))
        if tool is Tool.ROBOT:
            new = Robot(_free("Robot", level.robots), *at)
        elif tool is Tool.BEACON:
            new = Beacon(_free("Beacon", level.beacons), *at)
        else:
            new = Area(_free("Area", level.areas), *at, _NEW_RADIUS)

        def work(level: Level) -> Level:
            changed, self.selected = things.add(level, new)
            return changed

        what = f"place {tool.value}"
        if self.do(what, work) and self.stroke is not None:
            self.stroke.what, self.stroke.has_done = what, True
            self.stroke.is_handle = tool is Tool.AREA
        else:
            self.stroke = None

    def _drag_thing(self, stroke: Stroke, x: float, y: float) -> None:
        ref, thing = self.selected, self.thing
        if ref is None or thing is None:
            return
        values: dict[str, Any] = {}
        if not stroke.is_handle:
            what = stroke.what or "move"
            values = {"x": round(x - stroke.grip[0]), "y": round(y - stroke.grip[1])}
            if isinstance(thing, Robot):
                values["angle"] = thing.angle
        elif isinstance(thing, Robot):
            what = "turn"
            angle = round(math.degrees(math.atan2(y - thing.y, x - thing.x)) / 5) * 5 % 360
            values = {"x": thing.x, "y": thing.y, "angle": math.radians(angle)}
        elif isinstance(thing, Area):
            what = stroke.what or "size"
            radius = round(math.hypot(x - thing.x, y - thing.y))
            values = {"radius": max(float(radius), _LEAST_RADIUS)}
        if not values:
            return
        if not stroke.has_done:
            self._note_pose(ref)
        stroke.what = what
        work = partial(things.change, ref=ref, **values)
        done = self.do(what, work, goes_on=stroke.has_done)
        stroke.has_done = stroke.has_done or done

    def _paint(self, start: Point, end: Point) -> None:
        stroke = self.stroke
        if stroke is None:
            return
        settings, wall = self.settings, self.settings.tool is Tool.BRUSH
        work = partial(
            paint, points=[start, end], width=settings.width, grid=settings.grid, wall=wall
        )
        done = self.do(stroke.what, work, goes_on=stroke.has_done)
        stroke.has_done = stroke.has_done or done

    def _note_pose(self, ref: Ref) -> None:
        if ref.kind == "robots":
            self.poses.note(self.level.robots[ref.index], self.standing.robots[ref.index])


def reach_of(thing: Thing) -> float:
    """Return the distance in map units from a thing's centre to its edge."""
    if isinstance(thing, Area):
        return thing.radius
    return ROBOT_RADIUS if isinstance(thing, Robot) else BEACON_RADIUS


def handle_of(thing: Thing, units: float) -> Point | None:
    """Return a thing's turn or resize handle, or None; `units` is map units per column."""
    if isinstance(thing, Robot):
        away = max(2 * ROBOT_RADIUS, 3.5 * units)
        return thing.x + away * math.cos(thing.angle), thing.y + away * math.sin(thing.angle)
    if isinstance(thing, Area):
        return thing.x + thing.radius, thing.y
    return None


def _free(stem: str, there: Sequence[Thing]) -> str:
    names = (f"{stem} {number}" for number in range(1, len(there) + 2))
    return next(name for name in names if name not in {each.name for each in there})
