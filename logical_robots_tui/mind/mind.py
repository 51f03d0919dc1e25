"""A mind: a compiled program attached to SQLite; sensors and memories in, decisions out."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.mind.database import Database, TooMuchError, TooSlowError
from logical_robots_tui.mind.deciding import decide, note_stranger
from logical_robots_tui.mind.decision import Decision, Notice
from logical_robots_tui.mind.diagnostics import QueryError
from logical_robots_tui.mind.evaluation import Evaluation, Within
from logical_robots_tui.mind.failures import FailureError, in_plain_words
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.plain import printable
from logical_robots_tui.mind.stored import TooDeepError, from_sql, to_json, to_sql
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.mind.program import Program

__all__ = ["Mind", "Table"]

Memories = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of a predicate.

    Attributes:
        columns: Names of the columns.
        rows: Values; records are dicts, lists are lists.
        viewers: For each row the robot in whose reasoning it holds; () when all reason alike.
        truncated: Whether there were more rows than are shown.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[Value, ...], ...]
    viewers: tuple[str, ...] = ()
    truncated: bool = False


class Mind:
    """Thinks for all robots of a tick. Use it in one thread at a time.

    Args:
        program: What to think.
        memory: Whose memories a robot's program sees: ``own``, ``seen`` or ``all``.
        sensor: Whose sensors it sees: ``own`` or ``all``. A program's ``@Visible`` goes first.
        limits: Bounds on time and size.
    """

    def __init__(
        self,
        program: Program,
        memory: Literal["own", "seen", "all"] = "own",
        sensor: Literal["own", "all"] = "own",
        limits: Limits | None = None,
    ) -> None:
        self.program = program
        self.memory = program.memory or memory
        self.sensor = program.sensor or sensor
        self.limits = limits or Limits()
        self._database = Database(self.limits)
        self._loaded: Evaluation | None = None

    def think(
        self,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> list[Decision]:
        """Decide once for every robot that has a sensor row, in the order of the rows.

        Args:
            rows: ``{"robot_name": ..., "sensor": {...}}`` per robot.
            memories: What each robot remembers, by name; one that is missing remembers null.
            stop: Set it from another thread to give up.

        Raises:
            Stopped: `stop` was set before the thought was finished.
        """
        names = [row["robot_name"] for row in rows]
        answers: dict[str, list[Mapping[str, Value]]] = {name: [] for name in names}
        strangers: dict[str, list[Notice]] = {name: [] for name in names}
        failures: dict[str, Notice] = {}
        cut_off: dict[str, list[Notice]] = {name: [] for name in names}
        within = Within(self.limits.think_seconds, self.limits.think_rows, stop)
        for evaluation in self._evaluations(rows, memories):
            try:
                columns, found = self._ask("Robot", evaluation, within)
            except FailureError as failure:
                notice = self._blame(failure, evaluation, within)
                failures |= dict.fromkeys(evaluation.viewers, notice)
                continue
            for notice in self._cut_off(evaluation, within):
                for viewer in evaluation.viewers:
                    cut_off[viewer].append(notice)
            for values in found:
                row = dict(zip(columns, values, strict=True))
                name = row.get("robot_name")
                if name in evaluation.viewers:
                    answers[str(name)].append(row)
                elif name not in answers:
                    note_stranger(name, strangers[evaluation.viewers[0]])
        return [
            decide(
                name,
                answers[name],
                memories.get(name),
                [failures[name]] if name in failures else strangers[name] + cut_off[name],
                self.limits,
            )
            for name in names
        ]

    def query(
        self,
        predicate: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        *,
        stop: threading.Event | None = None,
    ) -> Table:
        """Rows of any predicate of the program, or of Sensor or Memory, at one moment.

        Where robots reason separately, each robot's rows are given, marked with its name.

        Raises:
            QueryError: No such predicate, it has no rows of its own, or it failed.
            Stopped: `stop` was set before the answer was there.
        """
        if predicate == "Sensor":
            return Table(
                ("robot_name", "sensor"), tuple((r["robot_name"], r["sensor"]) for r in rows)
            )
        if predicate == "Memory":
            found = tuple((r["robot_name"], memories.get(r["robot_name"])) for r in rows)
            return Table(("robot_name", "memory"), found)
        known = self.program.predicate(predicate)
        if known is None:
            raise QueryError(f"The program has no predicate {predicate}.")
        if not known.has_rows:
            raise QueryError(known.reason)
        return self._table(predicate, rows, memories, stop)

    def close(self) -> None:
        """Free the database."""
        self._database.close()

    # -- inside --------------------------------------------------------------------------------

    def _table(
        self,
        predicate: str,
        rows: Sequence[SensorRow],
        memories: Memories,
        stop: threading.Event | None,
    ) -> Table:
        columns: tuple[str, ...] = ()
        collected: list[tuple[Value, ...]] = []
        viewers: list[str] = []
        evaluations = self._evaluations(rows, memories)
        most = self.limits.rows
        within = Within(self.limits.query_seconds, most, stop, cut=True)
        for evaluation in evaluations:
            try:
                columns, found = self._ask(predicate, evaluation, within)
            except FailureError as failure:
                raise QueryError(f"{predicate} failed: {failure}") from None
            collected += found
            viewers += [evaluation.viewers[0]] * len(found)
        if "logica_value" in columns and "value" not in columns:
            columns = tuple("value" if c == "logica_value" else c for c in columns)
        return Table(
            columns,
            tuple(collected[:most]),
            tuple(viewers[:most]) if self._separate else (),
            truncated=len(collected) > most,
        )

    @property
    def _separate(self) -> bool:
        return not (self.memory == "all" and self.sensor == "all")

    def _evaluations(self, rows: Sequence[SensorRow], memories: Memories) -> list[Evaluation]:
        """What is to be evaluated so that each robot reasons over exactly what it may see."""
        sensors = [(r["robot_name"], to_json(r["sensor"])) for r in rows]
        remembered = [(name, to_sql(memories.get(name))) for name, _ in sensors]
        if not self._separate:
            return [Evaluation(tuple(n for n, _ in sensors), sensors, remembered)] if rows else []
        return [
            Evaluation(
                (name,),
                sensors if self.sensor == "all" else [own],
                [m for m in remembered if self._sees_memory(name, row, m[0])],
            )
            for (name, _), own, row in zip(sensors, sensors, rows, strict=True)
        ]

    def _sees_memory(self, viewer: str, row: SensorRow, other: str) -> bool:
        if self.memory == "all" or viewer == other:
            return True
        return self.memory == "seen" and any(
            ray["object"] == "robot" and ray["label"] == other for ray in row["sensor"]["radar"]
        )

    def _blame(self, failure: FailureError, evaluation: Evaluation, within: Within) -> Notice:
        """Say which predicate failed first, and on whose rows."""
        whose = " and ".join(evaluation.viewers[:3])
        if len(evaluation.viewers) > 3:
            whose += " and others"
        if failure.slow:
            return Notice("failed", f"The thought about {whose} failed: {failure}.")
        culprit, reason = "Robot", str(failure)
        for predicate in self.program.needed:
            try:
                self._ask(predicate, evaluation, within)
            except FailureError as found:
                if not found.slow:
                    culprit, reason = predicate, str(found)
                break
        alone = [e.viewers[0] for e in evaluation.one_by_one() if self._fails(culprit, e, within)]
        if 0 < len(alone) <= 3:
            whose = " and ".join(alone)
        return Notice("failed", f"{culprit} failed on the rows of {whose}: {reason}.")

    def _fails(self, predicate: str, evaluation: Evaluation, within: Within) -> bool:
        try:
            self._ask(predicate, evaluation, within)
        except FailureError:
            return True
        return False

    def _cut_off(self, evaluation: Evaluation, within: Within) -> Iterator[Notice]:
        """A notice for each recursion that was still changing when it reached its last step."""
        for predicate, (steps, sql) in self.program.recursions.items():
            try:
                _, rows = self._fetch(sql, evaluation, within)
            except FailureError:
                continue
            if rows[0][0]:
                yield Notice(
                    "recursion",
                    f"The recursion of {predicate} was still growing after {steps} steps, what "
                    f"lies further is missing: @Recursive({predicate}, N) says how far it goes.",
                )

    def _ask(
        self,
        predicate: str,
        evaluation: Evaluation,
        within: Within,
    ) -> tuple[tuple[str, ...], list[tuple[Value, ...]]]:
        """Rows of a predicate.

        Raises:
            FailureError: It failed, took too long, or has too many rows.
        """
        columns, rows = self._fetch(self.program.statements[predicate], evaluation, within)
        if len(rows) > within.rows and not within.cut:
            raise FailureError(f"{predicate} has more than {within.rows:,} rows")
        return columns, rows

    def _fetch(
        self, sql: str, evaluation: Evaluation, within: Within
    ) -> tuple[tuple[str, ...], list[tuple[Value, ...]]]:
        try:
            if self._loaded is not evaluation:
                self._loaded = None
                self._database.load(evaluation.sensors, evaluation.memories)
                self._loaded = evaluation
            columns, rows = self._database.ask(
                sql, most=within.rows + 1, deadline=within.deadline, stop=within.stop
            )
            return columns, [
                tuple(from_sql(v, self.limits.depth) for v in within.each(row)) for row in rows
            ]
        except TooSlowError:
            message = f"thinking took longer than {within.seconds:g} seconds"
            raise FailureError(message, slow=True) from None
        except (TooMuchError, TooDeepError) as error:
            raise FailureError(str(error)) from None
        except (sqlite3.Error, sqlite3.Warning) as error:
            raise FailureError(printable(in_plain_words(error))) from None
