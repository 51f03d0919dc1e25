"""A question with a few answers."""

from __future__ import annotations

from functools import partial
from time import monotonic
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import Button, Static

from logical_robots_tui.tui.layout.dialog import Dialog
from logical_robots_tui.tui.library.chooser import visible_lines

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual import events
    from textual.app import ComposeResult

__all__ = ["Question"]


class Question(Dialog[str]):
    """Asks, and gives the name of the answer.

    Args:
        title: What it is about.
        question: The question.
        answers: Pairs of name and label; the first letter of the label is its key.
        text: A text to show when asked, under the answer ``show``.
        noticing: Seconds for which it is to be seen before it shows its answers.

    Attributes:
        answered_from: When the answers were shown, as the clock of events says; inf before.
    """

    DEFAULT_CSS = """
    Question > #box { max-width: 76; padding: 1 2; }
    Question #text { height: auto; max-height: 14; margin-top: 1; display: none;
        background: $panel; padding: 0 1; }
    Question #answers { height: 1; margin-top: 1; }
    Question Button {
        height: 1; min-width: 8; border: none; margin-right: 1; padding: 0 1;
        background: $panel; color: $foreground; text-style: none;
    }
    Question Button:focus { background: $here; text-style: bold; border: none; }
    """

    def __init__(
        self,
        title: str,
        question: str,
        answers: Sequence[tuple[str, str]],
        *,
        text: str = "",
        noticing: float = 0.0,
    ) -> None:
        super().__init__()
        self._noticing = noticing
        self.answered_from = float("inf")
        self._title_text = title
        self._question = question
        self._answers = answers
        self._text = text

    def compose(self) -> ComposeResult:
        """The question above its answers."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            yield Static(Content(self._question), id="question")
            with VerticalScroll(id="text"):
                yield Static(Content(visible_lines(self._text)))
            with Horizontal(id="answers"):
                for name, label in self._answers:
                    yield Button(Content(label), id=f"answer-{name}", compact=True)

    def on_mount(self) -> None:
        """Show the answers, at once or when the question has been seen."""
        if self._noticing:
            self.query_one("#answers").visible = False
            self.call_after_refresh(partial(self.set_timer, self._noticing, self._show_answers))
        else:
            self._show_answers()

    def _show_answers(self) -> None:
        self.answered_from = monotonic()
        self.query_one("#answers").visible = True
        self.query(Button).first().focus()

    def on_key(self, event: events.Key) -> None:
        """Answer by the first letter, or go to the next answer with the arrows."""
        if event.key in ("left", "right"):
            event.stop()
            self.focus_next(Button) if event.key == "right" else self.focus_previous(Button)
        for name, label in self._answers:
            if event.character and event.character.casefold() == label[0].casefold():
                event.stop()
                self._answer(name)

    @on(Button.Pressed)
    def _pressed(self, event: Button.Pressed) -> None:
        if event.button.id is not None:
            self._answer(event.button.id.removeprefix("answer-"))

    def _answer(self, name: str) -> None:
        if name == "show":
            text = self.query_one("#text")
            text.display = not text.display
        else:
            self.dismiss(name)
