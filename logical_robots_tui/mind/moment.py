"""What is reasoned over in one tick, by whom, and how much time and how many rows that may take."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.mind.diagnostics import Stopped

if TYPE_CHECKING:
    import threading
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.values import SensorRow, Value

__all__ = ["Moment", "View", "Within"]


@dataclass(frozen=True, slots=True)
class View:
    """Robots that reason alike, and which rows of a moment they may see.

    Attributes:
        viewers: Names of the robots.
        sensors: Numbers of the first and the last sensor row.
        memories: Numbers of the first and the last memory row.
    """

    viewers: tuple[str, ...]
    sensors: tuple[int, int]
    memories: tuple[int, int]


class Moment:
    """The sensors and memories of one tick, arranged so that what a robot sees stands together.

    Args:
        rows: Sensor rows.
        memories: What each robot remembers, by name; one that is missing remembers null.
        memory: Whose memories a robot sees: ``own``, ``seen`` or ``all``.
        sensor: Whose sensors it sees: ``own`` or ``all``.

    Attributes:
        sensors: The sensor rows, numbered from 0.
        memories: Names and memories, numbered from 0: first one of each robot in the order of the
            rows; then, for each robot that meets others, its own and theirs once more.
        views: Who reasons over what.
    """

    def __init__(
        self,
        rows: Sequence[SensorRow],
        memories: Mapping[str, Value],
        memory: Literal["own", "seen", "all"],
        sensor: Literal["own", "all"],
    ) -> None:
        self.sensors = rows
        names = [row["robot_name"] for row in rows]
        own = [(name, memories.get(name)) for name in names]
        self.memories = own
        everybody = (0, len(rows) - 1)
        if not rows:
            self.views: list[View] = []
        elif memory == "all" and sensor == "all":
            self.views = [View(tuple(names), everybody, everybody)]
        else:
            self.views = [
                View(
                    (name,),
                    everybody if sensor == "all" else (number, number),
                    everybody if memory == "all" else (number, number),
                )
                for number, name in enumerate(names)
            ]
        if memory == "seen":
            self._let_see(own)

    def one_by_one(self, view: View) -> Iterator[View]:
        """The same for each robot alone, with the rows of the others left out."""
        for name in view.viewers if len(view.viewers) > 1 else ():
            number = next(i for i, row in enumerate(self.sensors) if row["robot_name"] == name)
            yield View((name,), (number, number), (number, number))

    def _let_see(self, own: Sequence[tuple[str, Value]]) -> None:
        """Add for each robot the memories of those that it meets."""
        self.memories = list(own)
        for number, (view, row) in enumerate(zip(self.views, self.sensors, strict=True)):
            met = {r["label"] for r in row["sensor"]["radar"] if r["object"] == "robot"}
            seen = [item for i, item in enumerate(own) if i == number or item[0] in met]
            if len(seen) > 1:
                first = len(self.memories)
                self.memories += seen
                last = len(self.memories) - 1
                self.views[number] = View(view.viewers, view.sensors, (first, last))


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
