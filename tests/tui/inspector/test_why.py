"""Why, in the game: a proof to fold, deeper and back, for the robot and tick at hand."""

import asyncio
from pathlib import Path

import pytest
from textual.widgets import Input

from logical_robots_tui.explain import Ask, Proof, ProofNode
from logical_robots_tui.game import Breakpoint, Frame, Inquiry
from logical_robots_tui.mind import Program
from logical_robots_tui.tui.inspector.pages.why import ValuesPrompt
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.value_tree import ValueTree
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from tests.short import AHEAD
from tests.tui.conftest import SLOW, Opened, opened

TALL = (100, 54)  # in which a whole proof has room
TWO_RULES = """\
Speed(d) = 0.5 :- d > 20;
Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: "far") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d > 20;
Robot(robot_name:, desire:, memory:) :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d <= 20,
  memory == "near", desire == {left_engine: 0, right_engine: 0};
"""
CALL = "left_engine: Speed(d)"
PROVED = "Speed(d) = 0.5 :- d > 20"


def view(game: Opened) -> WhyView:
    return game.main.query_one(WhyView)


def nodes(game: Opened) -> list[ProofNode]:
    return [line.node for line in view(game).lines]


def told(game: Opened) -> list[str]:
    return [node.text for node in nodes(game)]


async def go_to(game: Opened, text: str) -> int:
    """Put the cursor on the first line that begins with a text, once it is there; its number."""
    await game.until(lambda: any(line.startswith(text) for line in told(game)))
    place = next(n for n, line in enumerate(told(game)) if line.startswith(text))
    view(game).action_move(place - view(game).lines.index(view(game).line))
    return place


async def asked_why(game: Opened) -> None:
    await game.ready()
    await game.press("n", tick=1)
    await game.press("w", until=lambda: view(game).lines)


async def test_one_key_says_why_in_a_tree_that_folds_and_stays_folded(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        assert game.inspector.inspected == "why"
        rules = [node for node in nodes(game) if node.kind == "rule"]
        assert (rules[0].remark, rules[-1].remark) == ("gives this row", "gives no row")
        await game.until(lambda: PROVED in told(game))
        await game.sees("✗ 4: Robot(")
        assert game.shows("✓ 2: Robot(")
        assert game.shows("Why · tick 1")

        # It goes down to what a function gave, and folds by arrows as any tree.
        place = await go_to(game, CALL)
        assert view(game).lines[place].depth < view(game).lines[place + 1].depth
        before = told(game)
        await game.press("left", until=lambda: not view(game).is_open(place))
        assert PROVED not in told(game)
        await game.press("right", until=lambda: told(game) == before)
        await game.press("right", until=lambda: view(game).line is view(game).lines[place + 1])
        await game.press("left", "left", "left")  # fold it, go up, fold that
        await game.until(lambda: not view(game).is_open(place))
        assert view(game).line is view(game).lines[place]

        # The rule that did not give the row is folded below.
        last = len(told(game)) - 1
        assert told(game)[last].startswith("Robot(")
        assert not view(game).is_open(last)
        assert "d <= 20" not in told(game)
        await game.press("end", "right", until=lambda: "d <= 20" in told(game))
        assert nodes(game)[told(game).index("d <= 20")].holds is False

        await go_to(game, CALL)
        await game.press("n", sees="Why · tick 2")
        assert not view(game).is_open(place)
        assert view(game).line is view(game).lines[place]
        await game.write(AHEAD)
        await game.until(lambda: told(game)[:1] and "0.5, right_engine: 0.5" in told(game)[0])


async def test_one_goes_deeper_and_back_and_sees_the_place_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: PROVED in told(game))

        # A click on the marker folds; one on the line goes there, and the next one deeper.
        place = told(game).index(CALL)
        depth = view(game).lines[place].depth
        await game.click(WhyView, offset=(2 * depth, place))
        await game.until(lambda: not view(game).is_open(place))
        for number in (place + 1, place):
            await game.click(WhyView, offset=(2 * depth + 6, number))
            await game.settled()
            assert view(game).line is view(game).lines[number]
        await game.click(WhyView, offset=(2 * depth + 6, place))
        await game.until(lambda: told(game)[:1] == [PROVED] and game.shows("← Robot"))
        assert game.shows("Speed(")
        await game.press("left", until=lambda: told(game)[0].startswith("Robot("))
        await go_to(game, CALL)
        await game.press("enter", until=lambda: told(game)[:1] == [PROVED])
        await game.press("end", "backspace", until=lambda: told(game)[0].startswith("Robot("))

        # Its predicate is stopped at, unless that is a function.
        await game.press("asterisk", sees="The robots stop when Robot changes for Solo.")
        assert list(game.session.breakpoints) == [Breakpoint("change", "Robot", "Solo")]
        game.inspector.open("Speed")
        await game.press("w", "asterisk")
        await game.sees("Choose a predicate with rows")
        assert len(game.session.breakpoints) == 1
        await game.sees("Speed is a function of d: give a value for it.")

        # The place is no longer shown once the proof is left, and edited where it is shown.
        for leave in (lambda: game.inspector.inspect("robots"), None):
            await game.press("w")
            await go_to(game, "d == sensor")
            await game.until(lambda: game.editor.selected_text == "d == sensor.forward_distance")
            if leave:
                leave()
                await game.until(lambda: not game.editor.selected_text)
        edited = TWO_RULES.replace("d == s", "xd == s", 1)
        await game.press("e", "x", until=lambda: game.editor.text == edited)


async def test_what_is_expanded_deep_down_stays_so_in_another_tick(data_dir: Path) -> None:
    many = "".join(f", c > {-n}" for n in range(1, 10))
    text = (
        f"Deep1(c) :- Deep2(c){many};\nDeep2(c) :- Deep3(c){many};\nDeep3(c) :- c >= 0;\n"
        "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: 1) :-\n"
        f"  Sensor(robot_name:, sensor:), c == sensor.clock, Deep1(c){many};"
    )
    async with opened(data_dir, text=text, size=(120, 24)) as game:
        await asked_why(game)
        assert "Deep3(c)" not in told(game)
        lines = [line for n in range(1, 3) for line in (f"Deep{n}(c)", f"Deep{n}(c) :-")]
        for text in ("Robot(", *lines, "Deep3(c)"):
            await go_to(game, text)
            await game.press("right")
        await game.until(lambda: "Deep3(c) :- c >= 0" in told(game))
        before = told(game)
        await game.press("n", sees="Why · tick 2", until=lambda: told(game) == before)


async def test_a_rule_that_contributes_is_not_an_alternative(data_dir: Path) -> None:
    text = "Total() += 1;\nTotal() += 2;\n" + TWO_RULES
    async with opened(data_dir, text=text, size=TALL) as game:
        await game.ready()
        game.inspector.inspect("Total")
        await game.press("n", "w", tick=1, until=lambda: len(told(game)) > 1)
        assert [line for line in told(game) if ":" not in line] == ["Total() += 1", "Total() += 2"]


async def test_a_proof_goes_as_deep_as_there_is_room_and_on_where_opened(data_dir: Path) -> None:
    text = TWO_RULES.replace("d <= 20,", "Close(d), Low(d),").replace(":- d > 20;", ":- Far(d);", 1)
    text += "Far(d) :- Further(d);\nFurther(d) :- d > 20;\n"
    text += "Close(d) :- d <= 20;\nLow(d) :- d <= 30;\n"
    async with opened(data_dir, text=text, size=(120, 70)) as game:
        await asked_why(game)
        await game.until(lambda: "Further(d) :- d > 20" in told(game))

        # What another rule asks is proved when it is opened.
        await go_to(game, "Robot(")
        await game.press("end", "right")
        await go_to(game, "Close(d)")
        await game.press("right")
        await game.until(lambda: any(line.startswith("Close(d) :-") for line in told(game)))

        # Two calls that are opened at once are both proved.
        await game.sees("Why · tick 1")
        lacking = [
            ProofNode("call", f"{name}(d)", query=Ask(name, {"col0": 10}))
            for name in ("Close", "Low")
        ]
        view(game).show([ProofNode("rule", "both", children=tuple(lacking))], anew=True)
        view(game).open(2)
        view(game).open(1)
        for start in ("Close(d) :-", "Low(d) :-"):
            await game.until(lambda start=start: any(t.startswith(start) for t in told(game)))  # type: ignore[misc]  # a default


NEAREST = """\
Near(robot_name:, r? ArgMin= ray -> ray.distance) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: r.distance) :-
  Near(robot_name:, r:);
"""


async def test_a_ray_and_a_robot_are_brought_out_in_the_labyrinth(data_dir: Path) -> None:
    async with opened(data_dir, text=NEAREST, size=(120, 70)) as game:
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

        # A value is opened as a tree, by two keys.
        await game.press("w", until=lambda: any(node.kind == "contributor" for node in nodes(game)))
        view(game).action_move([node.kind for node in nodes(game)].index("contributor"))
        await game.press("enter", on=ValueTree, sees="distance")
        await game.press("escape", "X", on=ValueTree)
        await game.press("escape")

        # A ray is not brought out in another tick, even if the proof is hidden by then.
        await game.resize(80, 40, until=lambda: labyrinth.highlighted is not None)
        await game.press("1", "n", until=lambda: game.tick == 2 and labyrinth.highlighted is None)


async def test_a_row_that_there_is_not_is_told_with_values_and_a_change(data_dir: Path) -> None:
    text = (
        "Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n"
        "Far() :- Sensor(sensor:), r in sensor.radar, r.distance < 0;\n"
        'Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-\n'
        "  Sensor(robot_name:), ~Near(robot_name:);\n"
    )
    async with opened(data_dir, text=text, size=TALL, ready=True) as game:
        await game.press("n", tick=1)
        game.inspector.inspect("Near")
        await game.press("w", until=lambda: "sensor.clock > 5" in told(game))
        await game.sees("This change would give a row")
        await game.sees("Change `5` to `0` in line 1  rule in line 1")
        await game.sees("`sensor.clock` is 1, 4 too little.")

        # All values of a condition that failed can be seen, those without room in a tree.
        game.inspector.inspect("Far")
        await game.press("w", until=lambda: "r.distance" in told(game))
        place = told(game).index("r.distance")
        view(game).action_move(place)
        count = len(nodes(game)[place].values)
        (line,) = (row for row in view(game).plain.splitlines() if "r.distance = " in row)
        assert line.count(" or ") + int(line.split("(and ")[1].split()[0]) + 1 == count
        await game.press("enter", on=ValueTree)
        await game.until(lambda: all(game.shows(f" {number}  ") for number in range(1, count + 1)))


async def prompted(game: Opened, text: str) -> Input:
    await go_to(game, text)
    await game.press("exclamation_mark", on=ValuesPrompt)
    return game.app.screen.query_one(Input)


async def test_other_values_show_where_rules_stop_and_nonsense_is_mended(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL, ready=True) as game:
        await game.press("exclamation_mark")
        await game.sees("Put the cursor on a line of a proof; w makes one.")
        assert not view(game).lines
        await asked_why(game)
        await game.until(lambda: PROVED in told(game))

        # Another argument shows where a function stops.
        values = await prompted(game, "Speed(d) = 0.5")
        assert values.value.startswith("Speed(")
        values.value = "Speed(7)"
        await game.press("enter")
        await game.until(lambda: "d > 20" in told(game) and nodes(game)[0].holds is False)
        await game.sees("Speed(7)")
        await game.press("backspace")
        await game.until(lambda: told(game)[:1] and told(game)[0].startswith("Robot("))

        # The value under the cursor is selected.
        values = await prompted(game, "memory")
        assert (values.value, values.selected_text) == ('Robot(memory: "far")', '"far"')
        for nonsense, message in [
            ("Robot(memory: far + 1)", "This is not a value."),
            ("Robot(memory: ", "is never closed"),
            ("Robot(mood: 1)", "Robot has no column mood"),
            ("Robbot(1)", "no rules for Robbot"),
            ("Speed()", "Speed is a function"),
        ]:
            values.value = nonsense
            await game.press("enter", sees=message)
            assert values.screen is game.app.screen
        values.value = "Speed(30)"
        await game.press("enter", until=lambda: told(game)[0].startswith("Speed(d)"))
        await game.press("backspace")
        await game.until(lambda: told(game)[:1] and told(game)[0].startswith("Robot("))
        await prompted(game, "memory")
        await game.press(*'"near"', "enter")
        await game.until(lambda: told(game)[0].startswith("Robot(") and not nodes(game)[0].holds)
        assert nodes(game)[0].remark == "does not apply to these values"


async def test_a_slow_proof_can_be_stopped(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    is_proved, is_asked, asked_for = asyncio.Event(), asyncio.Event(), list[str]()
    prove = Inquiry.proof
    is_asked.set()

    async def proof(
        inquiry: Inquiry, program: Program, robot: str, frame: Frame, asked: Ask, depth: int
    ) -> Proof:
        if depth == 1:
            await is_asked.wait()
        else:
            asked_for.append(asked.predicate)
            if asked.predicate == "Robot":
                await is_proved.wait()
        return await prove(inquiry, program, robot, frame, asked, depth=depth)

    monkeypatch.setattr(Inquiry, "proof", proof)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("Solo: Robot  ") and game.shows("unfolding"))

        # Unfolding can be stopped and goes on call by call.
        await game.press("escape", sees="Stopped after")
        place = await go_to(game, CALL)
        await game.press("right", until=lambda: PROVED in told(game))
        assert asked_for == ["Robot", "Speed"]

        # A call that is opened meanwhile waits for the proof that is on its way.
        await game.press("left", "n")
        await game.until(lambda: game.shows("Why · tick 2") and game.shows("unfolding"))
        assert not view(game).is_open(place)
        await game.press("right", until=lambda: view(game).is_open(place))
        assert asked_for == ["Robot", "Speed", "Robot"]
        is_proved.set()
        await game.until(lambda: PROVED in told(game))
        assert told(game)[place + 1] == PROVED
        assert view(game).line is view(game).lines[place]
        await game.sees_no("unfolding")

        # The cursor stays while a slow answer for another tick is awaited.
        is_asked.clear()
        await game.press("n", sees="taking the rules of Robot apart")
        assert not view(game).lines
        await game.sees("s  esc here stops it")
        await game.press("escape", sees="Stopped after ")
        assert view(game).has_focus
        await game.press("n", sees="taking the rules of Robot apart")
        is_asked.set()
        await game.until(lambda: view(game).lines and view(game).line is view(game).lines[place])
        assert told(game)[place] == CALL

        # While robots run, the first level is enough.
        game.inspector.inspect("robots")
        await game.press("space", "w", sees="a pause unfolds it")
        assert CALL in told(game)
        assert PROVED not in told(game)
        await game.press("space", until=lambda: PROVED in told(game), sees_no="a pause unfolds it")
        await game.sees(f"Why · tick {game.tick}")


@pytest.mark.slow
async def test_no_old_proof_stands_under_a_new_question(data_dir: Path) -> None:
    text = SLOW.split("Robot(")[0] + TWO_RULES
    async with opened(data_dir, text=text) as game:
        await asked_why(game)
        game.inspector.inspect("Many")
        await game.press("w", sees="Solo: Many")
        assert not any(line.startswith("Robot(") for line in told(game))
