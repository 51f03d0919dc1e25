"""The exceptions that this package raises on purpose, as for an optional library."""

from __future__ import annotations

import re


class LogicalRobotsError(Exception):
    """Base of every error that this package raises on purpose."""

    title = "Something went wrong"


_CONTINUES = re.compile(r"(is|isn't|are|was|has|can't|could|already) ")


def joined(place: str, message: str) -> str:
    """Join a place, or "", and what is wrong there; a message like "is not a file" continues it."""
    between = "" if not place else " " if _CONTINUES.match(message) else ": "
    return f"{place}{between}{message}"


class InputError(LogicalRobotsError):
    """A file, key or value that a person gave can't be used.

    Attributes:
        place: Where it is: a file, a file and line, a key such as ``areas[2].radius``, or "".
        message: What is wrong, one plain sentence; or the rest of one that begins with the place.
        hint: What to do about it, or "".
    """

    title = "This input can't be used"

    def __init__(self, message: str, *, place: str = "", hint: str = "") -> None:
        self.place = place
        self.message = message
        self.hint = hint
        super().__init__(str(self))

    def __str__(self) -> str:
        head = joined(self.place, self.message)
        if not self.hint:
            return head
        return f"{head}{'' if head.endswith(('.', '!', '?')) else '.'} {self.hint}"


def is_installed(library: str) -> bool:
    """Return whether an optional library can be imported."""
    from importlib.util import find_spec

    return find_spec(library) is not None


def check_installed(library: str, purpose: str, package: str = "'logical-robots-tui[lab]'") -> None:
    """Raise InputError, with the package to install, if an optional library is missing."""
    if not is_installed(library):
        hint = f"Install it with: pip install {package}"
        raise InputError(f"{purpose} needs {library}", hint=hint)


def is_out_of_memory(error: BaseException | None) -> bool:
    """Return whether a process ran out of memory or threads, judging by its error."""
    while error is not None:
        if isinstance(error, MemoryError) or str(error) == "can't start new thread":
            return True
        error = error.__cause__ or error.__context__
    return False
