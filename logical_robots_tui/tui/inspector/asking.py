"""Asking, in the inspector: a line for any query, and its answer at the tick on the screen."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from textual.containers import Vertical
from textual.content import Content
from textual.suggester import Suggester
from textual.widgets import Input, Static

from logical_robots_tui.tui.inspector.table import ValueTable
from logical_robots_tui.tui.plain import one_line
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from collections.abc import Iterable

    from textual import events

    from logical_robots_tui.mind import ProgramError, Table
    from logical_robots_tui.values import Value

__all__ = ["AskView", "QueryLine", "shown_rows"]

_MOST_REMEMBERED = 100
_LAST_WORD = re.compile(r"[A-Za-z_]\w*$")
_RECALLS = {"up": -1, "down": 1}
_SHORTEST = 2  # letters before a word is suggested


def shown_rows(table: Table) -> tuple[tuple[str, ...], tuple[tuple[Value, ...], ...]]:
    """Columns and rows to show: with the minds that they are from, where that matters."""
    if len(set(table.viewers)) < 2 or "robot_name" in table.columns:
        return table.columns, table.rows
    rows = tuple((who, *row) for who, row in zip(table.viewers, table.rows, strict=True))
    return ("in the mind of", *table.columns), rows


class QueryLine(Input):
    """The line in which a query is typed; up and down bring earlier ones back."""

    def __init__(self) -> None:
        self._words = _Words()
        super().__init__(
            placeholder="Ask anything: Robot   Near(robot_name:, d:)   1 + 1",
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
            self.screen.focus_next(ValueTable)
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
    """The query line, what is wrong with it, and the answer."""

    DEFAULT_CSS = """
    AskView { height: 1fr; }
    AskView QueryLine { margin: 0 1; background: $panel; width: 1fr; }
    AskView #answer-said { padding: 0 1; height: auto; }
    AskView ValueTable { margin: 0 1; }
    """

    def __init__(self) -> None:
        self.line = QueryLine()
        self._said = Static(id="answer-said")
        self.table = ValueTable(id="answer")
        super().__init__(self.line, self._said, self.table, id="ask")

    def show(self, table: Table) -> None:
        """Show an answer."""
        self._said.update(Content.styled("No rows." if not table.rows else "", INK.dim))
        self._said.display = not table.rows
        self.table.show(*shown_rows(table))

    def refuse(self, query: str, error: ProgramError) -> None:
        """Show what is wrong with a query, under its place in the line."""
        first = error.diagnostics[0]
        mark = " " * (first.column - 1) + "^" * max(1, len(first.excerpt))
        self.say(
            Content.assemble(
                (f"{mark[: len(query) + 1]}\n", INK.bad),
                (f"{one_line(first.message)}. ", INK.warn),
                (one_line(first.hint), INK.text),
            )
        )

    def say(self, words: Content | str) -> None:
        """Show words instead of rows."""
        content = words if isinstance(words, Content) else Content.styled(one_line(words), INK.warn)
        self._said.update(content)
        self._said.display = True
        self.table.show((), ())


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
