"""One card of the level screen, with a miniature of the level."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len, set_cell_size
from rich.segment import Segment
from textual.strip import Strip

from logical_robots_tui.game import Frame
from logical_robots_tui.progress import NEW, LevelRecord
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
from logical_robots_tui.tui.labyrinth.drawing.picture import Picture
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
from logical_robots_tui.tui.labyrinth.results import brief
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK, rich_style
from logical_robots_tui.world import World, load_level

if TYPE_CHECKING:
    from pathlib import Path

    from rich.style import Style

    from logical_robots_tui.progress import State
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
    from logical_robots_tui.tui.labyrinth.drawing.palette import Palette
    from logical_robots_tui.world import Level

__all__ = [
    "LINES_AROUND",
    "SIGNS",
    "LevelCard",
    "card_strips",
    "draw_miniature",
    "miniature",
    "shipped_level",
]

LINES_AROUND = 4
"""Lines of a card besides the picture: two of the frame, the idea and the results."""

SIGNS: dict[State, str] = {"new": "○ new", "in work": "◐ in work", "won": "★ won"}

_COLOURS: dict[State, str] = {"new": INK.dim, "in work": INK.warn, "won": INK.good}
_UNMEASURED: dict[State, str] = {"new": "", "in work": "not won yet", "won": "won"}
_PAPER = "on $surface"


class _Frame(NamedTuple):
    """Characters of a frame."""

    left: str
    flat: str
    right: str
    side: str
    low_left: str
    low_right: str


_FRAMES = {False: _Frame(*"╭─╮│╰╯"), True: _Frame(*"┏━┓┃┗┛")}


@dataclass(frozen=True)
class LevelCard:
    """What a card tells.

    Attributes:
        name: The level's name.
        level: The level, or None as long as it is not read.
        record: What the player has achieved there.
        complaint: Why the level can't be used, or "".
        is_here: Whether it is the level at hand.
        file: Its file if the player has made it, else None.
    """

    name: str
    level: Level | None = None
    record: LevelRecord = NEW
    complaint: str = ""
    is_here: bool = False
    file: Path | None = None

    @property
    def title(self) -> str:
        """Number and title, as far as they are known."""
        if self.file is not None:
            return one_line(self.level.title) if self.level else self.name
        number, _, rest = self.name.partition("-")
        title = one_line(self.level.title) if self.level else rest.replace("-", " ")
        return f"{int(number)} {title}" if number.isdecimal() else title or self.name

    @property
    def idea(self) -> str:
        """What is new in the level, or why it can't be used."""
        if self.complaint or self.level is None:
            return one_line(self.complaint)
        if self.file is not None and not self.level.idea:
            return "a level of your own"
        first = self.level.briefing.strip().partition("\n")[0]
        return one_line(self.level.idea or first)

    def matches(self, words: list[str]) -> bool:
        """Whether all words occur in what the card tells; case does not matter."""
        told = f"{self.name} {self.title} {self.idea} {self.record.state}".casefold()
        return all(word in told for word in words)


def card_strips(
    card: LevelCard, picture: Cells | None, width: int, rows: int, chosen: bool
) -> list[Strip]:
    """The lines of a card.

    Args:
        card: What to tell.
        picture: The miniature, ``width - 2`` cells wide and `rows` high, or None for later.
        width: Columns of the whole card.
        rows: Lines of the miniature.
        chosen: Whether it is the one that enter takes.
    """
    frame = _FRAMES[chosen]
    ink = _style(INK.key if chosen else INK.faint, bold=chosen)
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
    results = brief(card.record.bests, room - 2) or _UNMEASURED[card.record.state]
    lines.append(inside(_line(f" {results}", room, _style(INK.dim))))
    lines.append(Strip([Segment(frame.low_left + frame.flat * room + frame.low_right, ink)]))
    return lines


def _head(card: LevelCard, width: int, frame: _Frame, ink: Style) -> Strip:
    """The upper side of the frame with the title and the state in it."""
    sign = SIGNS[card.record.state]
    title = _cut(f"{'▸ ' * card.is_here}{card.title}", width - len(sign) - 8)
    rest = width - cell_len(title) - len(sign) - 7
    return Strip(
        [
            Segment(f"{frame.left}{frame.flat} ", ink),
            Segment(title, _style(INK.title, bold=True)),
            Segment(f" {frame.flat * rest} ", ink),
            Segment(sign, _style(_COLOURS[card.record.state], bold=True)),
            Segment(f" {frame.right}", ink),
        ]
    ).adjust_cell_length(width, ink)


def _line(text: str, width: int, style: Style) -> Strip:
    """A text in exactly so many columns."""
    return Strip([Segment(_cut(text, width), style)]).adjust_cell_length(width, style)


def _cut(text: str, width: int) -> str:
    """A text in at most so many columns, with a sign where something is missing."""
    if cell_len(text) <= width:
        return text
    return set_cell_size(text, max(width - 1, 0)).rstrip() + "…"


def _style(colour: str, *, bold: bool = False) -> Style:
    return rich_style(f"{'bold ' * bold}{colour} {_PAPER}")


@lru_cache(maxsize=64)
def shipped_level(name: str) -> Level:
    """A level that came with the game; raises `LevelError`."""
    return load_level(name)


@lru_cache(maxsize=128)
def miniature(level: Level, columns: int, rows: int, drawing: Drawing, palette: Palette) -> Cells:
    """A level at its start, in so many cells. Takes milliseconds the first time."""
    return draw_miniature(level, columns, rows, drawing, palette)


def draw_miniature(
    level: Level,
    columns: int,
    rows: int,
    drawing: Drawing,
    palette: Palette,
    *,
    names: bool = False,
) -> Cells:
    """A level at its start, without rays, and without names unless they are wanted."""
    state = World(level).save()
    start = Frame(0, state, state, (), {}, (), {}, 0.0)
    viewport = Viewport.fit(level.width, level.height, columns, rows)
    look = Look(drawing=drawing, palette=palette, rays=False, marks=False, names=names)
    return Picture().draw(level, start, viewport, look)
