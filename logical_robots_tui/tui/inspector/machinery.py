"""The generated SQL of a predicate, SQLite's plan for it, and what every predicate costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.plain import one_line, visible
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.mind import QueryPlan

__all__ = ["machinery_text"]

_BAR = 24  # columns of the longest bar


def machinery_text(found: Sequence[QueryPlan], predicate: str) -> Static:
    """A widget that tells how long each predicate takes, and how one of them is computed.

    Args:
        found: All predicates, the slowest first.
        predicate: The one that is told in full; the slowest one if it is not there.
    """
    chosen = next((each for each in found if each.predicate == predicate), found[0])
    return Static(Content("\n").join([*_times(found, chosen), *_told(chosen)]))


def _times(found: Sequence[QueryPlan], chosen: QueryPlan) -> Iterator[Content]:
    yield Content.styled("Milliseconds, with all that it leans on", f"bold {INK.title}")
    longest = max(each.milliseconds for each in found) or 1.0
    for each in found:
        bar = "▇" * max(1, round(each.milliseconds / longest * _BAR))
        yield Content.assemble(
            (f"{each.milliseconds:8.2f}  ", INK.number),
            (f"{bar:<{_BAR}}  ", INK.faint),
            (one_line(each.predicate), f"bold {INK.key}" if each is chosen else INK.text),
        )


def _told(chosen: QueryPlan) -> Iterator[Content]:
    name = one_line(chosen.predicate)
    yield from _titled(f"SQLite's plan for {name}", chosen.plan, INK.record)
    if chosen.tuned:
        yield from _titled("What is run", chosen.tuned.splitlines(), INK.text)
        yield from _titled("What was generated", chosen.generated.splitlines(), INK.dim)
    else:
        yield from _titled(
            "What was generated, and is run", chosen.generated.splitlines(), INK.text
        )


def _titled(title: str, lines: Sequence[str], colour: str) -> Iterator[Content]:
    yield Content("")
    yield Content.styled(title, f"bold {INK.title}")
    for line in lines:
        if line.strip():
            yield Content.styled(f"  {visible(line)}", colour)
