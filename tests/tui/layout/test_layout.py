"""The panes and the lines at the top and the bottom, in terminals of all sizes."""

from contextvars import copy_context
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual import events
from textual.geometry import Size
from textual.widgets.text_area import Selection

from logical_robots_tui.game import Goal
from logical_robots_tui.game.frame import Peak, goals
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout import arrangement
from logical_robots_tui.tui.layout.arrangement import Needs, Pane, ScreenLayout, Shares, grid_for
from logical_robots_tui.tui.layout.command_bar import CommandBar, PaneTabs
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.layout.status_line import Status, fit
from logical_robots_tui.world import World, list_levels, load_level
from tests.tui.conftest import PAPER, Opened, opened

ALL = ["map", "editor", "inspector"]


def shows_just(game: Opened, panes: list[str]) -> bool:
    return shown(game) == panes


def shown(game: Opened) -> list[str]:
    return [pane.command_id for pane in game.main.query(Pane) if pane.display]


ASPECTS, WISHES = st.floats(0.01, 100), st.integers(-400, 400)
NEEDS = st.builds(
    lambda aspect, lines, listed: Needs(aspect, lines, max(lines), listed),
    ASPECTS,
    st.lists(st.integers(0, 300), min_size=1).map(tuple),
    st.integers(0, 300),
)


@given(st.integers(1, 400), st.integers(1, 200))
def test_every_size_has_an_arrangement(width: int, height: int) -> None:
    assert (arrangement.layout_for(width, height) is ScreenLayout.TINY) == (
        width < 40 or height < 12
    )


@given(st.integers(100, 400), st.integers(24, 200), st.builds(Shares, WISHES, WISHES), NEEDS)
def test_no_wish_makes_a_pane_vanish(width: int, height: int, wish: Shares, needs: Needs) -> None:
    layout = arrangement.layout_for(width, height)
    grid = grid_for(layout, width, height, wish, needs)
    assert 30 <= grid.program <= width - 30
    assert 6 <= grid.inspector <= height - 9
    assert grid_for(layout, width, height, grid.shares, needs) == grid
    assert grid_for(layout, width, height, Shares(), needs).shares == Shares()


@given(st.integers(40, 99), st.integers(46, 200), WISHES, ASPECTS.map(Needs))
def test_panes_in_a_column_keep_some_rows(width: int, height: int, rows: int, needs: Needs) -> None:
    grid = grid_for(ScreenLayout.TALL, width, height, Shares(0, rows), needs)
    assert min(grid.program, grid.inspector, height - 3 - grid.program - grid.inspector) >= 3
    assert grid_for(ScreenLayout.TALL, width, height, grid.shares, needs) == grid


def test_a_map_leaves_what_it_does_not_need_to_the_program() -> None:
    wide, high = (
        grid_for(ScreenLayout.WIDE, 120, 40, Shares(), Needs(aspect)) for aspect in (3.0, 1.0)
    )
    assert wide.program == 53
    assert high.program >= 70
    rows = 40 - 3 - high.inspector - 2
    assert 120 - high.program - 2 >= 2 * rows, "the map is as large as before"
    below = grid_for(ScreenLayout.TALL, 90, 60, Shares(), Needs.of(3.0, "A();", 9))
    assert (below.inspector, 60 - 3 - below.program - below.inspector) == (11, 17)


def test_panes_have_the_size_of_what_they_hold() -> None:
    large = grid_for(ScreenLayout.WIDE, 300, 100, Shares(), Needs())
    assert large.program < 100, "a text does not need more"
    assert 20 < large.inspector < 30
    short, code = "# " + "a comment " * 9, "x" * 73
    few, many = (
        grid_for(ScreenLayout.WIDE, 200, 60, Shares(), Needs.of(1.7, f"{short}\n{text}", rows))
        for text, rows in (("A();", 9), (code, 30))
    )
    assert few.inspector == 9 + 2
    assert few.program == 70, "a comment may be broken into lines"
    assert many.program > 73 + 6, "code is not"
    assert 18 < many.inspector < 30, "rows that neither fills, but the map is not made smaller"


async def test_in_80_columns_panes_are_tabs(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        # What is typed right after the key for the editor goes into the editor.
        await game.press("e", *"quit", until=lambda: game.editor.text == "quit" + PAPER)
        assert game.app.is_running
        assert game.main.focused is game.editor
        await game.press("escape", until=lambda: shown(game) == ["map"])
        await game.press("y", until=lambda: not game.main.query_one(LabyrinthView).rays)
        assert game.editor.text == "quit" + PAPER
        brackets = ("right_square_bracket", "map"), ("left_square_bracket", "inspector")
        for key, pane in (("2", "editor"), ("ctrl+n", "inspector"), *brackets, ("1", "map")):
            await game.press(key, until=partial(shows_just, game, [pane]))

        # A tab is chosen by a click, and tells about the program.
        await game.write(PAPER)
        await game.press("1")
        tabs = game.main.query_one(PaneTabs)
        await game.until(lambda: "Program · applied · mine" in tabs.render().plain)
        await game.click(PaneTabs, offset=(tabs.render().plain.index("Program"), 0))
        await game.until(lambda: shown(game) == ["editor"])
        await game.press("x", until=lambda: "not applied · mine*" in tabs.render().plain)

        # No title hides another tab.
        for width in (80, 60, 44):
            await game.resize(width, 24)
            game.main.arrangement.panes[1].note(
                "not applied, 500 errors, 1,000 warnings · a-name-of-24-characters*"
            )
            await game.until(lambda: tabs.size.width == game.app.size.width)
            title = tabs.render()
            assert "…" in title.plain
            assert all(f" {key} " in title.plain for key in "123")
            assert title.cell_length <= width
            assert len(tabs.places) == 3
        await game.press("f5", until=partial(shows_just, game, ["map"]))
        assert game.session.busy


async def test_a_tiny_terminal_is_told_what_is_needed_and_the_game_goes_on(data_dir: Path) -> None:
    async with opened(data_dir, size=(20, 5)) as game:
        await game.sees("40x12 needed")
        await game.ready()
        choice = game.inspector.query_one(Listing)
        choice.highlighted = 2
        choice.action_page_up()
        choice.action_page_down()
        assert choice.highlighted == 2, "a list without room has no pages"
        await game.press("space", until=lambda: game.tick > 2)
        await game.resize(80, 24, sees="1 Map", sees_no="needed")
        await game.resize(90, 60, until=lambda: shown(game) == ALL)
        tops = [pane.region.y for pane in game.main.query(Pane)]
        assert tops == sorted(set(tops)), "in a high terminal one is below the other"
        assert {pane.region.width for pane in game.main.query(Pane)} == {90}


async def test_a_terminal_that_is_too_large_is_told_of_once_whatever_covers_the_game(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    warnings: list[str] = []
    async with opened(data_dir, ready=True) as game:
        monkeypatch.setattr(game.main, "warn", warnings.append)
        await game.press("question_mark", sees="Type to filter")
        await game.resize(1000, 40, until=lambda: warnings)
        await game.press("escape", until=lambda: game.app.screen is game.main)
        await game.press("question_mark", sees="Type to filter")
        await game.later(1)
        assert warnings == ["Only 1000 columns and 400 lines of this terminal are drawn."]


async def test_panes_are_hidden_resized_and_pulled(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        labyrinth, program, inspector = game.main.arrangement.panes
        before = labyrinth.region.size
        await game.press("L", "underscore", until=lambda: labyrinth.region.size - (4, 2) == before)
        await game.press("D", "I", until=lambda: labyrinth.region.size == before)

        for keys, panes in (
            *(("k", ["map"]), (("2", "ctrl+t", "ctrl+t"), ["editor"]), (("ctrl+t",), ALL)),
            *((("escape", "3", "j"), ["map", "editor"]), ("j", ALL)),
            *(("j", ["editor", "inspector"]), ("1", ALL)),
        ):
            await game.press(*keys, until=partial(shows_just, game, panes))
            if panes == ["map", "editor"]:
                await game.until(lambda: labyrinth.region.height > 30)
        assert game.editor.text == PAPER
        await game.settled()

        async def pull(begin: tuple[int, int], end: tuple[int, int]) -> None:
            await game.pilot.mouse_down(offset=begin)
            await game.pilot.hover(offset=end)
            await game.pilot.mouse_up(offset=end)
            await game.pilot.pause()

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

        # The mouse outside of the screen does nothing.
        for x, y in ((134, 34), (0, 40), (119, 300)):
            down, move, up = events.MouseDown, events.MouseMove, events.MouseUp
            for kind, at in ((down, (9, 9)), (down, (x, y)), (move, (x, y)), (up, (x, y))):
                game.app.post_message(kind(None, *at, 0, 0, 1, False, False, False, *at))
                await game.handled()
        await game.press("n", tick=1)


async def test_resizing_keeps_text_cursor_selection_and_focus(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2", *"hello", until=lambda: game.editor.text.startswith("hello"))
        game.editor.selection = Selection((1, 2), (2, 1))
        text, editor = game.editor.text, game.editor
        for size, panes in [
            ((80, 24), ["editor"]),
            ((20, 5), []),
            ((100, 30), ALL),
            ((40, 12), ["editor"]),
            ((300, 80), ALL),
        ]:
            await game.resize(*size, until=partial(shows_just, game, panes))
            assert game.editor is editor
            assert (game.editor.text, game.editor.selection) == (text, Selection((1, 2), (2, 1)))
        assert game.main.focused is game.editor
        await game.press("x", until=lambda: game.editor.text != text)


HOME = Goal("Home", True, ("Ada", "Bo", "Cy"), ("Ada",))
STATUS = Status("Everybody home", "running", 1204, None, 40.0, 17.2, (HOME,), (), 0.0)


def test_the_status_line_tells_everything_where_there_is_room() -> None:
    assert fit(STATUS, 120).plain.split("   ") == [
        *(" LOGICAL ROBOTS", "Everybody home", "● RUNNING", "tick 1204", "17 of 40/s"),
        "Home: Ada ✓ Bo · Cy ·",
    ]
    most = "most at once 2/3, tick 812"
    passed = STATUS._replace(peak=Peak(2, 3, 812))
    long, short = "Home: Ada ✓ Bo · Cy ·", "Home 1/3"
    for width, words in ((120, f"{long}  {most}"), (80, f"{short}  {most}"), (60, short)):
        assert fit(passed, width).plain.endswith(f"   {words}")


@given(st.integers(0, 200))
def test_the_status_line_fits_and_keeps_the_most_important(width: int) -> None:
    line = fit(STATUS, width)
    assert line.cell_length <= max(width, 1)
    if width >= 40:
        assert "● RUNNING   tick 1204" in line.plain
        assert "Home" in line.plain


def test_the_name_of_the_level_stays_in_eighty_columns() -> None:
    for name in list_levels():
        level = load_level(name)
        now = goals(level, World(level).save())
        busy = STATUS._replace(tick=12_345, achieved=12.5)
        line = fit(busy._replace(title=level.title, goals=now), 80).plain
        assert all(words in line for words in (level.title, "RUNNING", "tick 12345")), line
        assert len(line) <= 80


class Bar(CommandBar):
    width = 80

    @property
    def size(self) -> Size:
        return Size(self.width, 1)


def words_by_width() -> dict[int, list[str]]:
    KEY_MAP.set(KeyMap(COMMANDS))
    bar, words = Bar(), {}
    for bar.width in range(60, 160):
        words[bar.width] = bar.render().plain.split()
    return words


def test_a_key_without_words_is_shown_with_the_next_or_not_at_all() -> None:
    shown = copy_context().run(words_by_width)
    for width, words in shown.items():
        assert ("-" in words) == ("+" in words) == ("Speed" in words), width
    assert {"-" in words for words in shown.values()} == {False, True}
