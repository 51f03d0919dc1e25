"""The radar of robots as light, marks and lines, and the trails behind them.

Lines are drawn in braille, eight dots to a cell, or by a character where the font may not have it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, RGB, mix, rgb_number, text_id
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas, Drawing
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Floats, Raster, Viewport
from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame

_FINE = 16  # steps between two rays in which the shape of a fan is tabulated
_STEPS = 12  # steps of brightness

_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], np.int64)
"""The bit of each dot of a braille cell, down and across (Unicode, block Braille Patterns)."""

_BRAILLE = np.array([text_id(chr(0x2800 + bits)) for bits in range(256)], np.int64)
_RING = 2.2  # radius of the ring around a highlighted robot, in radii of a robot
_LEAST_RING = 2.5  # the same at least, in columns
_FADES = 4  # steps in which a trail fades; each changes every cell of it once

_FAINTEST, _STRONGEST = 0.35, 0.85
"""Part of a robot's colour in the oldest and the newest part of its trail."""

_FADE = (_STRONGEST - _FAINTEST) / (_FADES - 1)
_TRAIL = 160  # ticks that a trail is long
_FLASH = 12  # ticks for which an area shows that it was switched

_KINDS = {"robot": 3, "beacon": 2, "wall": 1}
"""What a ray may hit; a greater number is more important."""


@dataclass(frozen=True, eq=False)
class Fan:
    """The rays of one robot in one tick; places and distances are map units.

    `headings` are clockwise from the right in radians, ascending and evenly spread; `ahead` is
    the heading of the ray with the angle 0; `objects` are ``wall``, ``robot``, ``beacon`` or
    ``none``.
    """

    name: str
    x: float
    y: float
    headings: Floats
    distances: Floats
    objects: Sequence[str]
    labels: Sequence[str]
    ahead: float

    def sightings(self) -> Iterable[tuple[float, float, str, str]]:
        """Yield (x, y, object, label) of each sensed beacon and robot, by its middle ray."""
        rays: dict[tuple[str, str], list[int]] = {}
        for ray, hit in enumerate(zip(self.objects, self.labels, strict=True)):
            if hit[0] in ("beacon", "robot"):
                rays.setdefault(hit, []).append(ray)
        for (kind, label), hits in rays.items():
            ray = hits[len(hits) // 2]
            away, heading = float(self.distances[ray]), float(self.headings[ray])
            yield self.x + away * math.cos(heading), self.y + away * math.sin(heading), kind, label

    def points(self) -> tuple[Floats, Floats]:
        """Return the map units x and y where the rays end."""
        with np.errstate(over="ignore", invalid="ignore"):
            x = self.x + self.distances * np.cos(self.headings)
            return x, self.y + self.distances * np.sin(self.headings)

    def points_along(self, ray: int, away: Floats) -> tuple[Floats, Floats]:
        """Return the map units x and y of places on a ray."""
        heading = float(self.headings[ray])
        return self.x + away * np.cos(heading), self.y + away * np.sin(heading)

    def nearest(self, angle: float) -> int:
        """Return the number of the ray nearest to an angle in radians, as programs read it."""
        return int(np.abs(self.headings - (self.ahead - angle)).argmin())


def fans(frame: Frame) -> list[Fan]:
    """Return the fan of each robot that sensed, from its position at that time."""
    poses = {robot.name: robot for robot in frame.before.robots}
    robot_fans = []
    for row in frame.sensors:
        pose, radar = poses.get(row["robot_name"]), row["sensor"]["radar"]
        if pose is None or len(radar) < 2:
            continue
        if not all(map(math.isfinite, (pose.x, pose.y, pose.angle))):
            continue
        robot_fans.append(
            Fan(
                name=pose.name,
                x=pose.x,
                y=pose.y,
                headings=pose.angle - np.array([ray["angle"] for ray in radar], np.float64),
                distances=np.array([ray["distance"] for ray in radar], np.float64),
                objects=[ray["object"] for ray in radar],
                labels=[str(ray["label"]) for ray in radar],
                ahead=pose.angle,
            )
        )
    return robot_fans


def brightness_of(fan: Fan, raster: Raster) -> tuple[tuple[slice, slice], Floats] | None:
    """Return a window of dots and a fan's brightness there, 0 to 1; None out of sight."""
    spill = 1.5 * raster.dot + 2
    reach = fan.distances + spill
    x, y = fan.x + reach * np.cos(fan.headings), fan.y + reach * np.sin(fan.headings)
    window = raster.window(
        min(fan.x, float(x.min())),
        max(fan.x, float(x.max())),
        min(fan.y, float(y.min())),
        max(fan.y, float(y.max())),
    )
    if window is None:
        return None
    dx, dy = raster.offsets(window, fan.x, fan.y)
    distance = np.sqrt(dx * dx + dy * dy)

    # Turn so that the middle of the fan is 0: it is far from where angles wrap around.
    first, last = float(fan.headings[0]), float(fan.headings[-1])
    middle, half = (first + last) / 2, (last - first) / 2
    half = half if abs(half) > 1e-6 else 1e-6
    cos, sin = np.float32(math.cos(middle)), np.float32(math.sin(middle))
    aside = np.arctan2(dy * cos - dx * sin, dx * cos + dy * sin)
    count = len(fan.distances)
    offset = aside * np.float32((count - 1) / (2 * half) * _FINE) + np.float32((count / 2) * _FINE)
    slots = np.clip(offset + 1, 0, count * _FINE + 1).astype(np.int32)

    ends, solid, line = _shape(fan)
    end = ends[slots]
    light = np.clip((end + solid[slots] * np.float32(spill) - distance) / raster.dot + 0.5, 0, 1)
    light *= 1 - np.float32(0.6 / SENSOR_RANGE) * distance
    # Rays show one by one where they are several dots apart.
    apart = distance * np.float32(2 * half / (count - 1) / raster.dot)
    light *= 1 - line[slots] * np.clip((apart - 4) / 16, 0, 0.25)
    # In few steps, so that a robot that moves a little changes few cells.
    return window, np.rint(np.maximum(light, 0) * _STEPS) * np.float32(1 / _STEPS)


def _shape(fan: Fan) -> tuple[Floats, Floats, Floats]:
    """Tabulate a fan by angle, ``_FINE`` slots around each ray, a dark one before and after.

    Returns where the light ends, 1 where that is a wall, and how far a slot is from the ray, 0
    on it to 1 between two.
    """
    count = len(fan.distances)
    nearest, low, part, line = _slots(count)
    first, second = fan.distances[low], fan.distances[low + 1]
    # Between rays that end on the same thing the end is nearly a straight line, and along one
    # the inverse of the distance grows evenly.
    between = 1 / ((1 - part) / np.maximum(first, 1) + part / np.maximum(second, 1))
    smooth = np.abs(first - second) < 0.3 * np.minimum(first, second) + 3
    ends = np.full(count * _FINE + 2, -1e9, np.float32)
    ends[1:-1] = np.where(smooth, between, fan.distances[nearest])
    solid = np.zeros(count * _FINE + 2, np.float32)
    solid[1:-1] = np.array([name == "wall" for name in fan.objects])[nearest]
    return ends, solid, line


@lru_cache(maxsize=8)
def _slots(count: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
    """Return each slot's nearest ray, the one before it, and how far it is past that one.

    Last, with the slots outside, how far each is from the nearest ray.
    """
    place = (np.arange(count * _FINE) + 0.5) / _FINE - 0.5
    nearest = np.rint(place).astype(np.int64).clip(0, count - 1)
    low = np.floor(place).astype(np.int64).clip(0, count - 2)
    line = np.zeros(count * _FINE + 2, np.float32)
    line[1:-1] = 2 * np.abs(place - nearest)
    return nearest, low, np.clip(place - low, 0, 1), line


def mark_ends(
    canvas: Canvas, fans: Sequence[Fan], robots: Iterable[tuple[RobotState, RGB]]
) -> None:
    """Mark where rays end, the most important in a cell, but not on robots' bodies."""
    if not fans:
        return
    cells, view, look = canvas
    cell_kinds = _ends(fans, view)
    if view.shows_bodies:
        for robot, _ in robots:
            _clear_body(cell_kinds, robot, view)
    glyphs, palette = look.glyphs, look.palette
    at_wall = glyphs.hit_wall_near if view.shows_bodies else glyphs.hit_wall
    texts = [text_id(text) for text in (at_wall, glyphs.hit_beacon, glyphs.hit_robot)]
    inks = [rgb_number(ink) for ink in (palette.hit_wall, palette.hit_beacon, palette.hit_robot)]
    marked = cell_kinds > 0
    kinds = cell_kinds[marked] - 1
    cells.text[marked] = np.array(texts)[kinds]
    style = np.array(inks)[kinds] << 24 | np.where(kinds, BOLD, 0)
    cells.style[marked] = style | cells.tone[marked]


def _ends(fans: Sequence[Fan], view: Viewport) -> NDArray[np.int64]:
    kinds = np.array([_KINDS.get(hit, 0) for fan in fans for hit in fan.objects])
    rows, columns, inside = view.dots(*np.concatenate([fan.points() for fan in fans], axis=1))
    kinds = kinds[inside]
    order = np.argsort(kinds, kind="stable")
    cell_kinds = np.zeros((view.rows, view.columns), np.int64)
    cell_kinds[rows[order], columns[order]] = kinds[order]
    return cell_kinds


def _clear_body(cell_kinds: NDArray[np.int64], robot: RobotState, view: Viewport) -> None:
    cell = view.cell(robot.x, robot.y)
    if cell is None:
        return
    reach = 0.8 * ROBOT_RADIUS
    across = round(reach / view.units)
    down = round(reach / (view.units * CELL_ASPECT))
    for row in range(max(cell[0] - down, 0), min(cell[0] + down + 1, view.rows)):
        for column in range(max(cell[1] - across, 0), min(cell[1] + across + 1, view.columns)):
            x, y = view.position(row, column)
            if math.hypot(x - robot.x, y - robot.y) < reach:
                cell_kinds[row, column] = 0


def draw_trails(canvas: Canvas, places: Floats, ages: Floats, colours: Sequence[RGB]) -> None:
    """Draw trails of shape (moments, robots, 2), map units, oldest first; ages from 1 to 0."""
    floor = canvas.look.palette.floor
    shares = [_FAINTEST + step * _FADE for step in range(_FADES)]
    inks = np.array(
        [[rgb_number(mix(floor, colour, share)) for share in shares] for colour in colours]
    )
    fresh = np.floor((1 - ages) * _FADES).clip(0, _FADES - 1).astype(np.int64)
    moments, robots = places.shape[:2]
    # Moments come oldest first, so that the newest has the last word on a cell's colour.
    ink = inks[np.tile(np.arange(robots), moments), np.repeat(fresh, robots)]
    _draw(canvas, places[..., 0].ravel(), places[..., 1].ravel(), ink)


def draw_rays(canvas: Canvas, fan: Fan, colour: RGB) -> None:
    # Near the robot rays would only be a blot.
    rays = [
        fan.points_along(ray, np.arange(min(12.0, distance), distance, canvas.view.units / 2))
        for ray, distance in enumerate(fan.distances.tolist())
    ]
    x, y = np.concatenate(rays, axis=1)
    _draw(canvas, x, y, rgb_number(mix(colour, canvas.look.palette.bright, 0.3)))


def draw_ring(canvas: Canvas, x: float, y: float) -> None:
    radius = max(_RING * ROBOT_RADIUS, _LEAST_RING * canvas.view.units)
    turn = np.linspace(0, 2 * np.pi, 120)
    ink = rgb_number(canvas.look.palette.bright)
    _draw(canvas, x + radius * np.cos(turn), y + radius * np.sin(turn), ink)


def draw_ray(canvas: Canvas, fan: Fan, angle: float) -> None:
    """Draw a highlighted ray by the program's angle, in radians, with a mark at its end."""
    _, view, look = canvas
    glyphs, palette = look.glyphs, look.palette
    ray = fan.nearest(angle)
    distance = float(fan.distances[ray])
    # The robot's own cell stays as it is.
    start = min(max(ROBOT_RADIUS, 1.5 * view.units), distance)
    places = fan.points_along(ray, np.arange(start, distance, view.units / 4))
    _draw(canvas, *places, rgb_number(palette.bright))
    signs = {
        "wall": (glyphs.hit_wall_near, palette.hit_wall),
        "beacon": (glyphs.hit_beacon, palette.hit_beacon),
        "robot": (glyphs.hit_robot, palette.hit_robot),
    }
    sign, paper = signs.get(fan.objects[ray], (glyphs.thread, palette.dead))
    x, y = fan.points()
    canvas.put(view.cell(float(x[ray]), float(y[ray])), sign, palette.plate, paper)


def _draw(canvas: Canvas, x: Floats, y: Floats, ink: NDArray[np.int64] | int) -> None:
    """Set a dot for each point; the last point in a cell determines its colour."""
    cells, view, look = canvas
    down, across, inside = view.dots(x, y, across=2, down=4)
    row, column = down // 4, across // 2
    if look.drawing in (Drawing.QUADRANTS, Drawing.SEXTANTS):
        bits = np.zeros(cells.text.shape, np.int64)
        np.bitwise_or.at(bits, (row, column), _BITS[down % 4, across % 2])
        cells.text[row, column] = _BRAILLE[bits[row, column]]
    else:
        cells.text[row, column] = text_id(look.glyphs.thread)
    cells.style[row, column] = np.broadcast_to(ink, x.shape)[inside] << 24 | cells.tone[row, column]


class Traces:
    """Recent positions of robots and states of areas, from the frames that were shown.

    Earlier ticks stay after going back; those that differ under another program are replaced.
    """

    def __init__(self) -> None:
        self._places: dict[int, Floats] = {}
        self._active: dict[int, tuple[bool, ...]] = {}
        self._number = 0, 0  # of robots and areas

    def forget(self) -> None:
        self._places.clear()
        self._active.clear()

    def record(self, frame: Frame) -> None:
        tick = frame.tick
        places = np.array([(robot.x, robot.y) for robot in frame.after.robots], np.float64)
        number = len(places), len(frame.after.areas)
        if number != self._number:
            self.forget()  # robots or areas came or went
            self._number = number
        stored_places = self._places.get(tick)
        if stored_places is not None and not np.array_equal(stored_places, places):
            self._drop(lambda stored_tick: stored_tick >= tick)
        self._drop(lambda stored_tick: abs(stored_tick - tick) > _TRAIL)
        self._places[tick] = places
        self._active[tick] = tuple(area.active for area in frame.after.areas)

    def trails(self, tick: int) -> tuple[Floats, Floats]:
        """Return places, (moments, robots, 2) in map units, and ages from 1 to 0, oldest first."""
        ticks = sorted(past_tick for past_tick in self._places if tick - _TRAIL < past_tick < tick)
        if not ticks:
            return np.zeros((0, 0, 2)), np.zeros(0)
        ages = (tick - np.array(ticks)) / _TRAIL
        return np.stack([self._places[past_tick] for past_tick in ticks]), ages

    def switched_areas(self, tick: int) -> frozenset[int]:
        """Return the numbers of the areas that were switched in the last few ticks."""
        ticks = sorted(
            past_tick for past_tick in self._active if tick - _FLASH <= past_tick <= tick
        )
        states = [self._active[past_tick] for past_tick in ticks]
        areas = enumerate(zip(*states, strict=True))
        return frozenset(number for number, activity in areas if len(set(activity)) > 1)

    def _drop(self, is_old: Callable[[int], bool]) -> None:
        for tick in [tick for tick in self._places if is_old(tick)]:
            del self._places[tick], self._active[tick]
