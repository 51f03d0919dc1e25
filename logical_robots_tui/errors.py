"""The exceptions that this package raises on purpose."""

from __future__ import annotations


class LogicalRobotsError(Exception):
    """Base of every error that this package raises on purpose."""

    title = "Something went wrong"


class InputError(LogicalRobotsError):
    """A file, key or value that a person gave can't be used.

    Attributes:
        place: Where it is: a file, a file and line, a key such as ``areas[2].radius``, or "".
        message: What is wrong, one plain sentence.
        hint: What to do about it, or "".
    """

    title = "This input can't be used"

    def __init__(self, message: str, *, place: str = "", hint: str = "") -> None:
        self.place = place
        self.message = message
        self.hint = hint
        super().__init__(str(self))

    def __str__(self) -> str:
        head = f"{self.place}: {self.message}" if self.place else self.message
        if not self.hint:
            return head
        return f"{head}{'' if head.endswith(('.', '!', '?')) else '.'} {self.hint}"


def is_out_of_memory(error: BaseException | None) -> bool:
    """Return whether a process ran out of memory or threads, judging by its error."""
    while error is not None:
        if isinstance(error, MemoryError) or str(error) == "can't start new thread":
            return True
        error = error.__cause__ or error.__context__
    return False
