"""Why, in the game: a proof to fold, deeper and back, for the robot and tick at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game import Breakpoint
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.value_tree import ValueTree
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from tests.short import AHEAD
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.explain import Node
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


async def go_to(game: Opened, text: str) -> int:
    """Put the cursor on the first line that begins with a text, once it is there; its number."""
    await game.until(lambda: any(each.startswith(text) for each in told(game)))
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
        assert game.inspector.inspected == "why"
        await game.sees("Why · tick 1")
        rules = [node for node in nodes(game) if node.kind == "rule"]
        assert rules[0].said == "gives this row"
        assert rules[-1].said == "gives no row"
        await game.sees("✓ 2: Robot(")
        await game.sees("✗ 4: Robot(")


async def test_the_proof_goes_down_to_what_a_function_gave(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        call = told(game).index(CALL)
        assert view(game).lines[call].depth < view(game).lines[call + 1].depth


def chain(depth: int, conditions: int) -> str:
    """A program whose calls go deep, each with some conditions beside it."""
    many = "".join(f", c > {-n}" for n in range(1, conditions + 1))
    return "\n".join(
        [
            *(f"Deep{n}(c) :- Deep{n + 1}(c){many};" for n in range(1, depth)),
            f"Deep{depth}(c) :- c >= 0;",
            "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: 1) :-",
            f"  Sensor(robot_name:, sensor:), c == sensor.clock, Deep1(c){many};",
        ]
    )


async def test_a_proof_goes_as_deep_as_there_is_room(data_dir: Path) -> None:
    async with opened(data_dir, text=chain(3, conditions=0), size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Deep3(c) :- c >= 0" in told(game))


async def test_what_is_expanded_deep_down_stays_so_in_another_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=chain(4, conditions=25), size=TALL) as game:
        await asked_why(game)
        lines = [line for n in range(1, 4) for line in (f"Deep{n}(c)", f"Deep{n}(c) :-")]
        for text in ("Robot(", *lines, "Deep4(c)"):
            await go_to(game, text)
            await game.press("right")
        await game.until(lambda: "Deep4(c) :- c >= 0" in told(game))
        before = told(game)
        await game.press("n")
        await game.sees("Why · tick 2")
        await game.until(lambda: told(game) == before)


async def test_a_rule_that_did_not_give_the_row_is_folded_below(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        last = len(told(game)) - 1
        assert told(game)[last].startswith("Robot(")
        assert not view(game).is_open(last)
        assert "d <= 20" not in told(game)
        await go_to(game, "Robot(")
        await game.press("end", "right")
        await game.until(lambda: "d <= 20" in told(game))
        failed = nodes(game)[told(game).index("d <= 20")]
        assert failed.holds is False


async def test_it_folds_by_arrows_as_any_tree(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = await go_to(game, CALL)
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
        place = await go_to(game, CALL)
        await game.press("left", "n")
        await game.sees("Why · tick 2")
        assert not view(game).is_open(place)
        assert view(game).line is view(game).lines[place]


async def test_a_click_on_the_marker_folds_and_one_on_the_line_goes_there(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = told(game).index(CALL)
        depth = view(game).lines[place].depth
        await game.click(WhyView, offset=(2 * depth, place))
        await game.until(lambda: not view(game).is_open(place))
        await game.click(WhyView, offset=(2 * depth + 6, place + 1))
        await game.until(lambda: view(game).line is view(game).lines[place + 1])
        await game.click(WhyView, offset=(2 * depth + 6, place))
        await game.until(lambda: view(game).line is view(game).lines[place])
        await game.click(WhyView, offset=(2 * depth + 6, place))
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])


async def test_deeper_and_back(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await go_to(game, CALL)
        await game.press("enter")
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])
        await game.sees("Speed(")
        await game.sees("← Robot")
        await game.press("left")
        await game.until(lambda: told(game)[0].startswith("Robot("))
        await go_to(game, CALL)
        await game.press("enter")
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])
        await game.press("end", "backspace")
        await game.until(lambda: told(game)[0].startswith("Robot("))


async def test_what_another_rule_asks_is_proved_when_it_is_opened(data_dir: Path) -> None:
    text = TWO_RULES.replace("d <= 20,", "Close(d),") + "Close(d) :- d <= 20;\n"
    async with opened(data_dir, text=text, size=TALL) as game:
        await asked_why(game)
        await go_to(game, "Robot(")
        await game.press("end", "right")
        await game.until(lambda: "Close(d)" in told(game))
        await go_to(game, "Close(d)")
        await game.press("right")
        await game.until(lambda: any(each.startswith("Close(d) :-") for each in told(game)))


async def test_the_place_is_shown_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await go_to(game, "d == sensor")
        await game.until(lambda: game.editor.selected_text == "d == sensor.forward_distance")
        await game.press("e", "x")
        await game.until(lambda: game.editor.text == TWO_RULES.replace("d == s", "xd == s", 1))


async def test_the_place_is_no_longer_shown_once_the_proof_is_left(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await go_to(game, "d == sensor")
        await game.until(lambda: game.editor.selected_text == "d == sensor.forward_distance")
        game.main.inspector.inspect("robots")
        await game.until(lambda: not game.editor.selected_text)


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
        await go_to(game, "Sensor(")
        await game.until(lambda: labyrinth.highlighted == Highlight("Solo"))
        assert labyrinth._cells.plain() not in (plain, with_ray)
        game.inspector.inspect("ask")
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
        await game.sees("distance")
        await game.press("escape", "X")
        await game.until(lambda: isinstance(game.app.screen, ValueTree))


async def test_all_values_of_a_condition_that_failed_can_be_seen(data_dir: Path) -> None:
    far = "Far() :- Sensor(sensor:), r in sensor.radar, r.distance < 0;\n"
    async with opened(data_dir, text=far + AHEAD, size=TALL) as game:
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
        await game.until(lambda: all(game.shows(f" {number}  ") for number in range(1, count + 1)))


async def test_it_follows_the_tick_and_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.press("p")
        await game.sees("Why · tick 0")
        await game.write(AHEAD)
        await game.until(lambda: told(game)[:1] and "0.5, right_engine: 0.5" in told(game)[0])


async def test_it_is_about_the_robot_that_is_chosen(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=TWO_RULES) as game:
        await asked_why(game)
        await game.sees("P: Robot")
        game.main.inspector.choose("Q")
        await game.sees("Q: Robot")
        assert any(node.values == ("Q",) for node in nodes(game))


async def test_of_a_predicate_that_is_inspected(data_dir: Path) -> None:
    text = f"Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n{AHEAD}"
    async with opened(data_dir, text=text, size=TALL) as game:
        await game.ready()
        game.inspector.inspect("Near")
        await game.press("w")
        await game.until(lambda: "sensor.clock > 5" in told(game))


async def test_its_predicate_is_stopped_at_unless_that_is_a_function(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await asked_why(game)
        await game.press("asterisk")
        await game.sees("The robots stop when Robot changes for Solo.")
        assert list(game.session.breakpoints) == [Breakpoint("change", "Robot", "Solo")]
        game.inspector.open("Speed")
        await game.press("w", "asterisk")
        await game.sees("Choose a predicate with rows, or type a query first.")
        assert len(game.session.breakpoints) == 1


async def test_a_function_without_arguments_says_so_in_place(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await game.ready()
        game.inspector.inspect("Speed")
        await game.press("w")
        await game.sees("Speed is a function of d: give a value for it.")


async def test_without_a_program_it_says_so(data_dir: Path) -> None:
    async with opened(data_dir, text="Robot(") as game:
        await game.ready()
        await game.press("w")
        await game.sees("There is no program to query yet.")


async def test_the_change_that_would_have_given_a_row_is_told(data_dir: Path) -> None:
    text = (
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n"
        'Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-\n'
        "  Sensor(robot_name:), ~Near(robot_name:);\n"
    )
    async with opened(data_dir, text=text, size=(100, 40)) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        game.inspector.inspect("Near")
        await game.press("w")
        await game.sees("This change would give a row")
        await game.sees("Change `5` to `0` in line 1  rule in line 1")
        await game.sees("`sensor.clock` is 1, 4 too little.")
