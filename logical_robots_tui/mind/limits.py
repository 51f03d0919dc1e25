"""Bounds on what a program may use."""

from __future__ import annotations

from dataclasses import dataclass, fields

__all__ = ["Limits"]


_LEAST_WEIGHT = 8_000  # also for one of a thousand robots


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds on what a program may use; every one can be set.

    Attributes:
        compile_seconds: Longest compilation.
        compile_bytes: Address space of the process that compiles.
        program_characters: Longest program.
        think_steps: Longest thought of all robots together in one tick, in steps of SQLite's
            virtual machine; a call of a function of ours counts for 10, and each character that
            it is given or gives for one more. The same on every machine.
        think_seconds: A guard for whoever waits for a thought that does much in few steps: how long
            it may take while the process has a processor. What it ends is marked, because it may
            go otherwise elsewhere.
        query_steps: Longest query of the inspector, in the same steps.
        query_seconds: The guard of such a query.
        mind_bytes: Memory of SQLite in this process, for all minds together; the smallest value
            that a process has seen is the one that holds, because SQLite never raises it again.
        value_bytes: Largest single text, list or record while thinking, as SQLite stores it.
        think_rows: Most rows of `Robot` for one evaluation.
        rows: Most rows that a query of the inspector shows; the rest is left out.
        result_bytes: Most text in the result of one evaluation or one query.
        memory_bytes: Largest memory of one robot, as JSON in UTF-8.
        memory_weight: Largest memory of one robot, as the objects that it is made of.
        memories_weight: The same for all robots together; each has an equal part.
        think_weight: The same for all rows that one thought, or one query, gives.
        depth: How deep records and lists in a result may be nested.
    """

    compile_seconds: float = 30.0
    compile_bytes: int = 1024**3
    program_characters: int = 200_000
    think_steps: int = 100_000_000
    think_seconds: float = 30.0
    query_steps: int = 200_000_000
    query_seconds: float = 30.0
    mind_bytes: int = 160 * 1024**2
    value_bytes: int = 2_000_000
    think_rows: int = 10_000
    rows: int = 1_000
    result_bytes: int = 8_000_000
    memory_bytes: int = 1_000_000
    memory_weight: int = 4_000_000
    memories_weight: int = 48_000_000
    think_weight: int = 96_000_000
    depth: int = 100

    def weight_of_each(self, robots: int) -> int:
        """Bytes of objects that the memory of each of so many robots may be made of."""
        part = self.memories_weight // max(robots, 1)
        return min(self.memory_weight, max(part, _LEAST_WEIGHT))

    def __post_init__(self) -> None:
        for field in fields(self):
            if getattr(self, field.name) < 0:
                raise ValueError(f"{field.name} can't be negative")
