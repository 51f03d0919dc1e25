"""What a program decides for one robot in one tick."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from logical_robots_tui.values import Desire, Value

__all__ = ["UNRELIABLE", "Decision", "Notice", "NoticeKind"]

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
    """Something about a decision that a player should know; it never stops the game.

    Attributes:
        kind: What sort of thing happened. What the clock has ended is ``late``, what found no room
            in the memory of the machine ``no room``: what follows depends on the machine.
        message: One plain sentence.
    """

    kind: NoticeKind
    message: str


@dataclass(frozen=True, slots=True)
class Decision:
    """One robot's desire and new memory, or why there is none.

    Attributes:
        robot_name: Whose decision this is.
        desire: What the engines should do; None stops the robot for this tick.
        memory: What the robot remembers from now on.
        notices: What was unusual about it, in the order found.
        weight: At least the bytes of the objects that the memory is made of; 0 if nobody knows.
    """

    robot_name: str
    desire: Desire | None
    memory: Value
    notices: tuple[Notice, ...] = ()
    weight: int = field(default=0, compare=False, repr=False)

    @property
    def is_reliable(self) -> bool:
        """Whether it would be the same on any machine: neither clock nor memory ended it."""
        return not any(notice.kind in UNRELIABLE for notice in self.notices)
