"""A level and a program in step: for scripts, notebooks and tests, without asyncio."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.errors import InputError, check_installed
from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.game.advancing import play_tick, start_frame
from logical_robots_tui.game.debugging.breakpoints import matching_rows
from logical_robots_tui.game.frame import Frame, ends, standing
from logical_robots_tui.game.history.history import History, Past
from logical_robots_tui.game.measuring import named_start_of
from logical_robots_tui.game.minds import mind_for
from logical_robots_tui.game.source import load_program, programs_for
from logical_robots_tui.mind import Program
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.world import Level, Sensors, World, load_level
from logical_robots_tui.world.levels.load import read_level
from logical_robots_tui.world.world import desire_of

if TYPE_CHECKING:
    import pandas

    from logical_robots_tui.explain import Explanation
    from logical_robots_tui.mind import CompiledQuery, Decision, Limits, Mind, ResultTable
    from logical_robots_tui.values import SensorRow, Value
    from logical_robots_tui.world import RobotState
    from logical_robots_tui.world.world import DesireLike

OneProgram: TypeAlias = str | Path
"""A Logica text, or the name or path of a program. What has a ``;`` or a line break is a text."""

MOST_TICKS = 20_000
"""Ticks after which a run gives up, and that history keeps."""

_MOST_POINTS = 2_000  # of a path in a picture


class Simulation:
    """A level under a program, from its start; computes what the game shows.

    Teams, visibility of sensors and memories, scores and limits are those of the level.

    Args:
        level: A level, or its name, path or text.
        program: A program, its name, path or text; in a level with teams for the first one, or a
            mapping by team. By default, and for teams that are not named, the one of the level.
        start: 0 is the given start, any other number a varied one.
        limits: Limits on thinking.
        sensors: Rays, field of view, reach and noise; by default those of the level.

    Attributes:
        level: The level, with its robots at that start.
        program: The program of the first team.
        frame: All about the present tick.

    Raises:
        LevelError: There is no such level, or it is wrong.
        InputError: There is no such program or team.
        ProgramError: The program is wrong.
    """

    def __init__(
        self,
        level: Level | str | Path,
        program: Program | OneProgram | Mapping[str, OneProgram] | None = None,
        *,
        start: int = 0,
        limits: Limits | None = None,
        sensors: Sensors | None = None,
    ) -> None:
        level = _level(level)
        self.level = named_start_of(replace(level, sensors=sensors or level.sensors), start)
        self._limits = limits
        self._world = World(self.level)
        self._minds: dict[str, Mind] = {}
        self.use(program)
        self.frame = start_frame(self.level, self._world)
        self._restart_history()

    def _restart_history(self) -> None:
        self._history = History(self.frame, self.level, MOST_TICKS)
        self._past = Past(self._history)

    def use(self, program: Program | OneProgram | Mapping[str, OneProgram] | None) -> None:
        """Use another program from the next tick on; it raises as the constructor does."""
        self.program = _program(self.level, program)
        self.close()

    @property
    def tick(self) -> int:
        """The number of finished ticks."""
        return self.frame.tick

    @property
    def won(self) -> bool:
        """Whether a goal was reached, now or earlier."""
        return self.won_at is not None

    @property
    def won_at(self) -> int | None:
        """The tick in which a goal was first reached, or None."""
        return self.frame.after.won_at

    @property
    def over(self) -> bool:
        """Whether the level was won, or the match is over, in this tick."""
        return ends(self.level, self.frame)

    @property
    def robots(self) -> dict[str, RobotState]:
        """The robots as they are now, by name."""
        return {robot.name: robot for robot in self.frame.after.robots}

    @property
    def memories(self) -> Mapping[str, Value]:
        """What the robots remember, by name."""
        return self.frame.memories

    @property
    def points(self) -> dict[str, float]:
        """The points of each team; {} where nothing is scored."""
        return standing(self.level, self.frame.after)

    @property
    def steps(self) -> int:
        """The steps that the last tick's thoughts took; the same on every machine."""
        return sum(mind.steps for mind in self._minds.values())

    def step(
        self,
        desires: Mapping[str, DesireLike] | None = None,
        memories: Mapping[str, Value] | None = None,
    ) -> Frame:
        """Let all robots sense, think and act once.

        Args:
            desires: What robots want instead of what the program decides, by name: a pair of
                numbers or a `Desire`.
            memories: What robots remember instead, by name.

        Raises:
            ValueError: There is no such robot, or it is not a desire.
        """
        overrides = {name: desire_of(name, desire) for name, desire in (desires or {}).items()}
        memories = memories or {}
        check_robots(sorted({*overrides, *memories}), self.robots)

        def decide(_tick: int, decisions: tuple[Decision, ...]) -> tuple[Decision, ...]:
            return tuple(
                replace(
                    decision,
                    desire=overrides.get(decision.robot_name, decision.desire),
                    memory=memories.get(decision.robot_name, decision.memory),
                )
                for decision in decisions
            )

        self._world.restore(self.frame.after)
        self.frame = play_tick(
            self._world, self._mind(), self.frame, decide=decide if overrides or memories else None
        )
        self._history.add(self.frame, self.program)
        return self.frame

    def run(
        self, ticks: int = MOST_TICKS, *, until: str | Callable[[Simulation], bool] | None = None
    ) -> Frame:
        """Step until the level is won, a match is over, or `until`, at most `ticks` ticks.

        Args:
            ticks: The most ticks from now on.
            until: A query in Logica, which holds where it has rows or a value other than null,
                false and 0; or a function of this simulation.

        Raises:
            ProgramError: The query is wrong.
            QueryError: The query failed.
        """
        question = self.program.question(until) if isinstance(until, str) else None
        for _ in range(ticks):
            self.step()
            if self.over:
                break
            if question is not None:
                if matching_rows(question, self._ask(question)).rows:
                    break
            elif callable(until) and until(self):
                break
        return self.frame

    def look(self) -> list[SensorRow]:
        """Return what the robots see right now; not to be changed."""
        self._world.restore(self.frame.after)
        return self._world.look()

    def query(self, query: str) -> ResultTable:
        """Return the rows of a predicate, or the answer to a query, in the present tick.

        Raises:
            ProgramError: The query is wrong.
            QueryError: The predicate has no rows of its own, or it failed.
        """
        if self.program.predicate(query) is None:
            return self._ask(self.program.question(query))
        return self._mind().query(query, self.frame.sensors, self.frame.memories_before)

    def _ask(self, question: CompiledQuery) -> ResultTable:
        return self._mind().ask(question, self.frame.sensors, self.frame.memories_before)

    def why(self, robot: str, row: str = "Robot", **values: Value) -> Explanation:
        """Explain which rules gave a row in a robot's mind, or why there is none.

        Args:
            robot: The robot to ask.
            row: A predicate, or one with values as in ``Next(robot_name: "Crow")``.
            values: Values of its columns.

        Raises:
            ValueError: There is no such robot.
            ProgramError: It is not a predicate with values.
            QueryError: There is no such predicate or column, or it failed.
        """
        from logical_robots_tui.explain.why.explainer import read_ask

        check_robots([robot], self.robots)
        mind = self._mind(self.level.team_of(robot))
        ask = read_ask(mind.program, row) if "(" in row else Ask(row)
        explainer = Explainer(mind, robot, self.frame.sensors, self.frame.memories_before)
        return explainer.why(replace(ask, given={**ask.given, **values}))

    def at(self, tick: int) -> Frame:
        """Return an earlier tick, or raise NoSuchTickError."""
        return self.frame if tick == self.tick else self._past.frame(tick)

    def save(self) -> Frame:
        """Return the present tick, for `restore`; it is immutable."""
        return self.frame

    def restore(self, saved: Frame) -> None:
        """Go on from a tick of this level, which this or another simulation saved.

        Raises:
            ValueError: It is of a level with other robots or areas.
        """
        self._world.restore(saved.after)
        is_stored = self._history.first <= saved.tick <= self._history.last
        is_past = is_stored and self._past.frame(saved.tick) == saved
        self.frame = saved
        if is_past:
            self._history.forget_future(saved.tick)
        else:
            self._restart_history()

    def record(self, path: str | Path, name: str = "simulation") -> None:
        """Write the ticks since the start as a replay, which the game opens.

        Raises:
            InputError: There are none, or the file can't be written.
        """
        from logical_robots_tui.editing.level_text import write_native
        from logical_robots_tui.game.replay import gather
        from logical_robots_tui.paths import write_atomically

        if not self.tick:
            raise InputError("There is nothing to record before the first tick.")
        work = gather(self._history, write_native, lambda _: name)
        with ThreadPoolExecutor(1) as pool:  # a notebook has a running event loop
            replay = pool.submit(asyncio.run, work).result()
        try:
            write_atomically(Path(path), replay.to_bytes())
        except OSError as error:
            message = f"can't be written: {error.strerror or error}"
            raise InputError(message, place=str(path)) from error

    def to_pandas(self) -> pandas.DataFrame:
        """Return `rows` as a table; raise InputError without pandas, which is installed apart."""
        check_installed("pandas", "A table", "pandas")
        from pandas import DataFrame

        return DataFrame(self.rows())

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield for each tick and robot where it was, what it wanted and what it remembered."""
        for tick in range(self._history.first, self._history.last + 1):
            frame = self.at(tick)
            for robot in frame.after.robots:
                decision = frame.decision_of(robot.name)
                desire = decision.desire if decision is not None else None
                yield {
                    "tick": tick,
                    "robot": robot.name,
                    "x": robot.x,
                    "y": robot.y,
                    "angle": robot.angle,
                    "battery": robot.battery_level,
                    "blocked": robot.blocked,
                    "left_engine": desire.left_engine if desire else None,
                    "right_engine": desire.right_engine if desire else None,
                    "memory": frame.memories.get(robot.name),
                }

    def svg(self) -> str:
        """Return a picture of the level with the robots where they are, and their paths."""
        from logical_robots_tui.tui.labyrinth.svg import svg

        first, last = self._history.first, self._history.last
        paths: dict[str, list[tuple[float, float]]] = {}
        for tick in range(first, last + 1, max(1, (last - first) // _MOST_POINTS)):
            for robot in self._history.moment(tick).after.robots:
                paths.setdefault(robot.name, []).append((robot.x, robot.y))
        states = self.robots
        pairs = ((robot, states[robot.name]) for robot in self.level.robots)
        robots = tuple(replace(robot, x=s.x, y=s.y, angle=s.angle) for robot, s in pairs)
        return svg(replace(self.level, robots=robots), paths)

    def _repr_html_(self) -> str:
        return f'<div style="max-width: 48em">{self.svg()}</div>'

    def __repr__(self) -> str:
        return f"<Simulation of {self.level.name} at tick {self.tick}>"

    def close(self) -> None:
        """Free the minds; new ones are made when they are needed."""
        for mind in self._minds.values():
            mind.close()
        self._minds.clear()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _mind(self, team: str = "") -> Mind:
        if team not in self._minds:
            self._minds[team] = mind_for(self.program.for_team(team), self.level, self._limits)
        return self._minds[team]


def check_robots(names: Iterable[str], robots: Collection[str]) -> None:
    """Raise ValueError for the first name that is not a robot."""
    for name in names:
        if name not in robots:
            raise ValueError(f"There is no robot {name!r}. {did_you_mean(name, robots)}")


def _level(level: Level | str | Path) -> Level:
    if isinstance(level, str) and "\n" in level:
        return read_level(level, "level")
    return level if isinstance(level, Level) else load_level(level)


def _program(
    level: Level, program: Program | OneProgram | Mapping[str, OneProgram] | None
) -> Program:
    if isinstance(program, Program):
        return program
    texts = {team: source.text for team, source in programs_for(level, (), {}).items()}
    if not isinstance(program, Mapping):
        program = {} if program is None else {next(iter(texts)): program}
    for team in program.keys() - texts.keys():
        raise InputError(f"{level.name} has no team {team!r}.", hint=did_you_mean(team, texts))
    texts |= {team: _text(source) for team, source in program.items()}
    return Program.compile(texts).first


def _text(program: OneProgram) -> str:
    if isinstance(program, str) and (";" in program or "\n" in program):
        return program
    return load_program(program).text
