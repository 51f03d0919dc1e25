"""Waiting for an answer: how long it takes is told meanwhile, and it can be stopped."""

from __future__ import annotations

import asyncio
from time import perf_counter
from typing import TYPE_CHECKING, Any, TypeVar

from textual.content import Content

from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

__all__ = ["GivenUp", "Waiting", "under_way"]

T = TypeVar("T")

_BEAT = 0.1  # seconds between two pictures of the spinner; what is quicker needs none
_SPINNER = "▖▘▝▗"


class GivenUp(Exception):  # noqa: N818 - the player's wish, and no error
    """The player no longer wants the answer."""


class Waiting:
    """Waits for one answer at a time.

    Attributes:
        seconds: How long the present answer, or the last one, has been waited for.
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self._task: asyncio.Future[Any] | None = None

    @property
    def is_long(self) -> bool:
        """Whether an answer is being waited for so long that this is told."""
        return self._task is not None and self.seconds > 0

    async def answer(self, work: Coroutine[Any, Any, T], tell: Callable[[], None]) -> T:
        """Wait for an answer.

        Args:
            work: What gives it; it is cancelled when nobody waits for it any more.
            tell: Called several times a second as long as the answer is not there.

        Raises:
            GivenUp: `stop` was called meanwhile.
        """
        task = asyncio.ensure_future(work)
        self._task, self.seconds = task, 0.0
        began = perf_counter()
        try:
            while not (await asyncio.wait({task}, timeout=_BEAT))[0]:
                self.seconds = perf_counter() - began
                tell()
            if task.cancelled():
                raise GivenUp
            return task.result()
        finally:
            task.cancel()
            if self._task is task:
                self._task = None

    def stop(self) -> None:
        """Give up what is being waited for."""
        if self._task is not None:
            self._task.cancel()


def under_way(what: str, seconds: float) -> Content:
    """What is shown while an answer is not there: a spinner, the time, and how to stop it."""
    spin = _SPINNER[int(seconds / _BEAT) % len(_SPINNER)]
    return Content.assemble(
        (f"{spin} ", INK.key),
        (one_line(what), INK.text),
        (f"  {seconds:.1f} s", INK.number),
        ("  esc here stops it", INK.dim),
    )
