"""Movement: what the robots are about to do by themselves, in one place."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import Literal, TypeAlias

__all__ = ["Movement"]

_MOST_OWED = 5  # steps that a key held down may leave behind
_NOTICEABLE = 0.5  # seconds of thinking from which on the screen says so

Kind: TypeAlias = Literal["rest", "awaiting", "run", "steps", "until"]


@dataclass(slots=True, eq=False)
class Movement:
    """What is under way; each begins as an object of its own, so that work knows its own.

    A session goes from ``rest`` to any other kind, and from any kind to any other, by putting
    another movement in place of the present one.

    Attributes:
        kind: ``rest``; ``awaiting`` a program to run with; ``run``, at the speed of the game;
            ``steps``, one tick after the other; ``until`` a tick, flat out.
        owed: Of ``steps``, those that are still to be taken.
        waiting_since: When the thought under way began, as `perf_counter` tells it.
    """

    kind: Kind = "rest"
    owed: int = 0
    waiting_since: float = field(default_factory=perf_counter)

    @property
    def is_resting(self) -> bool:
        """Whether nothing is under way."""
        return self.kind == "rest"

    @property
    def goes_on(self) -> bool:
        """Whether the robots go on by themselves, or will as soon as there is a program."""
        return self.kind in ("awaiting", "run", "until")

    @property
    def thinks(self) -> bool:
        """Whether a thought is under way."""
        return self.kind in ("run", "steps", "until")

    def owe(self, steps: int) -> None:
        """Take more steps, but not many more than were asked for at once."""
        self.owed = min(self.owed + steps, max(self.owed, _MOST_OWED * steps))

    def has_thought(self) -> None:
        """A thought is over; the next one begins."""
        self.waiting_since = perf_counter()

    def thinking_for(self, period: float) -> float:
        """Seconds that the thought under way has taken, 0.0 as long as that is not worth saying.

        Args:
            period: Seconds from one tick to the next while running.
        """
        if not self.thinks:
            return 0.0
        seconds = perf_counter() - self.waiting_since - (period if self.kind == "run" else 0.0)
        return seconds if seconds > _NOTICEABLE else 0.0
