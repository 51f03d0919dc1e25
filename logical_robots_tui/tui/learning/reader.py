"""Reading: hints, a lesson, a program."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, Literal

from textual import events
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Markdown, Static

from logical_robots_tui.language.services.lexer import LineStates, pieces
from logical_robots_tui.tui.layout.dialogs import Dialog, ScrollingText, keys_in_style
from logical_robots_tui.tui.theme.themes import INK, SYNTAX
from logical_robots_tui.wording import one_line, visible

if TYPE_CHECKING:
    from logical_robots_tui.player.learning import Learning
    from logical_robots_tui.world import Level

_PAUSE = 1.0  # seconds without a key before a hint is revealed


class TextReader(Dialog[Literal["questions"]]):
    """Shows a text; after it there may be questions, of which `answered` says how many are."""

    DEFAULT_CSS = """
    TextReader > #box { height: 90%; width: 100%; max-width: 88; }
    TextReader VerticalScroll { height: 1fr; scrollbar-gutter: stable; padding: 1 1 0 1; }
    TextReader Markdown { background: $surface; padding: 0; margin: 0; }
    TextReader MarkdownH1, TextReader MarkdownH2, TextReader MarkdownH3 {
        color: $ink-title; text-style: bold; background: $surface; margin: 1 0; padding: 0;
        content-align: left middle; border: none;
    }
    TextReader MarkdownFence { background: $panel; margin: 0 0 1 0; overflow: hidden hidden; }
    TextReader MarkdownFence > Label { width: 1fr; padding: 0 1; }
    TextReader MarkdownParagraph { margin: 0 0 1 0; }
    """

    BINDINGS = [("q,t,W,K", "leave"), ("space", "page"), ("enter", "questions")]

    keys = "↑↓ scroll   space next page   esc close"

    def __init__(self, title: str, text: Widget, answered: str = "") -> None:
        self._scroll = VerticalScroll(text)
        super().__init__(title, self._scroll)
        self._answered = answered

    def on_mount(self) -> None:
        for name in ("scroll_y", "virtual_size"):
            self.watch(self._scroll, name, self.on_resize)

    def on_resize(self) -> None:
        self.call_after_refresh(self._show_keys)

    @property
    def _is_at_end(self) -> bool:
        return self._scroll.scroll_y >= self._scroll.max_scroll_y

    def _show_keys(self) -> None:
        questions = f"enter questions ({self._answered})" if self._answered else ""
        keys = ["↑↓ scroll", "space next page", questions, "esc close"]
        if self._is_at_end:
            ending = questions or keys.pop()
            keys[1:3] = [f"space or {ending}"]
        line = keys_in_style("   ".join(filter(None, keys)))
        for footer in self.query("#keys").results(Static):  # none once it is closed
            footer.update(line, layout=False)

    def action_page(self) -> None:
        if self._is_at_end:
            self.dismiss("questions" if self._answered else None)
        else:
            self._scroll.scroll_page_down(animate=False)

    def action_questions(self) -> None:
        if self._answered:
            self.dismiss("questions")


def markdown(text: str) -> Markdown:
    """Return a Markdown widget without working links, because anybody may be the author."""
    lines = "\n".join(visible(line) for line in text.splitlines())
    return Markdown(lines, open_links=False)


def colour_code(text: str) -> Static:
    lines = [visible(line) for line in text.splitlines()]
    states, coloured_lines = LineStates(), []
    for number, line in enumerate(lines):
        content = Content(line)
        for start, end, kind in pieces(line, states.at(number, lines.__getitem__)):
            content = content.stylize(SYNTAX[kind], start, end)
        coloured_lines.append(content)
    return Static(Content("\n").join(coloured_lines))


class Hints(Dialog[Literal["lesson"]]):
    """Shows the hints revealed so far, at least one, and reveals the next when asked."""

    DEFAULT_CSS = """
    Hints > #box { max-width: 76; padding: 1 2 0 2; }
    Hints #more { margin-top: 1; color: $ink-dim; }
    """

    BINDINGS = [("t", "lesson"), ("q", "leave")]

    def __init__(self, level: Level, learning: Learning) -> None:
        hints = ScrollingText(Static(id="hints"))
        super().__init__(f"Hints · {level.title}", hints, Static(id="more"))
        self._of_all, self._learning = len(level.hints), learning
        self._has_lesson = bool(level.lesson)
        self._last_key_at = events.Event().time  # by the clock of events

    def on_resize(self) -> None:
        self.call_after_refresh(self._write)

    def on_click(self, event: events.Click) -> None:
        if event.widget is not None and event.widget.id == "more":
            self.action_more()

    def on_key(self, event: events.Key) -> None:
        """Reveal a hint after a pause: keys in a row are of a text that is typed by mistake."""
        pause, self._last_key_at = event.time - self._last_key_at, event.time
        if event.key in ("h", "enter", "space"):
            event.stop()
            if pause >= _PAUSE:
                self.action_more()
            else:
                self._write("wait a second, then press h.")

    def action_lesson(self) -> None:
        if self._has_lesson:
            self.dismiss("lesson")

    def action_more(self) -> None:
        if self._learning.reveal_next():
            self._write()
            self.query_one(VerticalScroll).scroll_end(animate=False)

    def _write(self, advice: str = "press h for the next one.") -> None:
        width = max(self.query_one(VerticalScroll).scrollable_content_region.width, 20)
        lines: list[Content] = []
        revealed = self._learning.revealed
        for number, hint in enumerate(revealed, start=1):
            first, *continuation = wrap(one_line(hint), max(width - 4, 1)) or [""]
            if lines:
                lines.append(Content(""))
            lines.append(Content.assemble((f"{number:>2}. ", INK.key), (first, INK.text)))
            lines += [Content.styled(f"    {line}", INK.text) for line in continuation]
        self.query_one("#hints", Static).update(Content("\n").join(lines))
        left = self._of_all - len(revealed)
        keys = ["h next hint"] * bool(left) + ["t lesson"] * self._has_lesson + ["esc close"]
        self.query_one("#keys", Static).update(keys_in_style("   ".join(keys)))
        self.query_one("#more", Static).update(
            Content(f"{left} more: {advice}" if left else "There are no more.")
        )
