"""Why, in the game: a proof to fold, deeper and back, for the robot and tick at hand."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.mind import Ask, Node
from logical_robots_tui.tui.inspector.predicate_list import ASK, WHY
from logical_robots_tui.tui.inspector.questions import Questions
from logical_robots_tui.tui.inspector.widgets.proof_tree import ProofLine, ProofTree, line_content
from logical_robots_tui.tui.inspector.widgets.proof_view import WhyView
from logical_robots_tui.tui.inspector.widgets.value_tree import ValueTree
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from tests.short import AHEAD
from tests.tui.conftest import SLOW, opened

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Explanation, Proof
    from tests.tui.conftest import Opened

TALL = (120, 70)
"""A terminal in which a whole proof has room."""

TWO_RULES = """\
Speed(d) = 0.5 :- d > 20;
Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: "far") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d > 20;
Robot(robot_name:, desire:, memory:) :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d <= 20,
  memory == "near", desire == {left_engine: 0, right_engine: 0};
"""

CALL = "left_engine: Speed(d)"


def view(game: Opened) -> WhyView:
    return game.main.query_one(WhyView)


def nodes(game: Opened) -> list[Node]:
    return [line.node for line in view(game).lines]


def told(game: Opened) -> list[str]:
    return [node.text for node in nodes(game)]


def go_to(game: Opened, text: str) -> int:
    """Put the cursor on the first line that begins with a text; its number."""
    place = next(n for n, each in enumerate(told(game)) if each.startswith(text))
    view(game).action_move(place - view(game).lines.index(view(game).line))
    return place


async def asked_why(game: Opened) -> None:
    await game.ready()
    await game.press("n")
    await game.until(lambda: game.tick == 1)
    await game.press("w")
    await game.until(lambda: view(game).lines)


async def test_one_key_says_why(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        assert game.inspector.inspected == WHY
        assert game.shows("Why · tick 1")
        rules = [node for node in nodes(game) if node.kind == "rule"]
        assert rules[0].said == "gives this row"
        assert rules[-1].said == "gives no row"
        assert game.shows("✓ 2: Robot(")
        assert game.shows("✗ 4: Robot(")


async def test_the_proof_goes_down_to_what_a_function_gave(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        call = told(game).index(CALL)
        assert view(game).lines[call].depth < view(game).lines[call + 1].depth


async def test_a_rule_that_did_not_give_the_row_is_folded_below(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        last = len(told(game)) - 1
        assert told(game)[last].startswith("Robot(")
        assert not view(game).is_open(last)
        assert "d <= 20" not in told(game)
        go_to(game, "Robot(")
        await game.press("end", "right")
        await game.until(lambda: "d <= 20" in told(game))
        failed = nodes(game)[told(game).index("d <= 20")]
        assert failed.holds is False


async def test_it_folds_by_arrows_as_any_tree(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = go_to(game, CALL)
        before = told(game)
        await game.press("left")
        await game.until(lambda: not view(game).is_open(place))
        assert "Speed(d) = 0.5 :- d > 20" not in told(game)
        await game.press("right")
        await game.until(lambda: told(game) == before)
        await game.press("right")
        await game.until(lambda: view(game).line is view(game).lines[place + 1])
        await game.press("left", "left", "left")  # fold it, go up, fold that
        await game.until(lambda: not view(game).is_open(place))
        assert view(game).line is view(game).lines[place]


async def test_what_is_folded_stays_folded_in_another_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = go_to(game, CALL)
        await game.press("left", "n")
        await game.until(lambda: game.shows("Why · tick 2"))
        assert not view(game).is_open(place)
        assert view(game).line is view(game).lines[place]


async def test_a_click_on_the_marker_folds_and_one_on_the_line_goes_there(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = told(game).index(CALL)
        depth = view(game).lines[place].depth
        await game.pilot.click(WhyView, offset=(2 * depth, place))
        await game.until(lambda: not view(game).is_open(place))
        await game.pilot.click(WhyView, offset=(2 * depth + 6, place + 1))
        await game.until(lambda: view(game).line is view(game).lines[place + 1])
        await game.pilot.click(WhyView, offset=(2 * depth + 6, place))
        await game.until(lambda: view(game).line is view(game).lines[place])
        await game.pilot.click(WhyView, offset=(2 * depth + 6, place))
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])


async def test_deeper_and_back(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        go_to(game, CALL)
        await game.press("enter")
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])
        assert game.shows("Speed(")
        assert game.shows("← Robot")
        await game.press("left")
        await game.until(lambda: told(game)[0].startswith("Robot("))
        go_to(game, CALL)
        await game.press("enter")
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])
        await game.press("end", "backspace")
        await game.until(lambda: told(game)[0].startswith("Robot("))


async def test_what_another_rule_asks_is_proved_when_it_is_opened(data_dir: Path) -> None:
    text = TWO_RULES.replace("d <= 20,", "Close(d),") + "Close(d) :- d <= 20;\n"
    async with opened(data_dir, text=text, size=TALL) as game:
        await asked_why(game)
        go_to(game, "Robot(")
        await game.press("end", "right")
        await game.until(lambda: "Close(d)" in told(game))
        go_to(game, "Close(d)")
        await game.press("right")
        await game.until(lambda: any(each.startswith("Close(d) :-") for each in told(game)))


async def test_the_place_is_shown_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        go_to(game, "d == sensor")
        await game.until(lambda: game.editor.selected_text == "d == sensor.forward_distance")
        await game.press("e", "x")
        await game.until(lambda: game.editor.text == TWO_RULES.replace("d == s", "xd == s", 1))


NEAREST = """\
Near(robot_name:, r? ArgMin= ray -> ray.distance) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: r.distance) :-
  Near(robot_name:, r:);
"""


async def test_a_ray_and_a_robot_are_brought_out_in_the_labyrinth(data_dir: Path) -> None:
    async with opened(data_dir, text=NEAREST, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: any(node.ray is not None for node in nodes(game)))
        labyrinth = game.main.labyrinth.view
        plain = labyrinth._cells.plain()
        node = next(node for node in nodes(game) if node.ray is not None)
        view(game).action_move(nodes(game).index(node))
        await game.until(lambda: labyrinth.highlighted == Highlight("Solo", node.ray))
        with_ray = labyrinth._cells.plain()
        assert with_ray != plain
        view(game).action_move(-1000)
        go_to(game, "Sensor(")
        await game.until(lambda: labyrinth.highlighted == Highlight("Solo"))
        assert labyrinth._cells.plain() not in (plain, with_ray)
        game.inspector.inspect(ASK)
        await game.until(lambda: labyrinth.highlighted is None)
        assert labyrinth._cells.plain() == plain


async def test_a_ray_is_not_brought_out_in_another_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=NEAREST, size=(80, 40)) as game:
        await asked_why(game)
        await game.until(lambda: any(node.ray is not None for node in nodes(game)))
        labyrinth = game.main.labyrinth.view
        view(game).action_move(next(n for n, e in enumerate(nodes(game)) if e.ray is not None))
        await game.press("1")
        await game.until(lambda: labyrinth.highlighted is not None)
        await game.press("n")
        await game.until(lambda: game.tick == 2 and labyrinth.highlighted is None)


async def test_a_value_is_opened_as_a_tree(data_dir: Path) -> None:
    async with opened(data_dir, text=NEAREST, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: any(node.ray is not None for node in nodes(game)))
        place = next(n for n, each in enumerate(nodes(game)) if each.kind == "contributor")
        view(game).action_move(place)
        await game.press("enter")
        await game.until(lambda: isinstance(game.app.screen, ValueTree))
        assert game.shows("distance")
        await game.press("escape", "X")
        await game.until(lambda: isinstance(game.app.screen, ValueTree))


async def test_all_values_of_a_condition_that_failed_can_be_seen(data_dir: Path) -> None:
    far = "Far() :- Sensor(sensor:), r in sensor.radar, r.distance < 0;\n"
    async with opened(data_dir, text=far + AHEAD) as game:
        await game.ready()
        game.inspector.inspect("Far")
        await game.press("w")
        await game.until(lambda: "r.distance" in told(game))
        place = told(game).index("r.distance")
        view(game).action_move(place)
        count = len(nodes(game)[place].values)
        (line,) = (each for each in view(game).plain.splitlines() if "r.distance = " in each)
        assert line.count(" or ") + int(line.split("(and ")[1].split()[0]) + 1 == count
        await game.press("enter")
        await game.until(lambda: isinstance(game.app.screen, ValueTree))
        assert all(game.shows(f" {number}  ") for number in range(1, count + 1))


async def test_it_follows_the_tick_and_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.press("p")
        await game.until(lambda: game.shows("Why · tick 0"))
        await game.write(AHEAD)
        await game.until(lambda: told(game)[:1] and "0.5, right_engine: 0.5" in told(game)[0])


async def test_it_is_about_the_robot_that_is_chosen(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=TWO_RULES) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("P: Robot"))
        game.main.inspector.choose("Q")
        await game.until(lambda: game.shows("Q: Robot"))
        assert any(node.values == ("Q",) for node in nodes(game))


async def test_a_proof_that_takes_long_says_so_and_can_be_stopped(data_dir: Path) -> None:
    async with opened(data_dir, text=SLOW) as game:
        await game.ready()
        await game.press("w")
        await game.until(lambda: game.shows("taking the rules of Robot apart"))
        await game.until(lambda: game.shows("s  esc here stops it"))
        await game.press("escape")
        await game.until(lambda: game.shows("Stopped after "))
        assert view(game).has_focus


async def test_the_first_level_is_there_before_the_whole_proof(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_let, prove = asyncio.Event(), Questions.proof

    async def late(questions: Questions, robot: str, frame: Frame, asked: Ask) -> Proof:
        await is_let.wait()
        return await prove(questions, robot, frame, asked)

    monkeypatch.setattr(Questions, "proof", late)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("Solo: Robot  ") and game.shows("unfolding"))
        assert CALL in told(game)
        place = go_to(game, CALL)
        assert not view(game).is_open(place)
        await game.press("right")  # which waits for the proof that is on its way
        await game.until(lambda: view(game).is_open(place))
        is_let.set()
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        assert told(game)[told(game).index(CALL) + 1] == "Speed(d) = 0.5 :- d > 20"
        assert view(game).line is view(game).lines[place]
        assert not game.shows("unfolding")


async def test_while_robots_run_the_first_level_is_enough(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.press("space")
        await game.until(lambda: game.shows("a pause unfolds it"))
        assert CALL in told(game)
        assert "Speed(d) = 0.5 :- d > 20" not in told(game)
        await game.press("space")
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        assert not game.shows("a pause unfolds it")
        assert game.shows(f"Why · tick {game.tick}")


async def test_unfolding_can_be_stopped_and_goes_on_call_by_call(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prove, asked_for = Questions.proof, list[str]()

    async def never_of_robot(questions: Questions, robot: str, frame: Frame, asked: Ask) -> Proof:
        asked_for.append(asked.predicate)
        if asked.predicate == "Robot":
            await asyncio.Event().wait()
        return await prove(questions, robot, frame, asked)

    monkeypatch.setattr(Questions, "proof", never_of_robot)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("unfolding"))
        await game.press("escape")
        await game.until(lambda: game.shows("stopped after"))
        go_to(game, CALL)
        await game.press("right")
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        assert asked_for == ["Robot", "Speed"]


async def test_two_calls_that_are_opened_at_once_are_both_proved(data_dir: Path) -> None:
    text = TWO_RULES.replace("d <= 20,", "Close(d), Low(d),")
    text += "Close(d) :- d <= 20;\nLow(d) :- d <= 30;\n"
    async with opened(data_dir, text=text, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        lacking = [
            Node("call", f"{name}(d)", asked=Ask(name, {"col0": 10})) for name in ("Close", "Low")
        ]
        view(game).show([Node("rule", "both", children=tuple(lacking))], anew=True)
        view(game).open(2)
        view(game).open(1)
        await game.until(lambda: any(each.startswith("Close(d) :-") for each in told(game)))
        await game.until(lambda: any(each.startswith("Low(d) :-") for each in told(game)))


async def test_the_cursor_stays_while_a_slow_answer_for_another_tick_is_awaited(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_let, ask = asyncio.Event(), Questions.why
    is_let.set()

    async def late(questions: Questions, robot: str, frame: Frame, asked: Ask) -> Explanation:
        await is_let.wait()
        return await ask(questions, robot, frame, asked)

    monkeypatch.setattr(Questions, "why", late)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = go_to(game, CALL)
        is_let.clear()
        await game.press("n")
        await game.until(lambda: game.shows("taking the rules of Robot apart"))
        assert not view(game).lines
        is_let.set()
        await game.until(lambda: view(game).lines)
        await game.until(lambda: view(game).line is view(game).lines[place])
        assert told(game)[place] == CALL


async def test_no_old_proof_stands_under_a_new_question(data_dir: Path) -> None:
    text = SLOW.split("Robot(")[0] + TWO_RULES
    async with opened(data_dir, text=text) as game:
        await asked_why(game)
        game.inspector.inspect("Many")
        await game.press("w")
        await game.until(lambda: game.shows("Solo: Many"))
        assert not any(text.startswith("Robot(") for text in told(game))


async def test_of_a_predicate_that_is_inspected(data_dir: Path) -> None:
    text = f"Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n{AHEAD}"
    async with opened(data_dir, text=text, size=TALL) as game:
        await game.ready()
        game.inspector.inspect("Near")
        await game.press("w")
        await game.until(lambda: "sensor.clock > 5" in told(game))


async def test_a_function_without_arguments_says_so_in_place(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await game.ready()
        game.inspector.inspect("Speed")
        await game.press("w")
        await game.until(lambda: game.shows("Speed is a function of col0: give a value for it."))


def many(count: int) -> Node:
    """A rule with so many nodes below it, ten below each."""
    waiting: list[Node] = [Node("value", f"v{n}", values=(n,)) for n in range(count)]
    while len(waiting) > 10:
        waiting = [
            Node("call", f"c{n}", children=tuple(waiting[n : n + 10]))
            for n in range(0, len(waiting), 10)
        ]
    return Node("rule", "Many(x)", holds=True, children=tuple(waiting))


def test_what_is_open_is_what_there_is_room_for() -> None:
    folds = ProofTree()
    folds.show([many(1000)], [many(10)], 30)
    assert 20 < len(folds.lines) <= 30
    assert folds.is_open(folds.lines[0])
    assert not folds.is_open(folds.lines[-1]), "the rest is folded"


def test_folds_are_exact_wherever_one_opens_and_closes() -> None:
    folds = ProofTree()
    folds.show([many(100)], [], 10_000)
    everything = [line.node for line in folds.lines]
    assert everything == [node for _, node in many(100).walk()]
    folds.close(1)
    assert [line.node for line in folds.lines] == [everything[0], everything[1], *everything[12:]]
    assert folds.parent(2) == 0
    folds.open(1)
    assert [line.node for line in folds.lines] == everything
    assert folds.parent(5) == 1


def test_a_player_s_folds_stay_when_another_tick_has_other_values() -> None:
    folds = ProofTree()
    folds.show([many(100)], [], 10_000)
    folds.close(1)
    folds.show([replace(many(100), said="gives this row")], [], 10_000)
    assert not folds.is_open(folds.lines[1])
    folds.show([many(100)], [], 10_000, anew=True)
    assert folds.is_open(folds.lines[1])


def test_a_proof_that_came_later_stays_when_what_is_above_it_is_folded() -> None:
    asks = Node("call", "Near(x)", asked=Ask("Near", {"x": 1}))
    folds = ProofTree()
    folds.show([Node("rule", "Robot()", children=(asks,))], [], 10)
    assert folds.lines[1].lacks
    folds.open(1)
    folds.unfold(folds.lines[1].key, [Node("rule", "Near(1)")])
    assert [line.node.text for line in folds.lines] == ["Robot()", "Near(x)", "Near(1)"]
    folds.close(0)
    folds.open(0)
    assert [line.node.text for line in folds.lines] == ["Robot()", "Near(x)", "Near(1)"]
    assert not folds.lines[1].lacks


@pytest.mark.parametrize("width", [53, 80, 200])
@pytest.mark.parametrize("depth", [0, 9, 150])
def test_values_that_have_no_room_are_counted(width: int, depth: int) -> None:
    node = Node("value", "ray.object", values=("wall", "none", "lamp", "gate", "door"), more=7)
    text = content(node, width, depth)
    shown = [value for value in node.values if str(value) in text]
    hidden = len(node.values) - len(shown) + node.more
    assert f"(and {hidden} more)" in text
    assert len(text) <= width


def test_truths_are_not_numbers() -> None:
    node = Node("value", "x > 2", values=(1, 0, None), is_truth=True)
    assert "= true or false or null" in content(node, 80)


def content(node: Node, width: int, depth: int = 0) -> str:
    return line_content(ProofLine(node, depth, 1, (), lacks=False), width, is_open=False).plain


async def test_without_a_program_it_says_so(data_dir: Path) -> None:
    async with opened(data_dir, text="Robot(") as game:
        await game.ready()
        await game.press("w")
        await game.until(lambda: game.shows("There is no program to query yet."))


async def test_the_change_that_would_have_given_a_row_is_told(data_dir: Path) -> None:
    text = (
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n"
        'Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-\n'
        "  Sensor(robot_name:), ~Near(robot_name:);\n"
    )
    async with opened(data_dir, text=text) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        game.inspector.inspect("Near")
        await game.press("w")
        await game.until(lambda: game.shows("One of these would give a row"))
