"""Where the lines of a text are once that has changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["followed"]


def followed(rows: Sequence[int], before: Sequence[str], after: Sequence[str]) -> list[int | None]:
    """Return where some lines of a text stand in a changed one, all counted from 0.

    Args:
        rows: Which lines.
        before: All lines of the text.
        after: All lines of the changed text.

    Returns:
        For each its new number, or None if it is gone. A line that was changed is still the same
        one, unless lines went or came in the same place.
    """
    same, most = 0, min(len(before), len(after))
    while same < most and before[same] == after[same]:
        same += 1
    most -= same
    tail = 0
    while tail < most and before[-1 - tail] == after[-1 - tail]:
        tail += 1
    grown = len(after) - len(before)
    changed = len(before) - tail - same

    def new(row: int) -> int | None:
        if row < same:
            return row
        if row >= same + changed:
            return row + grown
        if grown == 0:
            return row
        was_split, was_joined = changed == 1 and grown > 0, changed + grown == 1
        return same if was_split or was_joined else None

    return [new(row) for row in rows]
