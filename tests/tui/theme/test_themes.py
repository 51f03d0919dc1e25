"""Themes: everything stays legible, and the choice is kept."""

from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.segment import Segment
from textual.color import Color
from textual.theme import BUILTIN_THEMES

from logical_robots_tui.player.recorder import THEME, ProgressRecorder
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.app.settings_screen import ThemeList
from logical_robots_tui.tui.inspector.pane import PredicateList
from logical_robots_tui.tui.theme.themes import NIGHT, colours_in, contrast, palette_of
from tests.tui.conftest import Opened, opened

THEMES_OF_TEXTUAL = [theme for theme in BUILTIN_THEMES.values() if not theme.ansi]


def test_texts_and_walls_stand_out_in_every_theme() -> None:
    quiet = {"ink-dim": 3.5, "ink-comment": 3.5, "ink-faint": 1.7, "ink-nothing": 1.1}
    for theme in (NIGHT, *THEMES_OF_TEXTUAL):
        ours = {name: Color.parse(colour) for name, colour in colours_in(theme).items()}
        papers = theme.to_color_system().generate()
        surface = Color.parse(papers["surface"])
        for name, ink in ours.items():
            if not name.startswith("ink-"):
                continue
            for paper in ("background", "surface", "panel"):
                least = quiet.get(name, 4.4)
                assert contrast(ink, Color.parse(papers[paper])) >= least, (theme, name, paper)
            if name not in ("ink-faint", "ink-nothing"):
                assert contrast(ink, ours["here"]) >= 2.9, (theme, name)
        assert contrast(ours["here-ink"], ours["here"]) >= 3, theme
        elsewhere = contrast(ours["frame"], surface)
        assert contrast(ours["frame-here"], surface) >= max(3, elsewhere + 1), theme
        if theme is not NIGHT:
            palette = palette_of(theme)
            assert contrast(Color(*palette.rim), Color(*palette.floor)) >= 2.5, theme
            assert palette.light is not theme.dark, theme


def written(game: Opened, word: str) -> list[Segment]:
    strips = game.app.screen._compositor.render_strips()
    return [segment for strip in strips for segment in strip if word in segment.text]


def colours_of(game: Opened, word: str) -> set[object]:
    return {segment.style.color for segment in written(game, word) if segment.style is not None}


def ink_and_paper(segment: Segment) -> tuple[Color, Color]:
    style = segment.style
    assert style is not None
    colours = [colour and colour.triplet for colour in (style.color, style.bgcolor)]
    ink, paper = (Color(*triplet) for triplet in colours if triplet is not None)
    return ink, paper


@pytest.mark.slow
async def test_a_theme_is_chosen_from_the_palette_and_kept(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("n", "a", until=lambda: game.tick == 1 and game.shows("engines"))
        words = ("FreedomMotion", "PAUSED", "engines", "Map", "● ")
        before = {word: colours_of(game, word) for word in words}
        await game.press("ctrl+p", sees="Find a command")
        await game.press(*"theme", "enter", on=ThemeList)
        while game.app.theme != "solarized-light":
            await game.press("down")
        await game.press("enter", until=lambda: game.app.screen is game.main)
        for word in words:
            assert colours_of(game, word)
            assert not colours_of(game, word) & before[word], word
        assert game.main.labyrinth.view._palette.light
        for theme in ("ansi-light", "night", "gruvbox"):
            game.app.choose_theme(theme)
            await game.sees("FreedomMotion")
        await game.until(lambda: game.app.theme == "gruvbox")
    recorder = ProgressRecorder(data_dir / FILE_NAME)
    assert recorder.progress.fact(THEME) == "gruvbox"
    recorder.progress.close()


@pytest.mark.slow
async def test_the_chosen_entry_of_a_list_is_legible_in_every_theme(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("3", "w", sees="Why · tick 0")
        choice = game.main.inspector.query_one(PredicateList)
        choice.focus()
        for theme in (NIGHT, *THEMES_OF_TEXTUAL):
            game.app.theme = theme.name
            await game.pilot.pause()
            assert choice.has_focus
            (entry,) = (s for s in choice.render_line(2) if s.text.strip() == "Why")
            assert contrast(*ink_and_paper(entry)) >= 2.9, theme.name


@pytest.mark.slow
async def test_greys_alone_are_legible_too(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with opened(data_dir, ready=True) as game:
        for theme in ("night", "ansi-dark", "ansi-light"):
            game.app.theme = theme
            await game.sees("FreedomMotion")
            for word in ("FreedomMotion", "PAUSED", "Map"):
                for ink, paper in map(ink_and_paper, written(game, word)):
                    assert len({*ink.rgb}) == len({*paper.rgb}) == 1
                    assert contrast(ink, paper) >= 2.5, (theme, word)


async def test_all_characters_are_one_cell_wide(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("n", "a", "Y", "f")
        for keys in ("w", ("question_mark",), ("escape", "l")):  # the map: `test_cells.py`
            await game.press(*keys)
            await game.settled()
            assert not {char for char in game.screen() if char != "\n" and cell_len(char) != 1}
