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

LINES_AROUND = 4
"""Lines of a card without the picture: two of the frame, the idea and the results."""

SIGNS: dict[State, str] = {"new": "○ new", "in work": "◐ in work", "won": "★ won"}

_COLOURS: dict[State, str] = {"new": INK.dim, "in work": INK.warn, "won": INK.good}
_UNMEASURED: dict[State, str] = {"new": "", "in work": "not won yet", "won": "won"}
_PAPER = "on $surface"


class _Frame(NamedTuple):
    left: str
    flat: str
    right: str
    side: str
    low_left: str
    low_right: str


_FRAMES = {False: _Frame(*"╭─╮│╰╯"), True: _Frame(*"┏━┓┃┗┛")}


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
        if self.file is not None:
            return one_line(self.level.title) if self.level else self.name
        number, _, rest = self.name.partition("-")
        title = one_line(self.level.title) if self.level else rest.replace("-", " ")
        return f"{int(number)} {title}" if number.isdecimal() else title or self.name

    @property
    def idea(self) -> str:
        """The level's idea, or why it can't be used."""
        if self.complaint or self.level is None:
            return one_line(self.complaint)
        if self.file is not None and not self.level.idea:
            return "a level of your own"
        first = self.level.briefing.strip().partition("\n")[0]
        return one_line(self.level.idea or first)

    @property
    def sign(self) -> str:
        """The player's achievement, or a mark for levels where teams compete."""
        is_arena = self.level is not None and self.level.teams
        return "◇ arena" if is_arena else SIGNS[self.record.state]

    @property
    def results(self) -> str:
        """The competing teams, or a note that there are no results."""
        if self.level is not None and self.level.teams:
            return one_line(f"teams: {', '.join(team.name for team in self.level.teams)}")
        return _UNMEASURED[self.record.state]

    def matches(self, words: list[str]) -> bool:
        told = f"{self.name} {self.title} {self.idea} {self.sign[2:]}".casefold()
        return all(word in told for word in words)


def card_strips(
    card: LevelCard, picture: Cells | None, width: int, rows: int, chosen: bool
) -> list[Strip]:
    """Return a card's lines; the picture, if drawn, is `width - 2` by `rows` cells."""
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
    results = brief(card.record.bests, room - 2) or card.results
    lines.append(inside(_line(f" {results}", room, _style(INK.dim))))
    lines.append(Strip([Segment(frame.low_left + frame.flat * room + frame.low_right, ink)]))
    return lines


def _head(card: LevelCard, width: int, frame: _Frame, ink: Style) -> Strip:
    sign = card.sign
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
    return Strip([Segment(_cut(text, width), style)]).adjust_cell_length(width, style)


def _cut(text: str, width: int) -> str:
    if cell_len(text) <= width:
        return text
    return set_cell_size(text, max(width - 1, 0)).rstrip() + "…"


def _style(colour: str, *, bold: bool = False) -> Style:
    return rich_style(f"{'bold ' * bold}{colour} {_PAPER}")


@lru_cache(maxsize=64)
def shipped_level(name: str) -> Level:
    """Load a shipped level; raises `LevelError`."""
    return load_level(name)


@lru_cache(maxsize=128)
def miniature(
    level: Level,
    columns: int,
    rows: int,
    drawing: Drawing,
    palette: Palette,
    *,
    names: bool = False,
) -> Cells:
    """Return a level at its start, without rays. Takes milliseconds the first time."""
    state = World(level).save()
    start = Frame(0, state, state, (), {}, (), {}, 0.0)
    viewport = Viewport.fit(level.width, level.height, columns, rows)
    look = Look(drawing=drawing, palette=palette, rays=False, marks=False, names=names)
    return Picture().draw(level, start, viewport, look)
