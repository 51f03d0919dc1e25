"""The clock: one for a whole game, passed in, so that tests can own it."""

from __future__ import annotations

from pathlib import Path
from time import monotonic, thread_time

_SCHEDULE = Path("/proc/thread-self/schedstat")


class Clock:
    """The machine's clock, in seconds; the event loop must have the same time."""

    def now(self) -> float:
        """Return seconds since an arbitrary moment; may be called in any thread."""
        return monotonic()

    def computed(self) -> float:
        """Return the processor seconds that this thread has used."""
        return thread_time()

    def processor_times(self) -> tuple[float, float] | None:
        """Return how long this thread has computed, and has waited for a processor.

        Nanoseconds, only on Linux (Documentation/scheduler/sched-stats.rst); elsewhere None.
        """
        try:
            computed, waited, _ = _SCHEDULE.read_text().split()
        except (OSError, ValueError):
            return None
        return int(computed) / 1e9, int(waited) / 1e9


CLOCK = Clock()
