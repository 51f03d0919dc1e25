"""The graph of predicates is drawn without loose ends, and one goes along it."""

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.tui.inspector.predicate_graph import GraphView, joint
from tests.tui.conftest import opened

TEXT = """\
Ahead(robot_name:, d: sensor.forward_distance) :- Sensor(robot_name:, sensor:);
Near(robot_name:) :- Ahead(robot_name:, d:), d < 20;
Speed(robot_name:, v: 1 - d / 400) :- Ahead(robot_name:, d:), ~Near(robot_name:);
Slow(robot_name:) :- Memory(robot_name:, memory:), Near(robot_name:);
Mean(radar) = WeightedAverage { x.distance -> x.angle :- x in radar };
Robot(robot_name:, desire: {left_engine: v, right_engine: v}, memory: 2) :-
  Speed(robot_name:, v:);
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 1) :- Near(robot_name:);
"""


@given(st.integers(0, 9), st.integers(0, 9), st.integers(0, 9), st.booleans())
def test_lines_have_no_loose_ends(start: int, count: int, middle: int, to_right: bool) -> None:
    ends = range(start, start + count)
    joints = {row: joint(row, ends, middle, to_right=to_right) for row in range(-1, 20)}
    for row in range(-1, 19):
        assert ("s" in joints[row]) == ("n" in joints[row + 1]), "a line goes on"
    outer, inner = ("w", "e") if to_right else ("e", "w")
    assert {row for row, sides in joints.items() if outer in sides} == set(ends)
    assert [row for row, sides in joints.items() if inner in sides] == [middle] * bool(count)


async def test_one_goes_along_the_graph_and_opens_a_predicate(data_dir: Path) -> None:
    async with opened(data_dir, text=TEXT, ready=True) as game:
        await game.press("R", sees="Users → predicate")
        view = game.app.screen.query_one(GraphView)
        assert view.middle == "Robot", "the page of robots is no predicate"
        await game.sees("nobody     • Robot ─┬▶ • Speed", "╰▶ • Near")
        await game.press("right", "down", "right")
        await game.until(lambda: view.middle == "Near" and game.shows("─┼▶ • Near ──▶ • Ahead"))
        assert [name in view.plain for name in ("Speed", "Slow", "Robot")] == [True] * 3
        await game.press("right", until=lambda: view.chosen_name == "Ahead")
        speed = next(n for n, line in enumerate(view.plain.splitlines()) if "Speed" in line)
        await game.click(GraphView, offset=(3, speed), until=lambda: view.middle == "Speed")
        await game.press("right", "up", "enter", until=lambda: game.inspector.inspected == "Ahead")
        await game.sees("Ahead · tick 0 · 1 row")
        await game.press("R", sees="Users → predicate")
        view = game.app.screen.query_one(GraphView)
        assert view.middle == "Ahead", "it begins with what is inspected"
        view.centre("WeightedAverage")
        await game.sees("• Mean ──▶ ◦ WeightedAverage")
        await game.press("enter", sees="It is in the prelude.")
        assert game.inspector.inspected == "Ahead"
