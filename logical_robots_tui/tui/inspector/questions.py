"""Queries of the inspector: rows, answers, explanations, proofs, pins and costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.game import NoSuchTickError, Superseded
from logical_robots_tui.mind import QueryError, Table

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Inquiry
    from logical_robots_tui.mind import Program
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.world import Level

MOST_ROBOTS = 100
"""With more robots, replaying a past tick would hold up the screen."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The rows of every predicate at a tick, or why there are none, and at the tick before."""

    program: Program
    frame: Frame
    tables: dict[str, Table | QueryError]
    before: dict[str, Table | QueryError]

    def count(self, predicate: str) -> str:
        table = self.tables.get(predicate)
        if not isinstance(table, Table):
            return "" if table is None else "!"
        return f"{len(table.rows)}{'+' if table.truncated else ''}"

    def differs(self, predicate: str) -> bool:
        now, before = self.tables.get(predicate), self.before.get(predicate)
        return isinstance(now, Table) and isinstance(before, Table) and now != before


class Questions:
    """Queries the robots' program; raises `Superseded` without one or after newer ones."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._level: Level | None = None
        self._asked: Inquiry | None = None
        self._surveyed: Survey | None = None

    @property
    def program(self) -> Program:
        """The program that the robots think with, or raise Superseded if there is none yet."""
        if self._session.game is None:
            raise Superseded
        return self._session.game.program

    def about(self) -> tuple[Inquiry, Program]:
        return self._inquiry(), self.program

    def is_by_another_program(self, tick: int) -> bool:
        history, program = self._session.history, self._session.program
        decided = history.program_at(tick) if history else None
        return bool(decided and program and decided.texts != program.texts)

    def is_function(self, name: str) -> bool:
        known = (each for each in self._session.predicates if each.name == name)
        return any(each.kind == "program" and each.is_function for each in known)

    async def rows(self, predicate: str, robot: str, frame: Frame) -> Table:
        """A predicate's rows, or a function's calls for a robot, or raise QueryError."""
        if self.is_function(predicate):
            return await self._inquiry().calls(self.program, robot, frame, predicate)
        game = self._session.game
        if game is None:
            raise Superseded
        return await game.query(predicate, frame)

    async def survey(self, frame: Frame) -> Survey:
        program, last = self.program, self._surveyed
        if known := self.surveyed(frame):
            return known
        inquiry = self._inquiry()
        before: dict[str, Table | QueryError] = {}
        earlier = self._frame_before(frame)
        if last is not None and last.program is program and last.frame is earlier:
            before = last.tables
        elif earlier is not None:
            before = await inquiry.survey(program, earlier)
        tables = await inquiry.survey(program, frame)
        self._surveyed = Survey(program, frame, tables, before)
        return self._surveyed

    def surveyed(self, frame: Frame) -> Survey | None:
        """Return the survey of a frame if it is known; never computes one."""
        last, game = self._surveyed, self._session.game
        if last is None or game is None:
            return None
        return last if last.frame is frame and last.program is game.program else None

    async def close(self) -> None:
        inquiry, self._asked = self._asked, None
        if inquiry is not None:
            await inquiry.close()

    def _inquiry(self) -> Inquiry:
        from logical_robots_tui.game import Inquiry

        level = self._session.level
        seen_alike = self._level is not None and self._level.visibility == level.visibility
        if self._asked is None or not seen_alike:
            old, self._level = self._asked, level
            if old is not None:
                self._session.release(old.close)
            self._asked = Inquiry(self._level)
            self._surveyed = None
        return self._asked

    def _frame_before(self, frame: Frame) -> Frame | None:
        game = self._session.game
        if game is None or frame.tick == 0 or len(frame.sensors) > MOST_ROBOTS:
            return None
        if self._surveyed is not None and self._surveyed.frame.after is frame.before:
            return self._surveyed.frame
        try:
            return game.frame_at(frame.tick - 1)
        except NoSuchTickError:
            return None
