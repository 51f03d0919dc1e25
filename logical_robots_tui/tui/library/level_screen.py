"""The level screen: cards of all levels, or the path of any level file."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

from textual import events, on
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.game.victory import references_for
from logical_robots_tui.paths import is_file, pasted_path, typed_path
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.results import goal_lines, histogram_lines, scale_lines
from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.library.cards import (
    DAILY,
    LevelCard,
    LevelCards,
    miniature,
    shipped_miniature,
)
from logical_robots_tui.tui.library.chooser import is_path
from logical_robots_tui.tui.theme.themes import INK, palette_of
from logical_robots_tui.wording import count_of, one_line
from logical_robots_tui.world import Level, list_arenas, list_levels, list_shipped, load_level
from logical_robots_tui.world.levels.load import SUFFIXES

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Sequence

    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.progress.board import BoardStanding

_ROOMY = 24  # lines of the screen from which there is space for the results of the chosen level


Wish: TypeAlias = Literal["new", "daily"]
"""What may be chosen instead of a level: a level of one's own, or the labyrinth of the day."""


class LevelScreen(Dialog["Level | Wish"]):
    DEFAULT_CSS = """
    LevelScreen > #box { width: 100%; max-width: 100%; height: 100%; max-height: 100%;
        border: none; padding: 0; }
    LevelScreen #head { height: 1; padding: 0 1; background: $panel; text-wrap: nowrap; }
    LevelScreen Input { margin: 0; }
    LevelScreen #detail { height: 1; padding: 0 1; text-wrap: nowrap; text-overflow: ellipsis; }
    LevelScreen #detail.-tall { height: 5; }
    LevelScreen #complaint { padding: 0 1; }
    LevelScreen #keys { margin: 0; padding: 0 1; background: $panel; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "go('left')", priority=True),
        Binding("right", "go('right')", priority=True),
        Binding("up", "go('up')", priority=True),
        Binding("down", "go('down')", priority=True),
        Binding("pageup", "go('page_up')", priority=True),
        Binding("pagedown", "go('page_down')", priority=True),
        Binding("ctrl+n", "dismiss('new')", priority=True),
    ]

    keys = "enter play   ←↑↓→ choose   ^N new level   esc close"

    def __init__(
        self,
        level: Level,
        recorder: ProgressRecorder,
        drawing: Drawing,
        folder: Path,
        standings_of: Callable[[Level], Awaitable[Sequence[BoardStanding]]],
    ) -> None:
        placeholder = "type to filter, or the path of a .toml or .json file"
        line = Input(placeholder=placeholder, id="filter", select_on_focus=False)
        line.cursor_blink = False  # nothing is redrawn while idle
        self._cards = LevelCards()
        super().__init__("", Static(id="head"), line, self._cards, Static(id="detail"))
        self._folder, self._level = folder, level
        self._recorder, self._drawing, self._standings_of = recorder, drawing, standings_of
        self._standings: dict[str, Sequence[BoardStanding]] = {}
        self._all: list[LevelCard] = []
        self._shown: list[LevelCard] = []
        self._is_read = False

    def on_mount(self) -> None:
        """Show the names at once; details and miniatures follow as they are ready."""
        shipped, own_files = list_shipped(), own_levels(self._folder)
        current_name = self._level.name
        self._all = [LevelCard(name, is_here=name == current_name) for name in shipped] + [
            LevelCard(name, is_here=str(file) == self._level.source, file=file)
            for name, file in own_files.items()
            if name not in shipped
        ]
        self._all.insert(len(list_levels()), LevelCard(DAILY))
        self._filter(current_name)
        in_background(self, self._read_all, "cards", exclusive=True)

    def on_resize(self, event: events.Resize) -> None:
        self.query_one("#detail").set_class(event.size.height >= _ROOMY, "-tall")
        self._cards.forget_pictures()
        if self._all:
            in_background(self, self._draw_all, "pictures", exclusive=True)

    def action_go(self, motion: str) -> None:
        across, page = self._cards.across, self._cards.page
        steps = {"left": -1, "right": 1, "up": -across, "down": across}
        self._cards.move({**steps, "page_up": -page, "page_down": page}[motion])

    async def _read_all(self) -> None:
        painted = asyncio.Event()
        self.call_after_refresh(painted.set)
        await painted.wait()  # reading would delay the first picture
        keys = [str(card.file.absolute()) if card.file else card.name for card in self._all]
        records = await self._recorder.ask(
            lambda progress: {key: progress.record(key) for key in keys}
        )
        pairs = zip(self._all, keys, strict=True)
        self._all = [replace(card, record=records[key]) for card, key in pairs]
        self._tell_head()
        for index, card in enumerate(self._all):
            if card.name == DAILY:
                continue
            try:
                level = await asyncio.to_thread(_level_of, card)
                self._all[index] = replace(card, level=level)
            except LogicalRobotsError as error:
                self._all[index] = replace(card, complaint=str(error))
            names = [shown_card.name for shown_card in self._shown]
            if card.name in names:
                position = names.index(card.name)
                self._shown[position] = self._all[index]
                self._cards.replace(position, self._shown)
                if position == self._cards.chosen:
                    self._tell_detail()
        self._is_read = True
        in_background(self, self._draw_all, "pictures", exclusive=True)

    async def _draw_all(self) -> None:
        palette = palette_of(self.app.current_theme)
        for index in self._cards.seen_first():
            card = self._shown[index] if index < len(self._shown) else None
            if card is None or card.level is None or self._cards.has_picture(card.name):
                continue
            draw = partial(miniature, card.level)
            if card.file is None:
                draw = partial(shipped_miniature, card.name)
            picture = await asyncio.to_thread(
                draw, *self._cards.picture_size, self._drawing, palette
            )
            self._cards.set_picture(card.name, picture)

    def _filter(self, highlighted: str | None) -> None:
        text = self._filter_text
        words = [] if is_path(text) else text.casefold().split()
        self._shown = [card for card in self._all if not is_path(text) and card.matches(words)]
        names = [card.name for card in self._shown]
        self._cards.show(self._shown, names.index(highlighted) if highlighted in names else 0)
        self._tell_head()
        self._tell_detail()

    @property
    def _filter_text(self) -> str:
        return pasted_path(self.query_one("#filter", Input).value)

    @property
    def _chosen_card(self) -> LevelCard | None:
        index = self._cards.chosen
        return self._shown[index] if 0 <= index < len(self._shown) else None

    def _tell_head(self) -> None:
        arenas = set(list_arenas())
        to_win = [card for card in self._all if card.name not in (*arenas, DAILY)]
        won = sum(card.record.state == "won" for card in to_win)
        self.query_one("#head", Static).update(
            Content.assemble(
                ("LEVELS", f"bold {INK.title}"),
                (f"   {won} of {len(to_win)} won", INK.text),
                ("   ○ new   ◐ started   ★ won   ▸ you are here", INK.dim),
            )
        )

    @on(LevelCards.CardChosen)
    def _tell_detail(self) -> None:
        card, text = self._chosen_card, self._filter_text
        if is_path(text):
            detail = Content.assemble(("Open the file ", INK.dim), (one_line(text), INK.key))
        elif card is None:
            detail = Content.styled("Nothing has this name.", INK.dim)
        else:
            count = len(card.level.robots) if card.level else 0
            robots = f"{count_of(count, 'robot')} · " if count else ""
            detail = Content.assemble((robots, INK.dim), (card.idea, INK.text))
            if card.level is not None:
                bests, standings = card.record.bests, self._standings.get(card.name)
                scales = scale_lines(references_for(card.level).values(), bests)
                if standings:
                    plain = self._drawing is Drawing.ASCII
                    scales = histogram_lines(standings, plain=plain)
                elif standings is None and card.record.state == "won":
                    self._standings[card.name] = ()
                    read = partial(self._read_standings, card.name, card.level)
                    in_background(self, read, "standings")
                goals = Content("   ").join(goal_lines(card.level.second_goals, bests.goals))
                detail = Content("\n").join([detail, *scales, goals])
        self.query_one("#detail", Static).update(detail)

    async def _read_standings(self, name: str, level: Level) -> None:
        self._standings[name] = await self._standings_of(level)
        if self._chosen_card is not None and self._chosen_card.name == name:
            self._tell_detail()

    @on(Input.Changed, "#filter")
    def _filter_changed(self) -> None:
        self.complain("")
        self._filter(self._chosen_card.name if self._chosen_card else None)
        if self._is_read:
            in_background(self, self._draw_all, "pictures", exclusive=True)

    @on(Input.Submitted, "#filter")
    @on(LevelCards.Taken)
    def _take(self) -> None:
        choice, card = self._filter_text, self._chosen_card
        if not is_path(choice):
            choice = "" if card is None else str(card.file or card.name)
        if choice == DAILY:
            self.dismiss("daily")
        elif choice:
            in_background(self, partial(self.leave_with, _load, choice), "take", exclusive=True)


def _level_of(card: LevelCard) -> Level:
    return load_level(card.file or card.name)


def _load(name_or_path: str) -> Level:
    return load_level(typed_path(name_or_path) if "/" in name_or_path else name_or_path)


def own_levels(folder: Path) -> dict[str, Path]:
    """Return the files of the player's levels by name, sorted, one per name. Blocks."""
    try:
        files = [file for file in folder.iterdir() if file.suffix in SUFFIXES and is_file(file)]
    except OSError:  # no levels yet, or the folder can't be read
        return {}
    return {file.stem: file for file in sorted(files, reverse=True)[::-1]}
