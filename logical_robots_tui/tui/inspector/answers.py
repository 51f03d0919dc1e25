"""What the rows of an answer come to on the screen, and how many there are in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game import MIND
from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.mind import Table
    from logical_robots_tui.values import Value

__all__ = ["NO_PROGRAM", "counted", "shown_rows"]

NO_PROGRAM = "There is no program yet that could be asked."


def shown_rows(table: Table) -> tuple[tuple[str, ...], tuple[tuple[Value, ...], ...]]:
    """Columns and rows to show: with the minds that they are from, where that matters."""
    if len(set(table.viewers)) < 2 or "robot_name" in table.columns:
        return table.columns, table.rows
    rows = tuple((who, *row) for who, row in zip(table.viewers, table.rows, strict=True))
    return (MIND, *table.columns), rows


def counted(table: Table, what: str = "row", more: str = "") -> str:
    """How many rows a table has, in words.

    Args:
        table: The rows.
        what: What one of them is called.
        more: What is said behind it.
    """
    count = len(table.rows)
    if table.truncated:
        return with_keys(f"first {count:,} {what}s{more}, there are more: {{ask}} narrows down")
    return f"{count:,} {what}{'' if count == 1 else 's'}{more}"
