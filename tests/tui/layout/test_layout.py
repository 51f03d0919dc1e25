"""The panes in terminals of all sizes."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual import events
from textual.widgets.text_area import Selection

from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.arrangement import (
    Layout,
    Needs,
    Pane,
    Shares,
    grid_for,
    layout_for,
)
from logical_robots_tui.tui.layout.command_bar import PaneTabs
from tests.tui.conftest import PAPER, opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


def shows_just(game: Opened, panes: list[str]) -> bool:
    return shown(game) == panes


def shown(game: Opened) -> list[str]:
    return [pane.command_id for pane in game.main.query(Pane) if pane.display]


@given(st.integers(1, 400), st.integers(1, 200))
def test_every_size_has_an_arrangement(width: int, height: int) -> None:
    layout = layout_for(width, height)
    assert (layout is Layout.TINY) == (width < 40 or height < 12)


async def test_resizing_keeps_text_cursor_selection_and_focus(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2", *"hello")
        await game.until(lambda: game.editor.text.startswith("hello"))
        game.editor.selection = Selection((1, 2), (2, 1))
        text, editor = game.editor.text, game.editor
        for size, panes in [
            ((80, 24), ["editor"]),
            ((20, 5), ["map", "editor", "inspector"][:0]),
            ((120, 40), ["map", "editor", "inspector"]),
            ((40, 12), ["editor"]),
            ((300, 80), ["map", "editor", "inspector"]),
        ]:
            await game.pilot.resize_terminal(*size)
            await game.until(partial(shows_just, game, panes))
            assert game.editor is editor
            assert game.editor.text == text
            assert game.editor.selection == Selection((1, 2), (2, 1))
        assert game.main.focused is game.editor
        await game.press("x")
        await game.until(lambda: game.editor.text != text)


async def test_a_tiny_terminal_is_told_what_is_needed_and_the_game_goes_on(data_dir: Path) -> None:
    async with opened(data_dir, size=(20, 5)) as game:
        await game.sees("40x12 needed")
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 2)
        await game.pilot.resize_terminal(80, 24)
        await game.sees("1 Map")
        await game.sees_no("needed")


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(1, 1), (40, 12), (41, 13), (79, 23), (110, 24), (500, 150)])
async def test_no_size_breaks_the_screen(data_dir: Path, size: tuple[int, int]) -> None:
    async with opened(data_dir, size=size) as game:
        await game.ready()
        await game.press("n", "2", "3", "1")
        await game.until(lambda: game.tick == 1)


async def test_panes_are_tabs_in_80_columns(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.ready()
        assert shown(game) == ["map"]
        await game.press("2")
        await game.until(lambda: shown(game) == ["editor"])
        assert game.main.focused is game.editor
        await game.press("ctrl+n")
        await game.until(lambda: shown(game) == ["inspector"])
        await game.press("right_square_bracket")
        await game.until(lambda: shown(game) == ["map"])
        await game.press("left_square_bracket")
        await game.until(lambda: shown(game) == ["inspector"])
        await game.press("1")
        await game.until(lambda: shown(game) == ["map"])


async def test_a_tab_is_chosen_by_click_and_tells_about_the_program(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.ready()
        tabs = game.main.query_one(PaneTabs)
        await game.until(lambda: "Program · applied · mine" in tabs.render().plain)
        await game.click(PaneTabs, offset=(tabs.render().plain.index("Program"), 0))
        await game.until(lambda: shown(game) == ["editor"])
        await game.press("x")
        await game.until(lambda: "not applied · mine*" in tabs.render().plain)


@pytest.mark.parametrize("width", [80, 60, 44])
async def test_no_title_hides_another_tab(data_dir: Path, width: int) -> None:
    async with opened(data_dir, size=(width, 24)) as game:
        tabs = game.main.query_one(PaneTabs)
        await game.until(lambda: "Program" in tabs.render().plain)
        game.main.arrangement.panes[1].note(
            "1 error, the old version is still running · a-name-of-24-characters*"
        )
        await game.until(lambda: "…" in tabs.render().plain)
        shown = tabs.render()
        assert all(f" {key} " in shown.plain for key in "123")
        assert shown.cell_length <= width
        assert len(tabs.places) == 3


async def test_what_is_typed_right_after_the_key_for_the_editor_goes_into_the_editor(
    data_dir: Path,
) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.press("e", *"quit")
        await game.until(lambda: game.editor.text == "quit" + PAPER)
        assert game.app.is_running


async def test_escape_leaves_the_editor_for_the_labyrinth(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.press("2", "escape")
        await game.until(lambda: shown(game) == ["map"])
        await game.press("y")
        await game.until(lambda: not game.main.query_one(LabyrinthView).rays)
        assert game.editor.text == PAPER


@given(
    st.integers(110, 400),
    st.integers(24, 200),
    st.integers(-400, 400),
    st.integers(-400, 400),
    st.floats(0.01, 100),
    st.lists(st.integers(0, 300), min_size=1).map(tuple),
    st.integers(0, 300),
)
def test_no_wish_makes_a_pane_vanish(
    width: int,
    height: int,
    columns: int,
    rows: int,
    aspect: float,
    lines: tuple[int, ...],
    listed: int,
) -> None:
    layout = layout_for(width, height)
    needs = Needs(aspect, lines, max(lines), listed)
    grid = grid_for(layout, width, height, Shares(columns, rows), needs)
    assert 30 <= grid.program <= width - 30
    assert 6 <= grid.inspector <= height - 9
    assert grid_for(layout, width, height, grid.shares, needs) == grid
    assert grid_for(layout, width, height, Shares(), needs).shares == Shares()


@given(st.integers(40, 109), st.integers(46, 200), st.integers(-400, 400), st.floats(0.01, 100))
def test_panes_below_each_other_all_keep_some_rows(
    width: int, height: int, rows: int, aspect: float
) -> None:
    grid = grid_for(Layout.TALL, width, height, Shares(0, rows), Needs(aspect))
    assert min(grid.program, grid.inspector, height - 3 - grid.program - grid.inspector) >= 3
    assert grid_for(Layout.TALL, width, height, grid.shares, Needs(aspect)) == grid


def test_a_high_map_leaves_its_columns_to_the_program() -> None:
    wide, high = (grid_for(Layout.WIDE, 120, 40, Shares(), Needs(aspect)) for aspect in (3.0, 1.0))
    assert wide.program == 53
    assert high.program >= 70
    rows = 40 - 3 - high.inspector - 2
    assert 120 - high.program - 2 >= 2 * rows, "the map is as large as before"


def test_a_wide_terminal_gives_the_labyrinth_what_a_text_does_not_need() -> None:
    grid = grid_for(Layout.WIDE, 300, 100, Shares(), Needs())
    assert grid.program < 100
    assert 20 < grid.inspector < 30


def test_panes_have_the_size_of_what_they_hold() -> None:
    short, code = "# " + "a comment " * 9, "x" * 73
    few, many = (
        grid_for(Layout.WIDE, 200, 60, Shares(), Needs.of(1.7, f"{short}\n{text}", rows))
        for text, rows in (("A();", 9), (code, 30))
    )
    assert few.inspector == 9 + 2
    assert few.program == 70, "a comment may be broken into lines"
    assert many.program > 73 + 6, "code is not"
    assert many.inspector > 18, "rows that neither map nor program fill"
    assert many.inspector < 30, "the map is not made smaller"


def test_a_wide_map_leaves_its_rows_to_the_program_below_it() -> None:
    grid = grid_for(Layout.TALL, 90, 60, Shares(), Needs.of(3.0, "A();", 9))
    assert grid.inspector == 11
    assert 60 - 3 - grid.program - grid.inspector == 17


async def test_a_high_terminal_shows_all_panes_one_below_the_other(data_dir: Path) -> None:
    async with opened(data_dir, size=(90, 60)) as game:
        await game.ready()
        assert shown(game) == ["map", "editor", "inspector"]
        tops = [pane.region.y for pane in game.main.query(Pane)]
        assert tops == sorted(set(tops))
        assert {pane.region.width for pane in game.main.query(Pane)} == {90}


async def test_a_pane_is_enlarged_and_shares_again(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("k")
        await game.until(lambda: shown(game) == ["map"])
        await game.press("2", "ctrl+t", "ctrl+t")
        await game.until(lambda: shown(game) == ["editor"])
        await game.press("ctrl+t")
        await game.until(lambda: shown(game) == ["map", "editor", "inspector"])
        assert game.editor.text == PAPER


async def test_a_pane_is_hidden_and_shown_again(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("3", "j")
        await game.until(
            lambda: shown(game) == ["map", "editor"] and game.main.labyrinth.region.height > 30
        )
        await game.press("j")
        await game.until(lambda: shown(game) == ["map", "editor", "inspector"])
        await game.press("j")
        await game.until(lambda: shown(game) == ["editor", "inspector"])
        await game.press("1")
        await game.until(lambda: shown(game) == ["map", "editor", "inspector"])


async def test_panes_are_resized(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        before = game.main.labyrinth.region.size
        await game.press("L", "underscore")
        await game.until(lambda: game.main.labyrinth.region.size - (4, 2) == before)
        await game.press("D", "I")
        await game.until(lambda: game.main.labyrinth.region.size == before)


async def test_the_mouse_outside_of_the_screen_does_nothing(data_dir: Path) -> None:
    async with opened(data_dir, size=(100, 30)) as game:
        await game.ready()
        for x, y in ((114, 24), (0, 30), (99, 300)):
            down, move, up = events.MouseDown, events.MouseMove, events.MouseUp
            for kind, at in ((down, (9, 9)), (down, (x, y)), (move, (x, y)), (up, (x, y))):
                game.app.post_message(kind(None, *at, 0, 0, 1, False, False, False, *at))
                await game.handled()
        await game.press("n")
        await game.until(lambda: game.tick == 1)


async def test_a_border_is_pulled_with_the_mouse(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        labyrinth, program, inspector = game.main.arrangement.panes

        async def pull(begin: tuple[int, int], end: tuple[int, int]) -> None:
            await game.pilot.mouse_down(offset=begin)
            await game.pilot.hover(offset=end)
            await game.pilot.mouse_up(offset=end)
            await game.pilot.pause()

        await game.until(lambda: program.region.width)
        columns, side = program.outer_size.width, labyrinth.region.right - 1
        await pull((side, 10), (side - 10, 12))
        await game.until(lambda: program.outer_size.width == columns + 10)
        await pull((side - 9, 10), (side - 4, 10))
        await game.until(lambda: program.outer_size.width == columns + 5)
        rows, top = inspector.outer_size.height, inspector.region.y
        await pull((30, top), (40, top + 3))
        await game.until(lambda: inspector.outer_size.height == rows - 3)
        await pull((0, 10), (9, 10))
        await game.pilot.hover(offset=(50, 20))
        await game.settled()
        assert program.outer_size.width == columns + 5
