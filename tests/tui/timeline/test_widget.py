"""Travelling in time on the screen: each command, the mouse, and what is said in place."""

from __future__ import annotations

from contextlib import asynccontextmanager
from functools import partial
from typing import TYPE_CHECKING

import pytest
from textual.widgets import Input, OptionList

from logical_robots_tui.game import EVENTS, Breakpoint
from logical_robots_tui.tui.timeline.breakpoints import BreakpointForm, BreakpointList, TickPrompt
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.world import load_level
from tests.short import AHEAD
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from tests.tui.conftest import Opened

TURNS = """\
Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 12;
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: sensor.clock > 5) :-
  Sensor(robot_name:, sensor:);
"""


@asynccontextmanager
async def playing(
    data_dir: Path, short: Path, text: str = TURNS, size: tuple[int, int] = (120, 40)
) -> AsyncIterator[Opened]:
    async with opened(data_dir, level=short, text=text, size=size) as game:
        await game.ready()
        yield game


async def run_to(game: Opened, tick: int) -> None:
    """Go on to a tick, as a player does."""
    await game.press("U")
    await game.until(lambda: isinstance(game.app.screen, TickPrompt))
    await type_in(game, str(tick))
    await game.until(lambda: game.tick == tick and not game.session.busy)
    await game.until(lambda: game.main.labyrinth.has_focus and game.app.screen is game.main)


async def type_in(game: Opened, text: str) -> None:
    await game.press(*text, "enter")


def line(game: Opened) -> str:
    return game.main.query_one(Timeline).render().plain


async def test_ten_ticks_on_and_back_and_to_both_ends(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("N")
        await game.until(lambda: game.tick == 10)
        await game.press("N")
        await game.until(lambda: game.tick == 20 and not game.session.busy)
        await game.press("n")
        await game.until(lambda: game.tick == 21)
        await game.press("P")
        await game.until(lambda: game.tick == 11)
        await game.press("left_parenthesis")
        await game.until(lambda: game.tick == 0)
        await game.press("P", "right_parenthesis")
        await game.until(lambda: game.tick == 21)
        await game.until(lambda: "tick 21 of 21" in line(game))


@pytest.mark.parametrize("size", [(120, 40), (80, 24)])
async def test_the_swarm_is_counted_while_no_robot_is_selected(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    level = load_level("04-everybody-home")
    home = next(area for area in level.areas if area.victory_robots)
    there = {level.robots[0].name: (home.x, home.y, 0.0)}
    async with playing(data_dir, short, size=size) as game:
        await game.app.main.player.library.open_level(level)
        await game.until(lambda: f" · 0/3 in {home.name}" in line(game))
        await game.until(lambda: game.session.game is not None)
        game.session.change_level(level, there)
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await game.press("n")
        await game.until(lambda: f" · 1/3 in {home.name}" in line(game))
        await game.press("n")
        game.main.labyrinth.view.selected = level.robots[0].name
        game.main.redraw_lines()
        await game.until(lambda: "/3 in" not in line(game))


async def test_a_step_pressed_during_ten_takes_none_away(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("N", "n")
        await game.until(lambda: game.tick in (10, 11) and not game.session.busy)


async def test_a_tick_is_gone_to_by_its_number_and_one_that_is_not_there_says_what_is(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 20)
        await game.press("g")
        await game.until(lambda: isinstance(game.app.screen, TickPrompt))
        await type_in(game, "300")
        await game.sees("The history holds ticks 0 to 20, not 300.")
        game.app.screen.query_one(Input).value = "-8"
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main and game.tick == 12)
        await game.press("g")
        await game.until(lambda: isinstance(game.app.screen, TickPrompt))
        await type_in(game, "soon")
        await game.sees("A tick is a number")


async def test_a_run_until_a_tick_ends_there_and_one_into_the_past_is_refused(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 17)
        await game.press("U")
        await game.until(lambda: isinstance(game.app.screen, TickPrompt))
        await type_in(game, "9")
        await game.sees("The robots are already at tick 17.")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        assert game.tick == 17


async def test_a_run_until_a_tick_can_be_stopped(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short, text=STILL) as game:
        await game.press("U")
        await game.until(lambda: isinstance(game.app.screen, TickPrompt))
        await type_in(game, "1000000")
        await game.until(lambda: game.tick > 5 and "RUNNING" in game.status)
        await game.press("space")
        await game.until(lambda: not game.session.busy and "PAUSED" in game.status)


@pytest.mark.slow
async def test_marks_are_gone_to_one_after_the_other(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("space")
        await game.sees("Again")
        won_at = game.tick
        await game.press("escape", "left_parenthesis", "right_curly_bracket")
        await game.until(lambda: game.tick == won_at and "★ won" in line(game))
        game.main.labyrinth.view.selected = "Pip"
        await game.press("left_curly_bracket")
        await game.until(lambda: game.tick == 6)
        await game.until(lambda: f"tick 6 of {won_at}  ┷ Pip" in line(game))
        await game.press("left_curly_bracket")
        await game.until(lambda: game.tick == 1)
        await game.press("left_curly_bracket")
        await game.sees("Nothing happened before tick 1")


async def test_a_click_and_a_drag_on_the_timeline_go_to_ticks(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 30)
        await game.click(Timeline, offset=(13, 0))
        await game.until(lambda: game.tick == 12)
        await game.pilot.mouse_down(Timeline, offset=(21, 0))
        await game.until(lambda: game.tick == 20)
        await game.pilot.hover(Timeline, offset=(6, 0))
        await game.until(lambda: game.tick == 5)
        await game.pilot.hover(Timeline, offset=(60, 0))
        await game.until(lambda: game.tick == 30)
        await game.pilot.mouse_up(Timeline, offset=(60, 0))
        await game.pilot.hover(Timeline, offset=(4, 0))
        await game.click(Timeline, offset=(50, 0))
        await game.sees("Tick 49 is not in history")
        assert game.tick == 30


async def test_a_drag_there_and_back_counts_before_it_is_drawn(
    data_dir: Path, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 30)
        await game.until(lambda: "tick 30 of 30" in line(game))
        monkeypatch.setattr(Timeline, "show", lambda *_: None)
        await game.pilot.mouse_down(Timeline, offset=(6, 0))
        await game.until(lambda: game.tick == 5)
        await game.pilot.hover(Timeline, offset=(31, 0))
        await game.until(lambda: game.tick == 30)


async def test_the_timeline_is_driven_with_keys(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 30)
        await game.press("T")
        await game.until(lambda: game.main.timeline.has_focus)
        ticks = {"left": 29, "pageup": 19, "right": 20, "home": 0, "pagedown": 10, "end": 30}
        for key, tick in ticks.items():
            await game.press(key)
            await game.until(partial(lambda wanted: game.tick == wanted, tick))
        game.main.labyrinth.view.selected = "Pip"
        await game.press("up")
        await game.until(lambda: game.tick == 6)
        await game.press("down")
        await game.sees("Nothing happened after tick 6")
        await game.press("escape")
        await game.until(lambda: game.main.labyrinth.has_focus)


async def test_the_old_future_is_kept_compared_and_gone_over_to(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await game.press("F")
        await game.sees("There is no other branch yet")
        await run_to(game, 30)
        await game.press("g")
        await game.until(lambda: isinstance(game.app.screen, TickPrompt))
        await type_in(game, "10")
        await game.until(lambda: game.tick == 10)
        await game.write(TURNS.replace("sensor.clock > 5", "sensor.clock > 15"))
        await game.until(lambda: game.session.state.phase == "applied")
        await game.press("escape", "n")
        await game.until(lambda: game.tick == 11)
        await game.until(lambda: "┄" in line(game))
        assert "≠" in line(game)
        await game.press("N")
        await game.until(lambda: game.tick == 21)
        await game.press("C")
        await game.sees("The two branches differ from tick 11")
        for told in ("memory", "here   false", "there  true"):
            await game.until(lambda told=told: game.shows(told))  # type: ignore[misc]  # a default
        await game.until(lambda: game.shows("What Pip decides differs first in Robot("))
        await game.sees("here   line 2  memory: sensor.clock > 15")
        await game.sees("there  line 2  memory: sensor.clock > 5")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main and game.tick == 11)
        await game.press("F")
        await game.sees("This is the other branch.")
        assert game.session.frame.memories == {"Pip": True}
        assert game.session.program is not None
        assert game.session.program.text == TURNS
        await game.sees("not applied")
        await game.press("right_parenthesis")
        await game.until(lambda: game.tick == 30)


async def test_a_restart_under_the_same_program_goes_through_what_is_known(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 20)
        await game.press("r")
        await game.until(lambda: game.tick == 0)
        await game.press("space")
        await game.until(lambda: game.session.won_at is not None)
        assert game.session.history is not None
        assert game.session.history.other is None


async def test_a_run_stops_at_a_breakpoint_and_says_at_which(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        await game.sees("The robots stop when Near has rows.")
        await game.press("space")
        await game.until(lambda: game.tick == 13 and not game.session.running)
        await game.sees("Stopped at tick 13. Near has rows")
        await game.until(lambda: 'tick 13 of 13  ◉ Near has rows: "Pip"' in line(game))
        await game.press("space")
        await game.sees("Again")
        await game.press("escape", "left_curly_bracket")
        await game.until(lambda: game.tick == 13)


async def test_a_notice_is_told_beside_its_tick(data_dir: Path, short: Path) -> None:
    near, rule = TURNS.split("\n", 1)
    text = f"{near}\n{rule}{rule.replace('Sensor(robot_name:, sensor:)', 'Near(robot_name:)')}"
    text = text.replace("sensor.clock > 5", "1")
    async with playing(data_dir, short, text=text) as game:
        await run_to(game, 13)
        await game.until(lambda: "tick 13  ! Robot has 2 rows for Pip, wh…" in line(game))


async def test_breakpoints_are_listed_switched_off_and_deleted(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        game.main.timeline_controller.add_breakpoint(Breakpoint("enters", "Door"))
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Gone"))
        await game.press("B")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        await game.sees("◉ a robot enters Door")
        await game.sees("! The program has no predicate Gone.")
        await game.press("space")
        await game.sees("○ a robot enters Door")
        await game.press("down", "d")
        await game.until(lambda: game.app.screen.query_one(OptionList).option_count == 1)
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        await game.press("space")
        await game.until(lambda: game.session.won_at is not None)
        assert list(game.session.breakpoints) == [Breakpoint("enters", "Door")]


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_a_breakpoint_is_made_with_the_names_that_there_are(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await game.press("B", "a")
        await game.until(lambda: isinstance(game.app.screen, BreakpointForm))
        await game.sees("Sensor Memory Near Robot")
        await game.press("enter")
        await game.until(lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Ner", "enter")
        await game.sees("The program has no predicate Ner.")
        await game.press("backspace", *"a")
        await game.until(lambda: game.app.screen.query_one("#subject", Input)._suggestion)
        await game.press("right", "enter")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]
        await game.press("a")
        await game.until(lambda: isinstance(game.app.screen, BreakpointForm))
        events = game.app.screen.query_one(OptionList)
        events.highlighted = list(EVENTS).index("change")
        await game.until(lambda: game.app.screen.query_one("#column").display)
        await game.press("enter")
        await game.until(lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Near", "tab", *"Pip", "tab", *"robot_name", "enter")
        await game.until(lambda: len(game.session.breakpoints) == 2)
        assert game.session.breakpoints.on[1] == Breakpoint("change", "Near", "Pip", "robot_name")


async def test_nothing_of_this_hurts_before_there_is_a_program(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text="nonsense(") as game:
        await game.ready()
        await game.press("N", "P", "left_parenthesis", "right_parenthesis", "g", "U", "F", "C")
        await game.press("left_curly_bracket", "right_curly_bracket")
        await game.sees("There is no program yet.")
        assert game.tick == 0
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]


async def test_the_timeline_is_drawn_once_for_ticks_that_change_nothing_in_it(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short, text=AHEAD) as game:
        await run_to(game, 5)
        await game.later(1)
        before = game.main.timeline.render()
        game.main.timeline.show(game.session, None)
        assert game.main.timeline.render() is before
