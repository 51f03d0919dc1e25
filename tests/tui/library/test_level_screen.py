"""The level screen: a card for each level, what was achieved there, the labyrinth of the day."""

import gc
import weakref
from dataclasses import replace
from datetime import date
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len
from textual.geometry import Size
from textual.widgets import Input

from logical_robots_tui.game.victory import result_line
from logical_robots_tui.progress import FILE_NAME, Bests, LevelRecord, Measures, Progress
from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.tui.library.cards import (
    DAILY,
    LINES_AROUND,
    LevelCard,
    LevelCards,
    card_strips,
    miniature,
)
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.world import Level, list_arenas, list_levels, load_level
from tests.tui.conftest import Opened, opened
from tests.virtual_time import Hold

COURSE = list_levels()
NAMES = [*COURSE, DAILY, *list_arenas()]


async def open_levels(game: Opened) -> LevelCards:
    await game.ready()
    await game.press("l", on=LevelScreen)
    cards = game.app.screen.query_one(LevelCards)
    await game.until(lambda: len(cards._cards) == len(NAMES))
    await game.until(
        lambda: all(card.level or card.complaint or card.name == DAILY for card in cards._cards)
    )
    return cards


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(120, 40), (80, 24), (40, 12)])
async def test_each_level_has_a_card_with_picture(data_dir: Path, size: tuple[int, int]) -> None:
    async with opened(data_dir, size=size) as game:
        cards = await open_levels(game)
        for index, name in enumerate(NAMES):
            cards.choose(index)
            if name == DAILY:
                await game.sees("Labyrinth of the da")
                continue
            await game.until(partial(cards.has_picture, name))
            await game.sees(load_level(name).title[:20], "○ new")
            assert any(sign in game.screen() for sign in "▀▄▌▐▛▜▙▟")
        for line in game.screen().splitlines():
            assert cell_len(line) == len(line) <= size[0]


async def test_cards_tell_what_was_achieved_and_are_filtered_and_clicked(data_dir: Path) -> None:
    progress = Progress(data_dir / FILE_NAME)
    progress.win(NAMES[0], "text", Measures(1255, 1, 972.6, 19, 20))
    progress.begin(NAMES[1])
    progress.close()
    async with opened(data_dir) as game:
        cards = await open_levels(game)
        await game.sees(f"1 of {len(COURSE)} won", "★ won", "◐ started", "○ new", "not won yet")
        await game.sees("1,255 ticks · size 1 · 19/20")
        await game.press(*"won", until=lambda: names_on(cards) == [NAMES[0]])
        await game.press(*["backspace"] * 3, *"arena")
        await game.until(lambda: names_on(cards) == list_arenas())
        await game.sees("◇ arena", "teams: red, gold, blue, green")
        await game.press(*["backspace"] * 5, *"xyzzy", sees="Nothing has this name.")
        await game.press("enter", "right", "down", *["backspace"] * 5, *"daily", sees="◇ today")
        await game.press("enter", sees="which size?")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        assert game.session.level.name == "open_room"

        cards = await open_levels(game)
        await game.click(LevelCards, offset=(cards.card_width + 5, 3))
        await game.until(lambda: game.session.level.name == NAMES[1])
        cards = await open_levels(game)
        assert cards.chosen == 1, "the level at hand"
        await game.sees(f"▸ 2 {load_level(NAMES[1]).title}")
        await game.press(*"xyzzy", "enter", "escape", until=lambda: game.app.screen is game.main)
        assert game.session.level.name == NAMES[1]


def names_on(cards: LevelCards) -> list[str]:
    return [card.name for card in cards._cards]


async def test_cards_are_chosen_and_played(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with opened(data_dir, size=(80, 18)) as game:
        cards = await open_levels(game)
        assert (cards.across, cards.chosen) == (2, 0)
        await game.press("right", until=lambda: cards.chosen == 1)
        await game.press("left", "left", until=lambda: cards.chosen == 0)
        await game.press("down", until=lambda: cards.chosen == 2)
        assert cards.scroll_offset.y > 0, "the chosen card is in sight"
        await game.press(*["pagedown"] * len(NAMES), until=lambda: cards.chosen == len(NAMES) - 1)
        await game.press(*["pageup"] * len(NAMES), until=lambda: cards.chosen == 0)
        assert cards.scroll_offset.y == 0
        for size in ((80, 24), (200, 60), (20, 8), (120, 40)):
            await game.resize(*size, until=partial(fits, cards, NAMES[0]))
            assert game.app.screen.query_one(Input).has_focus
        lines = range(cards.size.height)
        before = [cards.render_line(line).text for line in lines]
        with monkeypatch.context() as patch:
            patch.setattr(type(game.app), "size", Size(80, 24))
            now = [cards.render_line(line).text for line in lines]
        assert now == before, "until the screen is laid out anew"
        await game.press("enter", until=lambda: game.session.level.name == NAMES[0])
        assert game.app.screen is game.main


async def test_early_keys_cost_no_pictures(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = data_dir / "levels"
    own.mkdir(parents=True)
    (own / "zzz.toml").write_text("title = ")
    hold = Hold()

    def slowly(card: LevelCard) -> Level:
        hold.here()
        return load_level(card.file or card.name)

    monkeypatch.setattr("logical_robots_tui.tui.library.level_screen._level_of", slowly)
    async with opened(data_dir) as game:
        try:
            await game.ready()
            await game.press("l", on=LevelScreen)
            cards = game.app.screen.query_one(LevelCards)
            line = game.app.screen.query_one("#filter", Input)
            await game.until(lambda: len(cards._cards) == len(NAMES) + 1)
            await game.press(*NAMES[1], until=lambda: names_on(cards) == [NAMES[1]])
        finally:
            hold.release()
        await game.until(partial(cards.has_picture, NAMES[1]))
        line.value = ""
        await game.until(lambda: len(cards._cards) == len(NAMES) + 1)
        for name in (*COURSE, *list_arenas()):
            await game.until(partial(cards.has_picture, name))


def fits(cards: LevelCards, name: str) -> bool:
    picture = cards._pictures.get(name)
    return picture is not None and picture.text.shape == cards.picture_size[::-1]


BESTS = st.just(Bests()) | st.builds(
    Bests, st.integers(1, 10**6), st.integers(1, 99), st.floats(0, 1e7), st.integers(0, 20)
)
RECORDS = st.builds(LevelRecord, st.sampled_from(["new", "started", "won"]), bests=BESTS)
TITLES, IDEAS = st.text(max_size=50), st.text(max_size=90)


@settings(deadline=None)
@given(TITLES, IDEAS, RECORDS, st.integers(24, 80), st.integers(1, 9), st.booleans())
def test_a_card_fills_its_room_whatever_it_tells(
    title: str, idea: str, record: LevelRecord, width: int, rows: int, chosen: bool
) -> None:
    level = replace(load_level(NAMES[0]), title=title, idea=idea)
    card = LevelCard("99-x", level, record, is_here=chosen)
    for shown in (miniature(load_level(NAMES[0]), width - 2, rows, Drawing.ASCII, DARK), None):
        strips = card_strips(card, shown, width, rows, chosen)
        assert [strip.cell_length for strip in strips] == [width] * (rows + LINES_AROUND)


def test_a_card_tells_without_colour_that_it_is_chosen_or_why_it_can_not_be_used() -> None:
    def text_of(card: LevelCard, *, chosen: bool = False) -> str:
        return "\n".join(strip.text for strip in card_strips(card, None, 40, 4, chosen))

    card = LevelCard(NAMES[0], load_level(NAMES[0]))
    assert text_of(card) != text_of(card, chosen=True)
    broken = text_of(LevelCard("99-broken", complaint="This is not valid TOML."))
    assert "99 broken" in broken
    assert "This is not valid TOML." in broken


async def test_today_s_labyrinth_is_opened_in_the_chosen_size_or_not(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        before = game.session.level
        today = f"daily-{date.today().isoformat()}-small"
        game.main.recorder.progress.set_fact(f"won {today}", "900")
        for key in ("escape", "s"):
            assert game.session.level is before
            game.main.run_worker(game.main.library.open_daily())
            await game.until(lambda: isinstance(game.app.screen, QuestionDialog))
            await game.press(key, until=lambda: game.app.screen is game.main)
        await game.until(lambda: game.session.level.name == today)
        await game.sees("Everybody has this labyrinth today.")


@pytest.mark.parametrize(
    ("measures", "line"),
    [
        (Measures(1258, 2, 971.4), "1,258 ticks · 2 symbols · 971 units driven"),
        (Measures(31, 1, 15.5, 19, 20), "31 ticks · 1 symbol · 16 units driven · 19 of 20 starts"),
    ],
)
def test_a_result_is_one_line(measures: Measures, line: str) -> None:
    whole = f"Logical Robots · First steps · {line}"
    assert result_line(load_level("01-first-steps"), measures) == whole


class _Cycle:
    def __init__(self) -> None:
        self.itself = self


async def test_what_only_cycles_hold_is_freed_when_another_level_was_opened(
    data_dir: Path,
) -> None:
    async with opened(data_dir) as game:
        await open_levels(game)
        cycle = weakref.ref(_Cycle())
        gc.disable()
        try:
            await game.press("right", "enter")
            await game.until(lambda: game.session.level.name == NAMES[1])
            await game.until(lambda: cycle() is None)
        finally:
            gc.enable()
