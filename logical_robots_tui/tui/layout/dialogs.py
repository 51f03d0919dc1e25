"""Dialogs: boxes over the game, a line to type, a question, a list."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from textual import events, on
from textual.await_complete import AwaitComplete
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.screen import ModalScreen, Screen
from textual.widgets import Button, Input, OptionList, Static

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.tui.terminal.textual_internals import limit_input_lines
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line, visible_lines

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.widget import Widget

Result = TypeVar("Result")

limit_input_lines()

_KEY = re.compile(r"((?:\S+ or )?\S+)(.*)")


def keys_in_style(text: str) -> Content:
    """Return a line such as ``enter open   esc close`` with its keys as in the command bar."""
    pairs = (_KEY.fullmatch(part) for part in text.split("   "))
    return Content("   ").join(
        Content.assemble((pair[1], f"bold {INK.key}"), (pair[2], INK.text))
        for pair in pairs
        if pair
    )


def drop_stale_size(event: events.Resize, screen: Screen[Any]) -> bool:
    """Keep a screen from taking a size that the terminal no longer has; return whether it hasn't.

    Nor does a screen take its own size: Textual sends it each size that it has taken, so two at
    once would alternate, and one would be laid out and drawn twice.
    """
    is_stale = event.size != screen.app.size
    if is_stale or event.size == screen.outer_size:
        event.prevent_default()
    return is_stale


class ClosedOnce(Screen[Result]):
    """A screen that closes only once; Textual would also close the one below, or the app."""

    @on(events.Resize)
    def _drop_stale_size(self, event: events.Resize) -> None:
        drop_stale_size(event, self)

    def dismiss(self, result: Result | None = None) -> AwaitComplete:
        return super().dismiss(result) if self.is_active else AwaitComplete()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Disable keys once it is closed, because its widgets are gone."""
        return self.is_active and super().check_action(action, parameters)


class Dialog(ModalScreen["Result | None"], ClosedOnce["Result | None"], Generic[Result]):
    """A box over the game with a title; closing it without an answer returns None."""

    heading = ""
    keys = "esc close"

    DEFAULT_CSS = """
    Dialog { align: center middle; background: $background 60%; }
    Dialog > #box {
        width: 90%; max-width: 96; height: auto; max-height: 90%; padding: 0 1;
        border: round $frame-here; border-title-color: $ink-title; background: $surface;
    }
    Dialog #complaint { color: $ink-bad; height: auto; max-height: 6; display: none; }
    Dialog #keys { height: 1; margin-top: 1; text-wrap: nowrap; }
    Dialog Input {
        border: none; height: 1; padding: 0 1; background: $panel; margin-bottom: 1;
    }
    Dialog Input:focus { border: none; }
    Dialog OptionList { border: none; padding: 0; background: $surface; }
    Dialog OptionList:focus { border: none; }
    """

    BINDINGS = [("escape", "leave")]

    def __init__(self, title: str = "", *widgets: Widget) -> None:
        super().__init__()
        self._heading, self._widgets = title or self.heading, widgets
        # Kept because a closing dialog loses its widgets before itself.
        self._complaint = Static(id="complaint")

    def compose(self) -> ComposeResult:
        with Vertical(id="box") as box:
            box.border_title = Content(one_line(self._heading))
            yield from self.content_widgets()
            yield self._complaint
            if self.keys:
                yield Static(keys_in_style(self.keys), id="keys")

    def content_widgets(self) -> ComposeResult:
        yield from self._widgets

    def action_leave(self) -> None:
        self.dismiss(None)

    async def leave_with(self, load: Callable[[str], Result], name: str) -> None:
        """Call `load` in a thread and close with its result, or show its error."""
        try:
            result = await asyncio.to_thread(load, name)
        except LogicalRobotsError as error:
            self.complain(str(error))
        else:
            self.dismiss(result)

    def complain(self, message: str) -> None:
        """Show an error message; "" hides it."""
        self._complaint.update(Content(one_line(message)))
        self._complaint.display = bool(message)


class ScrollingText(VerticalScroll):
    """A text that takes the lines its box has left; the box names the keys if it has more."""

    DEFAULT_CSS = "ScrollingText { height: auto; scrollbar-gutter: stable; }"

    def on_mount(self) -> None:
        self.watch(self, "virtual_size", self.on_resize)

    def on_resize(self) -> None:
        self.call_after_refresh(self._fit)

    def _fit(self) -> None:
        if isinstance(box := self.parent, Vertical):
            rest_height = box.virtual_size.height - self.outer_size.height + box.gutter.height
            room = max(self.screen.size.height * 9 // 10 - rest_height, 1)
            self.styles.max_height = room
            has_more = self.display and self.virtual_size.height > room
            box.border_subtitle = "↑↓ scroll" if has_more else ""


class Prompt(Dialog[Result]):
    DEFAULT_CSS = "Prompt > #box { max-width: 60; padding: 1 2 0 2; }"

    def __init__(self, title: str, text: str = "", placeholder: str = "") -> None:
        self._line = Input(text, placeholder=placeholder)
        super().__init__(title, self._line)

    def take(self, text: str) -> None:
        """Close with the value of a text, or show an error."""
        raise NotImplementedError

    @on(Input.Changed)
    def _changed(self) -> None:
        self.forget()

    def forget(self) -> None:
        self.complain("")

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        self.take(event.value)


class LinePrompt(Prompt[str]):
    keys = "enter accept   esc close"

    def take(self, text: str) -> None:
        self.dismiss(text)


class QuestionDialog(Dialog[str]):
    """Asks a question, and returns the name of the answer.

    A label's first letter is its key; the answer ``show`` shows the text. Answers appear after
    `noticing` seconds; `answered_from` is when, inf before.
    """

    DEFAULT_CSS = """
    QuestionDialog > #box { max-width: 76; padding: 1 2; }
    QuestionDialog #text { margin-top: 1; display: none; background: $panel; padding: 0 1; }
    QuestionDialog #answers { height: 1; margin-top: 1; }
    QuestionDialog Button {
        height: 1; min-width: 8; border: none; margin-right: 1; padding: 0 1;
        background: $panel; color: $foreground; text-style: none;
    }
    QuestionDialog Button:focus { background: $here; text-style: bold; border: none; }
    """

    BINDINGS = [(key, f"scroll_text('{key}')") for key in ("up", "down", "pageup", "pagedown")]

    keys = ""

    def __init__(
        self,
        title: str,
        question: str,
        answers: Sequence[tuple[str, str]],
        *,
        text: str = "",
        noticing: float = 0.0,
    ) -> None:
        super().__init__(title)
        self._noticing = noticing
        self.answered_from = float("inf")
        self._question = question
        self._answers = answers
        self._text = text

    def content_widgets(self) -> ComposeResult:
        yield Static(Content(self._question), id="question")
        with ScrollingText(id="text", can_focus=False):
            yield Static(Content(visible_lines(self._text)))
        with Horizontal(id="answers"):
            for name, label in self._answers:
                yield Button(Content(label), id=f"answer-{name}", compact=True)

    def on_mount(self) -> None:
        if self._noticing:
            self.query_one("#answers").visible = False
            self.call_after_refresh(partial(self.set_timer, self._noticing, self._show_answers))
        else:
            self._show_answers()

    def _show_answers(self) -> None:
        self.answered_from = events.Event().time  # by the clock of events
        self.query_one("#answers").visible = True
        self.query(Button).first().focus()

    def on_key(self, event: events.Key) -> None:
        """Answer by first letter; the arrows move between answers."""
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

    def action_scroll_text(self, key: str) -> None:
        for text in self.query(ScrollingText):
            getattr(text, f"scroll_{key.replace('page', 'page_')}")(animate=False)

    def _answer(self, name: str) -> None:
        if name == "show":
            text = self.query_one(ScrollingText)
            text.display = not text.display
            text.on_resize()
        else:
            self.dismiss(name)


class Listing(OptionList):
    """A list that tolerates being empty; Textual's would end the game."""

    def on_click(self, event: events.Click) -> None:
        line = event.style.meta.get("option")
        if line is not None and line >= self.option_count:
            event.prevent_default()

    def action_page_up(self) -> None:
        if self.scrollable_content_region:
            super().action_page_up()  # type: ignore[no-untyped-call] # so it is in Textual

    def action_page_down(self) -> None:
        if self.scrollable_content_region:
            super().action_page_down()  # type: ignore[no-untyped-call] # this, too


class TextSearch(NamedTuple):
    """A search; `replacement` is for all matches, None only searches."""

    text: str
    replacement: str | None


class Find(Dialog[TextSearch]):
    """Asks for a text to find; enter in the second line replaces it everywhere."""

    DEFAULT_CSS = "Find > #box { max-width: 60; padding: 1 2 0 2; }"

    heading = "Find in the program"
    keys = "enter find, below: replace all   esc close"

    def __init__(self, text: str) -> None:
        find = Input(text, placeholder="find", id="wanted")
        super().__init__("", find, Input(placeholder="replace by", id="instead"))

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        text = self.query_one("#wanted", Input).value
        replaces = event.input.id == "instead"
        self.dismiss(TextSearch(text, event.value if replaces else None) if text else None)
