"""Questions through time, in the game: searched for, stopped at, and watched."""

from pathlib import Path

import pytest
from textual.widgets import Input, OptionList

from logical_robots_tui.game import EVENTS, Breakpoint, Pin
from logical_robots_tui.mind import Mind
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.timeline.breakpoints import (
    BreakpointForm,
    BreakpointList,
    QuestionPrompt,
)
from tests.tui.conftest import Opened
from tests.tui.inspector.steps import pressed, run_until
from tests.tui.timeline.test_widget import playing
from tests.virtual_time import Hold

CLOCK = "Sensor(sensor:), t == sensor.clock, "
AT = f"{CLOCK}t in [3, 4, 9]"


async def search(game: Opened, question: str) -> None:
    """Type a question to search for, as a player does."""
    await pressed(game, "Q", on=QuestionPrompt)
    game.app.screen.query_one(Input).value = question
    await game.press("enter")


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
async def test_the_ticks_in_which_a_question_holds_are_gone_through(
    data_dir: Path, short: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await run_until(game, 12)
        # The first repetition asks for the question.
        await pressed(game, "left_parenthesis", "semicolon", on=QuestionPrompt)
        await pressed(game, "escape", until=lambda: game.app.screen is game.main)
        assert game.tick == 0

        # A wrong one says what is wrong and can be mended.
        await search(game, "Sensor(sensr:)")
        await game.sees("Sensor has no column sensr.")
        game.app.screen.query_one(Input).value = AT
        await game.sees_no("Sensor has no column sensr.")
        await pressed(game, "enter", tick=3)
        await pressed(game, "semicolon", tick=9)
        await pressed(game, "semicolon", sees="No other tick after 9")
        await pressed(game, "colon", tick=4)
        await pressed(game, "colon", sees="No other tick before 4")
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
        await pressed(game, "n", "n", tick=2)
        hold.release()
        await game.until(lambda: all(w.is_finished for w in game.main.workers if w.group == "seek"))
        assert game.tick == 2
        await game.sees_no("No tick after")


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
async def test_a_breakpoint_is_made_with_the_names_that_there_are(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    async with playing(data_dir, short, size=size) as game:
        await pressed(game, "B", "a", on=BreakpointForm, sees="Sensor Memory Near Robot")
        await pressed(game, "enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        await pressed(game, *"Ner", "enter", sees="The program has no predicate Ner.")
        await game.press("backspace", *"a")
        await game.until(lambda: game.app.screen.query_one("#subject", Input)._suggestion)
        await pressed(game, "right", "enter", on=BreakpointList)
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]
        await pressed(game, "a", on=BreakpointForm)
        events = game.app.screen.query_one(OptionList)
        events.highlighted = list(EVENTS).index("change")
        await game.until(lambda: game.app.screen.query_one("#column").display)
        await pressed(game, "enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Near", "tab", *"Pip", "tab", *"robot_name")
        await pressed(game, "enter", on=BreakpointList)
        assert game.session.breakpoints.on[1] == Breakpoint("change", "Near", "Pip", "robot_name")

        # It can be any question.
        await pressed(game, "a", on=BreakpointForm)
        await pressed(game, "enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        subject = game.app.screen.query_one("#subject", Input)
        subject.value = "Sensor(sensr:)"
        await pressed(game, "enter", sees="Sensor has no column sensr.")
        subject.value = AT
        await pressed(game, "enter", on=BreakpointList)
        assert game.session.breakpoints.on[2] == Breakpoint("rows", AT)
        await game.sees_no("!")
        await pressed(game, "escape", until=lambda: game.app.screen is game.main)
        await pressed(game, "space", until=lambda: game.tick == 3 and not game.session.busy)
        await game.sees("Stopped at tick 3.")
        await pressed(game, "space", until=lambda: game.tick == 9 and not game.session.busy)

        # The list says why a question can't be asked.
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Sensor(sensr:), 1 < 2"))
        await pressed(game, "n", tick=10)
        await pressed(game, "B", on=BreakpointList)
        await game.sees("! This can't be asked: Sensor has no column sensr.")
        assert game.app.screen.query_one(OptionList).option_count == 4


async def test_what_was_asked_or_searched_last_is_stopped_at_and_pinned(
    data_dir: Path, short: Path
) -> None:
    async with playing(data_dir, short) as game:

        async def ask(question: str) -> None:
            await pressed(game, "slash", until=lambda: isinstance(game.main.focused, QueryLine))
            game.main.query_one(QueryLine).value = question
            await pressed(game, "enter", sees="Ask · tick")
            await game.press("escape")

        async def stops_at(question: str) -> None:
            await game.press("asterisk")
            await game.until(lambda: [*game.session.breakpoints] == [Breakpoint("rows", question)])
            game.session.breakpoints.remove(Breakpoint("rows", question))

        await run_until(game, 12)
        await ask("sensor.clock > 1")
        await game.press("left_parenthesis")
        await search(game, AT)
        await game.until(lambda: game.tick == 3)
        await stops_at(AT)
        await ask("sensor.clock > 2")
        await stops_at("sensor.clock > 2")
        await pressed(game, "colon", sees="No other tick before 3")
        await stops_at(AT)

        await ask(AT)
        await game.sees("Ask · tick 3 · 1 row")
        await pressed(game, "asterisk", "at", sees="Pinned: ")
        assert list(game.session.breakpoints) == [Breakpoint("rows", AT)]
        view = game.main.query_one(WatchView)
        assert view.pins == (Pin(AT),)
        await game.press("escape", "left_parenthesis")
        for tick in (3, 9):
            await pressed(game, "space", tick=tick, until=lambda: not game.session.busy)
        game.session.breakpoints.remove(Breakpoint("rows", AT))
        await game.press("right_parenthesis", "V")
        await game.until(lambda: view.has_focus and AT[:20] in view.plain)
        # A line of ticks: empty, but for the third, the fourth and the ninth.
        await game.until(lambda: "  ▁▁▁██▁▁▁▁█▁▁▁" in view.plain)
        await pressed(game, "left", tick=10)
        await pressed(game, "enter", until=lambda: game.main.query_one(QueryLine).value == AT)
        await game.sees("Ask · tick 10")
