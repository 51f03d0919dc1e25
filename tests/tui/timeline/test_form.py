"""Questions through time, in the game: searched for, stopped at, and watched."""

from __future__ import annotations

from functools import partial
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


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
async def test_the_ticks_in_which_a_question_holds_are_gone_through(
    data_dir: Path, short: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await run_to(game, 12)
        # The first repetition asks for the question.
        await game.press("left_parenthesis", "semicolon")
        await game.until(lambda: isinstance(game.app.screen, QuestionPrompt))
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        assert game.tick == 0

        # A wrong one says what is wrong and can be mended.
        await search(game, "Sensor(sensr:)")
        await game.sees("Sensor has no column sensr.")
        game.app.screen.query_one(Input).value = AT
        await game.sees_no("Sensor has no column sensr.")
        await game.press("enter")
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

        # One that fails says so.
        await game.press("left_parenthesis")
        await search(game, 'x in ["a"], x.field == 2')
        failure = "It failed in some: Tick 0: This failed:"
        # The toast wraps its text; the message does not.
        await game.until(lambda: any(failure in toast.message for toast in game.app._notifications))
        assert game.tick == 0

        # A search that the player left changes nothing.
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


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
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

        # The list says why a question can't be asked.
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Sensor(sensr:), 1 < 2"))
        await game.press("n")
        await game.until(lambda: game.tick == 10)
        await game.press("B")
        await game.until(lambda: isinstance(game.app.screen, BreakpointList))
        await game.sees("! This can't be asked: Sensor has no column sensr.")
        assert game.app.screen.query_one(OptionList).option_count == 2


async def test_what_was_asked_or_searched_last_is_stopped_at_and_pinned(
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

        await run_to(game, 12)
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

        await ask(AT)
        await game.sees("Ask · tick 3 · 1 row")
        await game.press("asterisk", "at")
        await game.sees("Pinned: ")
        assert list(game.session.breakpoints) == [Breakpoint("rows", AT)]
        view = game.main.query_one(WatchView)
        assert view.pins == (Pin(AT),)
        await game.press("escape", "left_parenthesis")
        for tick in (3, 9):
            await game.press("space")
            await game.until(
                partial(lambda tick: game.tick == tick and not game.session.busy, tick)
            )
        game.session.breakpoints.remove(Breakpoint("rows", AT))
        await game.press("right_parenthesis", "V")
        await game.until(lambda: view.has_focus and AT[:20] in view.plain)
        # A line of ticks: empty, but for the third, the fourth and the ninth.
        await game.until(lambda: "  ▁▁▁██▁▁▁▁█▁▁▁" in view.plain)
        await game.press("left")
        await game.until(lambda: game.tick == 10)
        await game.press("enter")
        await game.until(lambda: game.main.query_one(QueryLine).value == AT)
        await game.sees("Ask · tick 10")
