"""Ask, in the game: any query is answered for the tick on the screen."""

import asyncio
from pathlib import Path
from typing import Unpack

import pytest
from textual.widgets import Static

from logical_robots_tui.game import Frame, Inquiry
from logical_robots_tui.mind import Program, ResultTable
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.table import ValueTable
from logical_robots_tui.tui.layout.command_bar import CommandBar
from tests.short import AHEAD
from tests.tui.conftest import Awaited, Opened, Size, at_both_sizes, opened


def line(game: Opened) -> QueryLine:
    return game.main.query_one(QueryLine)


async def ask(game: Opened, query: str, **awaited: Unpack[Awaited]) -> None:
    if not line(game).has_focus:
        await game.press("slash", until=lambda: line(game).has_focus)
    line(game).value = query
    await game.press("enter", **awaited)


def answered(game: Opened) -> str:
    about = game.main.query_one("AskPage > .about", Static)
    return str(about.render()) if about.display else line(game).value


async def test_a_query_is_answered_and_follows_the_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        # It can be typed before the page for it is loaded.
        await game.press("slash", *"Robot", "enter", sees="Ask · tick 0 · 1 row")
        line(game).value = ""
        await ask(game, "Q(a, b) :- Robot(robot_name: a), b == a", sees="Ask · tick 0 · 1 row")
        await ask(game, "Sensor(sensor:), clock == 100 + sensor.clock", sees=" 100 ")
        await game.press("escape", "n", sees=("Ask · tick 1 · 1 row", " 101 "))

        # An answer stands with its own question while another one is typed.
        await ask(game, "1000 + 1", sees="1001")
        assert not game.main.query_one("AskPage > .about", Static).display, "the line says it"
        line(game).value = "1000 + 5"
        await game.sees("1000 + 5", "1001")
        assert answered(game) == "1000 + 1"
        await ask(game, "2 + 2", sees="       4")
        for key, earlier in (("up", "2 + 2"), ("up", "1000 + 1")):
            await game.press(key)
            await game.settled()
            assert line(game).value == earlier
        await game.press("down", "down", until=lambda: line(game).value == "")

        await ask(game, "x in Range(1001)", sees="first 1,000 rows, there are more: / narrows down")
        table = game.main.query_one("#answer", ValueTable)
        table.action_go(10_000, 0)
        await game.sees("there are more rows than these first 1,000")
        await ask(game, "x in Range(1001), x > 990", sees="Ask · tick 1 · 10 rows")
        assert not table.missing


@at_both_sizes
async def test_the_line_helps_and_says_what_is_wrong_in_a_query(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, text="Lighthouse(1);\n" + AHEAD, size=size, ready=True) as game:
        await game.press("slash", sees="Robot, Q(a, b) :- …")
        bar = game.main.query_one(CommandBar)
        await game.until(lambda: bar.render().plain.startswith(" enter Ask  ↑↓ Earlier"))
        assert "F5 Run" in bar.render().plain

        # Names are completed.
        await game.until(lambda: "Lighthouse" in line(game)._completion.words)
        await game.press(*"1 < 2, Lig", until=lambda: line(game)._suggestion == "1 < 2, Lighthouse")
        await game.press("right", until=lambda: line(game).value == "1 < 2, Lighthouse")

        # A mistake is shown at its place and changes nothing.
        await ask(game, "Sensor(robot_nam:)")
        await game.sees("Sensor has no column robot_nam.", "       ^^^^^^^^^")
        await game.sees("Did you mean robot_name?")
        assert (game.tick, line(game).value) == (0, "Sensor(robot_nam:)")
        line(game).value = "Sensor(r"
        await game.sees_no("Sensor has no column")
        await ask(game, 'x in ["a"], x.field == 2', sees="neither a record nor a list")
        await ask(game, "x in [1], x > 2", sees="No rows.")

        # The bar is clicked while one types.
        line(game).value = ""
        await game.click(CommandBar, offset=(2, 0))
        await game.press(*"1 < 2", "enter", "escape")
        await game.until(lambda: "enter Ask" not in bar.render().plain)


SLOW = (
    "Sensor(sensor:), a in sensor.radar, b in sensor.radar, c in sensor.radar, d in sensor.radar, "
    "e in sensor.radar, a.distance + b.distance + c.distance + d.distance + e.distance < 0"
)
LATE = "0 < 0"


async def test_a_question_can_be_stopped(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer = Inquiry.ask

    async def late(inquiry: Inquiry, program: Program, query: str, frame: Frame) -> ResultTable:
        if query == LATE:
            await asyncio.Event().wait()
        return await answer(inquiry, program, query, frame)

    monkeypatch.setattr(Inquiry, "ask", late)
    async with opened(data_dir, text=AHEAD, ready=True) as game:
        await ask(game, "1000 + 1", sees="1001")
        await ask(game, LATE, sees=" s  esc here stops it")
        screen = game.screen()
        assert any(sign in screen for sign in "▖▘▝▗")
        assert "1001" not in screen, "an old answer stands under a new question"
        assert answered(game) == LATE
        await game.until(lambda: game.screen() != screen)  # the time goes on
        await game.press("escape", sees="Stopped after ")
        assert line(game).has_focus
        assert line(game).value == LATE
        await ask(game, "1000 + 2", sees="1002")

        # Escape stops it from the list, too, also when the program is really at work.
        with game.impatient():
            await ask(game, SLOW, sees="esc here stops it")
        game.inspector.enter()
        await game.press("escape", sees="Stopped after ")
        assert game.inspector.has_focus_within
        await game.press("escape", until=lambda: game.main.labyrinth.has_focus)

        # Another question does not wait for the answer.
        await ask(game, LATE, sees="esc here stops it")
        await ask(game, "t == 700 + Max{sensor.clock :- Sensor(sensor:)}")
        await game.sees("Ask · tick 0 · 1 row")
        await game.press("escape", "n", sees=("701", "Ask · tick 1 · 1 row"))


ROWS = """
@Visible(Sensor, "own");
@Visible(Memory, "all");
Pair(1, "one"); Pair(2, "two");
Half(x) = x / 2;
Near(robot_name:, half: Half(n)) :- Sensor(robot_name:), n in [2, 4];
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :- Sensor(robot_name:);
"""
QUERIES = [
    # a query, its rows, keys in them, what is explained
    ("Near", 6, ("down", "down", "down", "enter"), 'Q: Near("Q", 2.0)'),
    ("Near(half:, robot_name:)", 6, ("end", "w"), 'R: Near(2.0, "R")'),
    ("Pair", 2, ("down", "enter"), 'R: Pair(2, "two")'),
    ("Near(half: h)", 6, ("enter",), "Why explains rows of"),
    ("Memory", 3, ("w",), "Why explains rows of"),
    ("Near", 6, ("J", "enter"), "Why explains rows of"),
]


async def test_the_row_under_the_cursor_is_explained(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=ROWS, ready=True) as game:
        for query, count, keys, words in QUERIES:
            await ask(game, query, sees=f"Ask · tick 0 · {count} rows")
            await game.press("escape", *keys, sees=words)
        game.inspector.open("Half")
        await game.sees("Half · tick 0 · 2 calls of R")
        await game.press("enter", "down", "enter", sees="R: Half(4.0, 2.0)")
