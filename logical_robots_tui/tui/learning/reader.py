"""Reading a lesson or a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import Markdown, Static

from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.program.lexer import LineStates, pieces
from logical_robots_tui.tui.theme.safe_text import one_line, visible
from logical_robots_tui.tui.theme.themes import SYNTAX

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.widget import Widget

__all__ = ["Reader", "coloured", "markdown"]


class Reader(Dialog[None]):
    """A long text to scroll.

    Args:
        title: What it is.
        text: The text as a widget, from `markdown` or `coloured`.
    """

    DEFAULT_CSS = """
    Reader > #box { height: 90%; max-width: 88; }
    Reader VerticalScroll { height: 1fr; scrollbar-gutter: stable; padding: 1 1 0 1; }
    Reader Markdown { background: $surface; padding: 0; margin: 0; }
    Reader MarkdownH1, Reader MarkdownH2, Reader MarkdownH3 {
        color: $ink-title; text-style: bold; background: $surface; margin: 1 0; padding: 0;
        content-align: left middle; border: none;
    }
    Reader MarkdownFence { background: $panel; margin: 0 0 1 0; padding: 0 1; max-height: 30; }
    Reader MarkdownParagraph { margin: 0 0 1 0; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("q,t,W,K", "leave", "Close", show=False),
        Binding("space", "page", "On", show=False),
    ]

    def __init__(self, title: str, text: Widget) -> None:
        super().__init__()
        self._title_text = title
        self._text = text

    def compose(self) -> ComposeResult:
        """Yield the text in a box."""
        with Vertical(id="box") as box:
            box.border_title = Content(one_line(self._title_text))
            with VerticalScroll():
                yield self._text
            yield Static("↑↓ scroll   space on   esc close", id="keys", markup=False)

    def on_mount(self) -> None:
        """Start at the top."""
        self.query_one(VerticalScroll).focus()

    def action_page(self) -> None:
        """Scroll a page; at the end, close."""
        scroll = self.query_one(VerticalScroll)
        if scroll.scroll_y >= scroll.max_scroll_y:
            self.dismiss(None)
        else:
            scroll.scroll_page_down(animate=False)


def markdown(text: str) -> Markdown:
    """Return a widget for Markdown; its links don't work, because anybody may have written it."""
    lines = "\n".join(visible(line) for line in text.splitlines())
    return Markdown(lines, open_links=False)


def coloured(text: str) -> Static:
    """Return a widget for a program, coloured as in the editor."""
    lines = [visible(line) for line in text.splitlines()]
    states, told = LineStates(), []
    for number, line in enumerate(lines):
        shown = Content(line)
        for start, end, kind in pieces(line, states.at(number, lines.__getitem__)):
            if kind in SYNTAX:
                shown = shown.stylize(SYNTAX[kind], start, end)
        told.append(shown)
    return Static(Content("\n").join(told))
