"""Editing the properties of a level: its size, its texts, what its programs may see."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from logical_robots_tui.editing.level_text import KINDS, all_things, words_of
from logical_robots_tui.world.level import LevelError
from logical_robots_tui.world.levels.fields import Fields
from logical_robots_tui.world.levels.limits import MOST_OF_A_NUMBER
from logical_robots_tui.world.levels.native import Words, read_words

if TYPE_CHECKING:
    from logical_robots_tui.world.level import Level


def set_words(level: Level, **values: Any) -> Level:
    """Set texts, visibility or shared names, named as in ``Level``, or raise LevelError."""
    for name in values:
        if name not in Words.__annotations__:
            raise LevelError(f"A level has no property {name}.")
    words = read_words(Fields(words_of(replace(level, **values)), level.name))
    changed = replace(level, **words)
    return level if words_of(changed) == words_of(level) else changed


def resize(
    level: Level, width: int, height: int, *, left: int = 0, top: int = 0, wall: bool = False
) -> Level:
    """Resize a level, in map units; its objects move along.

    `left` and `top` are inserted before the first column and row, negative values cut; `wall`
    fills new space. Raises LevelError if the size is out of range or an object too far from the
    map.
    """
    sizes = Fields({"width": width, "height": height}, level.name)
    width, height = sizes.whole("width", least=1), sizes.whole("height", least=1)
    sizes.check_size("width", width, height)
    if (width, height, left, top) == (level.width, level.height, 0, 0):
        return level
    for some in all_things(level):
        if max(abs(some.x + left), abs(some.y + top)) > MOST_OF_A_NUMBER:
            raise LevelError(f'"{some.name}" would be too far from the map.')
    walls = np.full((height, width), wall, np.bool_)
    new_rows, old_rows = _overlap(height, level.height, top)
    new_columns, old_columns = _overlap(width, level.width, left)
    walls[new_rows, new_columns] = level.walls[old_rows, old_columns]
    walls.flags.writeable = False
    moved: dict[str, Any] = {
        kind: tuple(replace(one, x=one.x + left, y=one.y + top) for one in getattr(level, kind))
        for kind in KINDS
    }
    return replace(
        level,
        width=width,
        height=height,
        walls=walls,
        **moved,
    )


def _overlap(new: int, old: int, shift: int) -> tuple[slice, slice]:
    first, last = max(shift, 0), min(old + shift, new)
    last = max(last, first)
    return slice(first, last), slice(first - shift, last - shift)
