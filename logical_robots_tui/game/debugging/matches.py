"""The ticks of a run in which a question holds.

The answers for a whole run are cached on disk, next to the run itself.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.caching import CacheFolder, cache_place
from logical_robots_tui.game.debugging.watching import matching_rows
from logical_robots_tui.mind import QueryError
from logical_robots_tui.records import record

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import Mind, Question

__all__ = ["Matches", "find_matches"]

MAX_ENTRIES = 500
MAX_BYTES = 10_000_000
SUFFIX = ".when"

_LARGEST = 1_000_000  # bytes of one answer


@dataclass(frozen=True, slots=True)
class Matches:
    """The ticks of a run in which a question holds.

    Attributes:
        ticks: The last tick that was evaluated; the first one is 1.
        won_at: The tick of victory, if the run ended with it.
        stretches: First and last tick of each stretch in which it holds, ascending.
        failed: The same for the stretches in which it failed.
        reason: Why it first failed, or "".
        is_reliable: Whether no thought in these ticks was cut off by the clock.
    """

    ticks: int
    won_at: int | None
    stretches: tuple[tuple[int, int], ...]
    failed: tuple[tuple[int, int], ...] = ()
    reason: str = ""
    is_reliable: bool = True

    @property
    def holds_in(self) -> int:
        """The number of ticks in which it holds."""
        return sum(last - first + 1 for first, last in self.stretches)

    @property
    def failed_in(self) -> int:
        """The number of ticks in which it failed."""
        return sum(last - first + 1 for first, last in self.failed)


async def find_matches(
    run: Run,
    question: Question,
    ticks: int,
    robot: str = "",
    told: Callable[[int], object] = lambda _tick: None,
) -> Matches:
    """Evaluate a question at every tick of a run up to victory, or load the cached answer.

    Args:
        run: The run.
        question: A question compiled for the program of the run.
        ticks: The last tick to evaluate, if the run is not won before.
        robot: The robot whose mind counts; "" means any.
        told: Called with each tick.
    """
    about = (run.key, question.text, question.sql, robot, ticks)
    name = hashlib.sha256(json.dumps(about).encode()).hexdigest()
    if (known := _find(name)) is not None:
        return known

    def ask(frame: Frame, mind: Mind, stop: threading.Event) -> tuple[Frame, bool | str]:
        try:
            table = mind.ask(
                question, frame.sensors, frame.memories_before, stop=stop, in_order=False
            )
        except QueryError as error:
            return frame, str(error)
        return frame, bool(matching_rows(question, table, robot).rows)

    is_reliable = True

    holds: list[tuple[int, int]] = []
    failed: list[tuple[int, int]] = []
    reason, last, won_at = "", 0, None
    async for frame, answer in run.each(1, ticks, ask, to_victory=True):
        last, won_at = frame.tick, frame.after.won_at
        is_reliable = is_reliable and frame.is_reliable
        if isinstance(answer, str):
            _add(failed, last)
            reason = reason or answer
        elif answer:
            _add(holds, last)
        told(last)
    found = Matches(last, won_at, tuple(holds), tuple(failed), reason, is_reliable)
    if is_reliable and run.lasts and not failed:  # it may have failed only for lack of time
        _keep(name, found)
    return found


def _add(stretches: list[tuple[int, int]], tick: int) -> None:
    """Add a tick to the last stretch, or begin a new one."""
    if stretches and stretches[-1][1] == tick - 1:
        stretches[-1] = (stretches[-1][0], tick)
    else:
        stretches.append((tick, tick))


def _folder() -> CacheFolder | None:
    place = cache_place("runs", named="runs")
    return None if place is None else CacheFolder(place, SUFFIX, MAX_ENTRIES, MAX_BYTES)


def _find(name: str) -> Matches | None:
    folder = _folder()
    content = None if folder is None else folder.read(name, _LARGEST)
    if folder is None or content is None:
        return None
    digest, _, body = content.partition(b"\n")
    try:
        if digest != _digest(name, body):
            raise ValueError("another answer, or not all of it")
        found = record(Matches, json.loads(body))
        ends = [end for stretch in found.stretches for end in stretch]
        if ends != sorted(ends) or not all(0 < end <= found.ticks for end in ends):
            raise ValueError("no stretches of these ticks")
    except (ValueError, TypeError, RecursionError):
        folder.drop(name)
        return None
    return found


def _keep(name: str, found: Matches) -> None:
    body = json.dumps(asdict(found)).encode()
    folder = _folder()
    if folder is not None and len(body) < _LARGEST:
        folder.keep(name, [_digest(name, body), b"\n", body])


def _digest(name: str, body: bytes) -> bytes:
    return hashlib.sha256(name.encode() + body).hexdigest().encode()
