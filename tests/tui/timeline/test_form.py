"""Questions through time, in the game: searched for, stopped at, and watched."""

from pathlib import Path

import pytest
from textual.widgets import Input, OptionList

from logical_robots_tui.game import EVENTS, Breakpoint, Pin
from logical_robots_tui.mind import Mind
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.timeline import breakpoints
from logical_robots_tui.tui.timeline.breakpoints import BreakpointForm, BreakpointList
from tests.tui.conftest import Opened, Size, at_both_sizes, opened
from tests.tui.timeline.test_widget import TURNS
from tests.virtual_time import Hold

AT = "Sensor(sensor:), t == sensor.clock, t in [3, 4, 9]"


async def search(game: Opened, question: str) -> None:
    await game.press("Q", on=breakpoints.QuestionPrompt)
    game.app.screen.query_one(Input).value = question
    await game.press("enter")


@at_both_sizes
async def test_the_ticks_in_which_a_question_holds_are_gone_through(
    data_dir: Path, short: Path, size: Size, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(data_dir, level=short, text=TURNS, size=size, ready=True) as game:
        await game.run_until(12)
        # The first repetition asks for the question.
        await game.press("left_parenthesis", "semicolon", on=breakpoints.QuestionPrompt)
        await game.press("escape", until=lambda: game.app.screen is game.main)
        assert game.tick == 0

        # A wrong one says what is wrong and can be mended.
        await search(game, "Sensor(sensr:)")
        await game.sees("Sensor has no column sensr.")
        game.app.screen.query_one(Input).value = AT
        await game.sees_no("Sensor has no column sensr.")
        await game.press("enter", tick=3)
        await game.press("semicolon", tick=9)
        await game.press("semicolon", sees="No other tick after 9")
        await game.press("colon", tick=4)
        await game.press("colon", sees="No other tick before 4")
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
        await game.press("n", "n", tick=2)
        hold.release()
        await game.until(lambda: all(w.is_finished for w in game.main.workers if w.group == "seek"))
        assert game.tick == 2
        await game.sees_no("No tick after")


@at_both_sizes
async def test_a_breakpoint_is_made_of_known_names(data_dir: Path, short: Path, size: Size) -> None:
    async with opened(data_dir, level=short, text=TURNS, size=size, ready=True) as game:
        await game.press("B", "a", on=BreakpointForm, sees="Sensor Memory Near Robot")
        await game.press("enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Ner", "enter", sees="The program has no predicate Ner.")
        await game.press("backspace", *"a")
        await game.until(lambda: game.app.screen.query_one("#subject", Input)._suggestion)
        await game.press("right", "enter", on=BreakpointList)
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]
        await game.press("a", on=BreakpointForm)
        events = game.app.screen.query_one(OptionList)
        events.highlighted = list(EVENTS).index("change")
        await game.until(lambda: game.app.screen.query_one("#column").display)
        await game.press("enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Near", "tab", *"Pip", "tab", *"robot_name", "enter", on=BreakpointList)
        assert game.session.breakpoints.on[1] == Breakpoint("change", "Near", "Pip", "robot_name")

        # It can be any question.
        await game.press("a", on=BreakpointForm)
        await game.press("enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        subject = game.app.screen.query_one("#subject", Input)
        subject.value = "Sensor(sensr:)"
        await game.press("enter", sees="Sensor has no column sensr.")
        subject.value = AT
        await game.press("enter", on=BreakpointList)
        assert game.session.breakpoints.on[2] == Breakpoint("rows", AT)
        await game.sees_no("!")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        await game.press("space", until=lambda: game.tick == 3 and not game.session.busy)
        await game.sees("Stopped at tick 3.")
        await game.press("space", until=lambda: game.tick == 9 and not game.session.busy)

        # The list says why a question can't be asked.
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Sensor(sensr:), 1 < 2"))
        await game.press("n", tick=10)
        await game.press("B", on=BreakpointList)
        await game.sees("! This can't be asked: Sensor has no column sensr.")
        assert game.app.screen.query_one(OptionList).option_count == 4


async def test_the_last_question_is_stopped_at_and_pinned(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=TURNS, ready=True) as game:

        async def ask(question: str) -> None:
            await game.press("slash", until=lambda: isinstance(game.main.focused, QueryLine))
            game.main.query_one(QueryLine).value = question
            await game.press("enter", sees="Ask · tick")
            await game.press("escape")

        async def stops_at(question: str) -> None:
            await game.press("asterisk")
            await game.until(lambda: [*game.session.breakpoints] == [Breakpoint("rows", question)])
            game.session.breakpoints.remove(Breakpoint("rows", question))

        await game.run_until(12)
        await ask("sensor.clock > 1")
        await game.press("left_parenthesis")
        await search(game, AT)
        await game.until(lambda: game.tick == 3)
        await stops_at(AT)
        await ask("sensor.clock > 2")
        await stops_at("sensor.clock > 2")
        await game.press("colon", sees="No other tick before 3")
        await stops_at(AT)

        await ask(AT)
        await game.sees("Ask · tick 3 · 1 row")
        await game.press("asterisk", "at", sees="Pinned: ")
        assert list(game.session.breakpoints) == [Breakpoint("rows", AT)]
        view = game.main.query_one(WatchView)
        assert view.pins == (Pin(AT),)
        await game.press("escape", "left_parenthesis")
        for tick in (3, 9):
            await game.press("space", tick=tick, until=lambda: not game.session.busy)
        game.session.breakpoints.remove(Breakpoint("rows", AT))
        await game.press("right_parenthesis", "V")
        await game.until(lambda: view.has_focus and AT[:20] in view.plain)
        # A line of ticks: empty, but for the third, the fourth and the ninth.
        await game.until(lambda: "  ▁▁▁██▁▁▁▁█▁▁▁" in view.plain)
        await game.press("left", tick=10)
        await game.press("enter", until=lambda: game.main.query_one(QueryLine).value == AT)
        await game.sees("Ask · tick 10")
