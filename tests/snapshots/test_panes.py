"""Each pane, and two whole screens, compared with what they are meant to look like.

A pane is alone on its screen where others would take room from it, so that a change in one breaks
no picture of another. ``pytest --update-snapshots tests/snapshots`` accepts what is shown now.
"""

import random

import pyte
import pytest
from textual.widget import Widget

from logical_robots_tui.progress.board import BoardStanding
from logical_robots_tui.tui.layout.command_bar import CommandBar, PaneTabs
from logical_robots_tui.tui.layout.status_line import StatusLine
from logical_robots_tui.tui.timeline.widget import Timeline
from tests.snapshots.conftest import LOOKS, Show, Shown
from tests.snapshots.picture import cells_of, differences, picture, read_picture

STEPS = 10


def bars(shown: Shown) -> list[Widget]:
    return [shown.game.main.query_one(bar) for bar in (StatusLine, PaneTabs, Timeline, CommandBar)]


async def compare_panes(shown: Shown) -> None:
    game, main = shown.game, shown.game.main
    await shown.compare("bars", *bars(shown))
    await shown.compare("map", main.labyrinth)
    await game.press("2")
    await shown.compare("program", main.program)
    await game.press("escape", "w")
    await shown.compare("why", main.inspector)
    await game.press("3")
    await shown.compare("inspector", main.inspector)
    await game.press("1", "M")
    await shown.compare("editor", main.labyrinth)


async def test_the_main_screen_and_each_pane(show: Show) -> None:
    async with show((80, 24)) as shown:
        await shown.compare("start")
        await compare_panes(shown)
        await shown.game.press("escape")
        for _ in range(STEPS):
            await shown.game.press("n")
            await shown.game.later(0.1)  # it is drawn: trails are made of what was drawn
        await shown.compare(f"bars-tick-{STEPS}", *bars(shown))
        await shown.compare(f"map-tick-{STEPS}", shown.game.main.labyrinth)
        await shown.game.press("3", "home")
        await shown.compare(f"inspector-tick-{STEPS}", shown.game.main.inspector)


async def test_the_results_of_a_level_on_a_board(show: Show) -> None:
    async with show((80, 24)) as shown:
        chance = random.Random(59)
        shown.game.main.player.board.standings = [
            BoardStanding(
                None if player % 3 else f"Player {player}",
                player == 9,
                round(chance.gauss(300, 40)),
                chance.randint(20, 90),
                chance.gauss(500, 90),
            )
            for player in range(60)
        ]
        await shown.game.press("m")
        await shown.compare("results", shown.game.app.screen.query_one("#box"))


async def test_large_panes(show: Show) -> None:
    async with show((120, 40)) as shown:
        await shown.compare("start")
        main = shown.game.main
        await shown.game.press("k")
        await shown.compare("map", main.labyrinth)
        await shown.game.press("M")
        await shown.compare("editor", main.labyrinth)
        await shown.game.press("escape", "2")
        await shown.compare("program", main.program)
        await shown.game.press("escape", "k", "n")
        await shown.resize(160, 30)
        await shown.compare("inspector", main.inspector)


@pytest.mark.sampled
@pytest.mark.parametrize("look", LOOKS)
async def test_each_pane_in_other_colours(look: str, show: Show) -> None:
    async with show((80, 24), look) as shown:
        await compare_panes(shown)


def screen(*chunks: str, lines: int = 3) -> pyte.Screen:
    made = pyte.Screen(20, lines)
    stream = pyte.Stream(made)
    for chunk in chunks:
        stream.feed(chunk)
    return made


def test_a_picture_can_be_read_back_and_has_no_differences_then() -> None:
    cells = cells_of(screen("\x1b[31mhé\x1b[1;48;2;1;2;3mx=|\x1b[0m y"))
    assert read_picture(picture(cells)) == cells
    assert list(differences(read_picture(picture(cells)), cells)) == []


def test_another_character_is_told_with_its_place() -> None:
    told = list(differences(cells_of(screen("one\r\ntwo")), cells_of(screen("one\r\ntoo"))))
    assert told[0] == "line 2, columns 2 to 2, 1 cells:"
    assert [line.split("|")[1] for line in told[1:]] == ["w", "o"]


def test_another_size_is_told_with_the_lines_that_are_missing() -> None:
    told = list(differences(cells_of(screen("a\r\nb")), cells_of(screen("a", lines=1))))
    assert told[0] == "20x1 cells instead of 20x3"
    assert told[1] == "line 2, columns 1 to 20, 20 cells:"
    assert told[3] == "  found  || starting with nothing"


def test_another_colour_is_a_difference_but_not_the_ink_of_a_blank() -> None:
    assert list(differences(cells_of(screen("\x1b[31mx")), cells_of(screen("\x1b[32mx"))))
    assert cells_of(screen("\x1b[31m ")) == cells_of(screen("\x1b[32m "))
