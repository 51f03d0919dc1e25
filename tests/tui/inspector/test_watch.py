"""Pins: their values at the tick on the screen, how they went, and values as trees."""

from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from textual.widgets import OptionList, Tree

from logical_robots_tui.game import Pin
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.inspector.plots import BARS, PlotSample, sparkline
from logical_robots_tui.tui.inspector.table import ValueTable
from tests.tui.conftest import PAPER, Opened, opened

TEXT = """\
Late(x) :- Sensor(sensor:), sensor.clock > 20, x in [1, 2, 3];
Ray(robot_name:, i: x.angle, d: x.distance) :- Sensor(robot_name:, sensor:), x in sensor.radar;
Robot(robot_name:, desire: {left_engine: 0.2, right_engine: 0.2},
      memory: {phase: (if sensor.clock < 12 then "early" else "late"), deep: {n: sensor.clock}}) :-
  Sensor(robot_name:, sensor:);
"""

SAMPLES = st.builds(
    PlotSample,
    st.none() | st.floats(allow_nan=False, allow_infinity=False),
    st.none() | st.integers(),
)


@example([PlotSample(0.0, None), PlotSample(5e-324, None)], False, False)
@given(st.lists(st.none() | SAMPLES), st.booleans(), st.booleans())
def test_each_tick_has_a_character(
    samples: list[PlotSample | None], counts: bool, plain: bool
) -> None:
    line = sparkline(samples, counts=counts, plain=plain)
    assert len(line) == len(samples)
    assert not plain or line.isascii()
    for sample, character in zip(samples, line, strict=True):
        assert (character == " ") == (sample is None)
    if not plain:
        numbers = [s.number for s in samples if s is not None and s.number is not None]
        heights = [BARS.index(character) for character in line if character in BARS]
        pairs = pairwise(zip(numbers, heights, strict=True))
        for (one, height), (other, further) in pairs:
            assert (height - further) * (one - other) >= 0, "a higher bar is no lower number"


def test_what_is_not_a_number_shows_where_it_changes() -> None:
    told = [*[PlotSample(None, 1)] * 2, PlotSample(None, 2), None, PlotSample(None, None)]
    assert sparkline(told, counts=False) == "──┼ ·"
    assert sparkline(told, counts=False, plain=True) == "--| ."
    assert sparkline([PlotSample(3, 1)] * 2, counts=True) == "██"
    assert sparkline([PlotSample(3, 1)] * 2, counts=False) == "▄▄"
    assert sparkline([PlotSample(0, 1), PlotSample(1, 2)], counts=False) == "▁█"


def view(game: Opened) -> WatchView:
    return game.main.query_one(WatchView)


async def inspect(game: Opened, name: str, counted: str) -> ValueTable:
    choice = game.main.query_one("#choice", OptionList)
    await game.until(lambda: name in [option.id for option in choice.options])
    game.inspector.open(name)
    await game.sees(counted)
    await game.press("enter")
    table = game.main.query_one("#rows", ValueTable)
    await game.until(lambda: table.has_focus)
    return table


@pytest.mark.slow
async def test_pins_are_watched_gone_along_opened_and_removed(data_dir: Path) -> None:
    async with opened(data_dir, text=TEXT, ready=True) as game:
        await game.press("V", sees="Nothing is pinned.")
        await game.press("left", "right", "enter", "delete", "@")
        await game.run_until(40)

        # A number of rows, one row among many, a part of a memory.
        await inspect(game, "Ray", "Ray · tick 40 · 31 rows")
        await game.press("down", "right", "right", "at", until=lambda: len(view(game).pins) == 1)
        pin = view(game).pins[0]
        assert (pin.predicate, pin.column) == ("Ray", "d")
        assert [name for name, _ in pin.where] == ["robot_name", "i"]
        game.inspector.open("Late")
        await game.sees("Late · tick 40 · 3 rows")
        game.inspector.enter()
        await game.press("at")
        await inspect(game, "Memory", "Memory · tick 40 · 1 row")
        await game.press("right", "X", sees="enter or space fold")
        tree = game.app.screen.query_one(Tree)
        await game.until(lambda: len(tree.root.children[0].children) == 2)
        await game.press("down", "down", "enter", sees="n  39")
        await game.press("up", "at", "down", "down", "at", "escape")
        await game.until(lambda: len(view(game).pins) == 4)
        whose = (("robot_name", "Solo"),)
        parts = (Pin("Memory", "memory", whose, path) for path in (("phase",), ("deep", "n")))
        assert view(game).pins[1:] == (Pin("Late"), *parts)

        await game.press("V", until=lambda: game.inspector.inspected == "watch")
        line = "▁" * 20 + "█" * 20
        await game.until(lambda: line in view(game).plain)
        await game.until(lambda: "Memory.memory.phase for Solo" in view(game).plain)
        await game.until(lambda: f"··┼{'─' * 10}┼{'─' * 27}" in view(game).plain)

        # A click on a line goes to its tick, and keys to where a value changes.
        row = next(n for n, s in enumerate(view(game).plain.splitlines()) if "Late: rows" in s)
        await game.click(WatchView, offset=(2 + 20, row + 1 - view(game).scroll_offset.y))
        await game.until(lambda: game.tick == 20)
        await game.until(lambda: view(game).plain.splitlines()[row].endswith(" 0"))
        await game.press("right", tick=21)
        await game.until(lambda: view(game).plain.splitlines()[row].endswith(" 3"))
        assert line in view(game).plain, "the line stays where it is"
        await game.press("down", "left", tick=13)
        await game.until(lambda: game.shows('"late"') or game.shows(" late "))

        # A program without the predicate says so in place; the pin is still there afterwards.
        await game.write(PAPER, until=lambda: "no predicate Late" in view(game).plain)
        await game.sees("by the current program")
        await game.write(TEXT, until=lambda: line in view(game).plain)
        await game.sees_no("by the current program")

        # Another drawing has nothing to do with it, but plain characters have.
        labyrinth = game.main.labyrinth.view
        while (drawing := labyrinth.drawing).value != "ascii":
            await game.press("d", until=lambda: labyrinth.drawing != drawing)
        await game.press("p", until=lambda: f"{'_' * 20}{'#' * 20}" in view(game).plain)
        await game.press("delete", "up", "enter", until=lambda: len(view(game).pins) == 3)
        await game.sees("Late · tick 12 · 0 rows")
        await game.press("3", "at", until=lambda: Pin("Late") not in view(game).pins)


async def test_a_decision_is_looked_into_and_its_parts_are_pinned(data_dir: Path) -> None:
    async with opened(data_dir, text=TEXT, size=(100, 40), ready=True) as game:
        await game.press("n", "at", tick=1, until=lambda: view(game).pins)
        assert view(game).pins == (Pin("Memory", "memory", (("robot_name", "Solo"),)),)
        await game.press("X")
        tree = await _tree(game)
        names = [str(node.label).split("  ")[0] for node in tree.root.children]
        assert names == ["sensor", "memory before", "desire", "memory after"]
        await game.sees("left_engine  0.2")
        parts = tree.root.children[0].children
        radar = next(part for part in parts if str(part.label).startswith("radar"))
        tree.move_cursor(radar)
        await game.until(lambda: game.app.screen.query_one("#radar").display)
        await game.press("enter", until=lambda: len(radar.children) == 31)
        tree.move_cursor(tree.root.children[2].children[0])
        await game.until(lambda: not game.app.screen.query_one("#radar").display)
        await game.press("at", "escape", "V")
        await game.until(lambda: "Robot.desire.left_engine for Solo" in view(game).plain)
        await game.until(lambda: "for Solo" in view(game).plain and "▄▄ 0.2" in view(game).plain)
        await game.press("space", until=lambda: game.tick > 9)
        await game.press("space", until=lambda: not game.session.busy)
        await game.sees(f"Watch · tick {game.tick}")
        pin = view(game).pins[1]
        await game.until(lambda: None not in view(game)._samples.lookup(pin, view(game).ticks))

        # A pin is removed where it is watched by the key that made it.
        await game.press("home", "at", sees="No longer pinned: Memory.memory for Solo.")
        assert view(game).pins == (pin,)


@pytest.mark.slow
async def test_long_lists_are_folded_and_of_answers_questions_are_pinned(data_dir: Path) -> None:
    text = f"{PAPER}\nLong(l: Range(250));\n"
    async with opened(data_dir, text=text, ready=True) as game:
        await inspect(game, "Long", "Long · tick 0 · 1 row")
        await game.press("X")
        tree = await _tree(game)
        groups = tree.root.children[0]
        await game.until(lambda: len(groups.children) == 3)
        ranges = [str(group.label).strip() for group in groups.children]
        assert ranges == ["0 to 99", "100 to 199", "200 to 249"]
        group = groups.children[2]
        group.expand()
        await game.until(lambda: len(group.children) == 50 and group.children[49].line > 0)
        last = group.children[49]
        tree.move_cursor(last)
        await game.until(lambda: tree.cursor_node is last)
        await game.press("at", until=lambda: view(game).pins == (Pin("Long", "l", (), (249,)),))
        tree.move_cursor(group)
        await game.until(lambda: tree.cursor_node is group)
        await game.press("at", sees="Only a value of a predicate can be pinned.")
        await game.press("escape")
        game.inspector.go_to("ask")
        game.main.query_one(QueryLine).value = "Long(l:)"
        await game.press("enter")
        answer = game.main.query_one("#answer", ValueTable)
        await game.until(lambda: answer.shown.rows)
        answer.focus()
        await game.press("at", until=lambda: view(game).pins[1:] == (Pin("Long(l:)"),))
        await game.press("X")
        await _tree(game)
        await game.press("at")
        await game.settled()
        assert len(view(game).pins) == 2
        await game.press("escape")
        game.inspector.open("Nowhere")
        await game.sees("The program has no predicate Nowhere.")


async def _tree(game: Opened) -> Tree[object]:
    await game.until(lambda: game.app.screen.query(Tree))
    return game.app.screen.query_one(Tree)
