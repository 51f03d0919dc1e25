"""The Ask page: a line for any query, and its answer at the current tick."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from textual import events, on
from textual.content import Content
from textual.suggester import Suggester
from textual.widgets import Input, Static

from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.mind import ProgramError, QueryError
from logical_robots_tui.tui.inspector.page import NO_PROGRAM, Cancelled, Page, Questions, progress
from logical_robots_tui.tui.inspector.widgets.table import ValueTable, row_count
from logical_robots_tui.tui.program.completion import NAMES
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session

_INPUT_COLUMNS = ("robot_name", "sensor", "memory")
_HISTORY_SIZE = 100
_LAST_WORD = re.compile(r"[A-Za-z_]\w*$")
_HISTORY_KEYS = {"up": -1, "down": 1}
_SHORTEST = 2  # letters from which on a word is completed


class QueryLine(Input):
    """The line for a query; up and down recall earlier ones."""

    bar_keys = (("enter", "Ask"), ("↑↓", "Earlier"), ("→", "Complete"), ("esc", "To the rows"))

    def __init__(self, leave: Callable[[], None]) -> None:
        self._leave = leave
        self._completion = _Completion()
        super().__init__(
            placeholder="Ask, such as  sensor.forward_distance < 60  or  Robot",
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
            self._recall(_HISTORY_KEYS[event.key])
        else:
            return
        event.stop()
        event.prevent_default()

    def remember(self, query: str) -> None:
        if query:
            self._history = [each for each in self._history if each != query][-_HISTORY_SIZE:]
            self._history.append(query)
        self._place = len(self._history)

    def _recall(self, later: int) -> None:
        self._place = max(0, min(self._place + later, len(self._history)))
        self.value = next(iter(self._history[self._place :]), "")
        self.cursor_position = len(self.value)


class AskPage(Page):
    DEFAULT_CSS = """
    AskPage QueryLine { margin: 0 1; background: $panel; width: 1fr; }
    AskPage #answer-to {
        padding: 0 1; height: 1; display: none; text-wrap: nowrap; text-overflow: ellipsis;
    }
    AskPage > .message { padding: 0 1; }
    """

    title = "Ask"
    table: ValueTable

    def __init__(self, session: Session, questions: Questions) -> None:
        self._query = self._refused = ""
        self.line = QueryLine(self._leave)
        self._answer_to = Static(id="answer-to")
        answer = ValueTable(id="answer")
        above = (self.line, self._answer_to)
        super().__init__(session, questions, self.line, above=above, below=(answer,))
        self.table = answer

    @property
    def asked(self) -> str:
        """The query, or "" if there is none or it is invalid."""
        return "" if self._query == self._refused else self._query

    def put(self, query: str) -> None:
        if query:
            self._query = self.line.value = query
            self.line.remember(query)
            self.post_message(self.Changed())

    async def show(self, frame: Frame) -> None:
        names = (predicate.name for predicate in self._session.predicates)
        self.line.complete_from([*names, *NAMES, *_INPUT_COLUMNS])
        query, more = self._query, ""
        if not query:
            self.head(frame.tick)
            return

        def report() -> None:
            self.head(frame.tick)
            self._name_query(query)
            self._say_instead(progress("asking", self.pending.seconds))

        try:
            inquiry, program = self._questions.about()
            table = await self.pending.run(inquiry.ask(program, query, frame), report)
        except Superseded:
            if self._session.game is not None:
                return
            self._say_instead(NO_PROGRAM)
        except Cancelled:
            self._query = ""
            seconds = self.pending.seconds
            self._say_instead(f"Stopped after {seconds:.1f} s. Enter asks it again.")
        except ProgramError as error:
            self._name_query("")
            self._refuse(query, error)
        except QueryError as error:
            self._name_query(query)
            self._say_instead(str(error))
        else:
            more = row_count(table)
            self._name_query(query)
            self.say(Content.styled("" if table.rows else "No rows.", INK.dim))
            self.table.show(table)
        self.head(frame.tick, more)

    def _leave(self) -> None:
        if self.pending.is_long:
            self.pending.cancel()
        else:
            self.screen.set_focus(self.table)

    def _name_query(self, query: str) -> None:
        """Name the query that was answered; the line may hold another one by now."""
        self._answer_to.update(Content.styled(one_line(query), INK.title))
        self._answer_to.display = bool(query)

    def _refuse(self, query: str, error: ProgramError) -> None:
        self._refused = query
        first = error.diagnostics[0]
        mark = " " * (first.column - 1) + "^" * max(1, len(first.excerpt))
        self._say_instead(
            Content.assemble(
                (f"{mark[: len(query) + 1]}\n", INK.bad),
                (f"{one_line(first.message)}. ", INK.warn),
                (one_line(first.hint), INK.text),
            )
        )

    def _say_instead(self, words: Content | str) -> None:
        self.say(words)
        self.table.show(None)

    @on(Input.Changed)
    def _changed(self, event: Input.Changed) -> None:
        event.stop()
        if self._refused and event.value.strip() != self._refused:
            self._query = self._refused = ""
            self.say("")

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        event.stop()
        self._query = event.value.strip()
        self.line.remember(self._query)
        self.post_message(self.Changed())


class _Completion(Suggester):
    def __init__(self) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self.words: list[str] = []

    async def get_suggestion(self, value: str) -> str | None:
        found = _LAST_WORD.search(value)
        if found is None or len(found[0]) < _SHORTEST:
            return None
        longer = (word for word in self.words if word.startswith(found[0]) and word != found[0])
        word = next(longer, None)
        return None if word is None else value[: found.start()] + word
