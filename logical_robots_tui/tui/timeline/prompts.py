"""Prompts of the timeline: a tick, and a question in Logica."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.game import mistake_in_question
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.layout.dialogs import Dialog

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult

    from logical_robots_tui.mind import Program

__all__ = ["QuestionCheck", "QuestionPrompt", "TickPrompt", "tick_of"]

READING = "Reading the question…"


class QuestionCheck:
    """Compiles a question in the background of a dialog, and shows its errors.

    Args:
        dialog: The dialog, with a line for errors.
        program: The program that the question is about.
    """

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
                self.say(mistake)
            else:
                good()

        self.say(READING)
        in_background(self._dialog, look, "question", exclusive=True)

    def forget(self) -> None:
        """Cancel the check, because another text is being typed."""
        self._dialog.workers.cancel_group(self._dialog, "question")
        self._dialog.complain("")

    def say(self, words: str) -> None:
        """Show a message about the typed text."""
        self._dialog.complain(words)


class QuestionPrompt(Dialog[str]):
    """Asks for a question, and returns it if it is valid.

    Args:
        title: The title.
        text: The initial text.
        program: The program that the question is about.
    """

    DEFAULT_CSS = """
    QuestionPrompt > #box { max-width: 76; padding: 1 2 0 2; }
    """

    def __init__(self, title: str, text: str, program: Program) -> None:
        super().__init__()
        self._title_text = title
        self._text = text
        self._check = QuestionCheck(self, program)

    def compose(self) -> ComposeResult:
        """Yield the line, and its errors."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            placeholder = "such as Near(robot_name:, d:), d < 20"
            yield Input(self._text, placeholder=placeholder, id="question")
            yield Static(id="complaint")
            yield Static("enter search   esc close", id="keys", markup=False)

    @on(Input.Changed)
    def _changed(self) -> None:
        self._check.forget()

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        query = event.value.strip()
        self._check.begin(query, lambda: self.dismiss(query))


class TickPrompt(Dialog[int]):
    """Asks for the number of a tick.

    Args:
        title: The title.
        here: The current tick, to which ``+50`` and ``-50`` are relative.
        complaint: Returns why a tick is invalid, or "".
    """

    DEFAULT_CSS = """
    TickPrompt > #box { max-width: 60; padding: 1 2 0 2; }
    """

    def __init__(self, title: str, here: int, complaint: Callable[[int], str]) -> None:
        super().__init__()
        self._title_text = title
        self._here = here
        self._complaint = complaint

    def compose(self) -> ComposeResult:
        """Yield the line, and its errors."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            yield Input(placeholder="such as 120, +50 or -50", id="tick")
            yield Static(id="complaint")
            yield Static("enter go   esc close", id="keys", markup=False)

    @on(Input.Changed)
    def _changed(self) -> None:
        self.complain("")

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        tick = tick_of(event.value, self._here)
        complaint = "A tick is a number, such as 120." if tick is None else self._complaint(tick)
        if tick is not None and not complaint:
            self.dismiss(tick)
            return
        self.complain(complaint)


def tick_of(text: str, here: int) -> int | None:
    """Return the typed tick, or None if it is invalid; a sign makes it relative to `here`."""
    found = re.fullmatch(r"([+-]?)([0-9]{1,12})", text.replace(" ", "").replace(",", ""))
    if found is None:
        return None
    sign, number = found[1], int(found[2])
    return {"": number, "+": here + number, "-": here - number}[sign]
