"""The state of a session: the level at hand, and what the robots do by themselves."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

__all__ = ["Movement", "OpenLevel", "nothing"]


class OpenLevel:
    """One level in its three versions, from being opened until the player goes to another one.

    Args:
        level: The level as it was opened.

    Attributes:
        saved: As it is in its file, or as it was made.
        edits: As it is edited, and the way back and forth.
        shown: As it is in the frame on the screen.
    """

    def __init__(self, level: Level) -> None:
        self.saved = self.shown = level
        self.edits = Edits(level)

    @property
    def edited(self) -> Level:
        """The level as it is edited."""
        return self.edits.level

    @property
    def has_changes(self) -> bool:
        """Whether what is edited differs from the file, or from how it was made."""
        return not alike(self.edited, self.saved)

    @property
    def is_saved(self) -> bool:
        """Whether a file says the same as what is edited."""
        return bool(self.saved.source) and not self.has_changes


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


async def nothing() -> None:
    """Take the place of work that is to end."""
