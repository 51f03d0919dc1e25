"""Breakpoints: where a run stops, and what it says about that."""

import pytest

from logical_robots_tui.game import Breakpoint, Breakpoints, Game, Hit
from logical_robots_tui.mind import Program
from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import HALL, Play

# Ada drives to the wall at the right, remembers every tenth tick, and gives no row in tick 7;
# Bo stays where it is.
TEXT = """
Seen(robot_name:, label: ray.label) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "beacon";
Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.forward_distance < 50;
Tens(robot_name:, tens: ToInt64(Floor(sensor.clock / 10 + 0.5))) :- Sensor(robot_name:, sensor:);
Empty(robot_name:) :- Sensor(robot_name:), 1 == 2;
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: tens) :-
  Tens(robot_name:, tens:), Sensor(robot_name:, sensor:), robot_name == "Ada", sensor.clock != 7;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "still") :-
  Sensor(robot_name:), robot_name == "Bo";
"""
AHEAD = "Sensor(robot_name:, sensor:), d == sensor.forward_distance"
LEVEL = read_native(HALL + '\n[[beacons]]\nname = "Lamp"\nx = 80\ny = 25\n', "hall", "")


@pytest.fixture
def game(play: Play) -> Game:
    return play(TEXT, LEVEL)


async def stops(game: Game, *breakpoints: Breakpoint, ticks: int = 200) -> list[Hit]:
    for breakpoint_ in breakpoints:
        game.breakpoints.add(breakpoint_)
    hits: list[Hit] = []
    while game.frame.tick < ticks:
        await game.run_until(tick=ticks)
        hits += game.hits
    return hits


HITS: list[tuple[Breakpoint, list[int], str]] = [
    (Breakpoint("rows", "Near"), [103], '"Ada"'),
    (Breakpoint("no rows", "Seen", "Ada"), [50], '"Ada", "Lamp"'),
    (Breakpoint("change", "Tens", column="tens"), [5, 15, 25], "0; 0 → 1; 1"),
    (Breakpoint("change", "Tens", "Bo", "tens"), [5, 15, 25], "0 → 1"),
    (Breakpoint("enters", "Door"), [42], "Ada is in Door"),
    (Breakpoint("leaves", "Door", "Ada"), [81], "Ada was in Door"),
    (Breakpoint("leaves"), [81], "Ada was in Door"),
    (Breakpoint("enters", "Door", "Bo"), [], ""),
    (Breakpoint("blocked"), [151], "Ada at 189.0, 25.0"),
    (Breakpoint("loses sight", "Lamp", "Ada"), [50], "Ada saw Lamp last at distance"),
    (Breakpoint("notice"), [7], "Ada: Robot has no row for Ada"),
    (Breakpoint("notice", "no row", "Ada"), [7], "Ada: Robot has no row for Ada"),
    (Breakpoint("notice", "several rows"), [], ""),
    (Breakpoint("rows", f"{AHEAD}, d < 50"), [103], '"Ada"'),
    (Breakpoint("rows", f"{AHEAD}, d < 50", "Bo"), [], ""),
    (Breakpoint("no rows", 'Seen(robot_name: "Ada", label:)'), [50], '"Lamp"'),
    (Breakpoint("rows", f"Min{{d :- {AHEAD}}} < 50"), [103], "true"),
    (Breakpoint("no rows", f"Min{{d :- {AHEAD}}} >= 50", "Ada"), [103], "there was"),
    (Breakpoint("change", "Tens(robot_name:, tens:), tens > 0"), [5, 15, 25], "nothing → "),
    (Breakpoint("rows", "2 + 2 == 5"), [], ""),
    (Breakpoint("rows", "A(x) :- Tens(tens: x), x > 1; B(x) :- A(x), x > 2;"), [25], "3"),
]


async def test_a_run_stops_where_it_is_to_and_says_with_what_values(game: Game) -> None:
    hits = await stops(game, *(wanted for wanted, _, _ in HITS))
    for wanted, ticks, values in HITS:
        mine = [hit for hit in hits if hit.breakpoint == wanted]
        assert [hit.tick for hit in mine][: max(len(ticks), 1)] == ticks, wanted
        if mine:
            assert values in mine[0].values
            assert len(mine[0].values) < 300
    marks = game.history.marks
    marked = {t for t in range(1, 201) if "breakpoint" in [mark.kind for mark in marks.marks_at(t)]}
    assert marked == {hit.tick for hit in hits}


async def test_a_run_at_any_pace_stops_at_a_breakpoint_and_goes_on_from_it(game: Game) -> None:
    sensor = Breakpoint("change", "Sensor", "Bo")  # of a table that always changes
    hits = await stops(game, sensor, ticks=3)
    assert [(hit.tick, hit.breakpoint) for hit in hits] == [(tick, sensor) for tick in (1, 2, 3)]
    assert all(hit.values.startswith('"Bo", {"forward_') for hit in hits)
    game.breakpoints.remove(sensor)
    for event in ("enters", "leaves"):
        game.breakpoints.add(Breakpoint(event, "Door"))
    await game.run()
    assert "Ada" in game.frame.after.areas[0].visitors
    assert [hit.breakpoint.event for hit in game.hits] == ["enters"]
    await game.run()
    assert "Ada" not in game.frame.after.areas[0].visitors
    assert game.history.last == game.frame.tick


async def test_known_ticks_are_watched_unless_a_breakpoint_is_off_or_deleted(game: Game) -> None:
    await game.run_until(tick=120)
    game.go_to(0)
    hits = await stops(game, Breakpoint("rows", "Near"), Breakpoint("enters"), ticks=120)
    assert [hit.breakpoint.event for hit in hits] == ["enters", "rows"]
    assert game.history.last == 120
    game.go_to(hits[0].tick)
    assert game.hits == (hits[0],)
    enters, near = hits[0].breakpoint, hits[1].breakpoint
    game.breakpoints.switch(enters)
    assert {*game.breakpoints} == {enters, near}
    assert not game.breakpoints.is_on(enters)
    game.breakpoints.remove(near)
    game.go_to(0)
    await game.run_until(tick=120)
    assert game.frame.tick == 120
    game.breakpoints.add(enters)
    assert game.breakpoints.enabled == (enters,)


async def test_one_that_can_not_be_hit_says_why_and_the_run_goes_on(game: Game) -> None:
    problems = {
        Breakpoint("rows", "Sean"): 'The program has no predicate Sean. Did you mean "Seen"?',
        Breakpoint("change", "WeightedAverage"): "function of its arguments",
        Breakpoint("rows"): "needs the name of a predicate",
        Breakpoint("enters", "Dor"): 'This level has no area Dor. Did you mean "Door"?',
        Breakpoint("loses sight", "Lmap"): "Nothing in this level is called Lmap.",
        Breakpoint("notice", "nonsense"): "No notice is called nonsense.",
        Breakpoint("blocked", robot="Eve"): "This level has no robot Eve.",
        Breakpoint("change", "Tens", column="ten"): "Tens has no column ten.",
    }
    near = Breakpoint("rows", "Near")
    hits = await stops(game, *problems, near, ticks=110)
    assert [hit.breakpoint for hit in hits] == [near]
    for wrong, problem in problems.items():
        assert problem in game.problem_with(wrong)
    assert not game.problem_with(near)
    game.use(Program.compile(TEXT.replace("Near(", "Close(")))
    assert "no predicate Near" in game.problem_with(near)
    await game.run_until(tick=120)
    assert game.frame.tick == 120
    game.use(Program.compile(TEXT))
    assert not game.problem_with(near)


async def test_one_whose_question_is_wrong_says_so_and_stops_nothing(game: Game) -> None:
    wrong = Breakpoint("rows", "Near(robot_nam:)")
    assert game.problem_with(wrong) == ""
    assert await stops(game, wrong, ticks=3) == []
    assert "can't be asked: Near has no column robot_nam" in game.problem_with(wrong)
    game.use(Program.compile(TEXT.replace("Near(robot_name:)", "Near(robot_name:, robot_nam: 1)")))
    assert game.problem_with(wrong) == ""
    assert [hit.tick for hit in await stops(game, wrong, ticks=120)] == [103]


async def test_one_whose_question_or_predicate_fails_says_in_which_tick(game: Game) -> None:
    text = TEXT + "Bad(text) :- Memory(memory:), text = Join(memory, memory);\n"
    game.use(Program.compile(text))
    question, table = Breakpoint("rows", 'x in ["a"], x.field == 2'), Breakpoint("change", "Bad")
    assert await stops(game, question, table, ticks=5) == []
    assert game.problem_with(question).startswith("Tick 5: This failed: ")
    assert game.problem_with(table).startswith("Tick 5: Bad failed")


def test_words_say_what_a_breakpoint_is_about() -> None:
    told = {
        Breakpoint("rows", "Near"): "Near has rows",
        Breakpoint("no rows", "Near", "Ada"): "Near no longer has rows for Ada",
        Breakpoint("rows", "Near(d:), d < 5"): "Near(d:), d < 5 holds",
        Breakpoint("no rows", "1 < 2"): "1 < 2 no longer holds",
        Breakpoint("change", "Tens", "Bo", "tens"): "Tens.tens changes for Bo",
        Breakpoint("enters", "Door"): "a robot enters Door",
        Breakpoint("leaves", robot="Ada"): "Ada leaves an area",
        Breakpoint("blocked", robot="Ada"): "Ada is blocked by a wall",
        Breakpoint("loses sight", "Lamp"): "a robot loses sight of Lamp",
        Breakpoint("notice", "no row"): "a notice “no row” appears",
        Breakpoint("notice"): "a notice appears",
    }
    assert [about.words for about in told] == list(told.values())
    assert len(Breakpoints(told)) == len(told)
