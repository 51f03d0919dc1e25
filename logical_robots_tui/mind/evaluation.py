"""What is reasoned over at once, and how much time and how many rows that may take."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.diagnostics import Stopped

if TYPE_CHECKING:
    import threading
    from collections.abc import Iterator, Sequence

__all__ = ["Evaluation", "Within"]


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Rows to reason over, and the robots whose decisions follow from them."""

    viewers: tuple[str, ...]
    sensors: Sequence[tuple[str, Any]]
    memories: Sequence[tuple[str, Any]]

    def one_by_one(self) -> Iterator[Evaluation]:
        """The same for each robot alone, with the rows of the others left out."""
        for name in self.viewers if len(self.viewers) > 1 else ():
            yield Evaluation(
                (name,),
                [row for row in self.sensors if row[0] == name],
                [row for row in self.memories if row[0] == name],
            )


class Within:
    """The time and the rows that several evaluations share.

    Args:
        seconds: How long they may take together, from now on.
        rows: Most rows of one evaluation.
        stop: Ends them when it is set.
        cut: Whether more rows are left out, as opposed to being a failure.
    """

    def __init__(
        self, seconds: float, rows: int, stop: threading.Event | None, *, cut: bool = False
    ) -> None:
        self.seconds = seconds
        self.rows = rows
        self.stop = stop
        self.cut = cut
        self.deadline = monotonic() + seconds

    def each(self, row: tuple[Any, ...]) -> tuple[Any, ...]:
        """The row, unless the work is to end."""
        if self.stop is not None and self.stop.is_set():
            raise Stopped("The program was stopped while its answer was read.")
        return row
