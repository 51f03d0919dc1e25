"""Whether a recursion was cut off while it was still changing.

The package unrolls a recursion into steps, each a named query of one statement. The rows of the
last step equal those of the one before exactly if going on would change nothing.
"""

from __future__ import annotations

import re

__all__ = ["growth_check"]

_PIECE = re.compile(r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|[()]|\bSELECT\b")


def growth_check(statement: str, predicate: str, steps: int) -> str:
    """A query for 1 if the last step of a recursion still changed something, else 0.

    Args:
        statement: The compiled query of the predicate, ``WITH <steps> SELECT <last step>``.
        predicate: The recursive predicate.
        steps: How many times it was unrolled.

    Returns:
        SQL, or "" where the steps can't be told apart.
    """
    if not statement.startswith("WITH "):
        return ""
    before = rf"\b(t_\d+_{re.escape(predicate)}_f?r{steps - 1}) AS \("
    step, last = re.search(before, statement), _last_query(statement)
    if step is None or last is None:
        return ""
    named, query = statement[:last].rstrip(), statement[last:].strip().rstrip(";")
    changed = f"SELECT * FROM the_last_step EXCEPT SELECT * FROM {step.group(1)}"  # noqa: S608 - the compiler's own SQL
    return f"{named},\nthe_last_step AS ({query})\nSELECT EXISTS ({changed})"


def _last_query(statement: str) -> int | None:
    """Offset of the query after all named ones: the SELECT outside of parentheses."""
    depth = 0
    for found in _PIECE.finditer(statement):
        piece = found.group()
        depth += (piece == "(") - (piece == ")")
        if piece == "SELECT" and depth == 0:
            return found.start()
    return None
