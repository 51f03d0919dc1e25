"""The level format of this game: TOML with the labyrinth drawn in characters.

A row is drawn, ``#..####``, or shortened, ``1# 2. 4#``; a shortened row that begins with ``12*`` is
repeated twelve times. One character is ``cell`` map units wide and high.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from itertools import chain, cycle, pairwise
from operator import sub
from string import whitespace
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.toml_files import parse_toml
from logical_robots_tui.world.level import (
    AREA_COLOR,
    COMPARED,
    FLAGS,
    FORMER_GOAL,
    LONG_TEXTS,
    ROBOT_COLOR,
    SENSOR_BOUNDS,
    Area,
    Beacon,
    Cycle,
    Level,
    LevelError,
    LevelQuestion,
    Robot,
    Score,
    ScoreKind,
    SecondGoal,
    Sensors,
    Team,
    Visibility,
)
from logical_robots_tui.world.levels.fields import MOST_SIDE, Fields, check_robot_names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Bits = NDArray[np.bool_]

_TOP_KEYS = (
    *("lenient", "cell", "walls", "match"),
    *(name for name in COMPARED if name not in ("width", "height", "match_ticks")),
)
_ROBOT_KEYS = ("name", "x", "y", "heading", "angle", "color", "battery", "team")
_BATTERY_KEYS = ("capacity", "consumption", "charges_others", "used")
_TEAM_KEYS = ("name", "program")
_BEACON_KEYS = ("name", "x", "y", "charging_station")
_AREA_KEYS = (
    *("name", "x", "y", "radius", "color", "goal_for"),
    *("on_beacon", "off_beacon", "sticky", "solid", "cycle"),
)


def read_native(text: str, name: str, source: str) -> Level:
    """Read a level of this game; raise LevelError for anything that looks like a mistake."""
    text = text.replace("\r\n", "\n")
    top = Fields(_parse(text, source), source)
    top.refuse_unknown(_TOP_KEYS)
    words = read_words(top)
    walls = read_drawing(top, text)
    height, width = walls.shape
    robots = top.records("robots", read_robot, _ROBOT_KEYS)
    check_robot_names(top, tuple(robot.name for robot in robots))
    beacons = top.records("beacons", read_beacon, _BEACON_KEYS)
    areas = top.records("areas", read_area, _AREA_KEYS)
    words |= {"robots": robots, "beacons": beacons, "areas": areas}
    level = Level(name=name, width=width, height=height, walls=walls, source=source, **words)
    for oddity in chain(misfits(level), () if top.flag("lenient") else oddities(level)):
        raise top.error(oddity.path, oddity.message, oddity.hint)
    return level


def read_words(top: Fields) -> dict[str, Any]:
    """Return a level's attributes except the labyrinth and its objects, or raise LevelError."""
    match = top.table("match", ("ticks",))
    visibility = top.table("visibility", ("memory", "sensor"))
    if top.has("match") and not top.has("teams"):
        raise top.error("match", "A match needs teams.", "List them as [[teams]].")
    return {
        "title": top.name("title"),
        **{key: top.name(key, "") for key in ("idea", "starter", "solution")},
        **{key: top.text(key, "").strip("\n") for key in LONG_TEXTS},
        "hints": top.texts("hints"),
        "questions": top.records("questions", _question, ("ask", "answer", "ticks", "program")),
        "visibility": Visibility(
            memory=visibility.choice("memory", ("own", "seen", "all"), "own"),
            sensor=visibility.choice("sensor", ("own", "all"), "own"),
        ),
        **{key: top.names(key) for key in ("shared_names", "shuffled_names")},
        "second_goals": tuple(_second_goals(top)),
        "teams": top.records(
            "teams", lambda team: Team(team.name("name"), team.name("program", "")), _TEAM_KEYS
        ),
        "match_ticks": match.integer("ticks", minimum=1) if top.has("match") else 0,
        "scores": top.records("scores", _score, ("kind", "area", "points")),
        **{key: top.flag(key) for key in FLAGS},
        "sensors": _sensors(top, top.table("sensors", tuple(SENSOR_BOUNDS))),
    }


def _sensors(top: Fields, table: Fields) -> Sensors:
    numbers = {key: table.number(key) for key in SENSOR_BOUNDS if table.has(key)}
    whole = {key: int(number) for key, number in numbers.items() if number.is_integer()}
    try:
        return Sensors(**{**numbers, **whole})  # type: ignore[arg-type] # it checks them
    except ValueError as error:
        raise top.error("sensors", str(error)) from None


@dataclass(frozen=True, slots=True)
class Oddity:
    """Something in a level that does not fit the rest; key "" means the whole record."""

    kind: str
    index: int
    key: str
    message: str
    hint: str

    @property
    def path(self) -> str:
        """The key's place in the file, such as ``areas[2].goal_for``."""
        return f"{self.kind}[{self.index}]{'.' if self.key else ''}{self.key}"


def oddities(level: Level) -> Iterator[Oddity]:
    """Yield what only a lenient level may contain: robots outside, and unknown references."""
    size = f"The labyrinth is {level.width} x {level.height} units."
    for i, robot in enumerate(level.robots):
        if not (0 <= robot.x < level.width and 0 <= robot.y < level.height):
            yield Oddity("robots", i, "", f'Robot "{robot.name}" is outside the labyrinth.', size)
    robots = dict.fromkeys(robot.name for robot in level.robots)
    beacons = dict.fromkeys(beacon.name for beacon in level.beacons)
    for i, area in enumerate(level.areas):
        for name in area.victory_robots:
            if name not in robots:
                message = f'Area "{area.name}" is a goal for "{name}", but there is no such robot.'
                yield Oddity("areas", i, "goal_for", message, did_you_mean(name, robots))
        for key, name in (("on_beacon", area.on_beacon), ("off_beacon", area.off_beacon)):
            if name and name not in beacons:
                message = f'Area "{area.name}" is switched by "{name}"'
                hint = did_you_mean(name, beacons)
                yield Oddity("areas", i, key, f"{message}, but there is no such beacon.", hint)


def misfits(level: Level) -> Iterator[Oddity]:
    names = [team.name for team in level.teams]
    for i, robot in enumerate(level.robots):
        if robot.team not in (names or [""]):
            message = f'Robot "{robot.name}" has no team.'
            hint = "In a level with teams each has one."
            if robot.team:
                message = f'Robot "{robot.name}" is in "{robot.team}", but there is no such team.'
                hint = did_you_mean(robot.team, names) or "List the teams as [[teams]]."
            yield Oddity("robots", i, "team", message, hint)
    for i, name in enumerate(names):
        if name in names[:i]:
            yield Oddity("teams", i, "name", f'Two teams are called "{name}".', "")
        elif name not in [robot.team for robot in level.robots]:
            hint = f'Write team = "{name}" in a record of robots.'
            yield Oddity("teams", i, "", f'Team "{name}" has no robots.', hint)
    areas = {area.name for area in level.areas}
    for i, score in enumerate(level.scores):
        if not level.match_ticks:
            yield Oddity("scores", i, "", "A score needs a match.", "Write match = {ticks = 1000}.")
        if score.area and score.area not in areas:
            message = f'There is no area "{score.area}".'
            yield Oddity("scores", i, "area", message, did_you_mean(score.area, areas))
        if score.kind == "beacons" and len({b.name for b in level.beacons}) > MOST_SCORED:
            message = f"At most {MOST_SCORED} beacons of different names can be scored."
            yield Oddity("scores", i, "kind", message, "")
    object_names = {entity.name for entity in chain[Robot | Beacon](level.robots, level.beacons)}
    for i, pattern in enumerate(level.shuffled_names):
        if not any(fnmatchcase(name, pattern) for name in object_names):
            message = f'"shuffled_names" has "{pattern}", but no robot or beacon has such a name.'
            hint = "A * stands for any characters, a ? for one."
            yield Oddity("shuffled_names", i, "", message, hint)


MOST_SCORED = 60
"""Beacons; a tally has a bit for each of them."""


def _parse(text: str, source: str) -> dict[str, object]:
    try:
        return parse_toml(text)
    except InputError as error:
        place = f"{source}, {error.place}" if error.place else source
        hint = "A level of this game is a TOML file."
        raise LevelError(f"{error.message}.", place=place, hint=hint) from None


def read_robot(fields: Fields) -> Robot:
    battery = fields.table("battery", _BATTERY_KEYS)
    has_battery = fields.has("battery")
    used = battery.flag("used", True)
    if fields.has("angle") and fields.has("heading"):
        raise fields.error("angle", '"heading" and "angle" say the same in degrees and radians.')
    return Robot(
        *fields.name_and_position(),
        angle=fields.number("angle", math.radians(fields.number("heading", 0.0))),
        color=fields.color("color", ROBOT_COLOR),
        has_battery=has_battery and used,
        can_charge=used and battery.flag("charges_others"),
        battery_capacity=battery.number("capacity", minimum=0) if has_battery else 0.0,
        battery_consumption_rate=battery.number("consumption", 0.0, minimum=0),
        team=fields.name("team", ""),
    )


def read_beacon(fields: Fields) -> Beacon:
    return Beacon(*fields.name_and_position(), fields.flag("charging_station"))


def read_area(fields: Fields) -> Area:
    return Area(
        *fields.name_and_position(),
        radius=fields.number("radius", minimum=0),
        color=fields.color("color", AREA_COLOR),
        victory_robots=fields.names("goal_for"),
        on_beacon=fields.name("on_beacon", ""),
        off_beacon=fields.name("off_beacon", ""),
        sticky_switch=fields.flag("sticky"),
        impenetrable=fields.flag("solid"),
        cycle=_cycle(fields) if fields.has("cycle") else None,
    )


def _cycle(fields: Fields) -> Cycle:
    table = fields.table("cycle", Cycle._fields)
    cycle = Cycle(*(table.integer(key, minimum=1) for key in Cycle._fields))
    if not cycle.first <= cycle.last <= cycle.period:
        message = '"last" must be at least "first" and at most "period".'
        raise fields.error(
            "cycle", message, "Write cycle = {period = 600, first = 301, last = 600}."
        )
    if switches := [key for key in ("on_beacon", "off_beacon", "sticky") if fields.has(key)]:
        message = f'A cycle switches this area, so it can\'t have "{switches[0]}".'
        raise fields.error(switches[0], message, "Remove one of the two.")
    return cycle


def _score(fields: Fields) -> Score:
    kinds: tuple[ScoreKind, ...] = get_args(ScoreKind)
    kind = fields.choice("kind", kinds, None)
    if kind is None:
        raise fields.error("kind", '"kind" is missing.', f"There are {', '.join(kinds)}.")
    if has_area := kind not in ("beacons", "charged"):
        area = fields.name("area")
    elif fields.has("area"):
        raise fields.error("area", f'"{kind}" is scored everywhere, not in an area.')
    points = fields.number("points", 1.0, minimum=0)
    return Score(kind, area if has_area else "", points)


def _second_goals(top: Fields) -> Iterator[SecondGoal]:
    for i, words in enumerate(top.names("second_goals")):
        goal = SecondGoal.parse(words)
        if goal is None and not FORMER_GOAL.fullmatch(words):
            raise top.error(
                f"second_goals[{i}]",
                f'"{words}" is not a bonus goal.',
                'Write "at most N ticks", "at most N symbols", "at most N units", "never blocked", '
                '"wins from all 20 starts" or "wins in the mirrored labyrinth".',
            )
        if goal is not None:
            yield goal


LAST_TICK_ASKED = 10_000
"""The latest tick of a question, because a run to there has to be computed."""


def _question(fields: Fields) -> LevelQuestion:
    ask, answer = (fields.text(key).strip() for key in ("ask", "answer"))
    for key, text in (("ask", ask), ("answer", answer)):
        if not text:
            raise fields.error(key, f'"{key}" is empty.')
    ticks = fields.integers("ticks", minimum=0)
    if not ticks or ticks != tuple(sorted(set(ticks))) or ticks[-1] > LAST_TICK_ASKED:
        message = f'"ticks" must be ascending numbers up to {LAST_TICK_ASKED}.'
        raise fields.error("ticks", message, "Write them like [120, 480].")
    return LevelQuestion(ask, answer, ticks, fields.name("program", ""))


_WALL = ord("#")
_STRANGE = re.compile(r"[^#. ]")
_DIGIT = re.compile(r"\d")
_SHORT = re.compile(r"(?:(\d{1,4})\*\s*)?(\d{1,4}[#.](?:\s*\d{1,4}[#.])*)", re.ASCII)
_NO_KINDS = b"0123456789" + whitespace.encode()
_ONLY_COUNTS = str.maketrans("#.", "  ")
_WIDEST_DRAWN = 240  # characters; wider rows are shortened, because nobody draws them by hand
_LONGEST_ROW = 10 * MOST_SIDE  # characters of a shortened one
_LARGEST_CELL = 20  # map units; larger cells would be too coarse to draw anything new
_DRAW = "Draw walls as # and free cells as . or space, one row per line, between ''' and '''."
_SHORTEN = "Write runs of # and . such as 6# 94. 6#; 12* in front repeats the row 12 times."


class _Row(NamedTuple):
    """A line of a drawing, for equal rows; True in `kinds` is wall."""

    line: str
    times: int
    counts: NDArray[np.int16] | None = None
    kinds: _Bits | None = None

    @property
    def columns(self) -> int:
        return len(self.line) if self.counts is None else int(self.counts.sum())

    def cells(self) -> _Bits:
        cells: _Bits
        if self.counts is None or self.kinds is None:
            cells = np.frombuffer(self.line.encode("ascii", "replace"), np.uint8) == _WALL
        else:
            cells = self.kinds.repeat(self.counts)
        return cells


def read_drawing(top: Fields, text: str) -> _Bits:
    """Read ``cell`` and ``walls`` of a level file, or raise LevelError.

    Returns a read-only array of shape (height, width) in map units; True is wall.
    """
    cell = top.integer("cell", minimum=1)
    drawing = top.record.get("walls")
    if not isinstance(drawing, str):
        raise top.error("walls", '"walls" must be a drawing of the labyrinth.', _DRAW)
    number = drawing.removesuffix("\n").count("\n") + 1
    if number > MOST_SIDE:
        message = f"The drawing has {number} rows; at most {MOST_SIDE} are allowed."
        raise top.error("walls", message)
    lines = drawing.removesuffix("\n").split("\n")
    rows = [_row(line) for line in lines]
    columns = rows[0].columns if rows[0] else 0
    if rows[0] and not columns:
        raise top.error("walls", "The first row of the drawing is empty.", _DRAW)
    times = [row.times if row else 1 for row in rows]
    top.check_size("walls", columns * cell, sum(times) * cell)
    start = find_drawing(drawing, text)
    first_line = text.count("\n", 0, start) + 1 if start is not None else None
    cells = np.zeros((len(rows), columns), np.bool_)
    for i, (row, line) in enumerate(zip(rows, lines, strict=True)):
        if problem := _problem(row, line, columns):
            place = f"{top.file}, row {i + 1} of walls"
            place += f" (line {first_line + i})" if first_line else ""
            raise LevelError(problem[0], place=place, hint=problem[1])
        assert row
        cells[i] = row.cells()
    walls = cells.repeat(np.multiply(times, cell), axis=0).repeat(cell, axis=1)
    walls.flags.writeable = False
    return walls


def find_drawing(drawing: str, text: str) -> int | None:
    for match in re.finditer(r"^[ \t]*walls[ \t]*=[ \t]*('''|\"\"\")\n?", text, re.MULTILINE):
        if text.startswith(drawing + match[1], match.end()):
            return match.end()
    return None


def coarsest_cell(walls: _Bits) -> int:
    """Return the largest cell size in map units, at most 20, that draws the walls exactly."""
    height, width = walls.shape
    down = np.flatnonzero((walls[1:] != walls[:-1]).any(axis=1)) + 1
    across = np.flatnonzero((walls[:, 1:] != walls[:, :-1]).any(axis=0)) + 1
    common = int(np.gcd.reduce([height, width, *down.tolist(), *across.tolist()]))
    return max(size for size in range(1, _LARGEST_CELL + 1) if common % size == 0)


def expresses(walls: _Bits, cell: int) -> bool:
    height, width = walls.shape
    if height % cell or width % cell:
        return False
    cells = walls[::cell, ::cell]
    return bool((walls == cells.repeat(cell, axis=0).repeat(cell, axis=1)).all())


def draw_rows(walls: _Bits, cell: int, old_lines: Sequence[str] = ()) -> list[str]:
    """Return the lines that draw walls, keeping earlier ones that are still right.

    `cell`, in map units per character, must express the walls.
    """
    cells = walls[::cell, ::cell]
    rows = [row for row in map(_row, old_lines) if row]
    shape = sum(row.times for row in rows), rows[0].columns if rows else 0
    is_same_shape = shape == cells.shape and all(row.columns == shape[1] for row in rows)
    if not is_same_shape or len(rows) < len(old_lines):
        return list(_fresh(cells, short=cells.shape[1] > _WIDEST_DRAWN))
    lines = []
    start = 0
    for row in rows:
        block = cells[start : start + row.times]
        start += row.times
        if (block == row.cells()).all():
            lines.append(row.line)
        elif row.counts is not None:
            lines += _fresh(block, short=True)
        else:  # free cells keep their character
            free = " " if " " in row.line and "." not in row.line else "."
            pairs = zip(row.line, block[0].tolist(), strict=True)
            characters = ("#" if wall else free if old == "#" else old for old, wall in pairs)
            lines.append("".join(characters))
    return lines


def _row(line: str) -> _Row | None:
    if not _DIGIT.search(line):
        return _Row(line, 1)
    if len(line) > _LONGEST_ROW:
        return None
    match = _SHORT.fullmatch(line.strip())
    if not match or not int(match[1] or 1):
        return None
    text = match[2]
    if text.count("#") + text.count(".") > MOST_SIDE:
        return None
    counts = np.fromstring(text.translate(_ONLY_COUNTS), np.int16, sep=" ")
    kinds = np.frombuffer(text.encode("ascii").translate(None, _NO_KINDS), np.uint8) == _WALL
    return _Row(line, int(match[1] or 1), counts, kinds)


def _problem(row: _Row | None, line: str, columns: int) -> tuple[str, str] | None:
    if row is None:
        return "This shortened row can't be read.", _SHORTEN
    if row.columns != columns:
        message = f"This row has {row.columns} characters, the first one has {columns}."
        return message, "All rows must have the same length."
    match = None if row.counts is not None else _STRANGE.search(line)
    if match is None:
        return None
    character = match[0]
    description = f'"{character}"' if character.isprintable() else f"U+{ord(character):04X}"
    message = f"Character {match.start() + 1} is {description}, which is neither wall nor free."
    return message, _DRAW


def _fresh(cells: _Bits, *, short: bool) -> Iterator[str]:
    if not short:
        for row in cells:
            yield "".join("#" if wall else "." for wall in row.tolist())
        return
    changes = np.flatnonzero((cells[1:] != cells[:-1]).any(axis=1)) + 1
    bounds = [0, *changes.tolist(), len(cells)]
    for start, stop in pairwise(bounds):
        yield (f"{stop - start}* " if stop - start > 1 else "") + _shorten(cells[start])


def _shorten(row: _Bits) -> str:
    bounds = [0, *(np.flatnonzero(row[1:] != row[:-1]) + 1).tolist(), len(row)]
    walls, free = _runs()
    kinds = (walls, free) if row[0] else (free, walls)
    counts = map(sub, bounds[1:], bounds)
    return " ".join(kind[count] for kind, count in zip(cycle(kinds), counts, strict=False))


@cache
def _runs() -> tuple[tuple[str, ...], tuple[str, ...]]:
    counts = range(MOST_SIDE + 1)
    return tuple(f"{count}#" for count in counts), tuple(f"{count}." for count in counts)
