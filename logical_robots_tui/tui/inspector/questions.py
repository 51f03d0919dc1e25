"""Whom the inspector asks: the game for rows, and for reasons whoever explains them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.game import Inquiry, NoSuchTickError, Superseded
from logical_robots_tui.mind import QueryError, Table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.game import Frame, Pin, Reading
    from logical_robots_tui.mind import Ask, Explanation, Program, Proof, QueryPlan
    from logical_robots_tui.mind.diagnosis.nearest import Suggestion
    from logical_robots_tui.tui.session import Session
    from logical_robots_tui.world import Level

__all__ = ["MOST_ROBOTS", "Questions", "Survey"]

MOST_ROBOTS = 100
"""To sense a past tick for more of them would hold up the screen."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The rows of every predicate at a tick.

    Attributes:
        program: The program.
        frame: The tick.
        tables: By name of a predicate its rows, or why there are none.
        before: The same of the tick before, as far as that is known.
    """

    program: Program
    frame: Frame
    tables: dict[str, Table | QueryError]
    before: dict[str, Table | QueryError]

    def count(self, predicate: str) -> str:
        """How many rows a predicate has, in a few characters."""
        table = self.tables.get(predicate)
        if not isinstance(table, Table):
            return "" if table is None else "!"
        return f"{len(table.rows)}{'+' if table.truncated else ''}"

    def differs(self, predicate: str) -> bool:
        """Whether a predicate has other rows than at the tick before."""
        now, before = self.tables.get(predicate), self.before.get(predicate)
        return isinstance(now, Table) and isinstance(before, Table) and now != before


class Questions:
    """Asks about the program that the robots think with.

    Args:
        session: The level, the program and the game at hand.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._level: Level | None = None
        self._inquiry: Inquiry | None = None
        self._surveyed: Survey | None = None

    @property
    def has_program(self) -> bool:
        """Whether there is a program that could be asked."""
        return self._session.game is not None

    @property
    def program(self) -> Program:
        """The program that the robots think with.

        Raises:
            Superseded: There is none yet.
        """
        if self._session.game is None:
            raise Superseded
        return self._session.game.program

    def is_by_another_program(self, tick: int) -> bool:
        """Whether another program than the present one decided in a tick."""
        history, program = self._session.history, self._session.program
        return bool(history and program and history.is_by_another(program.text, tick))

    def is_function(self, name: str) -> bool:
        """Whether a name is that of a function of the program, which has calls and no rows."""
        known = (each for each in self._session.predicates if each.name == name)
        return any(each.kind == "program" and each.is_function for each in known)

    async def rows(self, predicate: str, robot: str, frame: Frame) -> Table:
        """The rows of a predicate at a frame; of a function its calls in a robot's reasoning.

        Raises:
            QueryError: It has none, or it failed.
            Superseded: There is no program yet, or something newer was asked.
        """
        if self.is_function(predicate):
            return await self._inquire().calls(self.program, robot, frame, predicate)
        return await self._session.query(predicate, frame)

    async def ask(self, query: str, frame: Frame) -> Table:
        """What a query gives at a frame.

        Raises:
            ProgramError: The query is wrong.
            QueryError: It failed.
            Superseded: There is no program yet, or something newer was asked.
        """
        return await self._inquire().ask(self.program, query, frame)

    async def why(self, robot: str, frame: Frame, asked: Ask) -> Explanation:
        """Why a predicate has its rows in a robot's reasoning at a frame.

        Raises:
            QueryError: It can't be asked.
            Superseded: There is no program yet, or something newer was asked.
        """
        return await self._inquire().why(
            self.program,
            robot,
            frame,
            predicate=asked.predicate,
            given=asked.given or None,
            within=asked.within,
        )

    async def proof(self, robot: str, frame: Frame, asked: Ask) -> Proof:
        """The whole proof of a row in a robot's reasoning at a frame.

        Raises:
            QueryError: It can't be asked.
            Superseded: There is no program yet, or something newer was asked.
        """
        return await self._inquire().proof(
            self.program,
            robot,
            frame,
            predicate=asked.predicate,
            given=asked.given or None,
            within=asked.within,
        )

    async def nearest(
        self, robot: str, frame: Frame, predicate: str
    ) -> list[tuple[int, Suggestion]]:
        """Which one change would have given a row to each rule of a predicate that gave none.

        Raises:
            QueryError: It can't be told.
            Superseded: There is no program yet, or something newer was asked.
        """
        return await self._inquire().nearest(self.program, robot, frame, predicate)

    async def readings(self, frame: Frame, pins: Sequence[Pin]) -> dict[Pin, Reading]:
        """What can be read off pins at a frame.

        Raises:
            Superseded: There is no program yet, or other pins were asked for meanwhile.
        """
        return await self._inquire().readings(self.program, frame, pins)

    async def machinery(self, frame: Frame) -> list[QueryPlan]:
        """How each predicate is computed at a frame, the slowest first.

        Raises:
            Superseded: There is no program yet, or something newer was asked.
        """
        return await self._inquire().machinery(self.program, frame)

    async def survey(self, frame: Frame) -> Survey:
        """The rows of every predicate at a frame, and at the one before.

        Raises:
            Superseded: There is no program yet, or something newer was asked.
        """
        program, last = self.program, self._surveyed
        if last is not None and last.program is program and last.frame is frame:
            return last
        inquiry = self._inquire()
        before: dict[str, Table | QueryError] = {}
        earlier = self._frame_before(frame)
        if last is not None and last.program is program and last.frame is earlier:
            before = last.tables
        elif earlier is not None:
            before = await inquiry.survey(program, earlier)
        tables = await inquiry.survey(program, frame)
        self._surveyed = Survey(program, frame, tables, before)
        return self._surveyed

    async def close(self) -> None:
        """Stop all work."""
        inquiry, self._inquiry = self._inquiry, None
        if inquiry is not None:
            await inquiry.close()

    # -- inside --------------------------------------------------------------------------------

    def _inquire(self) -> Inquiry:
        level = self._session.level
        seen_alike = self._level is not None and self._level.visibility == level.visibility
        if self._inquiry is None or not seen_alike:
            old, self._level = self._inquiry, level
            if old is not None:
                self._session.release(old.close)
            self._inquiry = Inquiry(self._level)
            self._surveyed = None
        return self._inquiry

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
