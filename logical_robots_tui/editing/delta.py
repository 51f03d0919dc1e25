"""Compact differences between two levels, for undo and redo."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from logical_robots_tui.world.level import Level
from logical_robots_tui.world.walls import PackedBits, changed_box

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Delta"]

_LISTS = ("robots", "beacons", "areas")
_APART = {*_LISTS, "walls", "name", "source"}
_VALUES = tuple(field.name for field in fields(Level) if field.name not in _APART)


class Delta(NamedTuple):
    """The change from one level to another, in both directions.

    Attributes:
        values: (attribute, before, after) of simple attributes that differ.
        lists: The differences of robots, beacons and areas.
        walls: The difference of the walls.
    """

    values: tuple[tuple[str, Any, Any], ...]
    lists: tuple[_Splice, ...]
    walls: _Flips | _Redrawn | None

    @classmethod
    def between(cls, before: Level, after: Level) -> Delta:
        """Return the difference, ignoring names and sources of the levels."""
        pairs = [(name, getattr(before, name), getattr(after, name)) for name in _VALUES]
        lists = [_Splice.between(n, getattr(before, n), getattr(after, n)) for n in _LISTS]
        return cls(
            tuple((name, old, new) for name, old, new in pairs if old != new),
            tuple(splice for splice in lists if splice.old or splice.new),
            _walls_between(before.walls, after.walls),
        )

    @property
    def empty(self) -> bool:
        """Whether there is no difference."""
        return not (self.values or self.lists or self.walls)

    def apply(self, level: Level) -> Level:
        """Return the new level, given the old one."""
        return self._change(level, forward=True)

    def revert(self, level: Level) -> Level:
        """Return the old level, given the new one."""
        return self._change(level, forward=False)

    def _change(self, level: Level, *, forward: bool) -> Level:
        changes = {name: new if forward else old for name, old, new in self.values}
        for splice in self.lists:
            changes[splice.name] = splice.change(getattr(level, splice.name), forward=forward)
        if self.walls is not None:
            changes["walls"] = self.walls.change(level.walls, forward=forward)
        return replace(level, **changes)


class _Splice(NamedTuple):
    """Replaces a slice of a list."""

    name: str
    start: int
    old: tuple[Any, ...]
    new: tuple[Any, ...]

    @classmethod
    def between(cls, name: str, old: tuple[Any, ...], new: tuple[Any, ...]) -> _Splice:
        most = min(len(old), len(new))
        start = next((i for i in range(most) if old[i] != new[i]), most)
        most -= start
        end = next((i for i in range(most) if old[-1 - i] != new[-1 - i]), most)
        return cls(name, start, old[start : len(old) - end], new[start : len(new) - end])

    def change(self, items: tuple[Any, ...], *, forward: bool) -> tuple[Any, ...]:
        there, wanted = (self.old, self.new) if forward else (self.new, self.old)
        return (*items[: self.start], *wanted, *items[self.start + len(there) :])


class _Flips(NamedTuple):
    """Flips units in a part of the walls."""

    top: int
    left: int
    flipped: PackedBits

    def change(self, walls: NDArray[np.bool_], *, forward: bool) -> NDArray[np.bool_]:
        height, width = self.flipped.shape
        changed = walls.copy()
        changed[self.top : self.top + height, self.left : self.left + width] ^= self.flipped.bits()
        changed.flags.writeable = False
        return changed


class _Redrawn(NamedTuple):
    """Replaces all walls, when the size changes."""

    old: PackedBits
    new: PackedBits

    def change(self, walls: NDArray[np.bool_], *, forward: bool) -> NDArray[np.bool_]:
        changed = (self.new if forward else self.old).bits()
        changed.flags.writeable = False
        return changed


def _walls_between(before: NDArray[np.bool_], after: NDArray[np.bool_]) -> _Flips | _Redrawn | None:
    if before.shape != after.shape:
        return _Redrawn(PackedBits.of(before), PackedBits.of(after))
    box = changed_box(before, after)
    if box is None:
        return None
    down, across = box
    return _Flips(down.start, across.start, PackedBits.of(before[box] ^ after[box]))
