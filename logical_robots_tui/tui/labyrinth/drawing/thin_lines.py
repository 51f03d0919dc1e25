"""Thin lines over the picture: trails of robots, rays of one of them, and highlights.

In braille, eight dots to a cell, or by one character where the font may not have it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import RGB, Cells, mix, rgb_number, text_id
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.rays import Fan
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Viewport
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame

_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]], np.int64)
"""The bit of each dot of a braille cell, down and across (Unicode, block Braille Patterns)."""

_BRAILLE = np.array([text_id(chr(0x2800 + bits)) for bits in range(256)], np.int64)
_RING = 2.2  # radius of the ring around a highlighted robot, in radii of a robot
_LEAST_RING = 2.5  # the same at least, in columns
_FADES = 4  # steps in which a trail fades; each changes every cell of it once

_FAINTEST, _STRONGEST = 0.35, 0.85
"""Part of a robot's colour in the oldest and the newest part of its trail."""


def draw_trails(
    cells: Cells,
    places: Floats,
    ages: Floats,
    colours: Sequence[RGB],
    viewport: Viewport,
    look: Look,
) -> None:
    """Draw trails of shape (moments, robots, 2), map units, oldest first; ages from 1 to 0."""
    fresh = np.floor((1 - ages) * _FADES).clip(0, _FADES - 1).astype(np.int64)
    inks = np.array(
        [
            [
                rgb_number(mix(look.palette.floor, colour, _FAINTEST + step * _FADE))
                for step in range(_FADES)
            ]
            for colour in colours
        ],
        np.int64,
    ).reshape(len(colours), _FADES)
    if not places.size:
        return
    moments, robots = places.shape[:2]
    x, y = places[..., 0].ravel(), places[..., 1].ravel()
    # Moments come oldest first, so that the newest has the last word on a cell's colour.
    ink = inks[np.tile(np.arange(robots), moments), np.repeat(fresh, robots)]
    _draw(cells, x, y, ink, viewport, look)


_FADE = (_STRONGEST - _FAINTEST) / (_FADES - 1)


def draw_rays(cells: Cells, fan: Fan, colour: RGB, viewport: Viewport, look: Look) -> None:
    step = viewport.units / 2
    x, y = [], []
    for heading, distance in zip(fan.headings.tolist(), fan.distances.tolist(), strict=True):
        # Near the robot rays would only be a blot.
        along = np.arange(min(12.0, distance), distance, step)
        x.append(fan.x + along * np.cos(heading))
        y.append(fan.y + along * np.sin(heading))
    every_x, every_y = np.concatenate(x), np.concatenate(y)
    ink = rgb_number(mix(colour, look.palette.bright, 0.3))
    _draw(cells, every_x, every_y, np.full(len(every_x), ink), viewport, look)


def draw_ring(cells: Cells, x: float, y: float, viewport: Viewport, look: Look) -> None:
    radius = max(_RING * ROBOT_RADIUS, _LEAST_RING * viewport.units)
    turn = np.linspace(0, 2 * np.pi, 120)
    ink = np.full(len(turn), rgb_number(look.palette.bright))
    _draw(cells, x + radius * np.cos(turn), y + radius * np.sin(turn), ink, viewport, look)


def draw_ray(cells: Cells, fan: Fan, ray: float, viewport: Viewport, look: Look) -> None:
    """Draw a highlighted ray by the program's angle, in radians, with a mark at its end."""
    ink = rgb_number(look.palette.bright)
    number = fan.nearest(ray)
    heading, distance = float(fan.headings[number]), float(fan.distances[number])
    # The robot's own cell stays as it is.
    start = min(max(ROBOT_RADIUS, 1.5 * viewport.units), distance)
    along = np.arange(start, distance, viewport.units / 4)
    x, y = fan.x + along * np.cos(heading), fan.y + along * np.sin(heading)
    _draw(cells, x, y, np.full(len(x), ink), viewport, look)
    every_x, every_y = fan.points()
    end = viewport.cell(float(every_x[number]), float(every_y[number]))
    if end is not None:
        glyphs, palette = look.drawing.glyphs, look.palette
        signs = {
            "wall": (glyphs.hit_wall_near, palette.hit_wall),
            "beacon": (glyphs.hit_beacon, palette.hit_beacon),
            "robot": (glyphs.hit_robot, palette.hit_robot),
        }
        sign, paper = signs.get(fan.objects[number], (glyphs.thread, palette.dead))
        cells.put(*end, sign, rgb_number(palette.plate), rgb_number(paper), bold=True)


def _draw(
    cells: Cells, x: Floats, y: Floats, ink: NDArray[np.int64], viewport: Viewport, look: Look
) -> None:
    """Set a dot for each point; the last point in a cell determines its colour."""
    rows, columns = cells.text.shape
    with np.errstate(invalid="ignore"):
        across = (x - viewport.left) / viewport.units * 2
        down = (y - viewport.top) / (viewport.units * 2) * 4
        inside = (across >= 0) & (across < 2 * columns) & (down >= 0) & (down < 4 * rows)
    across, down = across[inside].astype(np.int64), down[inside].astype(np.int64)
    row, column = down // 4, across // 2
    if look.drawing in (Drawing.QUADRANTS, Drawing.SEXTANTS):
        bits = np.zeros((rows, columns), np.int64)
        np.bitwise_or.at(bits, (row, column), _BITS[down % 4, across % 2])
        cells.text[row, column] = _BRAILLE[bits[row, column]]
    else:
        cells.text[row, column] = text_id(look.drawing.glyphs.thread)
    cells.style[row, column] = ink[inside] << 24 | cells.tone[row, column]


_TRAIL = 160  # ticks that a trail is long
_FLASH = 12  # ticks for which an area shows that it was switched


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
        known = self._places.get(tick)
        if known is not None and not np.array_equal(known, places):
            self._drop(lambda other: other >= tick)
        self._drop(lambda other: abs(other - tick) > _TRAIL)
        self._places[tick] = places
        self._active[tick] = tuple(area.active for area in frame.after.areas)

    def trails(self, tick: int) -> tuple[Floats, Floats]:
        """Return places, (moments, robots, 2) in map units, and ages from 1 to 0, oldest first."""
        ticks = sorted(then for then in self._places if tick - _TRAIL < then < tick)
        if not ticks:
            return np.zeros((0, 0, 2)), np.zeros(0)
        ages = (tick - np.array(ticks)) / _TRAIL
        return np.stack([self._places[then] for then in ticks]), ages

    def switched(self, tick: int) -> frozenset[int]:
        """Return the numbers of the areas that were switched in the last few ticks."""
        ticks = sorted(then for then in self._active if tick - _FLASH <= then <= tick)
        states = [self._active[then] for then in ticks]
        areas = enumerate(zip(*states, strict=True))
        return frozenset(number for number, found in areas if len(set(found)) > 1)

    def _drop(self, is_old: Callable[[int], bool]) -> None:
        for tick in [tick for tick in self._places if is_old(tick)]:
            del self._places[tick], self._active[tick]
