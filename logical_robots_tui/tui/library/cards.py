"""The scrolling grid of cards on the level screen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import ClassVar, NamedTuple

from rich.cells import cell_len, set_cell_size
from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Region, Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from logical_robots_tui.game import Frame
from logical_robots_tui.game.victory import brief
from logical_robots_tui.progress import NEW, LevelRecord, State
from logical_robots_tui.tui.labyrinth.drawing.cells import Cells, Palette
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.picture import Picture
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
from logical_robots_tui.tui.theme.themes import INK, rich_style
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level, World, load_level

DAILY = "daily"
"""The name of the card for the labyrinth of the day, which is made when it is chosen."""

LINES_AROUND = 4
"""Lines of a card without the picture: two of the frame, the idea and the results."""

SIGNS: dict[State, str] = {"new": "○ new", "started": "◐ started", "won": "★ won"}

_COLOURS: dict[State, str] = {"new": INK.dim, "started": INK.warn, "won": INK.good}
_UNMEASURED: dict[State, str] = {"new": "", "started": "not won yet", "won": "won"}
_PAPER = "on $surface"


class _CardFrame(NamedTuple):
    left: str
    flat: str
    right: str
    side: str
    low_left: str
    low_right: str


_FRAMES = {False: _CardFrame(*"╭─╮│╰╯"), True: _CardFrame(*"┏━┓┃┗┛")}


@dataclass(frozen=True)
class LevelCard:
    """A card's content; the level is None until loaded, the file None for shipped levels."""

    name: str
    level: Level | None = None
    record: LevelRecord = NEW
    complaint: str = ""
    is_here: bool = False
    file: Path | None = None

    @property
    def title(self) -> str:
        if self.name == DAILY:
            return "Labyrinth of the day"
        if self.file is not None:
            return one_line(self.level.title) if self.level else self.name
        number, _, slug = self.name.partition("-")
        title = one_line(self.level.title) if self.level else slug.replace("-", " ")
        return f"{int(number)} {title}" if number.isdecimal() else title or self.name

    @property
    def idea(self) -> str:
        """The level's idea, or why it can't be used."""
        if self.name == DAILY:
            return "Everybody has the same one today, in three sizes."
        if self.complaint or self.level is None:
            return one_line(self.complaint)
        if self.file is not None and not self.level.idea:
            return "a level of your own"
        first = self.level.briefing.strip().partition("\n")[0]
        return one_line(self.level.idea or first)

    @property
    def sign(self) -> str:
        """The player's achievement, or a mark for levels where teams compete."""
        if self.name == DAILY:
            return "◇ today"
        is_arena = self.level is not None and self.level.teams
        return "◇ arena" if is_arena else SIGNS[self.record.state]

    @property
    def results(self) -> str:
        """The competing teams, or a note that there are no results."""
        if self.level is not None and self.level.teams:
            return one_line(f"teams: {', '.join(team.name for team in self.level.teams)}")
        return _UNMEASURED[self.record.state]

    def matches(self, words: list[str]) -> bool:
        text = f"{self.name} {self.title} {self.idea} {self.sign[2:]}".casefold()
        return all(word in text for word in words)


def card_strips(
    card: LevelCard, picture: Cells | None, width: int, rows: int, is_chosen: bool
) -> list[Strip]:
    """Return a card's lines; the picture, if drawn, is `width - 2` by `rows` cells."""
    frame = _FRAMES[is_chosen]
    ink = _style(INK.key if is_chosen else INK.faint, bold=is_chosen)
    room = width - 2

    def inside(strip: Strip) -> Strip:
        side = Strip([Segment(frame.side, ink)])
        return Strip.join([side, strip, side])

    lines = [_head(card, width, frame, ink)]
    for row in range(rows):
        strip = picture.strip(row) if picture is not None else Strip.blank(room, _style(INK.dim))
        lines.append(inside(strip.adjust_cell_length(room, _style(INK.dim))))
    idea = INK.bad if card.complaint else INK.text
    lines.append(inside(_line(f" {card.idea}", room, _style(idea))))
    results = brief(card.record.bests, room - 2) or card.results
    lines.append(inside(_line(f" {results}", room, _style(INK.dim))))
    lines.append(Strip([Segment(frame.low_left + frame.flat * room + frame.low_right, ink)]))
    return lines


def _head(card: LevelCard, width: int, frame: _CardFrame, ink: Style) -> Strip:
    sign = card.sign
    title = _cut(f"{'▸ ' * card.is_here}{card.title}", width - len(sign) - 8)
    gap = width - cell_len(title) - len(sign) - 7
    return Strip(
        [
            Segment(f"{frame.left}{frame.flat} ", ink),
            Segment(title, _style(INK.title, bold=True)),
            Segment(f" {frame.flat * gap} ", ink),
            Segment(sign, _style(_COLOURS[card.record.state], bold=True)),
            Segment(f" {frame.right}", ink),
        ]
    ).adjust_cell_length(width, ink)


def _line(text: str, width: int, style: Style) -> Strip:
    return Strip([Segment(_cut(text, width), style)]).adjust_cell_length(width, style)


def _cut(text: str, width: int) -> str:
    if cell_len(text) <= width:
        return text
    return set_cell_size(text, max(width - 1, 0)).rstrip() + "…"


def _style(colour: str, *, bold: bool = False) -> Style:
    return rich_style(f"{'bold ' * bold}{colour} {_PAPER}")


@lru_cache(maxsize=128)  # of the pictures alone: all levels' walls would be 8 MB
def shipped_miniature(
    name: str, columns: int, rows: int, drawing: Drawing, palette: Palette
) -> Cells:
    return miniature(load_level(name), columns, rows, drawing, palette)


def miniature(
    level: Level,
    columns: int,
    rows: int,
    drawing: Drawing,
    palette: Palette,
    *,
    names: bool = False,
) -> Cells:
    """Return a level at its start, without rays. Takes milliseconds."""
    state = World(level).save()
    start = Frame(0, state, state, (), {}, (), {}, 0.0)
    viewport = Viewport.fit(level.width, level.height, columns, rows)
    look = Look(drawing=drawing, palette=palette, rays=False, marks=False, names=names)
    return Picture().draw(level, start, viewport, look)


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

    class CardChosen(Message):
        """Another card was chosen, or a card needs its picture."""

    class Taken(Message):
        """A card was clicked."""

    def __init__(self) -> None:
        super().__init__(id="cards")
        self.chosen = -1
        self._cards: Sequence[LevelCard] = ()
        self._pictures: dict[str, Cells] = {}
        self._strips: dict[int, list[Strip]] = {}
        self._rows = _ROWS

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
    def _card_height(self) -> int:
        return self._rows + LINES_AROUND

    @property
    def page(self) -> int:
        """The number of visible cards, at least one row."""
        return max(self.size.height // self._card_height, 1) * self.across

    def show(self, cards: Sequence[LevelCard], index: int) -> None:
        self._cards = cards
        self.chosen = index if 0 <= index < len(cards) else -1
        self._lay_out()
        self._reveal()
        self.post_message(self.CardChosen())

    def replace(self, index: int, cards: Sequence[LevelCard]) -> None:
        self._cards = cards
        self._strips.pop(index, None)
        self._refresh_card(index)

    def has_picture(self, name: str) -> bool:
        return name in self._pictures

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
        for card_index in {self.chosen, index}:
            self._strips.pop(card_index, None)
            self._refresh_card(card_index)
        self.chosen = index
        self._reveal()
        self.post_message(self.CardChosen())

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
        indices = range(first, min(first + self.across, len(self._cards)))
        parts = [self._card(index)[line] for index in indices]
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
            is_chosen = index == self.chosen
            strips = self._strips[index] = card_strips(card, picture, width, rows, is_chosen)
        return strips

    def _lay_out(self) -> None:
        # Read here alone: the terminal's size changes before the strips are made anew.
        self._rows = _TALL_ROWS if self.app.size.height >= _TALL_FROM else _ROWS
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
