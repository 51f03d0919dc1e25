"""The list of words that could stand at the cursor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.geometry import Offset
from textual.widgets.option_list import Option

from logical_robots_tui.tui.layout.listing import Listing
from logical_robots_tui.tui.theme.safe_text import clip
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.tui.program.words import Word

__all__ = ["Completion"]

_MOST = 60
_WIDTH = 58


class Completion(Listing, can_focus=False):
    """Offers words; the editor keeps the focus and passes keys on."""

    DEFAULT_CSS = f"""
    Completion {{
        overlay: screen; display: none; width: {_WIDTH}; height: auto; max-height: 10;
        constrain: inside inside; border: none; padding: 0; background: $panel;
    }}
    Completion > .option-list--option-highlighted {{ background: $here; color: $here-ink; }}
    """

    def __init__(self) -> None:
        super().__init__(id="completion")
        self._words: list[Word] = []

    def offer(self, words: list[Word], at: Offset) -> None:
        """Show words below a place of the screen, or nothing if there are none."""
        self._words = words[:_MOST]
        self.display = bool(words)
        if not words:
            return
        self.clear_options()
        self.add_options([Option(_line(word)) for word in self._words])
        self.highlighted = 0
        self.absolute_offset = at + Offset(0, 1)

    def close(self) -> None:
        """Hide."""
        self.display = False

    @property
    def names(self) -> list[str]:
        """The words that are offered."""
        return [word.name for word in self._words]

    @property
    def chosen(self) -> Word | None:
        """The word that is highlighted."""
        number = self.highlighted
        return self._words[number] if number is not None and number < len(self._words) else None


def _line(word: Word) -> Content:
    shape = clip(word.shape, 30)
    told = clip(word.told, _WIDTH - 34)
    return Content.assemble((f"{shape:<31}", INK.text), (told, INK.dim))
