"""A progress bar for what may be over at once."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Patience"]

_PATIENCE = 0.5  # seconds without a word


class Patience:
    """A progress bar on a terminal, once something has taken its time.

    Args:
        title: What is going on.
        ticks: The last tick.
    """

    def __init__(self, title: str, ticks: int) -> None:
        self._title, self._ticks = title, ticks
        self._began = monotonic()
        self._stack = ExitStack()
        self._show: Callable[[int], None] | None = None

    def __enter__(self) -> Callable[[int], None]:
        """Begin; gives what is to be told each finished tick."""
        return self._told

    def __exit__(self, *_error: object) -> None:
        """Take the bar away."""
        self._stack.close()

    def _told(self, tick: int) -> None:
        if self._show is None and monotonic() > self._began + _PATIENCE and sys.stderr.isatty():
            from logical_robots_tui.cli.progress import progress_bar

            self._show = self._stack.enter_context(progress_bar(self._title, self._ticks))
        if self._show is not None:
            self._show(tick)
