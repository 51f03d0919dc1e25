"""The state of the program: the compiled text, the text that the robots use, and errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol, TypeAlias

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic

__all__ = ["ProgramState", "ProgramText"]

Phase: TypeAlias = Literal["fresh", "compiling", "applied", "mistake"]


class ProgramState(NamedTuple):
    """The state of the program.

    Attributes:
        phase: ``fresh`` before the first compilation, then the result of the last one.
        tried: The last compiled text.
        applied: The text that the robots use, or None.
        mistakes: Errors of `tried`, or warnings if it runs.
        warnings: Warnings of `applied`.
        compiled: The number of compiled predicates and of all, while compiling.
    """

    phase: Phase = "fresh"
    tried: str = ""
    applied: str | None = None
    mistakes: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    compiled: tuple[int, int] = (0, 0)

    @classmethod
    def of_applied(cls, text: str, warnings: tuple[Diagnostic, ...]) -> ProgramState:
        """Return the state when the robots start to use a text."""
        return cls("applied", text, text, warnings, warnings)

    def compiling(self, text: str) -> ProgramState:
        """Return the state when the compilation of a text starts."""
        return self._replace(phase="compiling", tried=text, mistakes=(), compiled=(0, 0))

    def seen_from(self, text: str) -> ProgramState:
        """Return the state to show while that text is in the editor.

        Errors of another text are dropped once the robots' text is back.
        """
        if self.phase != "mistake" or text == self.tried or text != self.applied:
            return self
        return self._replace(phase="applied", tried=text, mistakes=self.warnings)


class ProgramText(Protocol):
    """The editable text of the current program."""

    @property
    def text(self) -> str:
        """The text."""

    def load(self, text: str) -> None:
        """Load another program's text."""

    def put(self, text: str) -> None:
        """Replace the text of the same program; undo restores the old one."""
