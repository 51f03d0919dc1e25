"""One query at a time in the background, with its progress on the screen and a way to cancel."""

from __future__ import annotations

import asyncio
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

from textual.content import Content

from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

__all__ = ["BackgroundQuery", "Cancelled", "progress"]

T = TypeVar("T")

_INTERVAL = 0.1  # seconds between two steps of the spinner; quicker queries show none
_SPINNER = "▖▘▝▗"


class Cancelled(Exception):  # noqa: N818 - the player's wish, and no error
    """The player has cancelled the query."""


class BackgroundQuery:
    """Waits for one answer at a time.

    Attributes:
        seconds: How long the present query, or the last one, has been running.
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self._task: asyncio.Future[Any] | None = None

    @property
    def is_long(self) -> bool:
        """Whether a query has been running long enough to show its progress."""
        return self._task is not None and self.seconds > 0

    async def run(self, work: Coroutine[Any, Any, T], report: Callable[[], None]) -> T:
        """Run a query.

        Args:
            work: The query; it is cancelled if this call is.
            report: Called ten times a second while it runs.

        Raises:
            Cancelled: `cancel` was called meanwhile.
        """
        task = asyncio.ensure_future(work)
        self._task, self.seconds = task, 0.0
        began = perf_counter()
        try:
            while not (await asyncio.wait({task}, timeout=_INTERVAL))[0]:
                self.seconds = perf_counter() - began
                report()
            if task.cancelled():
                raise Cancelled
            return task.result()
        finally:
            task.cancel()
            if self._task is task:
                self._task = None

    def cancel(self) -> None:
        """Cancel the running query."""
        if self._task is not None:
            self._task.cancel()


def progress(what: str, seconds: float) -> Content:
    """A spinner, what is running, for how long, and how to cancel it."""
    spin = _SPINNER[int(seconds / _INTERVAL) % len(_SPINNER)]
    return Content.assemble(
        (f"{spin} ", INK.key),
        (one_line(what), INK.text),
        (f"  {seconds:.1f} s", INK.number),
        ("  esc here stops it", INK.dim),
    )
