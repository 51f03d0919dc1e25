"""Prompts of the timeline: a tick, and a question in Logica."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from logical_robots_tui.game import mistake_in_question
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.layout.dialogs import Prompt

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.mind import Program
    from logical_robots_tui.tui.layout.dialogs import Dialog

READING = "Reading the question…"


class QuestionCheck:
    """Compiles a question in the background of a dialog, and shows its errors."""

    def __init__(self, dialog: Dialog[Any], program: Program | None) -> None:
        self._dialog = dialog
        self._program = program

    def begin(self, query: str, good: Callable[[], object]) -> None:
        """Check a question, and call `good` if it is valid; cancels an earlier check."""
        program = self._program
        if program is None:
            good()
            return

        async def look() -> None:
            mistake = await mistake_in_question(program, query)
            if mistake:
                self._dialog.complain(mistake)
            else:
                good()

        self._dialog.complain(READING)
        in_background(self._dialog, look, "question", exclusive=True)

    def forget(self) -> None:
        self._dialog.workers.cancel_group(self._dialog, "question")
        self._dialog.complain("")


class QuestionPrompt(Prompt[str]):
    """Asks for a question, and returns it if it is valid."""

    DEFAULT_CSS = """
    QuestionPrompt > #box { max-width: 76; }
    """

    keys = "enter search   esc close"

    def __init__(self, title: str, text: str, program: Program) -> None:
        super().__init__(title, text, "such as Near(robot_name:, d:), d < 20")
        self._check = QuestionCheck(self, program)

    def take(self, text: str) -> None:
        query = text.strip()
        self._check.begin(query, lambda: self.dismiss(query))

    def forget(self) -> None:
        self._check.forget()


class TickPrompt(Prompt[int]):
    """Asks for a tick; ``+50`` and ``-50`` are relative to `here`.

    `problem` returns why a tick is invalid, or "".
    """

    keys = "enter go   esc close"

    def __init__(self, title: str, here: int, problem: Callable[[int], str]) -> None:
        super().__init__(title, "", "such as 120, +50 or -50")
        self._here = here
        self._problem = problem

    def take(self, text: str) -> None:
        tick = tick_of(text, self._here)
        if tick is None:
            self.complain("A tick is a number, such as 120.")
        elif problem := self._problem(tick):
            self.complain(problem)
        else:
            self.dismiss(tick)


def tick_of(text: str, here: int) -> int | None:
    """Return the typed tick, or None if it is invalid; a sign makes it relative to `here`."""
    found = re.fullmatch(r"([+-]?)([0-9]{1,12})", text.replace(" ", "").replace(",", ""))
    if found is None:
        return None
    sign, number = found[1], int(found[2])
    return {"": number, "+": here + number, "-": here - number}[sign]
