"""Levels: immutable descriptions of a labyrinth and the objects in it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from logical_robots_tui.errors import InputError
from logical_robots_tui.schema import RADAR_DEGREES, RADAR_RAYS, SENSOR_RANGE
from logical_robots_tui.wording import clip

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

ROBOT_COLOR = "#4a9eff"
AREA_COLOR = "#3fb950"


class LevelError(InputError):
    """A level can't be found, read or understood."""

    title = "This level can't be used"


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot at the start.

    Attributes:
        name: Unique in the level.
        x: Map units from the left edge.
        y: Map units from the top edge, growing downwards.
        angle: Heading in radians, clockwise as seen on the screen, 0 to the right; kept as given.
        color: As given in the level, a CSS name or ``#rrggbb``.
        has_battery: Whether the engines need charge.
        can_charge: Whether it charges other robots; only with a battery.
        battery_capacity: Charge at the start and at most.
        battery_consumption_rate: Charge per tick at full power of both engines.
        team: Name of its team, or "" in a level without teams.
    """

    name: str
    x: float
    y: float
    angle: float = 0.0
    color: str = ROBOT_COLOR
    has_battery: bool = False
    can_charge: bool = False
    battery_capacity: float = 0.0
    battery_consumption_rate: float = 0.0
    team: str = ""

    @property
    def is_immobile(self) -> bool:
        """Whether it needs charge and can hold none, so that nothing is wrong if it is empty."""
        return self.has_battery and self.battery_capacity <= 0 < self.battery_consumption_rate


@dataclass(frozen=True, slots=True)
class Beacon:
    """A labelled light that radars see. Names need not be unique.

    Attributes:
        name: The label that a radar reports.
        x: Map units from the left edge.
        y: Map units from the top edge.
        charging_station: Whether it charges robots nearby.
    """

    name: str
    x: float
    y: float
    charging_station: bool = False


class Cycle(NamedTuple):
    """Ticks of every `period` in which an area is on, `first` to `last`, counted from 1."""

    period: int
    first: int
    last: int

    @property
    def words(self) -> str:
        """The ticks as a level's reader is told them."""
        return f"ticks {self.first} to {self.last} of every {self.period}"

    def has(self, tick: int) -> bool:
        """Whether a tick is among them; tick 0, before a run, is as tick 1."""
        return self.first <= max(0, tick - 1) % self.period + 1 <= self.last


@dataclass(frozen=True, slots=True)
class Area:
    """A circle that may be solid, a goal, or switched by beacons or the clock.

    Names need not be unique.

    Attributes:
        name: The label that a radar reports while the area is solid and active.
        x: Centre, map units from the left edge.
        y: Centre, map units from the top edge.
        radius: Map units.
        color: As given in the level.
        victory_robots: Names of the robots that must all be inside at once to win; () for no goal.
        on_beacon: Name of the beacon that switches it on when seen, or "".
        off_beacon: Name of the beacon that switches it off when seen, or "".
        sticky_switch: Whether it keeps its state when the beacon is out of sight.
        impenetrable: Whether it is solid while active.
        cycle: When the clock switches it on, or None; no beacon switches it then.
    """

    name: str
    x: float
    y: float
    radius: float
    color: str = AREA_COLOR
    victory_robots: tuple[str, ...] = ()
    on_beacon: str = ""
    off_beacon: str = ""
    sticky_switch: bool = False
    impenetrable: bool = False
    cycle: Cycle | None = None

    def is_on(self, tick: int) -> bool:
        """Whether it is active after a tick while no beacon switches it."""
        return not self.on_beacon if self.cycle is None else self.cycle.has(tick)


@dataclass(frozen=True, slots=True)
class Visibility:
    """Which rows of other robots a robot's program may see.

    Attributes:
        memory: ``own``, ``seen`` (also those of robots on its radar this tick), or ``all``.
        sensor: ``own`` or ``all``.
    """

    memory: Literal["own", "seen", "all"] = "own"
    sensor: Literal["own", "all"] = "own"


_LONGEST_TEAM = 44  # characters
_SIGHT = {
    ("own", "own"): "only its own rows of Sensor and Memory",
    ("seen", "own"): "its own rows, and Memory of robots on its radar",
    ("all", "own"): "its own rows, and Memory of {}",
    ("own", "all"): "its own rows, and Sensor of {}",
    ("seen", "all"): "Sensor of {}, and Memory of robots on its radar",
    ("all", "all"): "Sensor and Memory of {}",
}


@dataclass(frozen=True, slots=True)
class Sensors:
    """What the sensors of all robots are like; by default as everywhere in the game.

    Attributes:
        rays: Of the radar, an odd number, so that one of them points ahead.
        view: Degrees between the leftmost and the rightmost ray.
        reach: Map units; also the distance that a ray reports when it hits nothing.
        noise: Standard deviation of the distance of a ray that hits something, in map units.
        seed: Of the noise.

    Raises:
        ValueError: A number is out of its bounds.
    """

    rays: int = RADAR_RAYS
    view: float = RADAR_DEGREES
    reach: int = SENSOR_RANGE
    noise: float = 0
    seed: int = 1

    def __post_init__(self) -> None:
        for key, (kind, lower, upper) in SENSOR_BOUNDS.items():
            number = getattr(self, key)
            is_number = isinstance(number, int if kind == "whole" else int | float)
            if not is_number or not lower <= number <= upper or (key == "rays" and not number % 2):
                kind = "an odd" if key == "rays" else f"a {kind}".removesuffix("real").strip()
                raise ValueError(
                    f'"{key}" must be {kind} number, {lower} to {upper}, not {number}.'
                )


SENSOR_BOUNDS: Mapping[str, tuple[str, int, int]] = {
    "rays": ("whole", 3, 361),
    "view": ("real", 1, 360),
    "reach": ("whole", 10, SENSOR_RANGE),
    "noise": ("real", 0, 100),
    "seed": ("whole", 0, 1_000_000),
}
"""Kind of the number, the least and the most."""


@dataclass(frozen=True, slots=True)
class Team:
    """Robots that think with one program of their own.

    Attributes:
        name: Unique in the level.
        program: Name of the program that plays it when nobody else does, or "".
    """

    name: str
    program: str = ""


ScoreKind: TypeAlias = Literal["hold", "most", "first", "near", "beacons", "charged"]


@dataclass(frozen=True, slots=True)
class Score:
    """One part of the score of a match; `dynamics.points` computes it.

    Attributes:
        kind: ``hold`` an area alone, have the ``most`` robots in it, be ``first`` there or ``near``
            it at the end, see ``beacons``, or have robots ``charged`` at the end.
        area: Name of the area, which several areas may share, or "" where the kind needs none.
        points: For each tick, for being first or in the area, for each beacon, or for each robot.
    """

    kind: ScoreKind
    area: str = ""
    points: float = 1.0


GoalKind: TypeAlias = Literal["tick", "symbol", "unit", "blocked", "starts", "mirrored"]
_WORDS: dict[GoalKind, str] = {
    "blocked": "never blocked",
    "starts": "wins from all 20 starts",
    "mirrored": "wins in the mirrored labyrinth",
}
FORMER_GOAL = re.compile("without memory|at most [0-9]{1,9} rules?")
"""What was a bonus goal in level files of earlier versions."""


class SecondGoal(NamedTuple):
    """What a player may achieve besides winning.

    Attributes:
        kind: What is counted: ticks, the program's symbols, the units driven, in how many ticks a
            robot was blocked, how many varied starts are lost, or whether the mirrored level is.
        limit: The most of these that it allows.
    """

    kind: GoalKind
    limit: int = 0

    @property
    def words(self) -> str:
        """The goal as a level file says it."""
        return _WORDS.get(self.kind) or f"at most {self.limit} {self.kind}{'s' * (self.limit != 1)}"

    @property
    def is_tried_later(self) -> bool:
        """Whether a victory does not show it, but only further runs of the program."""
        return self.kind in ("starts", "mirrored")

    @classmethod
    def parse(cls, words: str) -> SecondGoal | None:
        """Return the goal that a level file says, or None."""
        number = re.fullmatch("at most ([0-9]{1,9}) [a-z]+", words)
        limit = int(number[1]) if number else 0
        goals = (cls(kind, limit) for kind in get_args(GoalKind))
        return next((goal for goal in goals if goal.words == words), None)


class LevelQuestion(NamedTuple):
    """A question to answer with one query over the rows of all robots.

    Attributes:
        ask: What is asked, plain text.
        answer: A query with the rows that are wanted.
        ticks: At least one, ascending; an answer must be right at each of them.
        program: Name of the program that runs until then, or "" for the starter.
    """

    ask: str
    answer: str
    ticks: tuple[int, ...]
    program: str = ""


@dataclass(frozen=True, eq=False)
class Level:
    """An immutable description of a labyrinth, its inhabitants and its teaching text.

    Attributes:
        name: Short name for the command line; the file's name without its ending.
        title: Name to show.
        width: Map units.
        height: Map units.
        walls: Read-only bool array of shape (height, width); True is wall.
        robots: At least one, in file order.
        beacons: In file order.
        areas: In file order.
        visibility: What a program may see of other robots.
        sensors: Rays, field of view, reach and noise.
        idea: What is new in it, one line, or "".
        briefing: The task, plain text with line breaks, or "".
        hints: Hints to reveal one at a time.
        lesson: What it teaches, in Markdown, or "".
        further: What to try after winning, or "".
        story: What these robots are for, told after a victory, plain text, or "".
        questions: What to find out with queries, beside the lesson.
        starter: Name of the program to start with, or "".
        solution: Name of the program that wins it as the lesson teaches, or "".
        shared_names: Names that several beacons or several areas have on purpose.
        second_goals: What to achieve besides winning.
        teams: In file order; () where one program drives all robots. Otherwise every robot is in
            one of them, and none is empty.
        match_ticks: Length of a match in ticks; 0 where there is none.
        scores: What a match is about, in file order.
        divided_charge: Whether a source divides its charge among its receivers.
        solid_robots: Whether robots block each other.
        all_goals: Whether all goals must be reached at once, not any one.
        shuffled_names: Patterns of names of robots and beacons that varied starts exchange.
        source: Path of the file it came from, or "".
    """

    name: str
    title: str
    width: int
    height: int
    walls: NDArray[np.bool_]
    robots: tuple[Robot, ...]
    beacons: tuple[Beacon, ...] = ()
    areas: tuple[Area, ...] = ()
    visibility: Visibility = field(default_factory=Visibility)
    idea: str = ""
    briefing: str = ""
    hints: tuple[str, ...] = ()
    lesson: str = ""
    further: str = ""
    story: str = ""
    questions: tuple[LevelQuestion, ...] = ()
    starter: str = ""
    solution: str = ""
    shared_names: tuple[str, ...] = ()
    second_goals: tuple[SecondGoal, ...] = ()
    teams: tuple[Team, ...] = ()
    match_ticks: int = 0
    scores: tuple[Score, ...] = ()
    divided_charge: bool = False
    solid_robots: bool = False
    all_goals: bool = False
    shuffled_names: tuple[str, ...] = ()
    sensors: Sensors = Sensors()
    source: str = ""

    @property
    def terms(self) -> tuple[str, ...]:
        """What holds for a player's program: its team, if there are teams, and whose rows it sees.

        Sentences that end every briefing.
        """
        visibility, all_robots = self.visibility, "all robots"
        team_lines = []
        if self.teams:
            name, all_robots = self.teams[0].name, "its team"
            names = ", ".join(robot.name for robot in self.robots if robot.team == name)
            team_lines = [f"Your team is {name}: {clip(names, _LONGEST_TEAM)}."]
        sight = _SIGHT[visibility.memory, visibility.sensor].format(all_robots)
        return (*team_lines, f"A robot sees {sight}.")

    def team_of(self, robot_name: str) -> str:
        """Return the team of a robot, or "" if it has none."""
        return next((robot.team for robot in self.robots if robot.name == robot_name), "")


def rename_in_areas(
    areas: Iterable[Area], robots: Mapping[str, str], beacons: Mapping[str, str]
) -> tuple[Area, ...]:
    """Return areas that refer to robots and beacons by new names, given by the old ones."""
    return tuple(
        replace(
            area,
            victory_robots=tuple(robots.get(name, name) for name in area.victory_robots),
            on_beacon=beacons.get(area.on_beacon, area.on_beacon),
            off_beacon=beacons.get(area.off_beacon, area.off_beacon),
        )
        for area in areas
    )


FLAGS = ("divided_charge", "solid_robots", "all_goals")
"""The attributes that a level file turns on with ``true``."""

LONG_TEXTS = ("briefing", "lesson", "further", "story")
"""The attributes that are texts of several lines."""

COMPARED = tuple(f.name for f in fields(Level) if f.name not in ("name", "source", "walls"))
"""The attributes by which levels are alike, besides their walls."""


def alike(level: Level, other: Level) -> bool:
    """Whether two levels are the same, regardless of their files."""
    return level is other or (
        all(getattr(level, name) == getattr(other, name) for name in COMPARED)
        and level.walls.shape == other.walls.shape
        and bool((level.walls == other.walls).all())
    )
