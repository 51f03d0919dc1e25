"""Asking both engines."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import Any

from logical_robots_tui.mind import Decision, Limits, Mind, Program
from tests.mind.rows import nearly_same, row

_SEEN: dict[str, dict[int, tuple[int, str, str]]] = {
    "Ada": {3: (40, "robot", "Bo"), 4: (33, "beacon", "A"), 9: (40, "wall", "wall")},
    "Bo": {0: (12, "wall", "wall"), 5: (50, "beacon", "B"), 6: (50, "beacon", "C")},
    "Cy": {7: (20, "robot", "Ada"), 8: (20, "robot", "Bo"), 30: (1, "beacon", "A")},
    "Di": {},
}
CROWD = [row(name, clock=clock, sees=seen) for clock, (name, seen) in enumerate(_SEEN.items(), 6)]
MEMORIES: dict[str, Any] = {"Ada": {"turn": 4}, "Bo": "", "Cy": {"turn": 0.5}}


def decisions(
    program: Program, rows: list[Any], memories: dict[str, Any], engine: Any, **options: Any
) -> list[Decision]:
    """What the robots decide with an engine."""
    limits = options.pop("limits", Limits())
    mind = Mind(program, limits=limits, engine=engine, **options)
    try:
        return mind.think(rows, memories)
    finally:
        mind.close()


def same_decisions(
    text: str,
    rows: list[Any] = CROWD,
    memories: dict[str, Any] = MEMORIES,
    **options: Any,
) -> list[Decision]:
    """What the robots decide, the same with both engines, whole numbers as whole ones."""
    program = Program.compile(text)
    ours, theirs = (
        decisions(program, rows, memories, engine, **options) for engine in ("sqlite", "duckdb")
    )
    assert nearly_same(
        [asdict(replace(d, weight=0)) for d in theirs], [asdict(replace(d, weight=0)) for d in ours]
    )
    for one, other in zip(ours, theirs, strict=True):
        assert kinds(one.memory) == kinds(other.memory)
        json.dumps(other.memory)
    return theirs


def kinds(value: Any) -> Any:
    """The types of a value and of all in it."""
    if isinstance(value, dict):
        return {name: kinds(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [kinds(inner) for inner in value]
    return type(value)
