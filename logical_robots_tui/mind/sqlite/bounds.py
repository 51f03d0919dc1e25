"""Limits that keep each single function call short."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.budget import STEPS_OF_A_CALL

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.mind.sqlite.budget import Work

__all__ = [
    "MAX_ITEMS",
    "MAX_RANGE",
    "MAX_TEXT",
    "Room",
    "TooLargeError",
    "check_items",
    "check_long",
    "check_text",
    "counted",
    "guarded",
]

MAX_ITEMS = 20_000
"""Most items and fields of all lists and records in a value that a function parses."""

MAX_RANGE = 100_000
"""Most numbers in a range."""

_MAX_COLLECTED = 100_000  # items and fields of everything that an aggregate collects

MAX_TEXT = 2_000_000
"""Most characters of a text that a function builds; SQLite also limits the bytes."""

_SHORT = 2 * MAX_ITEMS  # a shorter text can't hold more than MAX_ITEMS items


class TooLargeError(OverflowError):
    """A value is larger than a function accepts or returns; SQLite reports it as too big."""


def check_items(count: float, most: int = MAX_ITEMS) -> None:
    """Raise TooLargeError if a list has too many items."""
    if count > most:
        raise TooLargeError(f"a list of {count:,} items")


def check_text(length: int) -> None:
    """Raise TooLargeError if a text is too long."""
    if length > MAX_TEXT:
        raise TooLargeError(f"a text of {length:,} characters")


def counted(function: Callable[..., Any], work: Work) -> Callable[..., Any]:
    """Return a function whose calls and characters count as steps of some work."""

    def counted_function(*arguments: Any) -> Any:
        steps = STEPS_OF_A_CALL
        for argument in arguments:
            if argument.__class__ is str:
                steps += len(argument)
        work.steps -= steps
        if work.halted or work.steps < 0:
            raise TooLargeError("the think was halted")
        return function(*arguments)

    return counted_function


def guarded(function: Callable[..., Any], work: Work, *, null_safe: bool) -> Callable[..., Any]:
    """Return a function that stops when the work is halted, and refuses lists that would take long.

    Its calls and the characters of its arguments and result count as steps of the work.
    """

    def guarded_function(*arguments: Any) -> Any:
        steps = STEPS_OF_A_CALL
        for argument in arguments:
            if argument.__class__ is str:
                length = len(argument)
                steps += length
                if length > _SHORT:
                    check_long(argument)
            elif argument is None and null_safe:
                return None
        work.steps -= steps
        if work.halted or work.steps < 0:
            raise TooLargeError("the think was halted")
        result = function(*arguments)
        if result.__class__ is str:
            work.steps -= len(result)
        return result

    return guarded_function


def check_long(text: str) -> None:
    """Raise TooLargeError if a text, or the list or record in it, is too large."""
    check_text(len(text))
    check_items(_size(text))


class Room:
    """The remaining capacity of an aggregate."""

    __slots__ = ("_characters", "_items", "_size")

    def __init__(self) -> None:
        self._items = 0
        self._size = 0
        self._characters = 0

    def take(self, value: Any, items: int = 1) -> None:
        """Count a value; raise TooLargeError if it is too much."""
        self._items += items
        self._size += items
        check_items(self._items)
        if value.__class__ is str:
            self._characters += len(value)
            check_text(self._characters)
            self._size += _size(value)
        check_items(self._size, _MAX_COLLECTED)


def _size(text: str) -> int:
    """Return an upper bound for the items and fields of all lists and records in a text."""
    if text.lstrip()[:1] not in ("[", "{"):
        return 0
    return text.count(",") + text.count("[") + text.count("{")
