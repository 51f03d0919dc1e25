"""The commands for the table of the inspector: sort, search, filter, turn, copy, save, stop."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.game import Breakpoint
from logical_robots_tui.tui.inspector.arranging import as_csv, as_json
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.tui.inspector.table import ValueTable
    from logical_robots_tui.tui.screen import MainScreen

__all__ = ["RowCommands"]


class RowCommands:
    """What can be done with the rows on the screen.

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
        from logical_robots_tui.tui.dialogs.line import LinePrompt

        if (table := self._table()) is not None:
            question = "Only rows with this text; nothing shows all"
            text = await self._screen.app.push_screen_wait(LinePrompt(question, table.how.search))
            if text is not None:
                self._screen.inspector.rearrange(replace(table.how, search=text))

    def copy(self) -> None:
        """Send the rows to the terminal's clipboard, as CSV."""
        if (table := self._table()) is not None:
            self._screen.app.copy_to_clipboard(as_csv(table.shown))
            self._screen.tell(
                f"{len(table.shown.rows)} rows sent to your terminal's clipboard; "
                "if they don't arrive there, save them."
            )

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
            self._screen.tell(f"Saved as {path}.csv and .json.")

    def stop_here(self) -> None:
        """Stop when the predicate that is inspected changes, or a column of it."""
        inspector = self._screen.inspector
        known = {p.name for p in self._screen.session.predicates if p.has_rows}
        if inspector.inspected not in known:
            self._screen.tell("Choose a predicate in the inspector, then stop at it.")
            return
        has_focus = inspector.table.has_focus
        column = inspector.table.column if has_focus else ""
        robot = inspector.table.how.robot
        self._screen.add_breakpoint(Breakpoint("change", inspector.inspected, robot, column))

    def _table(self) -> ValueTable | None:
        table = self._screen.inspector.shown_table
        if table is None:
            self._screen.tell("There is no table: choose a predicate in the inspector.")
        return table
