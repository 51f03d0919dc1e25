"""Questions through time, in the game: searched for, stopped at, and watched."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from textual.widgets import Input, OptionList

from logical_robots_tui.game import Breakpoint, Pin
from logical_robots_tui.mind import Mind
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.timeline.breakpoints import (
    BreakpointForm,
    BreakpointList,
    QuestionPrompt,
)
from tests.tui.timeline.test_widget import playing, run_to
from tests.virtual_time import Hold

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

CLOCK = "Sensor(sensor:), t == sensor.clock, "
AT = f"{CLOCK}t in [3, 4, 9]"


async def search(game: Opened, question: str) -> None:
    """Type a question to search for, as a player does."""
    await game.press("Q")
    await game.until(lambda: isinstance(game.app.screen, QuestionPrompt))
    game.app.screen.query_one(Input).value = question
    await game.press("enter")


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_ticks_in_which_a_question_holds_are_gone_through(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await run_to(game, 12)
        await game.press("left_parenthesis")
        await search(game, AT)
        await game.until(lambda: game.tick == 3)
        await game.press("semicolon")
        await game.until(lambda: game.tick == 9)
        await game.press("semicolon")
        await game.sees("No other tick after 9")
        await game.press("colon")
        await game.until(lambda: game.tick == 4)
        await game.press("colon")
        await game.sees("No other tick before 4")
        assert game.tick == 4


async def test_the_first_repetition_asks_for_the_question(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 12)
        await game.press("left_parenthesis", "semicolon")
        await game.until(lambda: isinstance(game.app.screen, QuestionPrompt))
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        assert game.tick == 0


async def test_a_wrong_question_says_what_is_wrong_and_can_be_mended(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 12)
        await game.press("left_parenthesis")
        await search(game, "Sensor(sensr:)")
        await game.sees("Sensor has no column sensr.")
        game.app.screen.query_one(Input).value = AT
        await game.until(lambda: not game.shows("Sensor has no column sensr."))
        await game.press("enter")
        await game.until(lambda: game.tick == 3)


async def test_a_question_that_fails_says_so(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 12)
        await game.press("left_parenthesis")
        await search(game, 'x in ["a"], x.field == 2')
        said = "It failed in some: Tick 0: This failed:"
        # The toast wraps its text; the message does not.
        await game.until(lambda: any(said in each.message for each in game.app._notifications))
        assert game.tick == 0


async def test_a_search_that_the_player_left_changes_nothing(
    data_dir: Path, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with playing(data_dir, short) as game:
        await run_to(game, 12)
        await game.press("left_parenthesis")
        ask, hold = Mind.ask, Hold()

        def slow(mind: Mind, *arguments: object, **options: object) -> object:
            hold.here()
            return ask(mind, *arguments, **options)  # type: ignore[arg-type] # passed on

        monkeypatch.setattr(Mind, "ask", slow)
        await search(game, AT)
        await game.until(lambda: hold.has_begun)
        await game.press("n", "n")
        await game.until(lambda: game.tick == 2)
        hold.release()
        await game.until(lambda: all(w.is_finished for w in game.main.workers if w.group == "seek"))
        assert game.tick == 2
        await game.sees_no("No tick after")


async def test_nothing_is_searched_before_there_is_a_program(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("Q")
        await game.until(lambda: isinstance(game.app.screen, QuestionPrompt))


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_a_breakpoint_can_be_any_question(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await game.press("B", "a")
        await game.until(lambda: isinstance(game.app.screen, BreakpointForm))
        await game.press("enter")
        await game.until(lambda: game.app.screen.query_one("#subject").has_focus)
        subject = game.app.screen.query_one("#subject", Input)
        subject.value = "Sensor(sensr:)"
        await game.press("enter")
        await game.sees("Sensor has no column sensr.")
        subject.value = AT
        await game.press("enter")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        assert list(game.session.breakpoints) == [Breakpoint("rows", AT)]
        await game.sees_no("!")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        await game.press("space")
        await game.until(lambda: game.tick == 3 and not game.session.busy)
        await game.sees("Stopped at tick 3.")
        await game.press("space")
        await game.until(lambda: game.tick == 9 and not game.session.busy)


async def test_of_a_search_and_the_inspector_the_later_one_is_stopped_at(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:

        async def ask(question: str) -> None:
            await game.press("slash")
            await game.until(lambda: isinstance(game.main.focused, QueryLine))
            game.main.query_one(QueryLine).value = question
            await game.press("enter")
            await game.sees("Ask · tick")
            await game.press("escape")

        async def stops_at(question: str) -> None:
            await game.press("asterisk")
            await game.until(lambda: [*game.session.breakpoints] == [Breakpoint("rows", question)])
            game.session.breakpoints.remove(Breakpoint("rows", question))

        await run_to(game, 6)
        await ask("sensor.clock > 1")
        await game.press("left_parenthesis")
        await search(game, AT)
        await game.until(lambda: game.tick == 3)
        await stops_at(AT)
        await ask("sensor.clock > 2")
        await stops_at("sensor.clock > 2")
        await game.press("colon")
        await game.sees("No other tick before 3")
        await stops_at(AT)


async def test_what_is_asked_can_be_stopped_at_and_pinned(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        await game.press("slash")
        await game.until(lambda: isinstance(game.main.focused, QueryLine))
        game.main.query_one(QueryLine).value = AT
        await game.press("enter")
        await game.sees("Ask · tick 0 · 0 rows")
        await game.press("escape", "asterisk", "at")
        await game.sees("Pinned: ")
        assert list(game.session.breakpoints) == [Breakpoint("rows", AT)]
        assert game.main.query_one(WatchView).pins == (Pin(AT),)
        await game.press("escape")
        await run_to_hits(game)
        await game.press("V")
        view = game.main.query_one(WatchView)
        await game.until(lambda: view.has_focus and AT[:20] in view.plain)
        # A line of ticks: empty, but for the third, the fourth and the ninth.
        await game.until(lambda: "  ▁▁▁██▁▁▁▁█▁▁▁" in view.plain)
        await game.press("left")
        await game.until(lambda: game.tick == 10)
        await game.press("enter")
        await game.until(lambda: game.main.query_one(QueryLine).value == AT)
        await game.sees("Ask · tick 10")


async def run_to_hits(game: Opened) -> None:
    await game.press("space")
    await game.until(lambda: game.tick == 3 and not game.session.busy)
    await game.press("space")
    await game.until(lambda: game.tick == 9 and not game.session.busy)
    game.session.breakpoints.remove(Breakpoint("rows", AT))
    await game.press("n", "n", "n")
    await game.until(lambda: game.tick == 12)


async def test_the_list_says_why_a_question_can_t_be_asked(data_dir: Path, short: Path) -> None:
    async with playing(data_dir, short) as game:
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Sensor(sensr:), 1 < 2"))
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await game.press("B")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        await game.sees("! This can't be asked: Sensor has no column sensr.")
        assert game.app.screen.query_one(OptionList).option_count == 1
