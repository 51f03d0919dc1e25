"""Screens that are closed once."""

from __future__ import annotations

from typing import TypeVar

from textual.await_complete import AwaitComplete
from textual.screen import Screen

__all__ = ["ClosedOnce"]

Result = TypeVar("Result")


class ClosedOnce(Screen[Result]):
    """A screen that what comes in twice, such as a double click, closes once.

    Textual would close the screen below as well, or end the app if there is none but that.
    """

    def dismiss(self, result: Result | None = None) -> AwaitComplete:
        """Close, unless that is done already."""
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Whether a key may do something: not once it is closed, and has lost its parts."""
        return self.is_active and super().check_action(action, parameters)
