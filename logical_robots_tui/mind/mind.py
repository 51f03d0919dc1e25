"""A mind: a compiled program attached to SQLite; sensors and memories in, decisions out."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.mind.database import Database, TooSlowError
from logical_robots_tui.mind.deciding import decide, note_stranger
from logical_robots_tui.mind.decision import Decision, Notice
from logical_robots_tui.mind.diagnostics import QueryError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.stored import from_sql, to_json, to_sql
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
        self._database = Database(self.limits.think_seconds)

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
        for evaluation in self._evaluations(rows, memories):
            try:
                columns, found = self._ask("Robot", evaluation, most=10_000, stop=stop)
            except _FailureError as failure:
                failures |= dict.fromkeys(evaluation.viewers, Notice("failed", str(failure)))
                continue
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
                [failures[name]] if name in failures else strangers[name],
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
        for evaluation in evaluations:
            try:
                columns, found = self._ask(predicate, evaluation, most=most + 1, stop=stop)
            except _FailureError as failure:
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

    def _evaluations(self, rows: Sequence[SensorRow], memories: Memories) -> list[_Evaluation]:
        """What is to be evaluated so that each robot reasons over exactly what it may see."""
        sensors = [(r["robot_name"], to_json(r["sensor"])) for r in rows]
        remembered = [(name, to_sql(memories.get(name))) for name, _ in sensors]
        if not self._separate:
            return [_Evaluation(tuple(n for n, _ in sensors), sensors, remembered)] if rows else []
        return [
            _Evaluation(
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

    def _ask(
        self,
        predicate: str,
        evaluation: _Evaluation,
        *,
        most: int,
        stop: threading.Event | None,
    ) -> tuple[tuple[str, ...], list[tuple[Value, ...]]]:
        self._database.load(evaluation.sensors, evaluation.memories)
        try:
            columns, rows = self._database.ask(
                self.program.statements[predicate], most=most, stop=stop
            )
        except TooSlowError:
            raise _FailureError(
                f"thinking took longer than {self.limits.think_seconds:g} seconds"
            ) from None
        except (sqlite3.Error, sqlite3.Warning) as error:
            raise _FailureError(_in_plain_words(error)) from None
        return columns, [tuple(from_sql(v) for v in row) for row in rows]


@dataclass(frozen=True, slots=True)
class _Evaluation:
    """Rows to reason over, and the robots whose decisions follow from them."""

    viewers: tuple[str, ...]
    sensors: Iterable[tuple[str, Any]]
    memories: Iterable[tuple[str, Any]]


class _FailureError(Exception):
    """A query failed; the message is for the player."""


def _in_plain_words(error: Exception) -> str:
    text = str(error)
    if "malformed JSON" in text:
        return "a field was asked of something that is neither a record nor a list"
    if "user-defined" in text:
        return "a function was given a value that it can't use, such as text instead of a list"
    if "parser stack overflow" in text or "too many levels" in text or "too large" in text:
        return "an expression is nested too deeply; give parts of it names of their own"
    if "not authorized" in text or "prohibited" in text:
        return "it uses something that robots may not use"
    if "too big" in text:
        return "a value became too large"
    if found := text.removeprefix("no such function: "):
        return f"there is no function {found}" if found != text else f"SQLite says: {text}"
    return text
