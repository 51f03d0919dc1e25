"""Characters over the picture: beacons, robots, ends of rays, and names."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Container, Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing.cells import (
    BOLD,
    RGB,
    Cells,
    Palette,
    luminance,
    mix,
    parse,
    rgb_number,
    text_id,
)
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas, Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.ground import beacon_colour
from logical_robots_tui.tui.labyrinth.drawing.rays import Fan, mark_ends
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Floats, Viewport
from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.level import Area, Beacon, Level

if TYPE_CHECKING:
    from numpy.typing import NDArray


def fit_name(name: str, width: int, cut: str, unknown: str, ascii_only: bool = False) -> list[str]:
    """Return a name as the texts of cells, at most ``width`` of them.

    A character two cells wide is followed by an empty text. Marks stay with their letter.
    Control characters become ``unknown``; invisible ones, which could reorder the line, are
    left out. `cut` ends a name that was too long.
    """
    cells: list[str] = []
    for char in unicodedata.normalize("NFC", name[: 4 * width + 16]):
        category = unicodedata.category(char)
        if category in {"Cf", "Cs", "Me"} or "\ufe00" <= char <= "\ufe0f":
            continue
        if "\U0001f3fb" <= char <= "\U0001f3ff" or "\U0001f1e6" <= char <= "\U0001f1ff":
            char = unknown
        if category in {"Cc", "Zl", "Zp", "Co", "Cn"} or (ascii_only and not char.isascii()):
            char = unknown
        size = cell_len(char)
        if size:
            cells += [char] if size == 1 else [char, ""]
        elif cells and not ascii_only:
            base = -1 if cells[-1] else -2
            if len(cells[base]) < 3 and cell_len(cells[base] + char) == cell_len(cells[base]):
                cells[base] += char
    if len(cells) <= width:
        return cells
    cells = cells[: max(width - 1, 0)]
    if cells and cell_len(cells[-1]) == 2:
        cells.pop()
    return [*cells, cut][:width]


@lru_cache(maxsize=4096)
def fit_into(name: str, width: int, drawing: Drawing) -> tuple[str, ...]:
    glyphs = drawing.glyphs
    return tuple(fit_name(name, width, glyphs.cut, glyphs.unknown, drawing is Drawing.ASCII))


class Label(NamedTuple):
    """A name and its cell, with `clear` rows of what it names, which it may be `inside`."""

    cells: tuple[str, ...]
    row: int
    column: int
    clear: int = 0
    inside: bool = False

    def places(self, rows: int, columns: int) -> Iterator[tuple[int, int]]:
        """Yield possible places as (row, first column), the best first."""
        width, beside = len(self.cells), 2 * self.clear + 2
        if width > columns:
            return
        middle = min(max(self.column - width // 2, 0), columns - width)
        steps = [self.clear + 1, self.clear + 2, self.clear + 3]
        candidates = [(self.row, middle)] if self.inside else []
        candidates += [(self.row - steps[0], middle), (self.row + steps[0], middle)]
        candidates += [
            (self.row, self.column + beside),
            (self.row, self.column - beside + 1 - width),
        ]
        for step in steps:
            for row in (self.row - step, self.row + step):
                candidates += [(row, self.column + 1), (row, self.column - width), (row, middle)]
        for row, column in candidates:
            if 0 <= row < rows and 0 <= column <= columns - width:
                yield row, column


class _FreeCells:
    """The cells that are free for names: one integer per row, with one bit per cell."""

    def __init__(self, occupied: list[int], columns: int) -> None:
        self._occupied = occupied
        self._columns = columns

    def copy(self) -> _FreeCells:
        return _FreeCells(self._occupied.copy(), self._columns)

    def take(self, row: int, first: int, stop: int) -> None:
        first, stop = max(first, 0), min(stop, self._columns)
        if 0 <= row < len(self._occupied) and first < stop:
            self._occupied[row] |= (1 << stop) - (1 << first)

    def is_free(self, row: int, first: int, stop: int) -> bool:
        """Return whether cells of a row, and one to each side, are free."""
        return not (self._occupied[row] << 1 >> first) & ((1 << stop - first + 2) - 1)

    def place(self, plate: Label) -> tuple[int, int] | None:
        width = len(plate.cells)
        occupied, whole = self._occupied, (1 << width + 2) - 1
        for row, column in plate.places(len(occupied), self._columns):
            # As `is_free` has it; this is the innermost loop of a crowded picture.
            if not (occupied[row] << 1 >> column) & whole:
                self.take(row, column, column + width)
                return row, column
        return None


_MIN_COLUMNS, _MIN_ROWS = 24, 8  # below this a view is too small for names

_NAMES_AT_MOST = 4
"""One in so many cells may show the name of a robot; of a larger crowd only the selected one's."""

_PULSE = (0.35, 0.0, -0.4, 0.0)
"""How far the colour of a beacon goes towards the brightest, or below 0 towards the floor."""


def robot_colour(color: str, palette: Palette) -> RGB:
    return palette.legible(parse(color))


def names_once(level: Level) -> list[str]:
    """Return the names of areas, then beacons, "" where an area around shows the same one."""
    names, namesakes = list[str](), dict[str, list[Area]]()
    entities: list[Area | Beacon] = [*level.areas, *level.beacons]
    for entity in entities:
        areas = namesakes.setdefault(entity.name, [])
        is_shown = any(math.hypot(entity.x - a.x, entity.y - a.y) <= a.radius for a in areas)
        names.append("" if is_shown else entity.name)
        if isinstance(entity, Area):
            areas.append(entity)
    return names


class StaticLabels:
    """Beacons' symbols and names, areas' names, placed once; `ground` is (down, across, 3)."""

    def __init__(
        self, level: Level, active: Sequence[bool], viewport: Viewport, look: Look, ground: Floats
    ) -> None:
        palette, glyphs = look.palette, look.glyphs
        self.room = _FreeCells([0] * viewport.rows, viewport.columns)
        """The cells that the symbols of beacons, and small gates, leave free."""
        shining: list[tuple[tuple[int, int], str, RGB]] = []
        named: list[tuple[int, str, RGB, tuple[int, int], int, bool]] = []
        names = names_once(level)
        area_names, beacon_names = names[: len(level.areas)], names[len(level.areas) :]
        for beacon, name in zip(level.beacons, beacon_names, strict=True):
            cell = viewport.cell(beacon.x, beacon.y)
            if cell is None:
                continue
            colour = beacon_colour(beacon, palette)
            glyph = glyphs.charger if beacon.charging_station else glyphs.beacon
            shining.append((cell, glyph, colour))
            self.room.take(cell[0], cell[1], cell[1] + 1)
            named.append((1, name, mix(colour, palette.bright, 0.25), cell, 0, False))
        for area, name, is_active in zip(level.areas, area_names, active, strict=False):
            cell = viewport.cell(area.x, area.y)
            if cell is None:
                continue
            goal = bool(area.victory_robots)
            name = f"{glyphs.goal} {name}".rstrip() if goal else name
            colour = palette.strong(parse(area.color))
            if not is_active:
                colour = mix(colour, palette.floor, 0.45)
            is_hidden = area.impenetrable and 2 * area.radius < (len(name) + 2) * viewport.units
            reach = round(area.radius / (CELL_ASPECT * viewport.units)) if is_hidden else 0
            for row in range(cell[0] - reach, cell[0] + reach + 1) if is_hidden else ():
                self.room.take(row, cell[1] - 2 * reach, cell[1] + 2 * reach + 1)
            named.append((0 if goal else 2, name, colour, cell, reach, not is_hidden))

        rows, columns = np.array([cell for cell, _, _ in shining], np.int64).reshape(-1, 2).T
        self._places = rows, columns
        self._texts = np.array([text_id(glyph) for _, glyph, _ in shining], np.int64)
        towards = palette.bright, palette.floor
        self._inks = [
            np.array(
                [rgb_number(mix(c, towards[far < 0], abs(far))) for *_, c in shining], np.int64
            )
            for far in _PULSE
        ]

        self.plates: list[tuple[Label, int, tuple[int, int]]] = []
        """The names that found a place, their style and the place (row, first column)."""
        room = self.room.copy()
        for _, name, colour, cell, reach, inside in sorted(named, key=lambda item: item[0]):
            plate = Label(_name_cells(name, viewport, look), *cell, reach, inside)
            place = room.place(plate) if plate.cells else None
            if place:
                paper = self._paper(plate, place, ground, look)
                self.plates.append((plate, rgb_number(colour) << 24 | rgb_number(paper), place))

    def light(self, cells: Cells, pulse: int) -> None:
        inks, places = self._inks[pulse % len(_PULSE)], self._places
        cells.text[places] = self._texts
        cells.style[places] = inks << 24 | cells.tone[places] | BOLD

    def follow_ground(self, look: Look, ground: Floats, window: tuple[slice, slice]) -> None:
        down, across = look.drawing.dots[1], look.drawing.dots[0]
        first, last = window[0].start // down, (window[0].stop - 1) // down
        left, right = window[1].start // across, (window[1].stop - 1) // across
        for i, (plate, style, (row, column)) in enumerate(self.plates):
            if first <= row <= last and column <= right and left < column + len(plate.cells):
                paper = self._paper(plate, (row, column), ground, look)
                self.plates[i] = plate, style >> 24 << 24 | rgb_number(paper), (row, column)

    @staticmethod
    def _paper(plate: Label, place: tuple[int, int], ground: Floats, look: Look) -> RGB:
        across, down = look.drawing.dots
        row, column = place
        part = ground[
            row * down : (row + 1) * down, column * across : (column + len(plate.cells)) * across
        ]
        red, green, blue = part.mean(axis=(0, 1)).tolist()
        share = 1.0 if look.drawing is Drawing.ASCII else 0.6
        return mix((round(red), round(green), round(blue)), look.palette.plate, share)


class Faint(NamedTuple):
    """A robot of another run: place in map units, heading in radians, colour."""

    x: float
    y: float
    angle: float
    ink: RGB


def draw_labels(
    canvas: Canvas,
    still: StaticLabels,
    robots: Sequence[tuple[RobotState, RGB]],
    undecided: Container[str],
    fans: Sequence[Fan],
    ghosts: Sequence[Faint] = (),
) -> None:
    """Draw symbols and names over a picture; the most important robots come last."""
    cells, view, look = canvas
    if look.marks:
        mark_ends(canvas, fans, robots)
    room = still.room.copy()
    for ghost in ghosts:
        if (cell := view.cell(ghost.x, ghost.y)) is not None:
            cells.put(*cell, look.glyphs.ghost(ghost.angle), rgb_number(ghost.ink))
            room.take(*cell, cell[1] + 1)
    still.light(cells, look.pulse)
    clear = view.body_rows
    placed = []
    for robot, colour in robots:
        cell = view.cell(robot.x, robot.y)
        if cell is None:
            continue
        sign = _trouble(robot, undecided, look)
        placed.append((robot, sign, colour, cell))
        _put_robot(canvas, robot, sign, colour, cell)
        for row in range(cell[0] - clear, cell[0] + clear + 1):
            room.take(row, cell[1] - 2 * clear, cell[1] + 2 * clear + 1)

    moved = []
    for plate, style, (row, column) in still.plates:
        if room.is_free(row, column, column + len(plate.cells)):
            room.take(row, column, column + len(plate.cells))
            write(cells, row, column, plate.cells, style)
        else:
            moved.append((plate, style))
    is_crowd = _NAMES_AT_MOST * sum(len(entry[0].name) + 1 for entry in placed) > cells.text.size
    for robot, sign, colour, cell in reversed(placed):
        if robot.name == look.selected or not is_crowd:
            _put_robot_name(canvas, room, robot, sign, colour, cell)
    for plate, style in moved:
        place = room.place(plate)
        if place:
            write(cells, *place, plate.cells, style)


def _trouble(robot: RobotState, undecided: Container[str], look: Look) -> str:
    if robot.dead:
        return look.glyphs.dead
    if robot.name in undecided:
        return look.glyphs.undecided
    return look.glyphs.blocked if robot.blocked else ""


def _put_robot(
    canvas: Canvas, robot: RobotState, sign: str, colour: RGB, cell: tuple[int, int]
) -> None:
    look = canvas.look
    glyph = look.glyphs.dead if robot.dead else look.glyphs.heading(robot.angle)
    if not look.is_plain and canvas.view.shows_bodies:
        if not sign:
            return
        glyph = sign
        if not robot.dead:
            colour = look.palette.alarm
    elif robot.name != look.selected if look.is_plain else sign and not robot.dead:
        canvas.put(cell, glyph, colour, look.palette.floor)
        return
    canvas.put(cell, glyph, _text_on(colour), colour)


def _put_robot_name(
    canvas: Canvas,
    room: _FreeCells,
    robot: RobotState,
    sign: str,
    colour: RGB,
    cell: tuple[int, int],
) -> None:
    cells, view, look = canvas
    name = _name_cells(robot.name, view, look)
    if not name:
        return
    has_sign = sign and not robot.dead
    if has_sign:
        name = (*name, sign)
    place = room.place(Label(name, *cell, clear=view.body_rows))
    if place is None:
        return
    palette, is_selected = look.palette, robot.name == look.selected
    ink = _text_on(colour) if is_selected else palette.strong(colour)
    paper = colour if is_selected else mix(palette.plate, colour, 0.2)
    write(cells, *place, name, BOLD | rgb_number(ink) << 24 | rgb_number(paper))
    if has_sign and not is_selected:
        canvas.put((place[0], place[1] + len(name) - 1), sign, palette.alarm, paper)


def write(cells: Cells, row: int, column: int, texts: Sequence[str], style: int) -> None:
    part = slice(column, column + len(texts))
    cells.text[row, part] = _ids(tuple(texts))
    cells.style[row, part] = style


@lru_cache(maxsize=4096)
def _ids(texts: tuple[str, ...]) -> NDArray[np.int64]:
    return np.array([text_id(text) for text in texts], np.int64)


def _name_cells(name: str, viewport: Viewport, look: Look) -> tuple[str, ...]:
    if not look.names or viewport.columns < _MIN_COLUMNS or viewport.rows < _MIN_ROWS:
        return ()
    width = min(max(viewport.columns // 4, 6), 20)
    return fit_into(name, width, look.drawing)


def _text_on(colour: RGB) -> RGB:
    return (8, 8, 10) if luminance(colour) > 0.45 else (255, 255, 255)
