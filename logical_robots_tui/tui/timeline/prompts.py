"""Prompts of the timeline: a tick, and a question in Logica that is checked before use."""

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
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult
    from textual.screen import Screen

    from logical_robots_tui.mind import Program

__all__ = ["QuestionCheck", "QuestionPrompt", "TickPrompt", "tick_of"]

READING = "Reading the question…"


class QuestionCheck:
    """Compiles a question in the background of a dialog, and says what is wrong with it.

    Args:
        dialog: Has a line for complaints.
        program: What the question is about.
    """

    def __init__(self, dialog: Screen[Any], program: Program | None) -> None:
        self._dialog = dialog
        self._program = program

    def begin(self, query: str, good: Callable[[], object]) -> None:
        """Look at a question, and call `good` if it can be asked; an earlier one is given up."""
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
        """Give up what is under way: another text is being typed."""
        self._dialog.workers.cancel_group(self._dialog, "question")
        self._dialog.query_one("#complaint").display = False

    def say(self, words: str) -> None:
        """Say something about what was typed."""
        complaint = self._dialog.query_one("#complaint", Static)
        complaint.update(Content(one_line(words)))
        complaint.display = True


class QuestionPrompt(Dialog[str]):
    """Asks for a question, and gives it if the program can be asked so.

    Args:
        title: What for.
        text: What stands there already.
        program: What the question is about.
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
        """A line to type in, and what is wrong with it."""
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
    """Asks for a number of a tick, and gives it.

    Args:
        title: What for.
        here: The tick on the screen, to count from with ``+50`` or ``-50``.
        complaint: Says why a tick won't do, or "".
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
        """A line to type in, and what is wrong with it."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            yield Input(placeholder="such as 120, +50 or -50", id="tick")
            yield Static(id="complaint")
            yield Static("enter go   esc close", id="keys", markup=False)

    @on(Input.Changed)
    def _changed(self) -> None:
        self.query_one("#complaint").display = False

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        tick = tick_of(event.value, self._here)
        complaint = "A tick is a number, such as 120." if tick is None else self._complaint(tick)
        if tick is not None and not complaint:
            self.dismiss(tick)
            return
        shown = self.query_one("#complaint", Static)
        shown.update(Content(one_line(complaint)))
        shown.display = True


def tick_of(text: str, here: int) -> int | None:
    """The tick that was typed, or None if it is none; a sign counts from the tick `here`."""
    found = re.fullmatch(r"([+-]?)([0-9]{1,12})", text.replace(" ", "").replace(",", ""))
    if found is None:
        return None
    sign, number = found[1], int(found[2])
    return {"": number, "+": here + number, "-": here - number}[sign]
