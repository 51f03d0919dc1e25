"""The page of a predicate: its rows as a table, and the value under the cursor in full."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.mind import QueryError, Table
from logical_robots_tui.tui.inspector.page import NO_PROGRAM, Page, Questions, Survey
from logical_robots_tui.tui.inspector.widgets.plots import format_value
from logical_robots_tui.tui.inspector.widgets.table import ValueTable, row_count
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session


class PredicatePage(Page):
    DEFAULT_CSS = """
    PredicatePage #value {
        height: auto; max-height: 40%; border-top: solid $ink-faint; padding: 0 1;
    }
    """

    view: ValueTable

    def __init__(self, session: Session, questions: Questions) -> None:
        self._value = Static(id="value-text")
        self._value_box = VerticalScroll(self._value, id="value", can_focus=False)
        super().__init__(session, questions, ValueTable(), below=(self._value_box,))
        self.table = self.view
        self.predicate = ""
        self._value_shown = Content("")

    @property
    def depends_on_robot(self) -> bool:
        return self._questions.is_function(self.predicate)

    async def show(self, frame: Frame) -> None:
        name = self.predicate
        try:
            table = await self._questions.rows(name, self.robot, frame)
        except Superseded:
            if self._session.game is None:
                self._say_instead(frame, NO_PROGRAM)
        except QueryError as error:
            if name == self.predicate:
                self._say_instead(frame, str(error))
        else:
            if name == self.predicate:
                self._show_table(frame, table)

    def show_survey(self, survey: Survey) -> None:
        table = survey.tables.get(self.predicate)
        if isinstance(table, Table):
            self._show_table(survey.frame, table)

    def _show_table(self, frame: Frame, table: Table) -> None:
        what = ("call", f" of {self.robot}") if self.depends_on_robot else ("row", "")
        words = (row_count(table, *what), self.view.how.words)
        self.head(frame.tick, ", ".join(filter(None, words)), self.predicate)
        self.say("")
        self.view.display = True
        survey = self._questions.surveyed(frame)
        before = survey.before.get(self.predicate) if survey is not None else None
        self.view.show(table, before if isinstance(before, Table) else None)

    def _say_instead(self, frame: Frame, message: str) -> None:
        self.head(frame.tick, title=self.predicate)
        self.say(message)
        self.view.display = self._value_box.display = False

    @on(ValueTable.Pointed)
    def _pointed(self, event: ValueTable.Pointed) -> None:
        event.stop()
        pointed = self.view.pointed
        self._value_box.display = self.view.display and pointed is not None
        if pointed is not None:
            shown = Content.assemble(
                (f"{one_line(pointed[0])} = ", INK.dim), format_value(pointed[1])
            )
            if shown != self._value_shown:
                self._value_shown = shown
                self._value.update(shown)
