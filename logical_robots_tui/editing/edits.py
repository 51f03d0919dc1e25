"""A level being edited, with undo and redo, which keep only differences."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from logical_robots_tui.world.level import COMPARED, Level
from logical_robots_tui.world.walls import PackedBits, difference_box

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Delta(NamedTuple):
    """The differences of two levels, both ways; `values` are (attribute, before, after)."""

    values: tuple[tuple[str, Any, Any], ...]
    walls: _Flips | _Replacement | None

    @classmethod
    def between(cls, old_level: Level, new_level: Level) -> Delta:
        """Return the difference, ignoring names and sources of the levels."""
        pairs = [(name, getattr(old_level, name), getattr(new_level, name)) for name in COMPARED]
        differing = tuple(pair for pair in pairs if pair[1] != pair[2])
        old, new = old_level.walls, new_level.walls
        if old.shape != new.shape:
            return cls(differing, _Replacement(PackedBits.pack(old), PackedBits.pack(new)))
        if (box := difference_box(old, new)) is None:
            return cls(differing, None)
        down, across = box
        flips = _Flips(down.start, across.start, PackedBits.pack(old[box] ^ new[box]))
        return cls(differing, flips)

    @property
    def empty(self) -> bool:
        return not (self.values or self.walls)

    def apply(self, level: Level, *, forward: bool = True) -> Level:
        changes = {name: new if forward else old for name, old, new in self.values}
        if self.walls is not None:
            changes["walls"] = self.walls.change(level.walls, forward=forward)
        return replace(level, **changes)


class _Flips(NamedTuple):
    """Flips units in a part of the walls."""

    top: int
    left: int
    flipped: PackedBits

    def change(self, walls: NDArray[np.bool_], *, forward: bool) -> NDArray[np.bool_]:
        height, width = self.flipped.shape
        units = walls.copy()
        units[self.top : self.top + height, self.left : self.left + width] ^= self.flipped.bits()
        units.flags.writeable = False
        return units


class _Replacement(NamedTuple):
    """Replaces all walls, when the size changes."""

    old: PackedBits
    new: PackedBits

    def change(self, walls: NDArray[np.bool_], *, forward: bool) -> NDArray[np.bool_]:
        return (self.new if forward else self.old).bits()


class Edits:
    """A level with unlimited undo and redo; each step stores only the difference.

    The level before the newest step is kept until the next one, so that a stroke can extend it.
    """

    def __init__(self, level: Level) -> None:
        self.level = level
        self._undo_stack: list[tuple[str, Delta]] = []
        self._redo_stack: list[tuple[str, Delta]] = []
        self._open: tuple[str, Level] | None = None
        self._saved: int | None = 0

    @property
    def is_changed(self) -> bool:
        """Whether there are steps since the last save."""
        return self._position != self._saved

    @property
    def can_undo(self) -> str:
        """The step that would be undone, or ""."""
        if self._open is not None:
            return self._open[0]
        return self._undo_stack[-1][0] if self._undo_stack else ""

    @property
    def can_redo(self) -> str:
        """The step that would be redone, or ""."""
        return self._redo_stack[-1][0] if self._redo_stack else ""

    def do(self, label: str, level: Level, *, merge: bool = False) -> bool:
        """Apply a step and clear redo; return False if nothing changed, so no step was added.

        With `merge` it extends the previous step, if that has the same description and nothing
        was undone or saved since.
        """
        if level is self.level:
            return False
        if not (merge and self._open is not None and self._open[0] == label):
            self._close()
            self._open = label, self.level
            if self._saved is not None and self._saved > len(self._undo_stack):
                self._saved = None
        self._redo_stack.clear()
        self.level = level
        return True

    def undo(self) -> str:
        """Undo a step and return its description, or "" if there is none."""
        self._close()
        return self._step(self._undo_stack, self._redo_stack, forward=False)

    def redo(self) -> str:
        """Redo a step and return its description, or "" if there is none."""
        return self._step(self._redo_stack, self._undo_stack, forward=True)

    def _step(
        self, source: list[tuple[str, Delta]], target: list[tuple[str, Delta]], *, forward: bool
    ) -> str:
        if not source:
            return ""
        target.append(source.pop())
        label, delta = target[-1]
        self.level = delta.apply(self.level, forward=forward)
        return label

    def mark_saved(self) -> None:
        self._close()
        self._saved = self._position

    @property
    def _position(self) -> int:
        return len(self._undo_stack) + (self._open is not None)

    def _close(self) -> None:
        if self._open is not None:
            label, old_level = self._open
            self._open = None
            delta = Delta.between(old_level, self.level)
            if not delta.empty:
                self._undo_stack.append((label, delta))
