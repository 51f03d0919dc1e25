"""Asking for a question in Logica, which is looked at before it is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.game import mistake_in_question
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.layout.dialog import Dialog
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult
    from textual.screen import Screen

    from logical_robots_tui.mind import Program

__all__ = ["QuestionCheck", "QuestionPrompt"]

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
