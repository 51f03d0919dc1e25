"""A level being edited: what it is now, and the way back and forth."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.editing.delta import Delta

if TYPE_CHECKING:
    from logical_robots_tui.world.level import Level

__all__ = ["Edits"]


class _Step(NamedTuple):
    what: str
    delta: Delta


class Edits:
    """A level and all that was done to it.

    Everything can be undone and redone without limit: of each step only the difference is kept,
    except that of the newest the level before is held until the next one begins, so that a
    stroke may go on in it.

    Args:
        level: To begin with.
    """

    def __init__(self, level: Level) -> None:
        self._level = level
        self._done: list[_Step] = []
        self._undone: list[_Step] = []
        self._open: tuple[str, Level] | None = None
        self._saved: int | None = 0

    @property
    def level(self) -> Level:
        """The level as it is now."""
        return self._level

    @property
    def changed(self) -> bool:
        """Whether it differs from what was saved last, as far as steps tell."""
        return self._position != self._saved

    @property
    def can_undo(self) -> str:
        """What would be undone, or ""."""
        if self._open is not None:
            return self._open[0]
        return self._done[-1].what if self._done else ""

    @property
    def can_redo(self) -> str:
        """What would be redone, or ""."""
        return self._undone[-1].what if self._undone else ""

    def do(self, what: str, level: Level, *, goes_on: bool = False) -> bool:
        """Take a step; what was undone before can't be redone any more.

        Args:
            what: A few words for the player, such as "paint walls".
            level: The level after it, made from the present one.
            goes_on: Whether it belongs to the step before, if that was called the same and
                nothing was undone or saved since.

        Returns:
            False if nothing changed, so that there is no step.
        """
        if level is self._level:
            return False
        if not (goes_on and self._open is not None and self._open[0] == what):
            self._close()
            self._open = what, self._level
            if self._saved is not None and self._saved > len(self._done):
                self._saved = None
        self._undone.clear()
        self._level = level
        return True

    def undo(self) -> str:
        """Go a step back and return what was undone, or "" if there is nothing."""
        self._close()
        if not self._done:
            return ""
        step = self._done.pop()
        self._undone.append(step)
        self._level = step.delta.revert(self._level)
        return step.what

    def redo(self) -> str:
        """Go a step forward again and return what was redone, or "" if there is nothing."""
        if not self._undone:
            return ""
        step = self._undone.pop()
        self._done.append(step)
        self._level = step.delta.apply(self._level)
        return step.what

    def saved(self) -> None:
        """Note that the level is saved as it is now."""
        self._close()
        self._saved = self._position

    @property
    def _position(self) -> int:
        return len(self._done) + (self._open is not None)

    def _close(self) -> None:
        """Keep only the difference of the newest step."""
        if self._open is not None:
            what, before = self._open
            self._open = None
            delta = Delta.between(before, self._level)
            if not delta.empty:
                self._done.append(_Step(what, delta))
