"""What of a proof can be seen in the labyrinth."""

from dataclasses import replace

from logical_robots_tui.explain import ProofNode
from logical_robots_tui.tui.inspector.pages.why import sight
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.world import Robot
from tests.tui.labyrinth.drawing.scenes import room, start

FRAME = start(room(robots=(Robot("Ann", 60, 100), Robot("Bob", 300, 150, 2.0))))
RADAR = {row["robot_name"]: row["sensor"]["radar"] for row in FRAME.sensors}


def test_a_ray_is_seen_wherever_its_value_comes_up_and_a_robot_where_it_is_asked_about() -> None:
    for name in ("Ann", "Bob"):
        ray = RADAR[name][4]
        node = ProofNode("column", "ray", values=({**ray, "angle": ray["angle"] + 1e-15},))
        assert sight(node, name, FRAME) == Highlight(name, ray["angle"])
    ray = next(ray for ray in RADAR["Bob"] if ray not in RADAR["Ann"])
    node = ProofNode("value", "ray", values=(ray,))
    assert sight(node, "Ann", FRAME) == Highlight("Bob", ray["angle"])
    node = ProofNode("call", "Sensor(robot_name:)", robot="Bob")
    assert sight(node, "Ann", FRAME) == Highlight("Bob")


def test_what_is_not_a_ray_of_this_tick_is_not_seen() -> None:
    ray = RADAR["Ann"][4]
    for value in (ray["angle"], None, RADAR["Ann"], {**ray, "distance": ray["distance"] + 1}):
        assert sight(ProofNode("value", "x", values=(value,)), "Ann", FRAME) is None
    examples = ProofNode("value", "ray", values=(ray, RADAR["Ann"][5]))
    assert sight(examples, "Ann", FRAME) is None, "one of several is not what the cursor is on"
    assert sight(replace(examples, values=()), "Ann", FRAME) is None
