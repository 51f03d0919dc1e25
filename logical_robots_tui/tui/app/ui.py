"""What controllers may do on the screen, and what the player may do with the machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from textual.screen import Screen

Result = TypeVar("Result")

Work: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"
"""A function and not a coroutine, because one that is cancelled early would never be awaited."""


class Spawn(Protocol):
    def __call__(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Run `work`; an exclusive one cancels the other work of its group."""


class Ui(Protocol):
    """Messages, dialogs and work for a controller."""

    def tell(self, message: str) -> None:
        """Show a message."""

    def warn(self, message: str) -> None:
        """Show a warning."""

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Start background work; exclusive work cancels the other work of its group."""

    def show(
        self, dialog: Screen[Result], closed: Callable[[Result | None], None] | None = None
    ) -> None:
        """Show a dialog, and call `closed` with its result."""

    async def ask(self, dialog: Screen[Result]) -> Result | None:
        """Show a dialog and return its result; only for background work."""


class Permissions(NamedTuple):
    """Everything on one's own machine; less on a shared or public one, or in a class.

    `programs` are an editor, or the shell after suspending.
    """

    programs: bool = True
    clipboard: bool = True
    solutions: bool = True
