"""What a value comes from: ticks, rules and readings, told of memories and of any other value."""

import pytest

from logical_robots_tui.explain.why.explanation import Ask, Subject, ValueSource, part_of
from logical_robots_tui.game import Link, Origin, origin_in_game, origin_in_run, read_part
from logical_robots_tui.game.debugging.inquiry import path_text
from logical_robots_tui.game.debugging.origin import link_lines
from logical_robots_tui.mind import Program, QueryError
from logical_robots_tui.values import Value, spell
from logical_robots_tui.world import Level
from tests.game.playing import Play
from tests.game.test_run import opened

PHASES = """
Start(robot_name:) :- Memory(robot_name:, memory:), memory == "";
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {plan:, seen:, kept:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  plan = (if sensor.clock == 4 then {phase: "fetch", since: sensor.clock}
          else if sensor.clock < 4 then {phase: "look", since: 0}
          else memory.plan),
  seen = (if sensor.clock in [2, 6] then Coalesce(memory.seen, 0) + 1 else memory.seen),
  kept = memory.kept;
"""
pytestmark = pytest.mark.usefixtures("folder")


def subject(value: str, predicate: str = "Robot", **given: Value) -> Subject:
    column, path = read_part(value)
    return Subject(Ask(predicate, given), column, path)


async def origin(level: Level, asked: Subject, tick: int = 9, text: str = PHASES) -> Origin:
    async with opened(level, text) as run:
        return await origin_in_run(run, level.robots[0].name, asked, tick)


async def links(level: Level, value: str, tick: int = 9, text: str = PHASES) -> tuple[Link, ...]:
    return (await origin(level, subject(value), tick, text)).links


def source(link: Link) -> ValueSource:
    assert link.source is not None
    return link.source


def lines(link: Link) -> list[str]:
    return list(link_lines(link, spell))


def stretch(link: Link) -> tuple[Value, int, int]:
    return link.value, link.tick, link.until


def robot(fields: str, body: str, rest: str = "") -> str:
    return f"""{rest}
Robot(robot_name:, desire: {{left_engine: 0, right_engine: 0}}, memory: {{{fields}}}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), {body};
"""


async def test_ticks_that_kept_a_value_are_passed_over_and_its_making_told(level: Level) -> None:
    (link,) = await links(level, "memory.plan.phase")
    assert stretch(link) == ("fetch", 4, 9)
    assert lines(link) == [
        "the same since tick 4, set then by the rule in line 3",
        'line 5: "fetch"',
        "as in line 5 holds: sensor.clock == 4",
        f"from {link.robot}'s sensor.clock = 4",
    ]
    second, first = await links(level, "memory.seen")
    assert (second.value, second.tick, second.input_links) == (2, 6, (1,))
    assert stretch(first) == (1, 2, 5)


async def test_a_value_made_again_in_each_tick_is_the_same_since_it_first_was(level: Level) -> None:
    word = 'word = (if sensor.clock > 3 then "late" else "early"), now = sensor.clock'
    text = robot("word:, now:", word)
    (link,) = await links(level, "memory.word", text=text)
    assert stretch(link) == ("late", 4, 9)
    (link,) = await links(level, "memory.now", text=text)  # which is not a counter
    assert (link.tick, link.steps) == (9, None)
    assert lines(link)[-1] == f"read from {link.robot}'s sensor.clock = 9"


async def test_a_state_machine_of_facts_goes_back_from_phase_to_phase(level: Level) -> None:
    phases = """Plan(phase: "out", next: "fetch", at: 3);
Plan(phase: "fetch", next: "home", at: 6);
Plan(phase: "home", next: "home", at: 0);"""
    now = """Plan(phase: now, next:, at:), now == Coalesce(memory.phase, "out"),
  phase = (if sensor.clock == at then next else now)"""
    phase = await links(level, "memory.phase", text=robot("phase:", now, phases))
    home, fetch, out = [link for link in phase if link.path]
    assert [*map(stretch, (home, fetch, out))] == [("home", 6, 9), ("fetch", 3, 5), ("out", 1, 2)]
    assert lines(home)[1:3] == [
        'line 2: Plan(phase: "fetch", next: "home", at: 6)',
        "as in line 6 holds: sensor.clock == at",
    ]


async def test_what_counts_is_one_link_that_goes_on_before_its_steps(level: Level) -> None:
    text = robot(
        "down:, up:, half:",
        """down = (if sensor.clock == 2 then 20 else memory.down - 1),
  up = (if sensor.clock in [2, 4, 5, 8] then Coalesce(memory.up, 0) + 1 else memory.up),
  half = (if sensor.clock == 2 then 64 else memory.half / 2)""",
    )
    for field, line, begin in (
        ("down", "counts down by 1 since tick 3, from 20 (2.)", (20, 2, 2)),
        ("up", "counts up by 1, 3 times since tick 4, from 1 (2.)", (1, 2, 3)),
        ("half", "changes in each tick since tick 3, from 64.0 (2.)", (64, 2, 2)),
    ):
        count, first = await links(level, f"memory.{field}", text=text)
        assert line in lines(count)
        assert stretch(first) == begin
        if field == "down":
            assert count.steps is not None
            assert (count.value, count.tick, count.steps.increment, count.steps.since) == (
                13,
                9,
                -1,
                3,
            )
            assert count.began == 1


async def test_a_value_that_a_join_makes_equal_to_a_memory_comes_from_it(level: Level) -> None:
    text = robot(
        "copy:, at:",
        "at = (if sensor.clock == 4 then 2 else Coalesce(memory.at, 1)),\n"
        "  Number(x), x == Coalesce(memory.at, 1), copy = x",
        "Number(1); Number(2);",
    )
    copy, at = await links(level, "memory.copy", text=text)
    assert (copy.value, copy.tick, at.name, at.tick) == (2, 5, f"{at.robot}'s memory.at", 4)
    assert lines(copy)[-1] == f"copied from {at.robot}'s memory.at = 2 (2.)"


async def test_a_value_nobody_wrote_is_from_the_start_or_the_first_thought(level: Level) -> None:
    text = "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}) :- Sensor(robot_name:);"
    (link,) = await links(level, "memory", text=text)
    assert (link.value, link.tick) == ("", 0)
    assert lines(link) == ["there from the start until tick 9"]
    (link,) = await links(level, "memory.kept")
    assert (link.value, link.tick) == (None, 1)


async def test_an_element_of_a_list_is_followed_to_the_tick_that_added_it(level: Level) -> None:
    text = robot(
        "all:",
        "all = Set{x :- Item(x:)}",
        """Item(x:) :- Memory(memory:), x in TryCast(memory, {all: [Num]}).all;
    Item(x: sensor.clock) :- Sensor(sensor:), sensor.clock in [2, 5];""",
    )
    for place in ("[1]", "[-1]"):
        (link,) = await links(level, f"memory.all{place}", text=text)
        assert stretch(link) == (5, 5, 9)
        assert source(link).rule is not None
        assert lines(link)[0].endswith("by the rule in line 2")


async def test_another_robots_memory_is_told_apart_and_followed(level: Level) -> None:
    text = '@Visible(Memory, "all");' + robot(
        "said:, heard:",
        'said = (if robot_name == "Bo" && sensor.clock == 3 then 7 else Coalesce(memory.said, 0)),'
        " heard = Max{m.said :- Memory(memory: m)}",
    )
    heard, said = (await links(level, "memory.heard", text=text))[:2]
    assert (heard.robot, heard.value, heard.tick) == ("Ada", 7, 4)
    assert (said.robot, said.value, said.tick) == ("Bo", 7, 3)


RAYS = """
Ahead(radar, what) = Avg{ray.distance :- ray in radar, ray.object == what};
Near(robot_name:, ray? ArgMin= ray -> ray.distance) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar;
Speed(way) = {left_engine: way / 1000, right_engine: 0};
Robot(robot_name:, desire: Speed(Ahead(sensor.radar, "wall")), memory: {at:, past:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), Near(robot_name:, ray:),
  past = (if sensor.clock > 2 then memory.past else sensor.clock), at = ray.angle;
"""


async def test_an_engine_is_traced_through_functions_to_rays(level: Level) -> None:
    engine, way = await links(level, "desire.left_engine", tick=2, text=RAYS)
    assert engine.name == f"{engine.robot}'s desire.left_engine"
    assert lines(engine)[:1] == ["line 5: way / 1000"]
    assert way.value == pytest.approx(1000 * engine.value)  # type: ignore[operator]  # a number
    assert lines(way)[0].startswith("line 2: Avg{ray.distance")
    assert all(" wall, distance " in line for line in lines(way)[1:6])
    assert lines(way)[-1].startswith("and from ")


async def test_a_column_of_a_predicate_and_a_function_are_traced(level: Level) -> None:
    (link,) = (await origin(level, subject("ray.distance", "Near"), text=RAYS)).links
    (ray,) = link.inputs
    assert ray.read is not None
    assert part_of(ray.read.value, ("distance",)) == link.value
    assert lines(link)[0].startswith(f"read from {link.robot}'s ray ")
    (speed,) = (await origin(level, subject("value.left_engine", "Speed", way=12), text=RAYS)).links
    assert speed.value == 0.012


async def test_an_expression_and_a_variable_of_a_rule_are_traced(level: Level) -> None:
    by_name = await origin(level, Subject(Ask(), "", variable="seen", value=2), 6)
    span = source(by_name.links[0]).span
    assert span is not None
    assert span.text == "Coalesce(memory.seen, 0) + 1"
    by_place = await origin(level, Subject(Ask(), "", span=span, value=2), 6)
    assert by_place.links[0].name == span.text
    for seen in (by_name, by_place):
        assert [link.tick for link in seen.links] == [6, 2]


async def test_a_game_is_asked_with_the_program_that_decided(level: Level, play: Play) -> None:
    game = play(PHASES, level)
    await game.run_until(tick=6)
    game.use(Program.compile(PHASES.replace("fetch", "other")))
    await game.run_until(tick=9)
    (link,) = (await origin_in_game(game, "Ada", subject("memory.plan.phase"))).links
    assert (link.value, link.tick) == ("fetch", 4)


async def test_what_is_not_there_is_named(level: Level) -> None:
    for value, predicate, message in (
        ("memory.plan.at", "Robot", "plan has no part at"),
        ("desire.speed", "Robot", "This value has no part speed"),
        ("plan", "Robot", "Robot has no column plan; it has robot_name, desire, memory"),
        ("robot_name", "Start", "Start has no such row"),
    ):
        with pytest.raises(QueryError, match=message):
            await origin(level, subject(value, predicate))


def test_the_path_of_a_part_can_be_written_and_read_and_what_names_no_part_is_refused() -> None:
    assert read_part("memory.plan.seen[2].at") == ("memory", ("plan", "seen", 2, "at"))
    assert path_text(("plan", "seen", 2, "at")) == "memory.plan.seen[2].at"
    assert read_part("memory") == ("memory", ())
    for text in ("memory.", "memory[x]", "memory.a..b", ""):
        with pytest.raises(ValueError, match="is not a part"):
            read_part(text)
