"""How far the program is: what was tried, what the robots think with, and what is wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol, TypeAlias

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic

__all__ = ["ProgramState", "ProgramText"]

Phase: TypeAlias = Literal["fresh", "compiling", "applied", "mistake"]


class ProgramState(NamedTuple):
    """How far the program is.

    Attributes:
        phase: ``fresh`` before the first compilation, then what the last one came to.
        tried: The text that was last compiled.
        applied: The text that the robots think with, or None.
        mistakes: What is wrong with `tried`, or odd about it though it runs.
        warnings: What is odd about `applied`.
        compiled: How many predicates of how many are compiled, while compiling.
    """

    phase: Phase = "fresh"
    tried: str = ""
    applied: str | None = None
    mistakes: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    compiled: tuple[int, int] = (0, 0)

    @classmethod
    def of_applied(cls, text: str, warnings: tuple[Diagnostic, ...]) -> ProgramState:
        """The state when the robots have begun to think with a text."""
        return cls("applied", text, text, warnings, warnings)

    def compiling(self, text: str) -> ProgramState:
        """The state when the compilation of a text has begun."""
        return self._replace(phase="compiling", tried=text, mistakes=(), compiled=(0, 0))

    def seen_from(self, text: str) -> ProgramState:
        """What to say while that text stands in the editor.

        The mistakes of another text are no matter once that of the robots is back.
        """
        if self.phase != "mistake" or text == self.tried or text != self.applied:
            return self
        return self._replace(phase="applied", tried=text, mistakes=self.warnings)


class ProgramText(Protocol):
    """The text of the program at hand, where it can be changed."""

    @property
    def text(self) -> str:
        """What stands there."""

    def load(self, text: str) -> None:
        """Put another program's text there."""

    def put(self, text: str) -> None:
        """Put another text of the same program there; undo brings the former back."""
