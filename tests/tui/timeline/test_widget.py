"""Travelling in time on the screen, by commands, mouse and questions; stops, and what is said."""

from pathlib import Path
from typing import Unpack

import pytest
from textual.widgets import Input, OptionList

from logical_robots_tui.game import EVENTS, Breakpoint, Pin
from logical_robots_tui.mind import Mind
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.timeline import breakpoints, controller
from logical_robots_tui.tui.timeline.breakpoints import BreakpointForm, BreakpointList, TickPrompt
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.world import load_level
from tests.tui.conftest import STILL, Awaited, Opened, Size, at_both_sizes, opened
from tests.virtual_time import Hold

TURNS = """\
Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 12;
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: sensor.clock > 5) :-
  Sensor(robot_name:, sensor:);
"""


async def asked(game: Opened, key: str, text: str, **awaited: Unpack[Awaited]) -> None:
    await game.press(key, on=TickPrompt)
    await game.press(*text, "enter", **awaited)


def line(game: Opened) -> str:
    return game.main.query_one(Timeline).render().plain


async def test_one_goes_to_ticks_by_keys_by_their_number_and_by_mouse(
    data_dir: Path, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(data_dir, level=short, text=TURNS, ready=True) as game:
        await game.press("N", "n")  # a step pressed during ten takes none away
        await game.until(lambda: game.tick in (10, 11) and not game.session.busy)
        await game.press("left_parenthesis", tick=0)
        for key, tick in [("N", 10), ("N", 20), ("n", 21), ("P", 11), ("left_parenthesis", 0)]:
            await game.press(key, tick=tick, until=lambda: not game.session.busy)
        await game.press("P", "right_parenthesis", tick=21)
        await game.until(lambda: "tick 21 of 21" in line(game))

        # A tick that is not there says which are, and one into the past is refused.
        await asked(game, "g", "300", sees="The history holds ticks 0 to 21, not 300.")
        game.app.screen.query_one(Input).value = "-8"
        await game.press("enter", until=lambda: game.app.screen is game.main and game.tick == 13)
        await asked(game, "g", "soon", sees="A tick is a number")
        await game.press("escape")
        await asked(game, "U", "30", until=lambda: game.tick == 30 and not game.session.busy)
        await asked(game, "U", "9", sees="The robots are already at tick 30.")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        assert game.tick == 30

        # So do a click and a drag on the timeline.
        await game.click(Timeline, offset=(13, 0), until=lambda: game.tick == 12)
        await game.pilot.mouse_down(Timeline, offset=(21, 0))
        await game.until(lambda: game.tick == 20)
        for column, tick in ((6, 5), (60, 30)):
            await game.pilot.hover(Timeline, offset=(column, 0))
            await game.press(tick=tick)
        await game.pilot.mouse_up(Timeline, offset=(60, 0))
        await game.pilot.hover(Timeline, offset=(4, 0))
        await game.click(Timeline, offset=(50, 0), sees="Tick 49 is not in history")
        assert game.tick == 30

        # A drag there and back counts before it is drawn.
        await game.until(lambda: "tick 30 of 30" in line(game))
        with monkeypatch.context() as patch:
            patch.setattr(Timeline, "show", lambda *_: None)
            await game.pilot.mouse_down(Timeline, offset=(6, 0))
            await game.until(lambda: game.tick == 5)
            await game.pilot.hover(Timeline, offset=(31, 0))
            await game.until(lambda: game.tick == 30)
            await game.pilot.mouse_up(Timeline, offset=(31, 0))

        # The timeline is driven with keys.
        await game.press("T", until=lambda: game.main.timeline.has_focus)
        ticks = {"left": 29, "pageup": 19, "right": 20, "home": 0, "pagedown": 10, "end": 30}
        for key, tick in ticks.items():
            await game.press(key, tick=tick)
        game.main.labyrinth.view.selected = "Pip"
        await game.press("up", tick=6)
        await game.press("down", sees="No event after tick 6. Events are")
        await game.press("escape", until=lambda: game.main.labyrinth.has_focus)


@at_both_sizes
async def test_a_swarm_without_choice_is_counted(data_dir: Path, short: Path, size: Size) -> None:
    level = load_level("04-everybody-home")
    home = next(area for area in level.areas if area.victory_robots)
    there = {level.robots[0].name: (home.x, home.y, 0.0)}
    async with opened(data_dir, level=short, text=TURNS, size=size, ready=True) as game:
        await game.app.main.player.library.open_level(level)
        await game.until(lambda: f" · 0/3 in {home.name}" in line(game))
        await game.until(lambda: game.session.game is not None)
        game.session.change_level(level, there)
        await game.press("n", tick=1)
        await game.press("n", until=lambda: f" · 1/3 in {home.name}" in line(game))
        await game.press("n")
        game.main.labyrinth.view.selected = level.robots[0].name
        game.main.redraw_lines()
        await game.until(lambda: "/3 in" not in line(game))
        # Where all goals are needed, they count together.
        await game.app.main.player.library.open_level(load_level("14-right-of-way"))
        await game.until(lambda: line(game).endswith(" · 0/6 in goals"))


async def test_a_run_until_a_tick_can_be_stopped(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=STILL, ready=True) as game:
        await asked(game, "U", "5000", until=lambda: game.tick > 5 and "RUNNING" in game.status)
        await game.press("space", until=lambda: not game.session.busy and "PAUSED" in game.status)

        # The timeline is drawn once for ticks that change nothing in it.
        await game.later(1)
        before = game.main.timeline.render()
        game.main.timeline.show(game.session, None)
        assert game.main.timeline.render() is before


@pytest.mark.slow
async def test_marks_are_gone_to_one_after_the_other(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=TURNS, ready=True) as game:
        await game.press("space", sees="Again")
        won_at = game.tick
        await game.press("escape", "left_parenthesis", "right_curly_bracket")
        await game.until(lambda: game.tick == won_at and "★ won" in line(game))
        game.main.labyrinth.view.selected = "Pip"
        await game.press("left_curly_bracket", tick=6)
        await game.until(lambda: f"tick 6 of {won_at}  ┷ Pip" in line(game))
        await game.press("left_curly_bracket", tick=1)
        await game.press("left_curly_bracket", sees="No event before tick 1. Events are")


async def test_an_old_future_is_kept_compared_and_gone_over_to(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=TURNS, ready=True) as game:
        await game.press("F", sees="There is no other branch yet")
        await game.run_until(30)
        await asked(game, "g", "10", until=lambda: game.tick == 10)
        await game.apply(TURNS.replace("sensor.clock > 5", "sensor.clock > 15"))
        await game.press("escape", "n", tick=11, until=lambda: "┄" in line(game))
        assert "≠" in line(game)
        await game.press("N", tick=21)
        await game.press("C", sees="The two branches differ from tick 11")
        for words in ("memory", "here   false", "there  true"):
            await game.until(lambda words=words: game.shows(words))  # type: ignore[misc]  # a default
        await game.until(lambda: game.shows("The proofs of what Pip decides differ:"))
        await game.sees("here     memory: sensor.clock > 15 = false")
        await game.sees("there    memory: sensor.clock > 5 = true")
        await game.press("escape", until=lambda: game.app.screen is game.main and game.tick == 11)
        await game.press("F", sees="This is the other branch.")
        assert game.session.frame.memories == {"Pip": True}
        assert game.session.program is not None
        assert game.session.program.text == TURNS
        await game.sees("not applied")
        await game.press("right_parenthesis", tick=30)


async def test_a_run_stops_at_a_breakpoint_and_says_at_which(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=TURNS, ready=True) as game:
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        await game.sees("The robots stop when Near has rows.")
        game.main.timeline_controller.add_breakpoint(Breakpoint("enters", "Door"))
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Gone"))
        await game.press("space", until=lambda: game.tick == 13 and not game.session.running)
        await game.sees("Stopped at tick 13. Near has rows")
        await game.until(lambda: 'tick 13 of 13  ◉ Near has rows: "Pip"' in line(game))

        await game.press("n", "n", tick=15)
        await game.press("left_curly_bracket", tick=13)

        # They are listed, switched off and deleted.
        await game.press("B", on=BreakpointList, sees="◉ a robot enters Door")
        assert game.shows("◉ Near has rows")
        assert game.shows("! The program has no predicate Gone.")
        await game.press("home", "space", sees="○ Near has rows")
        await game.press("down", "down", "d")
        await game.until(lambda: game.app.screen.query_one(OptionList).option_count == 2)
        await game.press("escape", until=lambda: game.app.screen is game.main)
        names = [breakpoint_.subject for breakpoint_ in game.session.breakpoints]
        assert names == ["Near", "Door"]

        # A restart under the same program goes through what is known, past the one that is off.
        await game.press("r", tick=0)
        await game.press("space", until=lambda: game.tick > 16)
        await game.press("space", until=lambda: not game.session.busy)
        assert game.session.history is not None
        assert game.session.history.other_ticks is None


async def test_a_notice_is_told_beside_its_tick(data_dir: Path, short: Path) -> None:
    near, rule = TURNS.split("\n", 1)
    text = f"{near}\n{rule}{rule.replace('Sensor(robot_name:, sensor:)', 'Near(robot_name:)')}"
    text = text.replace("sensor.clock > 5", "1")
    async with opened(data_dir, level=short, text=text, ready=True) as game:
        await game.run_until(13)
        await game.until(lambda: "tick 13  ! Robot has 2 rows for Pip, wh…" in line(game))


async def test_nothing_of_this_hurts_before_there_is_a_program(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text="nonsense(", ready=True) as game:
        await game.press("N", "P", "left_parenthesis", "right_parenthesis", "g", "U", "F", "C")
        await game.press("left_curly_bracket", "right_curly_bracket", "w")
        await game.sees("There is no program yet.", "There is no program to query yet.")
        await game.press("v", sees="No earlier versions yet")
        assert game.tick == 0
        game.main.timeline_controller.add_breakpoint(Breakpoint("rows", "Near"))
        assert list(game.session.breakpoints) == [Breakpoint("rows", "Near")]


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
        monkeypatch.setattr(controller, "_PATIENCE", -1.0)
        await game.press("enter", tick=3)
        await game.press("semicolon", tick=9)
        await game.press("semicolon", sees="No other tick after 9")
        assert not any("Searching" in toast.message for toast in game.app._notifications)
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
        game.app.screen.query_one(OptionList).highlighted = list(EVENTS).index("change")
        await game.until(lambda: game.app.screen.query_one("#column").display)
        await game.press("enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        await game.press(*"Near", "tab", *"Pip", "tab", *"robot_name", "enter", on=BreakpointList)
        assert game.session.breakpoints.enabled[1] == Breakpoint(
            "change", "Near", "Pip", "robot_name"
        )

        # It can be any question.
        await game.press("a", on=BreakpointForm)
        await game.press("enter", until=lambda: game.app.screen.query_one("#subject").has_focus)
        subject = game.app.screen.query_one("#subject", Input)
        subject.value = "Sensor(sensr:)"
        await game.press("enter", sees="Sensor has no column sensr.")
        subject.value = AT
        await game.press("enter", on=BreakpointList)
        assert game.session.breakpoints.enabled[2] == Breakpoint("rows", AT)
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
