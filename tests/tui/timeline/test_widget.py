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


async def asked(game: Opened, key: str, text: str) -> None:
    """Type an answer into the prompt for a tick that a key opens."""
    await game.press(key)
    await game.until(lambda: isinstance(game.app.screen, TickPrompt))
    await type_in(game, text)


async def run_to(game: Opened, tick: int) -> None:
    """Go on to a tick, as a player does."""
    await asked(game, "U", str(tick))
    await game.until(lambda: game.tick == tick and not game.session.busy)
    await game.until(lambda: game.main.labyrinth.has_focus and game.app.screen is game.main)


async def type_in(game: Opened, text: str) -> None:
    await game.press(*text, "enter")


def line(game: Opened) -> str:
    return game.main.query_one(Timeline).render().plain


async def test_one_goes_to_ticks_by_keys_and_by_their_number(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("N", "n")  # a step pressed during ten takes none away
        await game.until(lambda: game.tick in (10, 11) and not game.session.busy)
        await game.press("left_parenthesis")
        await game.until(lambda: game.tick == 0)
        for tick in (10, 20):
            await game.press("N")
            await game.until(
                partial(lambda tick: game.tick == tick and not game.session.busy, tick)
            )
        for keys, tick in {("n",): 21, ("P",): 11, ("left_parenthesis",): 0}.items():
            await game.press(*keys)
            await game.until(partial(lambda tick: game.tick == tick, tick))
        await game.press("P", "right_parenthesis")
        await game.until(lambda: game.tick == 21)
        await game.until(lambda: "tick 21 of 21" in line(game))

        # A tick that is not there says which are, and one into the past is refused.
        await asked(game, "g", "300")
        await game.sees("The history holds ticks 0 to 21, not 300.")
        game.app.screen.query_one(Input).value = "-8"
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main and game.tick == 13)
        await asked(game, "g", "soon")
        await game.sees("A tick is a number")
        await game.press("escape")
        await run_to(game, 30)
        await asked(game, "U", "9")
        await game.sees("The robots are already at tick 30.")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        assert game.tick == 30

        # The timeline is driven with keys.
        await game.press("T")
        await game.until(lambda: game.main.timeline.has_focus)
        ticks = {"left": 29, "pageup": 19, "right": 20, "home": 0, "pagedown": 10, "end": 30}
        for key, tick in ticks.items():
            await game.press(key)
            await game.until(partial(lambda tick: game.tick == tick, tick))
        game.main.labyrinth.view.selected = "Pip"
        await game.press("up")
        await game.until(lambda: game.tick == 6)
        await game.press("down")
        await game.sees("Nothing happened after tick 6")
        await game.press("escape")
        await game.until(lambda: game.main.labyrinth.has_focus)


async def test_a_click_and_a_drag_on_the_timeline_go_to_ticks(
    data_dir: Path, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 30)
        await game.click(Timeline, offset=(13, 0))
        await game.until(lambda: game.tick == 12)
        await game.pilot.mouse_down(Timeline, offset=(21, 0))
        await game.until(lambda: game.tick == 20)
        for column, tick in ((6, 5), (60, 30)):
            await game.pilot.hover(Timeline, offset=(column, 0))
            await game.until(partial(lambda tick: game.tick == tick, tick))
        await game.pilot.mouse_up(Timeline, offset=(60, 0))
        await game.pilot.hover(Timeline, offset=(4, 0))
        await game.click(Timeline, offset=(50, 0))
        await game.sees("Tick 49 is not in history")
        assert game.tick == 30

        # A drag there and back counts before it is drawn.
        await game.until(lambda: "tick 30 of 30" in line(game))
        monkeypatch.setattr(Timeline, "show", lambda *_: None)
        await game.pilot.mouse_down(Timeline, offset=(6, 0))
        await game.until(lambda: game.tick == 5)
        await game.pilot.hover(Timeline, offset=(31, 0))
        await game.until(lambda: game.tick == 30)


@pytest.mark.parametrize("size", [pytest.param((120, 40), marks=pytest.mark.slow), (80, 24)])
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


async def test_a_run_until_a_tick_can_be_stopped(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short, text=STILL) as game:
        await asked(game, "U", "1000000")
        await game.until(lambda: game.tick > 5 and "RUNNING" in game.status)
        await game.press("space")
        await game.until(lambda: not game.session.busy and "PAUSED" in game.status)

        # The timeline is drawn once for ticks that change nothing in it.
        await game.later(1)
        before = game.main.timeline.render()
        game.main.timeline.show(game.session, None)
        assert game.main.timeline.render() is before


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


async def test_the_old_future_is_kept_compared_and_gone_over_to(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await game.press("F")
        await game.sees("There is no other branch yet")
        await run_to(game, 30)
        await asked(game, "g", "10")
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
        for words in ("memory", "here   false", "there  true"):
            await game.until(lambda words=words: game.shows(words))  # type: ignore[misc]  # a default
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


async def test_a_run_stops_at_a_breakpoint_and_says_at_which(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        await game.sees("The robots stop when Near has rows.")
        game.main.timeline_controller.add_breakpoint(Breakpoint("enters", "Door"))
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Gone"))
        await game.press("space")
        await game.until(lambda: game.tick == 13 and not game.session.running)
        await game.sees("Stopped at tick 13. Near has rows")
        await game.until(lambda: 'tick 13 of 13  ◉ Near has rows: "Pip"' in line(game))

        # They are listed, switched off and deleted.
        await game.press("B")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        await game.sees("◉ a robot enters Door")
        assert game.shows("! The program has no predicate Gone.")
        await game.press("home", "down", "space")
        await game.sees("○ a robot enters Door")
        await game.press("down", "d")
        await game.until(lambda: game.app.screen.query_one(OptionList).option_count == 2)
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        assert [*game.session.breakpoints] == [
            Breakpoint("rows", "Near"),
            Breakpoint("enters", "Door"),
        ]

        # The one that is switched off does not stop the robots; the mark of the other one stays.
        await game.press("space")
        await game.sees("Again")
        won_at = game.session.won_at
        await game.press("escape", "left_curly_bracket")
        await game.until(lambda: game.tick == 13)
        game.session.breakpoints.remove(Breakpoint("rows", "Near"))

        # A restart under the same program goes through what is known.
        await game.press("r")
        await game.until(lambda: game.tick == 0)
        await game.press("space")
        await game.until(lambda: game.tick == won_at and not game.session.busy)
        assert game.session.history is not None
        assert game.session.history.other is None


async def test_a_notice_is_told_beside_its_tick(data_dir: Path, short: Path) -> None:
    near, rule = TURNS.split("\n", 1)
    text = f"{near}\n{rule}{rule.replace('Sensor(robot_name:, sensor:)', 'Near(robot_name:)')}"
    text = text.replace("sensor.clock > 5", "1")
    async with playing(data_dir, short, text=text) as game:
        await run_to(game, 13)
        await game.until(lambda: "tick 13  ! Robot has 2 rows for Pip, wh…" in line(game))


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
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
        await game.press("left_curly_bracket", "right_curly_bracket", "w")
        await game.sees("There is no program yet.")
        await game.sees("There is no program to query yet.")
        assert game.tick == 0
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]
