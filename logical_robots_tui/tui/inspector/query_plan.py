"""A predicate's generated SQL and query plan, and the time that each predicate takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.theme.safe_text import one_line, visible
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.mind import QueryPlan

__all__ = ["query_plans_text"]

_BAR = 24  # columns of the longest bar


def query_plans_text(found: Sequence[QueryPlan], predicate: str) -> Static:
    """How long each predicate takes, and the SQL and plan of one of them.

    Args:
        found: All predicates, the slowest first.
        predicate: The one to show in full; the slowest if it is not among them.
    """
    chosen = next((each for each in found if each.predicate == predicate), found[0])
    return Static(Content("\n").join([*_times(found, chosen), *_in_full(chosen)]))


def _times(found: Sequence[QueryPlan], chosen: QueryPlan) -> Iterator[Content]:
    yield Content.styled("Milliseconds, including dependencies", f"bold {INK.title}")
    longest = max(each.milliseconds for each in found) or 1.0
    for each in found:
        bar = "▇" * max(1, round(each.milliseconds / longest * _BAR))
        yield Content.assemble(
            (f"{each.milliseconds:8.2f}  ", INK.number),
            (f"{bar:<{_BAR}}  ", INK.faint),
            (one_line(each.predicate), f"bold {INK.key}" if each is chosen else INK.text),
        )


def _in_full(chosen: QueryPlan) -> Iterator[Content]:
    name = one_line(chosen.predicate)
    yield from _titled(f"SQLite's plan for {name}", chosen.plan, INK.record)
    if chosen.tuned:
        yield from _titled("Optimised SQL, which is run", chosen.tuned.splitlines(), INK.text)
        yield from _titled("Generated SQL", chosen.generated.splitlines(), INK.dim)
    else:
        yield from _titled("Generated SQL, which is run", chosen.generated.splitlines(), INK.text)


def _titled(title: str, lines: Sequence[str], colour: str) -> Iterator[Content]:
    yield Content("")
    yield Content.styled(title, f"bold {INK.title}")
    for line in lines:
        if line.strip():
            yield Content.styled(f"  {visible(line)}", colour)
