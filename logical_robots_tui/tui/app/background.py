"""Work in the background of a widget, given up when the widget goes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

from textual.css.query import NoMatches

from logical_robots_tui.tui.terminal.textual_internals import is_being_removed

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from textual.dom import DOMNode
    from textual.worker import Worker

__all__ = ["Spawn", "Work", "in_background"]

Work: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"
"""A function and not a coroutine: one that is cancelled early has never been begun."""


class Spawn(Protocol):
    """Starts work in the background of the screen."""

    def __call__(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Run `work`; an exclusive one cancels what its group still does."""


def in_background(
    node: DOMNode, work: Work, group: str = "default", *, exclusive: bool = False
) -> Worker[None]:
    """Start work for a widget.

    Args:
        node: The widget.
        work: What to do.
        group: Name of the work it belongs to.
        exclusive: Whether what the group still does is cancelled.
    """

    async def unless_gone() -> None:
        try:
            await work()
        except NoMatches:
            # A dialog that is closed loses its widgets before its work is cancelled.
            if not is_being_removed(node):
                raise

    worker: Worker[None] = node.run_worker(unless_gone, group=group, exclusive=exclusive)
    return worker
