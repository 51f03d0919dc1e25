"""Asking why with values of one's own: a line with the question as a predicate with values."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from textual.widgets.input import Selection

from logical_robots_tui.explain import Ask
from logical_robots_tui.explain.why.explainer import read_ask
from logical_robots_tui.explain.why.spelling import spell_call
from logical_robots_tui.mind import ProgramError, QueryError
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.layout.dialogs import Prompt
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program


class ValuesPrompt(Prompt[Ask]):
    """Returns a question with other values; the one in `column` is selected at first."""

    DEFAULT_CSS = """
    ValuesPrompt > #box { max-width: 100; }
    """

    keys = "enter ask why   esc close"

    def __init__(self, program: Program, asked: Ask, column: str) -> None:
        super().__init__("Why, or why not, with these values?", spell_call(asked))
        self._program, self._within = program, asked.within
        self._line.select_on_focus = False
        value = spell(asked.given[column]) if column in asked.given else ""
        start = self._line.value.find(value, len(asked.predicate)) if value else -1
        if start >= 0:
            self._line.selection = Selection(start, start + len(value))

    def take(self, text: str) -> None:
        async def read() -> None:
            try:
                found = await asyncio.to_thread(read_ask, self._program, text, self._within)
            except ProgramError as error:
                first = error.diagnostics[0]
                self.complain(f"{first.message[:1].upper()}{first.message[1:]}. {first.hint}")
            except QueryError as error:
                self.complain(str(error))
            else:
                self.dismiss(found)

        in_background(self, read, "question", exclusive=True)

    def forget(self) -> None:
        self.workers.cancel_group(self, "question")
        self.complain("")
