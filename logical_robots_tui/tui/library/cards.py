"""The scrolling grid of cards on the level screen."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.geometry import Region, Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from logical_robots_tui.tui.library.card import LINES_AROUND, LevelCard, card_strips
from logical_robots_tui.tui.theme.themes import rich_style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual import events

    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells

_LEAST_WIDTH = 36
_TALL_FROM = 30
_ROWS, _TALL_ROWS = 6, 8


class LevelCards(ScrollView, can_focus=False):
    """Cards in a grid; `chosen` is an index, -1 if there is none."""

    DEFAULT_CSS = """
    LevelCards { width: 1fr; height: 1fr; background: $surface; scrollbar-gutter: stable;
        overflow-x: hidden; }
    """
    ALLOW_SELECT: ClassVar[bool] = False

    class Chosen(Message):
        """Another card was chosen, or a card needs its picture."""

    class Taken(Message):
        """A card was clicked."""

    def __init__(self) -> None:
        super().__init__(id="cards")
        self.chosen = -1
        self._cards: Sequence[LevelCard] = ()
        self._pictures: dict[str, Cells] = {}
        self._strips: dict[int, list[Strip]] = {}

    @property
    def across(self) -> int:
        return max(self._room // _LEAST_WIDTH, 1)

    @property
    def card_width(self) -> int:
        return self._room // self.across

    @property
    def picture_size(self) -> tuple[int, int]:
        """Columns and rows of a miniature."""
        return max(self.card_width - 2, 1), self._rows

    @property
    def _room(self) -> int:
        return max(self.scrollable_content_region.width or self.size.width, 4)

    @property
    def _rows(self) -> int:
        return _TALL_ROWS if self.app.size.height >= _TALL_FROM else _ROWS

    @property
    def _card_height(self) -> int:
        return self._rows + LINES_AROUND

    @property
    def page(self) -> int:
        """The number of visible cards, at least one row."""
        return max(self.size.height // self._card_height, 1) * self.across

    def show(self, cards: Sequence[LevelCard], chosen: int) -> None:
        self._cards = cards
        self.chosen = chosen if 0 <= chosen < len(cards) else -1
        self._lay_out()
        self._reveal()
        self.post_message(self.Chosen())

    def replace(self, index: int, cards: Sequence[LevelCard]) -> None:
        self._cards = cards
        self._strips.pop(index, None)
        self._refresh_card(index)

    def set_picture(self, name: str, picture: Cells) -> None:
        self._pictures[name] = picture
        for index, card in enumerate(self._cards):
            if card.name == name:
                self._strips.pop(index, None)
                self._refresh_card(index)

    def forget_pictures(self) -> None:
        self._pictures.clear()
        self._lay_out()

    def move(self, steps: int) -> None:
        if self._cards:
            self.choose(min(max(self.chosen + steps, 0), len(self._cards) - 1))

    def choose(self, index: int) -> None:
        for each in {self.chosen, index}:
            self._strips.pop(each, None)
            self._refresh_card(each)
        self.chosen = index
        self._reveal()
        self.post_message(self.Chosen())

    def seen_first(self) -> list[int]:
        first = self.scroll_offset.y // self._card_height * self.across
        order = range(len(self._cards))
        near = set(range(first, first + self.page + self.across))
        return sorted(order, key=lambda index: (index not in near, index))

    def on_resize(self) -> None:
        self._lay_out()
        self._reveal()

    def render_line(self, y: int) -> Strip:
        row, line = divmod(y + self.scroll_offset.y, self._card_height)
        first = row * self.across
        shown = range(first, min(first + self.across, len(self._cards)))
        parts = [self._card(index)[line] for index in shown]
        paper = rich_style("on $surface")
        return Strip.join(parts).adjust_cell_length(self.size.width, paper)

    def _card(self, index: int) -> list[Strip]:
        strips = self._strips.get(index)
        if strips is None:
            card = self._cards[index]
            width, rows = self.card_width, self._rows
            picture = self._pictures.get(card.name)
            if picture is not None and picture.text.shape != (rows, width - 2):
                picture = None
            chosen = index == self.chosen
            strips = self._strips[index] = card_strips(card, picture, width, rows, chosen)
        return strips

    def _lay_out(self) -> None:
        self._strips.clear()
        rows = -(-len(self._cards) // self.across)
        self.virtual_size = Size(self._room, rows * self._card_height)
        self.refresh()

    def _region(self, index: int) -> Region:
        row, column = divmod(index, self.across)
        return Region(
            column * self.card_width, row * self._card_height, self.card_width, self._card_height
        )

    def _refresh_card(self, index: int) -> None:
        if 0 <= index < len(self._cards):
            self.refresh(self._region(index).translate(-self.scroll_offset))

    def _reveal(self) -> None:
        if self.chosen >= 0 and self.size:
            self.scroll_to_region(self._region(self.chosen), animate=False, force=True)

    def on_click(self, event: events.Click) -> None:
        column, row = event.x // self.card_width, (event.y + self.scroll_offset.y)
        index = row // self._card_height * self.across + column
        if column < self.across and 0 <= index < len(self._cards):
            self.choose(index)
            self.post_message(self.Taken())
