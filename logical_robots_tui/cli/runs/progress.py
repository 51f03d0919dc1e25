"""A progress bar on standard error."""

from __future__ import annotations

import sys
from contextlib import ExitStack, contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from logical_robots_tui.cli.text import harmless

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rich.progress import Progress

__all__ = ["progress_bar"]

_REDRAW_EVERY = 0.1  # seconds


@contextmanager
def progress_bar(title: str, ticks: int, *, after: float = 0.0) -> Iterator[Callable[[int], None]]:
    """Show the progress of a run on a terminal; the bar disappears at the end.

    Args:
        title: The label.
        ticks: The last tick.
        after: Seconds before the bar appears.

    Yields:
        A callback to call with each finished tick; it redraws a few times a second only.
    """
    began = monotonic()
    due = began + after if sys.stderr.isatty() else float("inf")
    bar: Progress | None = None
    with ExitStack() as stack:

        def show(tick: int) -> None:
            nonlocal bar, due
            now = monotonic()
            if now < due:
                return
            due = now + _REDRAW_EVERY
            if bar is None:
                bar = stack.enter_context(_new_bar())
                bar.add_task(harmless(title), total=ticks, pace=0.0)
            pace = tick / max(now - began, 1e-9)
            bar.update(bar.task_ids[0], completed=tick, pace=pace, refresh=True)

        yield show


def _new_bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("tick {task.completed:.0f} of {task.total:.0f}"),
        TextColumn("{task.fields[pace]:.0f} ticks/s"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
