"""A progress bar on standard error."""

from __future__ import annotations

from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from logical_robots_tui.cli.text import harmless

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["progress_bar"]

_REDRAW_EVERY = 0.1  # seconds


@contextmanager
def progress_bar(title: str, ticks: int) -> Iterator[Callable[[int], None]]:
    """Show how far a run has come; the bar vanishes when it is over.

    Args:
        title: What is running.
        ticks: The last tick.

    Yields:
        A function to be told each finished tick; it redraws a few times a second only.
    """
    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("tick {task.completed:.0f} of {task.total:.0f}"),
        TextColumn("{task.fields[pace]:.0f} ticks/s"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
    began = monotonic()
    last = began - _REDRAW_EVERY
    with bar:
        task = bar.add_task(harmless(title), total=ticks, pace=0.0)

        def show(tick: int) -> None:
            nonlocal last
            now = monotonic()
            if now - last < _REDRAW_EVERY:
                return
            last = now
            pace = tick / max(now - began, 1e-9)
            bar.update(task, completed=tick, pace=pace, refresh=True)

        yield show
