"""A program's decision for one robot in one tick."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from logical_robots_tui.values import Desire, Value

NoticeKind: TypeAlias = Literal[
    "no row",
    "several rows",
    "bad engine",
    "no memory",
    "null name",
    "unknown robot",
    "failed",
    "late",
    "no room",
    "recursion",
]

UNRELIABLE: frozenset[NoticeKind] = frozenset({"late", "no room"})
"""Kinds of notices that another run may not have."""


@dataclass(frozen=True, slots=True)
class Notice:
    """Something unusual about a decision, in one plain sentence; it never stops the game."""

    kind: NoticeKind
    message: str


@dataclass(frozen=True, slots=True)
class Decision:
    """One robot's desire and new memory, or why there is none.

    Attributes:
        robot_name: The robot.
        desire: The engine power; None stops the robot for this tick.
        memory: What the robot remembers from now on.
        notices: Notices, in order.
        weight: A lower bound for the bytes of the memory's objects; 0 if unknown.
    """

    robot_name: str
    desire: Desire | None
    memory: Value
    notices: tuple[Notice, ...] = ()
    weight: int = field(default=0, compare=False, repr=False)

    @property
    def is_reliable(self) -> bool:
        """Whether it is the same on any machine: no time limit or lack of memory affected it."""
        return not any(notice.kind in UNRELIABLE for notice in self.notices)
