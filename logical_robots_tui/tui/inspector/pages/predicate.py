"""The page of a predicate: its rows as a table, and the value under the cursor in full."""

from __future__ import annotations

from collections.abc import Sequence

from textual import on
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.game import ROBOT_COLUMNS, Breakpoint, Frame, Pin, Superseded, pin_of_cell
from logical_robots_tui.mind import QueryError, ResultTable
from logical_robots_tui.tui.inspector.page import Page, PageEntry
from logical_robots_tui.tui.inspector.plots import format_value
from logical_robots_tui.tui.inspector.questions import NO_PROGRAM, InspectorQuestions, Survey
from logical_robots_tui.tui.inspector.table import ValueTable, row_count
from logical_robots_tui.tui.inspector.value_tree import ValueBranch
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line


class PredicatePage(Page):
    DEFAULT_CSS = """
    PredicatePage #value {
        height: auto; max-height: 40%; border-top: solid $ink-faint; padding: 0 1;
    }
    """

    view: ValueTable

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        self._value = Static(id="value-text")
        self._value_box = VerticalScroll(self._value, id="value", can_focus=False)
        super().__init__(entry, questions, ValueTable(), below=(self._value_box,))
        self.table = self.view
        self._value_shown = Content("")

    @property
    def depends_on_robot(self) -> bool:
        return self._questions.is_function(self.predicate)

    async def show(self, frame: Frame) -> None:
        try:
            table = await self._questions.rows(self.predicate, self.robot, frame)
        except Superseded:
            if self._session.game is None:
                self._say_instead(frame, NO_PROGRAM)
        except QueryError as error:
            self._say_instead(frame, str(error))
        else:
            self._show_table(frame, table)

    def show_survey(self, survey: Survey) -> None:
        table = survey.tables.get(self.predicate)
        if isinstance(table, ResultTable):
            self._show_table(survey.frame, table)

    def pin_here(self) -> Pin | None:
        """The pin of a cell or of the number of rows; None if the row can't be told apart."""
        table = self.table_here
        if table is None or self.depends_on_robot:
            return None
        if table.has_focus and table.place is not None:
            return self._pin_of_cell(table)
        named = next((name for name in ROBOT_COLUMNS if name in table.all.columns), "")
        only = table.row_order.robot if named else ""
        return Pin(self.predicate, where=((named, only),) if only else ())

    def values_here(self) -> tuple[str, Sequence[ValueBranch]]:
        table = self.table_here
        if table is None or table.pointed is None:
            return "", ()
        # A call can't be found again in another tick.
        pin = None if self.depends_on_robot else self._pin_of_cell(table)
        return self.predicate, (ValueBranch(*table.pointed, pin),)

    def breakpoint_here(self) -> Breakpoint | None:
        column = self.view.column if self.view.has_focus else ""
        return self.breakpoint_at(self.predicate, self.view.row_order.robot, column)

    def _pin_of_cell(self, table: ValueTable) -> Pin | None:
        if table.place is None:
            return None
        number, column = table.place
        return pin_of_cell(self.predicate, table.all.columns, table.all.rows, number, column)

    def _show_table(self, frame: Frame, table: ResultTable) -> None:
        table = table.once()
        nouns = ("call", f" of {self.robot}") if self.depends_on_robot else ("row", "")
        words = (row_count(table, *nouns), self.view.row_order.words)
        self.head(frame.tick, ", ".join(filter(None, words)), self.predicate)
        self.say("")
        self.view.display = True
        survey = self._questions.stored_survey(frame)
        previous = survey.previous_tables.get(self.predicate) if survey is not None else None
        self.view.show(table, previous.once() if isinstance(previous, ResultTable) else None)

    def _say_instead(self, frame: Frame, message: str) -> None:
        self.head(frame.tick, title=self.predicate)
        self.say(message)
        self.view.display = self._value_box.display = False

    @on(ValueTable.CellPointed)
    def _pointed(self, event: ValueTable.CellPointed) -> None:
        event.stop()
        pointed = self.view.pointed
        self._value_box.display = self.view.display and pointed is not None
        if pointed is not None:
            content = Content.assemble(
                (f"{one_line(pointed[0])} = ", INK.dim), format_value(pointed[1])
            )
            if content != self._value_shown:
                self._value_shown = content
                self._value.update(content)
