"""``logical-robots run`` and ``trace``, and what all commands share that run a program."""

from __future__ import annotations

import argparse
import asyncio
import math
import threading
from collections import Counter
from collections.abc import Awaitable, Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from logical_robots_tui import game, mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    UNRELIABLE,
    ProgramFileError,
    columns,
    harmless,
    line_of_json,
    named_programs,
    own_programs,
    prefers_json,
    print_json,
    progress_bar,
)
from logical_robots_tui.errors import InputError
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.probing import SourceSpan
    from logical_robots_tui.progress import Measures

T = TypeVar("T")

BAR_DELAY = 0.5
"""Seconds before the progress bar appears."""


def run_args(
    *,
    first_tick: int | None = None,
    ticks: tuple[int, str] | None = None,
    robot: str = "",
    needs_robot: bool = False,
    only_json: bool = False,
) -> command.Part:
    """Return the arguments of a command that takes a level and a program, which `open_run` loads.

    `first_tick` is the lowest ``--tick``, `ticks` the default and the help of ``--ticks``,
    `robot` the help of ``--robot``; by default there is no such option.
    """
    parts = [command.LEVEL, command.programs()]
    if first_tick is not None:
        about = "the tick" if first_tick else "the tick; 0 is the start"
        read = command.number_from(first_tick)
        parts.append(command.option("--tick", "N", about, type=read, required=True))
    if ticks is not None:
        parts.append(command.number("--ticks", command.number_from(1), *ticks))
    if robot:
        parts.append(command.option("--robot", "R", robot, required=needs_robot))
    parts.append(command.START)
    if not only_json:
        parts.append(command.flag("--json", "print JSON even to a terminal"))
    wants_json = (lambda _options: True) if only_json else prefers_json

    def add(parser: argparse._ActionsContainer) -> None:
        parser.set_defaults(wants_json=wants_json)
        for part in (*parts, command.DATA_DIR, command.NO_SOLUTIONS):
            part(parser)

    return add


def open_run(options: argparse.Namespace) -> tuple[world.Level, mind.Program]:
    """Load level and program, check the robot; raise InputError or ProgramFileError."""
    from logical_robots_tui.game.measuring import named_start_of
    from logical_robots_tui.game.source import programs_for

    level = named_start_of(world.load_level(options.level), options.start_number)
    if not named_programs(options):
        hint = "For a first look: logical-robots run 01-first-steps first-steps"
        raise InputError("No program is named.", hint=hint)
    folder = own_programs(options)
    sources = programs_for(level, options.programs, dict(options.teams), folder, pipes=True)
    try:
        program = mind.Program.compile({team: source.text for team, source in sources.items()})
    except mind.ProgramError as error:
        source = sources[error.team]
        place = str(source.path) if str(source.path) in named_programs(options) else source.name
        raise ProgramFileError(place, error) from error
    robot = getattr(options, "robot", None)
    if robot is not None:
        check_name("robot", robot, (robot.name for robot in level.robots))
    return level, program.for_team(level.team_of(robot or ""))


@contextmanager
def mistakes_in(place: str) -> Iterator[None]:
    """Raise ProgramFileError, which names the place, for a ProgramError."""
    try:
        yield
    except mind.ProgramError as error:
        raise ProgramFileError(place, error) from error


def place_of(span: SourceSpan | None) -> dict[str, Any]:
    return {"line": span and span.line, "text": span and span.text}


def show(options: argparse.Namespace, document: Any, lines: Iterable[str]) -> None:
    print(line_of_json(document) if prefers_json(options) else "\n".join(lines))


def check_name(kind: str, name: str, valid_names: Iterable[str]) -> None:
    """Raise InputError, with the valid names as a hint, unless the name is one of them."""
    names = list(valid_names)
    if name not in names:
        examples = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
        raise InputError(
            f"There is no {kind} {name}.",
            hint=f"There {'is' if len(names) == 1 else 'are'} {examples}.",
        )


async def with_run(
    level: world.Level,
    program: mind.Program,
    ticks: int,
    work: Callable[[game.Run, Callable[..., None]], Awaitable[T]],
) -> T:
    """Return what `work` makes of a run, which reuses stored ticks, and a progress callback."""
    run = game.Run(level, program)
    try:
        with progress_bar(level.title, ticks, delay=BAR_DELAY) as show:
            return await work(run, show)
    finally:
        await run.close()


async def frame_at(level: world.Level, program: mind.Program, tick: int) -> game.Frame:
    return await with_run(level, program, tick, lambda run, show: run.frame(tick, show))


_Tables: TypeAlias = "dict[str, mind.ResultTable | mind.QueryError]"

WON, NOT_WON = 0, 1
DEFAULT_TICKS = 5000
SAMPLE = 10  # notices reported in full


@command.declare(
    "run",
    run_args(ticks=(DEFAULT_TICKS, "give up after this many ticks")),
    command.flag("--times", "include times in the JSON output"),
)
def run(options: argparse.Namespace) -> int:
    """run a program in a level without a screen

    Run a program in a level without a screen, as fast as possible.

    examples:
      logical-robots run 01-first-steps first-steps            print the result
      logical-robots run 01-first-steps first-steps --json     print it as JSON
      logical-robots run 01-first-steps first-steps | jq .won  piped output is JSON
      logical-robots run my-level.toml my-program.l --ticks 900
      logical-robots run 16-high-ground high-ground high-ground-sparring

    exit status: 0 won or match over, 1 not won in time, 2 bad level or program
    """
    level, program = open_run(options)
    with progress_bar(level.title, options.ticks) as show:
        outcome = asyncio.run(
            play_out(level, program, " ".join(named_programs(options)), options.ticks, show)
        )
    if prefers_json(options):
        print_json(outcome.as_data(times=options.times))
    else:
        print(outcome.as_text())
    is_over = level.match_ticks == outcome.frame.tick
    return WON if outcome.won_at is not None or is_over else NOT_WON


async def play_out(
    level: world.Level,
    program: mind.Program,
    program_name: str,
    ticks: int,
    show: Callable[[int], object] = lambda _tick: None,
) -> Outcome:
    from logical_robots_tui.game.victory import victory_of

    live_game = game.Game(level, program, history=1)
    outcome = Outcome(level, program_name, live_game.frame)

    def record(frame: game.Frame) -> None:
        outcome.count(frame)
        show(frame.tick)

    live_game.listen(record)
    began = perf_counter()
    try:
        await live_game.run_until(tick=ticks)
        victory = victory_of(live_game, level)
        outcome.peak = live_game.history.peak(live_game.frame.tick)
    finally:
        await live_game.close()
    outcome.seconds = perf_counter() - began
    if victory is not None:
        outcome.measures = victory.measures
    return outcome


@dataclass
class Outcome:
    """The result of a run so far; `first` are a few notices: tick, robot, kind and message."""

    level: world.Level
    program_name: str
    frame: game.Frame
    notices: Counter[str] = field(default_factory=Counter)
    first: list[tuple[int, str, str, str]] = field(default_factory=list)
    think_milliseconds: float = 0.0
    is_reliable: bool = True
    seconds: float = 0.0
    measures: Measures | None = None
    peak: game.Peak = field(default_factory=lambda: game.Peak())

    def count(self, frame: game.Frame) -> None:
        self.frame = frame
        self.think_milliseconds += frame.think_milliseconds
        self.is_reliable = self.is_reliable and frame.is_reliable
        for decision in frame.decisions:
            for notice in decision.notices:
                self.notices[notice.kind] += 1
                if len(self.first) < SAMPLE:
                    entry = (frame.tick, decision.robot_name, notice.kind, notice.message)
                    self.first.append(entry)

    @property
    def won_at(self) -> int | None:
        return self.frame.after.won_at

    def as_data(self, *, times: bool = False) -> dict[str, Any]:
        """Return the outcome for JSON, without times by default, because they vary."""
        from logical_robots_tui.world.dynamics import points

        ticks = self.frame.tick
        document: dict[str, Any] = {
            "level": self.level.name,
            "program": self.program_name,
            "won": self.won_at is not None,
            "ticks": ticks,
            "size": self.measures and self.measures.size,
            "distance": self.measures and round(self.measures.distance, 1),
            "reliable": self.is_reliable,
            "robots": [
                {**robot, "memory": self.frame.memories.get(robot["name"])}
                for robot in _robots(self.level, self.frame, "blocked")
            ],
            "goals": [
                {"area": goal.area_name, "wanted": goal.robots, "inside": goal.inside}
                for goal in game.goals(self.level, self.frame.after)
            ],
            "most_at_once": self.peak._asdict() if self.peak.words else None,
            **({"scores": points(self.level, self.frame.after)} if self.level.scores else {}),
            "second_goals": self._second_goals(),
            "notices": {
                "count": self.notices.total(),
                "kinds": dict(self.notices),
                "first": [
                    {"tick": tick, "robot": robot, "kind": kind, "message": message}
                    for tick, robot, kind, message in self.first
                ],
            },
        }
        if times:
            document["milliseconds_per_tick"] = round(self.seconds * 1000 / ticks, 4)
            think = self.think_milliseconds / ticks
            document["think_milliseconds_per_tick"] = round(think, 4)
        return document

    def _second_goals(self) -> dict[str, bool | None]:
        goals = self.measures.goals if self.measures else ()
        return {
            goal.words: None if goal.is_tried_later else goal.words in goals
            for goal in self.level.second_goals
        }

    def as_text(self) -> str:
        lines = [self._verdict()]
        if self.measures is not None and self.level.second_goals:
            size, distance = count_of(self.measures.size, "symbol"), self.measures.distance
            lines.append(f"The program has {size}; the robots drove {distance:,.0f} units.")
            words = {True: "yes", False: "no", None: "not tried"}
            summary = "; ".join(
                f"{goal}: {words[is_reached]}" for goal, is_reached in self._second_goals().items()
            )
            lines.append(f"Bonus goals: {summary}.")
        lines += ["", *self._table()]
        if self.first:
            total = self.notices.total()
            lines += ["", f"{total} notice{'' if total == 1 else 's'} from the program:"]
            lines += [
                f"  tick {tick}, {harmless(robot)}: {harmless(message)}"
                for tick, robot, _kind, message in self.first
            ]
            if total > len(self.first):
                lines.append(f"  ... and {total - len(self.first)} more")
        if not self.is_reliable:
            lines += ["", UNRELIABLE]
        pace = self.frame.tick / self.seconds
        lines += ["", f"{self.frame.tick} ticks in {self.seconds:.1f} s ({pace:.0f} ticks/s)"]
        return "\n".join(lines)

    def _verdict(self) -> str:
        from logical_robots_tui.game.frame import standing_words

        title = harmless(self.level.title)
        if self.level.scores:
            standing = harmless(standing_words(self.level, self.frame.after))
            return f"{title}: after {self.frame.tick} ticks {standing}."
        if self.won_at is not None:
            return f"{title}: won at tick {self.won_at}."
        if not any(area.victory_robots for area in self.level.areas):
            return f"{title}: {self.frame.tick} ticks done. This level has no goal."
        missing = [
            f"{harmless(goal.area_name)} is still missing "
            + ", ".join(harmless(name) for name in goal.robots if name not in goal.inside)
            for goal in game.goals(self.level, self.frame.after)
            if not goal.is_reached and len(goal.inside) < len(goal.robots)
        ]
        verdict = f"{title}: not won within {self.frame.tick} ticks"
        peak = self.peak.words.capitalize()
        return ". ".join(filter(None, [verdict, *missing, peak])) + "."

    def _table(self) -> list[str]:
        rows: list[tuple[str, ...]] = [("ROBOT", "X", "Y", "HEADING", "BATTERY")]
        for level_robot, robot in zip(self.level.robots, self.frame.after.robots, strict=True):
            heading = f"{math.degrees(robot.angle) % 360:.0f} deg"
            battery = "none"
            if level_robot.has_battery:
                battery = f"{robot.battery_level:.1f} of {level_robot.battery_capacity:g}"
            rows.append((robot.name, f"{robot.x:.1f}", f"{robot.y:.1f}", heading, battery))
        return columns(rows)


def _robots(level: world.Level, frame: game.Frame, *fields: str) -> list[dict[str, Any]]:
    return [
        {
            "name": robot.name,
            "x": robot.x,
            "y": robot.y,
            "angle": robot.angle,
            "battery_level": robot.battery_level if level_robot.has_battery else None,
            **{name: getattr(robot, name) for name in fields},
        }
        for level_robot, robot in zip(level.robots, frame.after.robots, strict=True)
    ]


@command.declare(
    "trace",
    run_args(
        ticks=(DEFAULT_TICKS, "stop after this many ticks"), robot="only this robot", only_json=True
    ),
    command.option(
        "--predicates",
        "A,B",
        "include the rows of these predicates",
        type=lambda text: tuple(name.strip() for name in text.split(",") if name.strip()),
        default=(),
    ),
    command.flag("--times", "include how long thinking took"),
)
def trace(options: argparse.Namespace) -> int:
    """print every tick of a run as a line of JSON

    Print every tick of a run, up to victory, as a line of JSON.

    examples:
      logical-robots trace 01-first-steps first-steps > run.jsonl
      logical-robots trace 06-breadcrumbs breadcrumbs --ticks 100 --robot Crow \\
        | jq .decisions
      logical-robots trace 06-breadcrumbs breadcrumbs --ticks 100 \\
        --predicates Next | jq -c .predicates.Next.rows

    A line holds: tick, won, robots (after the tick), sensors and memories (as the
    program saw them), decisions (desire, memory, notices), areas, the rows of the
    requested predicates, and reliable: false once a time limit has cut a thought
    short, so that another run may differ.

    exit status: 0 won, 1 not won in time, 2 bad level or program
    """
    level, program = open_run(options)
    for name in options.predicates:
        check_name("predicate", name, (p.name for p in program.predicates if p.has_rows))
    is_won = asyncio.run(_trace(level, program, options))
    return WON if is_won else NOT_WON


async def _trace(level: world.Level, program: mind.Program, options: argparse.Namespace) -> bool:
    def ask(
        frame: game.Frame, thinking: mind.Mind, stop: threading.Event
    ) -> tuple[game.Frame, _Tables]:
        tables: _Tables = {}
        for name in options.predicates:
            try:
                tables[name] = thinking.query(name, frame.sensors, frame.memories_before, stop=stop)
            except mind.QueryError as error:
                tables[name] = error
        return frame, tables

    run = game.Run(level, program)
    is_won, is_reliable = False, True
    try:
        async for frame, tables in run.map_ticks(1, options.ticks, ask, to_victory=True):
            is_won = frame.after.won_at is not None
            is_reliable = is_reliable and frame.is_reliable
            document = _data(level, frame, options.robot, tables)
            document["reliable"] = is_reliable
            if options.times:
                document["think_milliseconds"] = round(frame.think_milliseconds, 4)
            print(line_of_json(document))
        return is_won
    finally:
        await run.close()


def _data(
    level: world.Level, frame: game.Frame, robot: str | None, tables: _Tables
) -> dict[str, Any]:
    names = frozenset([robot] if robot is not None else [r.name for r in level.robots])
    state = frame.after
    return {
        "tick": frame.tick,
        "won": state.won_at is not None,
        "robots": [
            robot
            for robot in _robots(level, frame, "left_engine", "right_engine", "blocked", "dead")
            if robot["name"] in names
        ],
        "sensors": {
            row["robot_name"]: row["sensor"] for row in frame.sensors if row["robot_name"] in names
        },
        "memories": {name: frame.memories_before.get(name) for name in sorted(names)},
        "decisions": [
            {
                "robot": decision.robot_name,
                "desire": decision.desire and asdict(decision.desire),
                "memory": decision.memory,
                "notices": [asdict(notice) for notice in decision.notices],
            }
            for decision in frame.decisions
            if decision.robot_name in names
        ],
        "areas": [asdict(area) for area in state.areas],
        "predicates": {name: _rows(table, robot) for name, table in tables.items()},
    }


def _rows(table: mind.ResultTable | mind.QueryError, robot: str | None) -> dict[str, Any]:
    if isinstance(table, Exception):
        return {"error": str(table)}
    robot_table = table.in_mind_of(robot)
    document: dict[str, Any] = {"columns": robot_table.columns, "rows": robot_table.rows}
    if table.viewers:
        document["minds"] = robot_table.viewers
    if table.truncated:
        document["truncated"] = True
    return document
