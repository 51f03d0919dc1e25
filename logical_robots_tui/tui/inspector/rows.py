"""The commands for what the inspector shows: rows, values, pins, what a predicate costs."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.game import Breakpoint, Pin, Superseded
from logical_robots_tui.tui.commands.table import with_keys
from logical_robots_tui.tui.inspector.page import NO_PROGRAM
from logical_robots_tui.tui.inspector.predicate_list import ASK
from logical_robots_tui.tui.inspector.under_cursor import (
    branches_here,
    branches_of,
    memory_here,
    memory_of,
    pin_here,
)
from logical_robots_tui.tui.inspector.widgets.row_order import as_csv, as_json
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

__all__ = ["RowCommands"]

_NO_PIN = (
    "Choose a predicate, ask a question, or put the cursor on a value of it in a row that another "
    "column tells from the rest; then pin it."
)
_NO_MEMORY = (
    "Put the cursor on a memory: in a row of Memory, on a pin, or on a part of one in the tree "
    "that {open_value} opens."
)


class RowCommands:
    """What can be done with what the inspector shows.

    Args:
        screen: The screen.
        folder: Where rows are saved.
    """

    def __init__(self, screen: MainScreen, folder: Path) -> None:
        self._screen = screen
        self._folder = folder

    def only_robot(self) -> None:
        """Show the rows of the chosen robot only, or of all again."""
        if (table := self._table()) is not None:
            robot = "" if table.how.robot else self._screen.inspector.robot
            self._screen.inspector.rearrange(replace(table.how, robot=robot))

    def sort(self) -> None:
        """Sort by the column under the cursor: up, down, not at all."""
        if (table := self._table()) is None:
            return
        how, column = table.how, table.column
        if how.sideways or not column:
            self._screen.tell("Put the cursor on a column of a table that is not turned.")
        elif how.sort != column:
            self._screen.inspector.rearrange(replace(how, sort=column, descending=False))
        elif not how.descending:
            self._screen.inspector.rearrange(replace(how, descending=True))
        else:
            self._screen.inspector.rearrange(replace(how, sort="", descending=False))

    def turn(self) -> None:
        """Turn the table on its side, or back."""
        if (table := self._table()) is not None:
            self._screen.inspector.rearrange(replace(table.how, sideways=not table.how.sideways))

    async def search(self) -> None:
        """Show only rows with a text."""
        from logical_robots_tui.tui.layout.line_dialog import LinePrompt

        if (table := self._table()) is not None:
            question = "Only rows with this text; nothing shows all"
            text = await self._screen.app.push_screen_wait(LinePrompt(question, table.how.search))
            if text is not None:
                self._screen.inspector.rearrange(replace(table.how, search=text))

    def copy(self) -> None:
        """Copy the rows as CSV, as the editor copies."""
        if (table := self._table()) is not None:
            text, count = as_csv(table.shown), len(table.shown.rows)
            self._screen.app.copy_to_clipboard(text)
            self._screen.tell(f"{count:,} row{'s' * (count != 1)} copied{_but(table)}.")
            self._screen.scribe.keep_copy(text)

    def save(self) -> None:
        """Save the rows as CSV and as JSON."""
        if (table := self._table()) is None:
            return
        name = re.sub(r"\W+", "-", self._screen.inspector.inspected).strip("-")
        path = self._folder / f"{name}-tick-{self._screen.session.frame.tick}"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            write_atomically(path.with_suffix(".csv"), as_csv(table.shown))
            write_atomically(path.with_suffix(".json"), as_json(table.shown))
        except OSError as error:
            self._screen.warn(f"The rows can't be saved in {self._folder}: {error.strerror}.")
        else:
            self._screen.tell(f"Saved as {path}.csv and .json{_but(table)}.")

    def stop_here(self) -> None:
        """Stop when the predicate that is inspected changes, or when the question asked holds."""
        inspector = self._screen.inspector
        if inspector.inspected == ASK and inspector.pages.asking.asked:
            self._screen.add_breakpoint(Breakpoint("rows", inspector.pages.asking.asked))
            return
        known = {p.name for p in self._screen.session.predicates if p.has_rows}
        if inspector.inspected not in known:
            self._screen.tell("Choose a predicate or ask a question, then stop at it.")
            return
        has_focus = inspector.pages.table.has_focus
        column = inspector.pages.table.column if has_focus else ""
        robot = inspector.pages.table.how.robot
        self._screen.add_breakpoint(Breakpoint("change", inspector.inspected, robot, column))

    def pin(self) -> None:
        """Pin what the cursor is on, or unpin it."""
        inspector = self._screen.inspector
        if inspector.pages.pins.has_focus:
            inspector.pages.pins.action_remove()
            return
        query = inspector.pages.asking.asked if inspector.inspected == ASK else ""
        pin = Pin(query) if query else None
        pin = pin or pin_here(inspector.inspected, inspector.shown_table, inspector.robot)
        if pin is None or inspector.is_function:
            self._screen.tell(_NO_PIN)
        elif inspector.pages.pins.toggle(pin):
            where = with_keys("{watch} shows what is pinned.")
            self._screen.tell(f"Pinned: {one_line(pin.words)}. {where}")
        else:
            self._screen.tell(f"No longer pinned: {one_line(pin.words)}.")

    def open_value(self) -> None:
        """Open the value under the cursor, or what a decision came from, as a tree."""
        from logical_robots_tui.tui.inspector.widgets.value_tree import ValueTree

        inspector, frame = self._screen.inspector, self._screen.session.frame
        view = inspector.pages.reasons.view
        if view.has_focus and view.pointed is not None and view.pointed.values:
            title, branches = branches_of(view.pointed)
        else:
            title, branches = branches_here(
                inspector.inspected, inspector.shown_table, inspector.robot, frame
            )
        if inspector.is_function:  # a call can't be found again in another tick
            branches = [replace(branch, pin=None) for branch in branches]
        if branches:
            title = f"{title} · tick {frame.tick}"
            tree = ValueTree(title, branches, inspector.pages.pins.toggle, self._follow_back)
            self._screen.app.push_screen(tree)
        else:
            self._screen.tell("Put the cursor on a value, or choose Decision.")

    def origin(self) -> None:
        """Follow the value under the cursor back to where it was made."""
        inspector, frame = self._screen.inspector, self._screen.session.frame
        if self._screen.session.game is None:
            self._screen.tell(NO_PROGRAM)
            return
        asked = memory_here(inspector, frame)
        if asked is None and inspector.pages.origin.asked is None:
            self._screen.tell(with_keys(_NO_MEMORY))
            return
        self._screen.point_at(inspector)
        inspector.follow_back(asked)

    def _follow_back(self, pin: Pin) -> bool:
        """Follow a value that was opened as a tree; whether it is part of a memory."""
        asked = memory_of(pin, self._screen.session.frame.tick)
        if asked is not None:
            self._screen.point_at(self._screen.inspector)
            self._screen.inspector.follow_back(asked)
        return asked is not None

    async def graph(self) -> None:
        """Show which predicate uses which, and open the one that is chosen there."""
        from logical_robots_tui.tui.inspector.predicate_graph import Graph

        screen, program = self._screen, self._screen.session.program
        if program is None:
            screen.tell(NO_PROGRAM)
            return
        known = program.predicate(screen.inspector.inspected)
        chosen = await screen.app.push_screen_wait(Graph(program, known.name if known else "Robot"))
        predicate = program.predicate(chosen) if chosen is not None else None
        if predicate is not None and predicate.kind == "prelude":
            screen.tell(f"{predicate.reason} It is in the prelude.")
        elif predicate is not None:
            screen.go_to(screen.inspector)
            screen.inspector.open(predicate.name)

    async def machinery(self) -> None:
        """Show how the predicate that is inspected is computed, and what all of them cost."""
        from logical_robots_tui.tui.inspector.query_plan import machinery_text
        from logical_robots_tui.tui.learning.reader import Reader

        inspector, frame = self._screen.inspector, self._screen.session.frame
        try:
            found = await inspector.questions.machinery(frame)
        except Superseded:
            found = []
        if found:
            text = machinery_text(found, inspector.inspected)
            self._screen.app.push_screen(Reader(f"How it is computed · tick {frame.tick}", text))
        else:
            self._screen.tell(NO_PROGRAM)

    def _table(self) -> ValueTable | None:
        table = self._screen.inspector.shown_table
        if table is None:
            self._screen.tell("There is no table: choose a predicate in the inspector.")
        return table


def _but(table: ValueTable) -> str:
    return f"; {table.missing}" if table.missing else ""
