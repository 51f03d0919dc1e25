"""The level editor without its widgets: tools, strokes and the selection."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING, Any

from logical_robots_tui.editing import entities
from logical_robots_tui.editing.entities import Poses, Ref, level_at
from logical_robots_tui.editing.level_text import KINDS, Entity
from logical_robots_tui.editing.strokes import Point, fill, paint, paint_rectangle
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
"""Tools that place an object."""

WIDTHS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 40)
"""Choices for the width of brush and border, in grid squares."""

GRIDS = (1, 2, 5, 10, 20, 50)
"""Choices for the size of a grid square, in map units."""


@dataclass(frozen=True, slots=True)
class ToolSettings:
    """Settings of the tools: `width` in grid squares, `grid` in map units."""

    tool: Tool = Tool.HAND
    width: int = 1
    grid: int = 5
    is_grid_shown: bool = True
    is_wall: bool = True
    is_filled: bool = False


TURN = math.radians(15)
_NEW_RADIUS = 30.0  # map units, of an area that is placed without dragging
_LEAST_RADIUS = 2.0
_REACH = 1.5  # columns beside an object within which it is picked


@dataclass(slots=True)
class Stroke:
    """A stroke between pressing and releasing.

    `label` is its name for undo, "" before any change; `grip` the offset from an object's
    position.
    """

    label: str
    start: Point
    end: Point
    grip: Point = (0.0, 0.0)
    is_handle: bool = False
    has_changed: bool = False


class LevelEditor:
    """A level, tool, cursor and selection; an invalid change is reported without effect."""

    def __init__(
        self,
        edits: Edits,
        state: Callable[[], WorldState],
        on_change: Callable[[], None],
        warn: Callable[[str], None],
    ) -> None:
        self.edits = edits
        self.poses = Poses()
        self.settings = ToolSettings()
        self.selected: Ref | None = None
        self.cursor: Point = (float(edits.level.width // 2), float(edits.level.height // 2))
        self.stroke: Stroke | None = None
        self._state, self._on_change, self._warn = state, on_change, warn

    @property
    def level(self) -> Level:
        return self.edits.level

    @property
    def standing(self) -> Level:
        """The level with its robots at their current places."""
        return level_at(self.level, self._state())

    @property
    def is_under_way(self) -> bool:
        """Whether the robots have left their starts."""
        return self._state().tick > 0

    @property
    def entity(self) -> Entity | None:
        return None if self.selected is None else entities.entity_of(self.standing, self.selected)

    def configure(self, **values: Any) -> None:
        self.finish()
        self.settings = replace(self.settings, **values)

    def widen(self, steps: int) -> None:
        width = self.settings.width
        index = min(range(len(WIDTHS)), key=lambda index: abs(WIDTHS[index] - width))
        wider = WIDTHS[min(max(index + steps, 0), len(WIDTHS) - 1)]
        self.settings = replace(self.settings, width=wider)

    def choose_next_grid(self) -> None:
        larger = [grid for grid in GRIDS if grid > self.settings.grid]
        self.settings = replace(self.settings, grid=larger[0] if larger else GRIDS[0])

    def toggle_grid(self) -> None:
        self.settings = replace(self.settings, is_grid_shown=not self.settings.is_grid_shown)

    def press(self, x: float, y: float, units: float) -> None:
        """Start a stroke with the current tool, at map units.

        `units` is map units per column: an object can be picked from a little further away.
        """
        tool = self.settings.tool
        self.stroke = Stroke("", (x, y), (x, y))
        if tool is Tool.HAND:
            self._pick(x, y, units)
        elif tool in (Tool.BRUSH, Tool.ERASER):
            self.stroke.label = "brush" if tool is Tool.BRUSH else "eraser"
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
        previous, stroke.end = stroke.end, (x, y)
        if tool in (Tool.BRUSH, Tool.ERASER):
            self._paint(previous, (x, y))
        elif tool in PLACING or tool is Tool.HAND:
            self._drag_entity(stroke, x, y)

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
        if stroke is not None and stroke.has_changed:
            self.undo()
        return stroke is not None

    def do(self, label: str, work: Callable[[Level], Level], *, merge: bool = False) -> bool:
        """Change the level; return whether anything changed."""
        try:
            level = work(self.level)
        except LevelError as error:
            self._warn(error.message)
            return False
        if not self.edits.do(label, level, merge=merge):
            return False
        self._handle_change()
        return True

    def adopt(self, label: str, level: Level) -> None:
        self.selected = None
        self.edits.do(label, level)

    def undo(self) -> str:
        return self._report_step(self.edits.undo())

    def redo(self) -> str:
        return self._report_step(self.edits.redo())

    def _report_step(self, label: str) -> str:
        if label:
            self._handle_change()
        return label

    def set_values(self, ref: Ref, values: dict[str, Any]) -> None:
        """Set properties, leaving a robot under way in place, or raise LevelError."""
        self._note_pose(ref)
        level = entities.change(self.level, ref, **values)
        if ref.kind == "robots" and self.is_under_way:
            self.poses.note(level.robots[ref.index], self.standing.robots[ref.index])
        if self.edits.do("properties", level):
            self._handle_change()

    def change_level(self, label: str, level: Level) -> None:
        """Replace the level as an undo step; robots that it moves start where they are."""
        bodies = {robot.name: robot for robot in self.standing.robots}
        starts = {robot.name: robot for robot in self.level.robots}
        for robot in level.robots:
            if (body := bodies.get(robot.name)) is not None:
                start = starts[robot.name]
                self.poses.note(start, body)
                x, y = body.x + robot.x - start.x, body.y + robot.y - start.y
                self.poses.note(robot, replace(body, x=x, y=y))
        self.do(label, lambda _: level)

    def turn(self, steps: int) -> None:
        ref, robot = self.selected, self.entity
        if ref is None or not isinstance(robot, Robot):
            self._warn("Select a robot first.")
            return
        self._note_pose(ref)
        angle = (round(robot.angle / TURN) + steps) % round(math.tau / TURN) * TURN
        work = partial(entities.change, ref=ref, x=robot.x, y=robot.y, angle=angle)
        self.do(f"turn {robot.name}", work, merge=True)

    def duplicate(self) -> None:
        ref, entity = self.selected, self.entity
        if ref is None or entity is None:
            self._warn("Select something to duplicate first.")
            return
        distance = 2 * reach_of(entity) + 4
        room = self.level.width - reach_of(entity)
        across = distance if entity.x + distance < room else -distance

        def work(level: Level) -> Level:
            new_level, self.selected = entities.duplicate(level, ref, across, 0.0)
            return new_level

        self.do("duplicate", work)

    def delete(self) -> None:
        ref = self.selected
        if ref is None or self.entity is None:
            self._warn("Select something to delete first.")
        elif self.do("delete", lambda level: entities.remove(level, ref)):
            self.selected = None

    def select_next(self, steps: int) -> None:
        level = self.level
        refs = [Ref(kind, i) for kind in KINDS for i in range(len(getattr(level, kind)))]
        start = refs.index(self.selected) if self.selected in refs else (-1 if steps > 0 else 0)
        self.selected = refs[(start + steps) % len(refs)]
        entity = self.entity
        if entity is not None:
            self.cursor = (entity.x, entity.y)

    def _handle_change(self) -> None:
        ref = self.selected
        if ref is not None and ref.index >= len(getattr(self.level, ref.kind)):
            self.selected = None
        self._on_change()

    def _pick(self, x: float, y: float, units: float) -> None:
        entity, stroke = self.entity, self.stroke
        if stroke is None:
            return
        reach = _REACH * units
        handle = None if entity is None else handle_of(entity, units)
        if handle and math.hypot(x - handle[0], y - handle[1]) <= max(reach, 3.0):
            stroke.is_handle = True
            return
        self.selected = entities.ref_at(self.standing, x, y, reach)
        entity = self.entity
        if entity is None:
            self.stroke = None
        else:
            stroke.grip = x - entity.x, y - entity.y

    def _place(self, tool: Tool, x: float, y: float) -> None:
        new: Entity
        level, point = self.level, (round(x), round(y))
        if tool is Tool.ROBOT:
            new = Robot(_free_name("Robot", level.robots), *point)
        elif tool is Tool.BEACON:
            new = Beacon(_free_name("Beacon", level.beacons), *point)
        else:
            new = Area(_free_name("Area", level.areas), *point, _NEW_RADIUS)

        def work(level: Level) -> Level:
            new_level, self.selected = entities.add(level, new)
            return new_level

        label = f"place {tool.value}"
        if self.do(label, work) and self.stroke is not None:
            self.stroke.label, self.stroke.has_changed = label, True
            self.stroke.is_handle = tool is Tool.AREA
        else:
            self.stroke = None

    def _drag_entity(self, stroke: Stroke, x: float, y: float) -> None:
        ref, entity = self.selected, self.entity
        if ref is None or entity is None:
            return
        values: dict[str, Any] = {}
        if not stroke.is_handle:
            label = stroke.label or "move"
            values = {"x": round(x - stroke.grip[0]), "y": round(y - stroke.grip[1])}
            if isinstance(entity, Robot):
                values["angle"] = entity.angle
        elif isinstance(entity, Robot):
            label = "turn"
            angle = round(math.degrees(math.atan2(y - entity.y, x - entity.x)) / 5) * 5 % 360
            values = {"x": entity.x, "y": entity.y, "angle": math.radians(angle)}
        elif isinstance(entity, Area):
            label = stroke.label or "size"
            radius = round(math.hypot(x - entity.x, y - entity.y))
            values = {"radius": max(float(radius), _LEAST_RADIUS)}
        if not values:
            return
        if not stroke.has_changed:
            self._note_pose(ref)
        stroke.label = label
        work = partial(entities.change, ref=ref, **values)
        stroke.has_changed |= self.do(label, work, merge=stroke.has_changed)

    def _paint(self, start: Point, end: Point) -> None:
        stroke = self.stroke
        if stroke is None:
            return
        settings, wall = self.settings, self.settings.tool is Tool.BRUSH
        work = partial(
            paint, points=[start, end], width=settings.width, grid=settings.grid, wall=wall
        )
        stroke.has_changed |= self.do(stroke.label, work, merge=stroke.has_changed)

    def _note_pose(self, ref: Ref) -> None:
        if ref.kind == "robots":
            self.poses.note(self.level.robots[ref.index], self.standing.robots[ref.index])


def reach_of(entity: Entity) -> float:
    """Return the distance in map units from an object's centre to its edge."""
    if isinstance(entity, Area):
        return entity.radius
    return ROBOT_RADIUS if isinstance(entity, Robot) else BEACON_RADIUS


def handle_of(entity: Entity, units: float) -> Point | None:
    """Return an object's turn or resize handle, or None; `units` is map units per column."""
    if isinstance(entity, Robot):
        distance = max(2 * ROBOT_RADIUS, 3.5 * units)
        dx, dy = distance * math.cos(entity.angle), distance * math.sin(entity.angle)
        return entity.x + dx, entity.y + dy
    if isinstance(entity, Area):
        return entity.x + entity.radius, entity.y
    return None


def _free_name(stem: str, entities: Sequence[Entity]) -> str:
    names = (f"{stem} {number}" for number in range(1, len(entities) + 2))
    return next(name for name in names if name not in {entity.name for entity in entities})
