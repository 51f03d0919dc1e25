"""The Ask page: a line for any query, and its answer at the current tick."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from textual import events, on
from textual.content import Content
from textual.suggester import Suggester
from textual.widgets import Input

from logical_robots_tui.game import Breakpoint, Frame, Pin
from logical_robots_tui.language.services.completion import NAMES
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.tui.inspector.page import Page, PageEntry
from logical_robots_tui.tui.inspector.questions import InspectorQuestions
from logical_robots_tui.tui.inspector.table import ValueTable, row_count
from logical_robots_tui.tui.inspector.value_tree import ValueBranch
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line

_INPUT_COLUMNS = ("robot_name", "sensor", "memory")
_HISTORY_SIZE = 100
_CALLED = re.compile(r"([A-Z]\w*)(?:\((?:\s*\w+:\s*(?:,|(?=\))))*\))?")
"""A query whose rows are rows of one predicate, with the same names of columns."""
_LAST_WORD = re.compile(r"[A-Za-z_]\w*$")
_HISTORY_KEYS = {"up": -1, "down": 1}
_SHORTEST = 2  # letters from which on a word is completed


class QueryLine(Input):
    """The line for a query; up and down recall earlier ones."""

    bar_keys = (("enter", "Ask"), ("↑↓", "Earlier"), ("→", "Complete"), ("esc", "To the rows"))

    def __init__(self, leave: Callable[[], None]) -> None:
        self._leave = leave
        self._completion = _WordSuggester()
        super().__init__(
            placeholder="Ask, such as sensor.clock > 9, Robot, Q(a, b) :- …",
            suggester=self._completion,
            compact=True,
            id="query",
        )
        self._history: list[str] = []
        self._place = 0

    def complete_from(self, words: Iterable[str]) -> None:
        self._completion.words = sorted(set(words))

    def on_key(self, event: events.Key) -> None:
        """Handle some keys at once: bindings run after letters that arrive at the same moment."""
        if event.key == "escape":
            self._leave()
        elif event.key in _HISTORY_KEYS:
            place = self._place + _HISTORY_KEYS[event.key]
            self._place = max(0, min(place, len(self._history)))
            self.value = next(iter(self._history[self._place :]), "")
            self.cursor_position = len(self.value)
        else:
            return
        event.stop()
        event.prevent_default()

    def remember(self, query: str) -> None:
        if query:
            self._history = [line for line in self._history if line != query][-_HISTORY_SIZE:]
            self._history.append(query)
        self._place = len(self._history)


class AskPage(Page):
    DEFAULT_CSS = """
    AskPage QueryLine { margin: 0 1; background: $panel; width: 1fr; }
    AskPage > .message { padding: 0 1; }
    """

    table: ValueTable

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        self._query = self._refused = self._answered_query = ""
        self._is_here = True  # the query was asked in this level
        self.line = QueryLine(self._leave)
        self.table = ValueTable(id="answer")
        super().__init__(entry, questions, self.line, above=(self.line,), below=(self.table,))

    def begin(self, subject: str) -> None:
        self._query, self._is_here = subject, True
        self.line.value = subject
        self.line.remember(subject)

    def forget(self) -> None:
        self._is_here = False

    async def show(self, frame: Frame) -> None:
        names = (predicate.name for predicate in self._session.predicates)
        self.line.complete_from([*names, *NAMES, *_INPUT_COLUMNS])
        query = self._query
        if not query:
            self.head(frame.tick)
            return

        def say(words: Content | str) -> None:
            self.head(frame.tick)
            self._caption_query(query)
            self._say_instead(words)

        called = _CALLED.fullmatch(query)
        self.predicate = called[1] if called else ""
        try:
            table = await self.answer(
                lambda inquiry, program: inquiry.ask(program, query, frame), lambda: "asking", say
            )
        except ProgramError as error:
            self.head(frame.tick)
            self._caption_query("")
            if self._is_here:
                self._refuse(query, error)
            else:
                self._query = self.line.value = ""
                self._say_instead("")
            return
        if table is not None:
            table = table.once()
            self.head(frame.tick, row_count(table))
            self._caption_query(query)
            self.say(Content.styled("" if table.rows else "No rows.", INK.dim))
            self.table.show(table)

    def _caption_query(self, query: str) -> None:
        """Show the answered query, unless the line still holds it."""
        self._answered_query = query
        text = "" if query == self.line.value.strip() else one_line(query)
        self.caption(Content.styled(text, INK.title))

    def stopped(self) -> str:
        self._query = ""
        return f"{super().stopped()} Enter asks it again."

    def pin_here(self) -> Pin | None:
        return Pin(self._valid) if self._valid else None

    def values_here(self) -> tuple[str, Sequence[ValueBranch]]:
        pointed = self.table_here and self.table_here.pointed
        return ("Answer", (ValueBranch(*pointed),)) if pointed else ("", ())

    def breakpoint_here(self) -> Breakpoint | None:
        return Breakpoint("rows", self._valid) if self._valid else None

    @property
    def _valid(self) -> str:
        """The query, or "" if there is none or it is invalid."""
        return "" if self._query == self._refused else self._query

    def _leave(self) -> None:
        if self.pending.is_long:
            self.pending.cancel()
        else:
            self.screen.set_focus(self.table)

    def _say_instead(self, words: Content | str) -> None:
        self.say(words)
        self.table.show(None)

    def _refuse(self, query: str, error: ProgramError) -> None:
        self._refused = query
        first = error.first
        mark = " " * (first.column - 1) + "^" * max(1, len(first.excerpt))
        self._say_instead(
            Content.assemble(
                (f"{mark[: len(query) + 1]}\n", INK.bad),
                (f"{one_line(first.message)}. ", INK.warn),
                (one_line(first.hint), INK.text),
            )
        )

    @on(Input.Changed)
    def _changed(self, event: Input.Changed) -> None:
        event.stop()
        if self._answered_query:
            self._caption_query(self._answered_query)
        if self._refused and event.value.strip() != self._refused:
            self._query = self._refused = ""
            self.say("")

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        event.stop()
        self._query, self._is_here = event.value.strip(), True
        self.line.remember(self._query)
        self.post_message(self.Changed())


class _WordSuggester(Suggester):
    def __init__(self) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self.words: list[str] = []

    async def get_suggestion(self, value: str) -> str | None:
        match = _LAST_WORD.search(value)
        if match is None or len(match[0]) < _SHORTEST:
            return None
        longer = (word for word in self.words if word.startswith(match[0]) and word != match[0])
        word = next(longer, None)
        return None if word is None else value[: match.start()] + word
