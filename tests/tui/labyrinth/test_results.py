"""Where a player's results stand among those of the reference programs, and bonus goals."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from logical_robots_tui.game.victory import references_for
from logical_robots_tui.paths import write_atomically
from logical_robots_tui.progress import FILE_NAME, Bests, Measures, Progress
from logical_robots_tui.progress.board import BoardStanding
from logical_robots_tui.tui.commands.help import PaletteScreen
from logical_robots_tui.tui.labyrinth.results import (
    ResultsDialog,
    goal_lines,
    histogram_lines,
    scale_lines,
)
from logical_robots_tui.tui.library.level_screen import LevelScreen
from logical_robots_tui.world import list_levels, load_level
from logical_robots_tui.world.level import SecondGoal
from tests.player.test_standings import standings
from tests.short import AHEAD
from tests.tui.conftest import SHORT, Size, opened

THREE = [Measures(100, 1, 300.0), Measures(200, 5, 250.4), Measures(150, 9, 350.0)]
SIZES = [pytest.param((80, 24), marks=pytest.mark.slow), (120, 40)]


def scales(
    ticks: int | None = None, size: int | None = None, distance: float | None = None
) -> list[str]:
    return [line.plain for line in scale_lines(THREE, Bests(ticks, size, distance))]


def test_a_scale_goes_from_the_best_reference_to_the_worst_and_holds_ones_own_mark() -> None:
    ticks, distance = "ticks      ", "distance   "
    assert scales() == [
        f"{ticks}┼─────────┼─────────┼  100  150  200",
        "size       ┼─────────┼─────────┼  1  5  9",
        f"{distance}┼─────────┼─────────┼  250  300  350",
    ]
    assert scales(175, 1, 250.2) == [
        f"{ticks}┼─────────┼────●────┼  100  150  175●  200",
        "size       ●─────────┼─────────┼  1●  5  9",
        f"{distance}●─────────┼─────────┼  250●  300  350",
    ]
    better, *_, worse = scales(0, None, 450)
    assert better.startswith(f"{ticks}●─────────┼────┼────┼")
    assert worse.startswith(f"{distance}┼────┼────┼─────────●")
    # Equal references are one mark, and without any there is no scale.
    (_, size, _) = scale_lines([THREE[0]] * 3, Bests())
    assert size.plain == "size       ┼────────────────────  1"
    assert list(scale_lines([], Bests(1, 1, 1.0))) == []


@given(standings(), st.booleans())
def test_a_histogram_marks_ones_own_bin_and_fits_into_the_narrowest_dialog(
    rows: list[BoardStanding], plain: bool
) -> None:
    has_won = any(row.is_me for row in rows)
    for line in histogram_lines(rows, plain=plain):
        assert line.cell_length <= 64
        assert line.plain[11:28].count("●") == has_won
        assert (f" of {len(rows)} " in line.plain[28:41]) == has_won
        assert plain is not any(sign in line.plain[11:28] for sign in "▁▂▃▄▅▆▇█─")


def test_a_histogram_names_who_is_first_and_whoever_is_off_the_board_has_no_rank() -> None:
    rows = [BoardStanding("漢字" * 9, False, 50, 9, 9.0), BoardStanding(None, False, 90, 9, 9.0)]
    ticks, size, _ = (line.plain for line in histogram_lines(rows))
    assert ticks == "ticks      █───────────────█  2 won      best 50 漢字漢字 …"
    assert size.endswith("best 9 漢字漢字 …")
    (plain_ticks, *_) = histogram_lines(rows, plain=True)
    assert plain_ticks.plain.startswith("ticks      #               #  2 won")


def test_second_goals_are_ticked_when_they_are_reached() -> None:
    lines = goal_lines([SecondGoal("symbol", 11), SecondGoal("blocked")], ["never blocked"])
    assert [line.plain for line in lines] == ["☐ at most 11 symbols", "✓ never blocked"]
    assert list(goal_lines([], ["never blocked"])) == []


@pytest.mark.parametrize("size", SIZES)
async def test_the_results_show_scales_and_goals(data_dir: Path, size: Size) -> None:
    level = load_level(list_levels()[0])
    (goal, other) = level.second_goals
    progress = Progress(data_dir / FILE_NAME)
    progress.win(level.name, AHEAD, Measures(1500, 3, 1300.0, goals=(goal.words,)))
    progress.close()
    async with opened(data_dir, level=Path(level.source), size=size) as game:
        await game.until(lambda: game.main.recorder.record.state == "won")
        await game.press("1", "m")
        told = [f"✓ {goal.words}", f"☐ {other.words}", "1,500●", "1,300●", "● your best"]
        told += [f"  {measures.ticks:,}" for measures in references_for(level).values()]
        await game.sees(*told)
        assert all(cell_len(line) == len(line) for line in game.screen().splitlines())
        await game.press("m", "l", on=LevelScreen, sees=("1,500●", f"✓ {goal.words}"))
        assert all(cell_len(line) == len(line) for line in game.screen().splitlines())
        await game.press("escape", sees_no="challenge")
        game.app.push_screen(ResultsDialog(game.main.recorder, "Won", [("results", "Close")]))
        await game.sees(f"☐ {other.words}: a challenge")


async def test_a_victory_covers_no_palette_that_was_opened_while_it_waited(
    data_dir: Path, short: Path
) -> None:
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.press("2", until=lambda: game.editor.has_focus)
        game.session.run()
        while game.session.won_at is None:
            await game.press("x")
            await game.later(0.2)
        await game.press("x")
        await game.later(0.2)
        await game.press("ctrl+p", on=PaletteScreen)
        await game.later(5)
        assert isinstance(game.app.screen, PaletteScreen)
        await game.press("escape", on=ResultsDialog)


@pytest.mark.parametrize("size", SIZES)
async def test_a_victory_ticks_the_goals_reached(data_dir: Path, short: Path, size: Size) -> None:
    goals = 'second_goals = ["at most 11 symbols", "at most 20 ticks"]\n'
    write_atomically(short, goals + SHORT)
    async with opened(data_dir, level=short, text=AHEAD, size=size, ready=True) as game:
        await game.sees("☐ at most 11 symbols")
        await game.press(*["plus"] * 6, "space", sees="✓ at most 11 symbols")
        await game.sees("☐ at most 20 ticks", "☐ not reached")
        await game.press("r", until=lambda: game.app.screen is game.main and not game.tick)
        await game.press("space", sees="☐ at most 20 ticks")
        assert not game.shows("☐ not reached"), "signs are explained once"
        await game.press("escape", until=lambda: game.app.screen is game.main)

        # What is measured before the results are mounted is shown.
        results = ResultsDialog(game.main.recorder, "Won", [("restart", "Once more")])
        results._rows = []
        game.app.push_screen(results)
        assert results.is_active
        results.follow()
        await game.until(lambda: game.shows("Once more") and game.shows("your best"))
    best = Progress(data_dir / FILE_NAME).record(str(short)).bests
    assert best.goals == ("at most 11 symbols",)
