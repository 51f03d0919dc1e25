"""Bounds on what a program may use."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Limits"]


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds on what a program may use.

    Attributes:
        think_seconds: Longest thought of one tick, per evaluation.
        rows: Most rows that a query of the inspector shows.
        memory_bytes: Largest memory of one robot, as JSON.
    """

    think_seconds: float = 30.0
    rows: int = 1_000
    memory_bytes: int = 1_000_000
