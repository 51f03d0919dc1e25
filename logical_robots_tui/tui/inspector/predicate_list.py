"""The list at the left of the inspector: its pages, then the predicates with their row counts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets.option_list import Option

from logical_robots_tui.tui.inspector.register import PAGES
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from logical_robots_tui.mind import Predicate
    from logical_robots_tui.tui.inspector.questions import Survey

MARKS = {"input": ("◂", INK.robot), "program": ("•", INK.key), "prelude": ("◦", INK.dim)}
"""The sign and colour of each kind of predicate."""

_CHANGED = "•"
_NARROWEST = 12  # columns of an entry


class PredicateList(Listing):
    DEFAULT_CSS = """
    PredicateList {
        width: 24; height: 1fr; border: none; padding: 0; background: $surface;
        border-right: solid $ink-faint;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    def __init__(self) -> None:
        super().__init__(id="choice", markup=False, compact=True)
        self.predicates: tuple[Predicate, ...] | None = None
        self.names: Sequence[str] = ()
        self._survey: Survey | None = None
        self._counted: dict[str, tuple[str, bool, int]] = {}

    def list(self, predicates: tuple[Predicate, ...], inspected: str) -> None:
        self.predicates, self._survey = predicates, None
        self._counted.clear()
        # Functions of the prelude never have rows to show; those of the program have calls.
        listed = [each for each in predicates if each.has_rows or each.kind != "prelude"]
        pages = [page for page in PAGES if page.is_listed]
        names = [*(page.id for page in pages), *(predicate.name for predicate in listed)]
        self.names = names
        self.clear_options()
        self.add_options(
            [Option(Content.styled(page.title, f"bold {INK.entry}"), id=page.id) for page in pages]
            + [Option(_entry(predicate), id=predicate.name) for predicate in listed]
        )
        self.highlighted = names.index(inspected) if inspected in names else None

    def count(self, survey: Survey) -> None:
        if survey.program.predicates == self.predicates:
            self._survey = survey
            self._count()

    def on_resize(self) -> None:
        self._count()

    def go_to(self, name: str) -> None:
        self.highlighted = self.get_option_index(name)

    def _count(self) -> None:
        if self._survey is None:
            return
        width = max(self.scrollable_content_region.width, _NARROWEST)
        for predicate in self.predicates or ():
            name = predicate.name
            told = (self._survey.count(name), self._survey.differs(name), width)
            if predicate.has_rows and self._counted.get(name) != told:
                self._counted[name] = told
                self.replace_option_prompt(name, _with_count(_entry(predicate), *told))


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
    count = f"{rows}{_CHANGED if differs else ' '}"
    room = width - len(count) - 1
    gap = " " * max(1, width - entry.cell_length - len(count))
    return entry.truncate(room, ellipsis=True).append(
        Content.styled(gap + count, INK.key if differs else INK.dim)
    )
