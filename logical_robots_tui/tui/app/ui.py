"""What a controller may ask of the screen without knowing it: saying, asking, working."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from textual.screen import Screen

__all__ = ["Spawn", "Ui", "Work"]

Result = TypeVar("Result")

Work: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"
"""A function and not a coroutine: one that is cancelled early has never been begun."""


class Spawn(Protocol):
    """Starts work in the background of the screen."""

    def __call__(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Run `work`; an exclusive one cancels what its group still does."""


class Ui(Protocol):
    """Says, asks and works for a controller."""

    def tell(self, message: str) -> None:
        """Say something in passing."""

    def warn(self, message: str) -> None:
        """Say what went wrong."""

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Work in the background; an exclusive work cancels what its group still does."""

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog, and call `closed` with what it gives."""

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog and return what it gives; only for work in the background."""
