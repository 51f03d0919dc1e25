"""Asking, in the inspector: a line for any query, and its answer at the tick on the screen."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.suggester import Suggester
from textual.widgets import Input, Static

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import ProgramError, QueryError
from logical_robots_tui.tui.inspector.answers import NO_PROGRAM, shown_rows
from logical_robots_tui.tui.inspector.waiting import GivenUp, Waiting, under_way
from logical_robots_tui.tui.inspector.widgets.table import ValueTable
from logical_robots_tui.tui.program.completion import NAMES
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from textual import events

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Predicate, Table
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["AskView", "QueryLine"]

_COLUMNS = ("robot_name", "sensor", "memory")  # of the inputs
_MOST_REMEMBERED = 100
_LAST_WORD = re.compile(r"[A-Za-z_]\w*$")
_RECALLS = {"up": -1, "down": 1}
_SHORTEST = 2  # letters before a word is suggested


class QueryLine(Input):
    """The line in which a query is typed; up and down bring earlier ones back.

    Args:
        leave: What escape does.
    """

    def __init__(self, leave: Callable[[], None]) -> None:
        self._leave = leave
        self._words = _Words()
        super().__init__(
            placeholder="Ask anything: Robot   Sensor(robot_name:, sensor:)   1 + 1",
            suggester=self._words,
            compact=True,
            id="query",
        )
        self._earlier: list[str] = []
        self._recalled = 0

    def knows(self, words: Iterable[str]) -> None:
        """Suggest these words from now on."""
        self._words.words = sorted(set(words))

    def on_key(self, event: events.Key) -> None:
        """Take some keys at once: as bindings they would come after letters of the same moment."""
        if event.key == "escape":
            self._leave()
        elif event.key in _RECALLS:
            self._recall(_RECALLS[event.key])
        else:
            return
        event.stop()
        event.prevent_default()

    def remember(self, query: str) -> None:
        """Keep a query among the earlier ones."""
        if query:
            self._earlier = [each for each in self._earlier if each != query][-_MOST_REMEMBERED:]
            self._earlier.append(query)
        self._recalled = len(self._earlier)

    def _recall(self, later: int) -> None:
        """Bring an earlier query back, or a later one."""
        self._recalled = max(0, min(self._recalled + later, len(self._earlier)))
        recalled = self._earlier[self._recalled :][:1]
        self.value = recalled[0] if recalled else ""
        self.cursor_position = len(self.value)


class AskView(Vertical):
    """The query line, what is wrong with it, and the answer.

    Args:
        questions: Whom to ask.
    """

    DEFAULT_CSS = """
    AskView { height: 1fr; }
    AskView QueryLine { margin: 0 1; background: $panel; width: 1fr; }
    AskView #answer-to {
        padding: 0 1; height: 1; display: none; text-wrap: nowrap; text-overflow: ellipsis;
    }
    AskView #answer-said { padding: 0 1; height: auto; }
    AskView ValueTable { margin: 0 1; }
    """

    class Asked(Message):
        """There is another query to answer."""

    def __init__(self, questions: Questions) -> None:
        self._questions = questions
        self._query = self._refused = ""
        self.waiting = Waiting()
        self.line = QueryLine(self._leave)
        self._to = Static(id="answer-to")
        self._said = Static(id="answer-said")
        self.table = ValueTable(id="answer")
        super().__init__(self.line, self._to, self._said, self.table, id="ask")

    def knows(self, predicates: Iterable[Predicate]) -> None:
        """Suggest the names of these predicates, and everything else a query may be made of."""
        self.line.knows([*(predicate.name for predicate in predicates), *NAMES, *_COLUMNS])

    @property
    def asked(self) -> str:
        """What is asked, or "" if nothing is, or nothing that could be."""
        return "" if self._query == self._refused else self._query

    def put(self, query: str) -> None:
        """Ask a query, as if it had been typed."""
        if query:
            self._query = self.line.value = query
            self.line.remember(query)
            self.post_message(self.Asked())

    async def follow(self, frame: Frame, told: Callable[[Table | None], None]) -> None:
        """Answer the query at a tick.

        Args:
            frame: The tick.
            told: Called with the answer when it is shown; with None when something else is.
        """
        query = self._query
        if not query:
            told(None)
            return

        def wait() -> None:
            told(None)
            self._answer_to(query)
            self._say(under_way("asking", self.waiting.seconds))

        try:
            table = await self.waiting.answer(self._questions.ask(query, frame), wait)
        except Superseded:
            if not self._questions.has_program:
                self._say(NO_PROGRAM)
            return
        except GivenUp:
            self._query = ""
            self._say(f"Stopped after {self.waiting.seconds:.1f} s. Enter asks it again.")
        except ProgramError as error:
            self._answer_to("")
            self._refuse(query, error)
        except QueryError as error:
            self._answer_to(query)
            self._say(str(error))
        else:
            told(table)
            self._answer_to(query)
            self._said.update(Content.styled("No rows." if not table.rows else "", INK.dim))
            self._said.display = not table.rows
            columns, rows = shown_rows(table)
            self.table.show(columns, rows, are_all=not table.truncated)
            return
        told(None)

    def _leave(self) -> None:
        """Stop what is under way, or else go to the answer."""
        if self.waiting.is_long:
            self.waiting.stop()
        else:
            self.screen.focus_next(ValueTable)

    def _answer_to(self, query: str) -> None:
        """Name the query that what is below belongs to; the line above may hold another text."""
        self._to.update(Content.styled(one_line(query), INK.title))
        self._to.display = bool(query)

    def _refuse(self, query: str, error: ProgramError) -> None:
        """Show what is wrong with a query, under its place in the line."""
        self._refused = query
        first = error.diagnostics[0]
        mark = " " * (first.column - 1) + "^" * max(1, len(first.excerpt))
        self._say(
            Content.assemble(
                (f"{mark[: len(query) + 1]}\n", INK.bad),
                (f"{one_line(first.message)}. ", INK.warn),
                (one_line(first.hint), INK.text),
            )
        )

    def _say(self, words: Content | str) -> None:
        """Show words instead of rows."""
        content = words if isinstance(words, Content) else Content.styled(one_line(words), INK.warn)
        self._said.update(content)
        self._said.display = True
        self.table.show((), ())

    @on(Input.Changed)
    def _changed(self, event: Input.Changed) -> None:
        """Take away what was said of a wrong query: its mark stands under another text now."""
        event.stop()
        if self._refused and event.value.strip() != self._refused:
            self._query = self._refused = ""
            self._said.display = False

    @on(Input.Submitted)
    def _typed(self, event: Input.Submitted) -> None:
        event.stop()
        self._query = event.value.strip()
        self.line.remember(self._query)
        self.post_message(self.Asked())


class _Words(Suggester):
    """Completes the last word of a query."""

    def __init__(self) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self.words: list[str] = []

    async def get_suggestion(self, value: str) -> str | None:
        """The query with its last word completed, or None."""
        found = _LAST_WORD.search(value)
        if found is None or len(found[0]) < _SHORTEST:
            return None
        longer = (word for word in self.words if word.startswith(found[0]) and word != found[0])
        word = next(longer, None)
        return None if word is None else value[: found.start()] + word
