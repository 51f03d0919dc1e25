"""The list of words to choose from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from textual.content import Content
from textual.geometry import Offset
from textual.widgets.option_list import Option

from logical_robots_tui.language.services.completion import WordHelp
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip

_MOST = 60
_WIDEST, _MARGIN = 90, 6  # columns of the list, and those left beside it
_NARROWEST = 8  # columns that a word needs; where there are fewer, none is offered
_LONGEST = 40  # characters of a shape before its meaning stands below


class Completion(Listing, can_focus=False):
    """The list of offered words; the editor keeps the focus and forwards keys."""

    DEFAULT_CSS = """
    Completion {
        overlay: screen; display: none; height: auto; max-height: 12;
        constrain: inside inside; border: round $frame-here; padding: 0; background: $panel;
    }
    Completion > .option-list--option-highlighted { background: $here; color: $here-ink; }
    """

    def __init__(self) -> None:
        super().__init__(id="completion")
        self.names: list[str] = []

    def offer(self, words: Sequence[WordHelp], cursor: Offset) -> None:
        width = min(self.screen.size.width - _MARGIN, _WIDEST)
        words = words[:_MOST] if width >= _NARROWEST else []
        self.names = [word.name for word in words]
        self.display = bool(words)
        if words:
            lines = list(lines_of(words, width))
            self.styles.width = max(line.get_optimal_width({}, 0) for line in lines) + 4
            self.clear_options()
            self.add_options([Option(line) for line in lines])
            self.highlighted = 0
            self.absolute_offset = cursor + Offset(0, 1)

    def close(self) -> None:
        self.display = False


def lines_of(words: Sequence[WordHelp], width: int) -> Iterator[Content]:
    """Yield each word with its shape and whole meaning, in so many columns."""
    shapes = [len(word.shape) for word in words if len(word.shape) <= _LONGEST]
    column = max(shapes, default=0) + 2
    for word in words:
        if len(word.shape) <= _LONGEST and column + len(word.meaning) <= width:
            shape, meaning = f"{word.shape:<{column}}", word.meaning
        else:
            shape = f"{clip(word.shape, width)}\n"
            lines = wrap(word.meaning, width - 2, initial_indent="  ", subsequent_indent="  ")
            meaning = "\n".join(lines)
        yield Content.assemble((shape, INK.text), (meaning, INK.dim))
