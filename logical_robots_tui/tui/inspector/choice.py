"""What can be inspected: a few pages, then the predicates with the number of their rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets.option_list import Option

from logical_robots_tui.tui.layout.listing import Listing
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.mind import Predicate
    from logical_robots_tui.tui.inspector.questions import Survey

__all__ = ["ASK", "DECISION", "DIAGNOSIS", "MARKS", "ORIGIN", "ROBOTS", "WATCH", "WHY", "Choice"]

ROBOTS, DECISION, WHY, ASK, WATCH = "(robots)", "(decision)", "(why)", "(ask)", "(watch)"
DIAGNOSIS, ORIGIN = "(diagnosis)", "(origin)"
"""The pages; no predicate can have these names. That of an origin is not listed."""

_PAGES = {
    ROBOTS: "Robots",
    DECISION: "Decision",
    WHY: "Why",
    ASK: "Ask",
    WATCH: "Watch",
    DIAGNOSIS: "Diagnosis",
}
MARKS = {"input": ("◂", INK.robot), "program": ("•", INK.key), "prelude": ("◦", INK.dim)}
"""The sign of each kind of predicate, with its colour."""

_CHANGED = "•"
_NARROWEST = 12  # columns of an entry


class Choice(Listing):
    """The list at the left of the inspector."""

    DEFAULT_CSS = """
    Choice {
        width: 24; height: 1fr; border: none; padding: 0; background: $surface;
        border-right: solid $ink-faint;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    def __init__(self) -> None:
        super().__init__(id="choice", markup=False, compact=True)
        self._predicates: tuple[Predicate, ...] | None = None
        self._names: list[str] = []
        self._survey: Survey | None = None
        self._counted: dict[str, tuple[str, bool, int]] = {}

    @property
    def predicates(self) -> tuple[Predicate, ...] | None:
        """The predicates of the program that is listed, or None before the first one."""
        return self._predicates

    @property
    def names(self) -> Sequence[str]:
        """The pages and predicates that are listed."""
        return self._names

    def list(self, predicates: tuple[Predicate, ...], inspected: str) -> None:
        """List the predicates of a program.

        Args:
            predicates: All of them.
            inspected: What is being inspected.
        """
        self._predicates, self._survey = predicates, None
        self._counted.clear()
        # The prelude's functions have nothing to show in any tick; the program's own may surprise.
        listed = [each for each in predicates if each.has_rows or each.kind != "prelude"]
        names = self._names = [*_PAGES, *(predicate.name for predicate in listed)]
        self.clear_options()
        self.add_options(
            [
                Option(Content.styled(title, f"bold {INK.title}"), id=page)
                for page, title in _PAGES.items()
            ]
            + [Option(_entry(predicate), id=predicate.name) for predicate in listed]
        )
        self.highlighted = names.index(inspected) if inspected in names else None

    def count(self, survey: Survey) -> None:
        """Show how many rows each predicate has, if these are the predicates that are listed."""
        if survey.program.predicates == self._predicates:
            self._survey = survey
            self._count()

    def on_resize(self) -> None:
        """Use the width there is now."""
        self._count()

    def go_to(self, name: str) -> None:
        """Highlight a page or a predicate."""
        self.highlighted = self.get_option_index(name)

    def _count(self) -> None:
        if self._survey is None:
            return
        width = max(self.scrollable_content_region.width, _NARROWEST)
        for predicate in self._predicates or ():
            name = predicate.name
            told = (self._survey.count(name), self._survey.differs(name), width)
            if predicate.has_rows and self._counted.get(name) != told:
                self._counted[name] = told
                self._renew(self.get_option_index(name), _with_count(_entry(predicate), *told))

    def _renew(self, line: int, entry: Content) -> None:
        """Show another entry on a line; to replace it would paint all others anew as well."""
        option = self.get_option_at_index(line)
        option._set_prompt(entry)
        for key in list(self._option_render_cache.keys()):
            if key[0] is option:
                self._option_render_cache.discard(key)
        self.refresh_line(line)


def _entry(predicate: Predicate) -> Content:
    mark, colour = MARKS[predicate.kind]
    name = INK.text if predicate.has_rows else INK.dim
    entry = Content.assemble((f"{mark} ", colour), (one_line(predicate.name), name))
    if not predicate.has_rows:
        entry = entry.append(Content.styled(" ƒ", INK.dim))
    if predicate.line is not None:
        entry = entry.append(Content.styled(f" :{predicate.line}", INK.faint))
    return entry


def _with_count(entry: Content, rows: str, differs: bool, width: int) -> Content:
    """An entry with the number of rows at its right end, marked if the rows have changed."""
    count = f"{rows}{_CHANGED if differs else ' '}"
    room = width - len(count) - 1
    gap = " " * max(1, width - entry.cell_length - len(count))
    return entry.truncate(room, ellipsis=True).append(
        Content.styled(gap + count, INK.key if differs else INK.dim)
    )
