"""The lines of a proof: what is folded and has room, and what is seen in the labyrinth."""

from dataclasses import replace

import pytest

from logical_robots_tui.explain import Ask, ProofNode
from logical_robots_tui.tui.inspector.pages.why import sight
from logical_robots_tui.tui.inspector.proof import ProofLine, ProofTree, line_content
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.world import Robot
from tests.tui.labyrinth.drawing.scenes import room, start


def many(count: int) -> ProofNode:
    waiting: list[ProofNode] = [ProofNode("value", f"v{n}", values=(n,)) for n in range(count)]
    while len(waiting) > 10:
        waiting = [
            ProofNode("call", f"c{n}", children=tuple(waiting[n : n + 10]))
            for n in range(0, len(waiting), 10)
        ]
    return ProofNode("rule", "Many(x)", holds=True, children=tuple(waiting))


def shown(node: ProofNode) -> ProofTree:
    folds = ProofTree()
    folds.show([node], [], 10_000)
    return folds


def nodes(folds: ProofTree) -> list[ProofNode]:
    return [line.node for line in folds.lines]


def test_what_is_open_is_what_there_is_room_for() -> None:
    folds = ProofTree()
    folds.show([many(1000)], [many(10)], 30)
    assert 20 < len(folds.lines) <= 30
    assert folds.is_open(folds.lines[0])
    assert not folds.is_open(folds.lines[-1]), "the rest is folded"
    other = ProofNode("derivation", "Derivation 2", children=many(3).children)
    folds.show([replace(many(10), children=(other,))], [], 30)
    assert len(folds.lines) == 2, "further derivations are folded"
    folds.open(1)
    assert len(folds.lines) == 5


def test_folds_are_exact_wherever_one_opens_and_closes() -> None:
    folds = shown(many(100))
    everything = nodes(folds)
    assert everything == [node for _, node in many(100).walk()]
    folds.close(1)
    assert nodes(folds) == [*everything[:2], *everything[12:]]
    assert folds.parent(2) == 0
    folds.open(1)
    assert (nodes(folds), folds.parent(5)) == (everything, 1)

    # A player's folds stay when another tick has other values.
    folds.close(1)
    folds.show([replace(many(100), remark="gives this row")], [], 10_000)
    assert not folds.is_open(folds.lines[1])
    folds.show([many(100)], [], 10_000, anew=True)
    assert folds.is_open(folds.lines[1])


def test_a_proof_that_came_later_stays_when_what_is_above_it_is_folded() -> None:
    asks = ProofNode("call", "Near(x)", query=Ask("Near", {"x": 1}))
    folds = shown(ProofNode("rule", "Robot()", children=(asks,)))
    assert folds.lines[1].lacks
    folds.open(1)
    folds.unfold(folds.lines[1].key, [ProofNode("rule", "Near(1)")])
    texts = [node.text for node in nodes(folds)]
    assert texts == ["Robot()", "Near(x)", "Near(1)"]
    folds.close(0)
    folds.open(0)
    assert [node.text for node in nodes(folds)] == texts
    assert not folds.lines[1].lacks


@pytest.mark.parametrize("width", [53, 80, 200])
@pytest.mark.parametrize("depth", [0, 9, 150])
def test_values_that_have_no_room_are_counted(width: int, depth: int) -> None:
    node = ProofNode(
        "value", "ray.object", values=("wall", "none", "lamp", "gate", "door"), excess=7
    )
    text = content(node, width, depth)
    shown = [value for value in node.values if str(value) in text]
    hidden = len(node.values) - len(shown) + node.excess
    assert f"(and {hidden} more)" in text
    assert len(text) <= width
    truths = ProofNode("value", "x > 2", values=(True, False, None))
    assert "= true or false or null" in content(truths, 80), "they are no numbers"


def content(node: ProofNode, width: int, depth: int = 0) -> str:
    return line_content(ProofLine(node, depth, 1, (), lacks=False), width, is_open=False).plain


def test_what_fails_is_opened_before_what_holds() -> None:
    value = (ProofNode("value", "x", values=(1,)),)
    holds = ProofNode("condition", "x > 0", holds=True, children=value)
    fails = ProofNode("condition", "x > 5", holds=False, children=value)
    folds = ProofTree()
    folds.show([ProofNode("rule", "P(x)", holds=False, children=(holds, fails))], [], 4)
    assert [folds.is_open(line) for line in folds.lines] == [True, False, True, False]


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
