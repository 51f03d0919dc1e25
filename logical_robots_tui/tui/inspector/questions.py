"""Questions about the robots' program: to whom they go, and how one waits for an answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from textual.content import Content

from logical_robots_tui.game import Frame, NoSuchTickError, Superseded
from logical_robots_tui.mind import QueryError, ResultTable
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.clock import Clock
    from logical_robots_tui.game import Game, Inquiry
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session

T = TypeVar("T")

NO_PROGRAM = "There is no program to query yet."

MOST_ROBOTS = 100
"""With more robots, replaying a past tick would hold up the screen."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The rows of every predicate at a tick, or why there are none, and at the tick before."""

    program: Program
    frame: Frame
    tables: dict[str, ResultTable | QueryError]
    previous_tables: dict[str, ResultTable | QueryError]

    def count(self, predicate: str) -> str:
        table = self.tables.get(predicate)
        if not isinstance(table, ResultTable):
            return "" if table is None else "!"
        return f"{len(table.once().rows)}{'+' if table.truncated else ''}"

    def differs(self, predicate: str) -> bool:
        table, old_table = self.tables.get(predicate), self.previous_tables.get(predicate)
        return (
            isinstance(table, ResultTable)
            and isinstance(old_table, ResultTable)
            and table != old_table
        )


class InspectorQuestions:
    """Queries the robots' program; raises `Superseded` without one or after newer ones."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.chosen: str | None = None
        """The robot that the player chose last, of this level or an earlier one."""
        self._level: Level | None = None
        self._inquiry: Inquiry | None = None
        self._survey: Survey | None = None

    @property
    def program(self) -> Program:
        """The program that the robots think with, or raise Superseded if there is none yet."""
        if self.session.game is None:
            raise Superseded
        return self.session.game.program

    @property
    def robot(self) -> str:
        names = [robot.name for robot in self.session.level.robots]
        return self.chosen if self.chosen in names else names[0]

    @property
    def branch(self) -> tuple[Game, int] | None:
        """Equal as long as the ticks of the history are not replaced by others."""
        game = self.session.game
        return None if game is None else (game, game.history.turns)

    @property
    def run_key(self) -> tuple[Game, int, Program] | None:
        """Equal as long as the run and the program that the robots think with are the same."""
        return None if self.branch is None else (*self.branch, self.program)

    def context(self) -> tuple[Inquiry, Program]:
        """Return what answers questions about the level at hand, and the program to ask."""
        from logical_robots_tui.game import Inquiry

        program, level = self.program, self.session.level
        seen_alike = self._level is not None and self._level.visibility == level.visibility
        if self._inquiry is None or not seen_alike:
            if self._inquiry is not None:
                self.session.release(self._inquiry.close)
            self._level, self._inquiry, self._survey = level, Inquiry(level), None
        return self._inquiry, program

    def is_function(self, name: str) -> bool:
        matches = (predicate for predicate in self.session.predicates if predicate.name == name)
        return any(predicate.kind == "program" and predicate.is_function for predicate in matches)

    async def rows(self, predicate: str, robot: str, frame: Frame) -> ResultTable:
        """A predicate's rows, or a function's calls for a robot, or raise QueryError."""
        if self.is_function(predicate):
            inquiry, program = self.context()
            return await inquiry.calls(program, robot, frame, predicate)
        game = self.session.game
        if game is None:
            raise Superseded
        return await game.query(predicate, frame)

    async def survey(self, frame: Frame) -> Survey:
        if stored_survey := self.stored_survey(frame):
            return stored_survey
        last, (inquiry, program) = self._survey, self.context()
        previous_tables: dict[str, ResultTable | QueryError] = {}
        earlier = self._frame_before(frame)
        if last is not None and last.program is program and last.frame is earlier:
            previous_tables = last.tables
        elif earlier is not None:
            previous_tables = await inquiry.survey(program, earlier)
        tables = await inquiry.survey(program, frame)
        self._survey = Survey(program, frame, tables, previous_tables)
        return self._survey

    def stored_survey(self, frame: Frame) -> Survey | None:
        """Return the survey of a frame if it is known; never computes one."""
        last, game = self._survey, self.session.game
        if last is None or game is None:
            return None
        return last if last.frame is frame and last.program is game.program else None

    async def close(self) -> None:
        inquiry, self._inquiry = self._inquiry, None
        if inquiry is not None:
            await inquiry.close()

    def _frame_before(self, frame: Frame) -> Frame | None:
        game = self.session.game
        if game is None or frame.tick == 0 or len(frame.sensors) > MOST_ROBOTS:
            return None
        if self._survey is not None and self._survey.frame.after is frame.before:
            return self._survey.frame
        try:
            return game.frame_at(frame.tick - 1)
        except NoSuchTickError:
            return None


_INTERVAL = 0.1  # seconds between two steps of the spinner; quicker queries show none
_SPINNER = "▖▘▝▗"


class Cancelled(Exception):  # noqa: N818 - the player's wish, and no error
    """The player has cancelled the query."""


class BackgroundQuery:
    """Waits for one answer at a time; `seconds` is how long the last query ran so far."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.seconds = 0.0
        self._task: asyncio.Future[Any] | None = None

    @property
    def is_long(self) -> bool:
        """Whether a query has been running long enough to show its progress."""
        return self._task is not None and self.seconds > 0

    async def run(
        self, work: Coroutine[Any, Any, T], doing: Callable[[], str], say: Callable[[Content], None]
    ) -> T:
        """Run a query, saying ten times a second what it is `doing`; `cancel` raises Cancelled."""
        task = asyncio.ensure_future(work)
        self._task, self.seconds = task, 0.0
        began = self._clock.now()
        try:
            while not (await asyncio.wait({task}, timeout=_INTERVAL))[0]:
                self.seconds = self._clock.now() - began
                spinner = _SPINNER[int(self.seconds / _INTERVAL) % len(_SPINNER)]
                say(
                    Content.assemble(
                        (f"{spinner} ", INK.key),
                        (one_line(doing()), INK.text),
                        (f"  {self.seconds:.1f} s", INK.number),
                        ("  esc here stops it", INK.dim),
                    )
                )
            if task.cancelled():
                raise Cancelled
            return task.result()
        finally:
            task.cancel()
            if self._task is task:
                self._task = None

    def cancel(self) -> None:
        if self._task is not None:
            self._task.cancel()
