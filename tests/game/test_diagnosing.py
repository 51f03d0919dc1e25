"""Diagnosis of a run: what is told is true, and each sort of mistake is told with its line."""

import asyncio

import pytest

from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.game import Game, Superseded
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose, extent
from logical_robots_tui.mind import Program
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import HALL, Play

ENGINES = "desire: {left_engine: 0.1, right_engine: 0.1}"
PLAIN = f'Robot(robot_name:, {ENGINES}, memory: "") :- Sensor(robot_name:);'


async def diagnosed(level: Level, text: str, ticks: int = 6) -> Diagnosis:
    game = Game(level, Program.compile(text))
    try:
        await game.run_until(tick=ticks)
        return await diagnose(game)
    finally:
        await game.close()


def places(diagnosis: Diagnosis) -> list[tuple[str, int | None]]:
    return [(one.kind, one.span.line if one.span else None) for one in diagnosis.findings]


def kinds(diagnosis: Diagnosis) -> list[str]:
    return [finding.kind for finding in diagnosis.findings]


def the(diagnosis: Diagnosis, kind: str) -> tuple[Finding, SourceSpan]:
    finding = next(finding for finding in diagnosis.findings if finding.kind == kind)
    assert finding.span is not None
    return finding, finding.span


async def test_where_there_is_no_mistake_there_is_nothing_to_tell(play: Play) -> None:
    answer = '(if StartsWith(robot_name, "A") then robot_name ++ "!" else "nobody")'
    used = f"Awake() :- Sensor(robot_name: r);\n{PLAIN[:-1]}, Awake();"  # a predicate
    game = play(used.replace('""', answer))  # with texts that are no names
    assert extent(await diagnose(game)) == "There are no ticks to examine yet."
    await game.run_until(tick=6)
    diagnosis = await diagnose(game)
    assert diagnosis.findings == ()
    assert extent(diagnosis) == "Ticks 1 to 6, not won."


async def test_a_text_that_the_program_gives_itself_is_no_mistake(level: Level) -> None:
    text = PLAIN.replace("robot_name:);", "robot_name:), Plan(phase: Now(robot_name));")
    rules = 'Plan(phase: "out");\nNow(name) = (if name == "Ada" then "out" else "in");'
    assert "unknown string" not in kinds(await diagnosed(level, f"{rules}\n{text}"))


async def test_a_comparison_beside_an_equation_is_told_with_what_it_lacks(level: Level) -> None:
    text = f"""Robot(robot_name:, {ENGINES}, memory: short) :-
    Sensor(robot_name:, sensor:), short = sensor.forward_distance < 0;"""
    finding, span = the(await diagnosed(level, text), "no rows")
    assert span.text == "short = sensor.forward_distance < 0"
    assert "at best short = sensor.forward_distance was" in finding.message


WRONG = """Num(1); Num(2); One(1);
Odd(robot_name:) :- Sensor(robot_name:), Num(x), (x > 5 | x < 0);
Awake() :- Sensor(robot_name: "Nobody");
Far(robot_name:) :- Sensor(robot_name:, sensor:),
  sensor.clock > 9000;
Go(d) = (if d < 0 then 0 else 0.1);
Turn(sensor) = (if sensor.forward_object == "Wall" then 0 else 0.1);
Sees(radar, what) = Min{ray.distance :- ray in radar, ray.object == what};
Ahead(ray) :- ray.distance > 90;
Big(x) :- Num(x); Made := Big(Num: One);
Other := Big(Num: One);
Robot(robot_name:, desire: {left_engine: Go(sensor.forward_distance), right_engine: Turn(sensor)},
  memory: {count:, near:, far:, scale:,
    other: 1}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), Made(y), Other(y),
  ~Odd(robot_name:), ~Awake(), ~Far(robot_name:),
  robot_name != "Adda",
  count = Coalesce(memory.counts, 0),
  near = Sees(sensor.radar, "wall"),
  far = Sees(sensor.radar, "wal"),
  scale = Coalesce(sensor.forward_distance / 1000, sensor.clock);
"""
TOLD = [
    ("no rows", 2, "The rule of Odd in line 2 never had a row"),
    ("no rows", 3, "Awake"),
    ("no rows", 5, "`sensor.clock > 9000` never held in the 12 cases evaluated, first at tick 1; "
     "at best sensor.clock was 8994 too little"),
    ("never true", 6,
     "`d < 0` never held in the 12 cases evaluated, first at tick 1; at best d was"),
    ("never true", 7, '`sensor.forward_object == "Wall"` never held in the 12 cases evaluated'),
    ("unused", 9, "Nothing uses Ahead."),
    ("same copy", 11, "Other and Made are the same: both are `Big(Num: One)`."),
    ("memory never read", 14, "The field other of memory is written and never read"),
    ("unknown string", 17, 'Nothing in this level is called "Adda".'),
    ("memory never written", 18, "memory.counts is read, but no memory ever had a field counts"),
    ("never true", 20,
     '`ray.object == "wal"` never held in the 372 cases evaluated, first at tick 1.'),
    ("never null", 21, "`sensor.forward_distance / 1000` was never null in the 12 cases evaluated, "
     "first at tick 1: `sensor.clock` was never used."),
]  # fmt: skip


async def test_each_mistake_of_many_is_told_with_its_line(level: Level) -> None:
    diagnosis = await diagnosed(level, WRONG)
    messages = [finding.message for finding in diagnosis.findings]
    findings = list(zip(places(diagnosis), messages, strict=True))
    for *place, words in TOLD:
        assert any(there == (*place,) and words in message for there, message in findings), findings


MISTAKES = f"""
4 memory lost: Ada forgot memory.count at tick 3
Robot(robot_name:, {ENGINES}, memory: {{count: n}}) :- n < 3,
  Memory(robot_name:, memory:), n == Coalesce(memory.count, 0) + 1;
Robot(robot_name:, {ENGINES},
  memory: "") :- n >= 3, Memory(robot_name:, memory:), n == Coalesce(memory.count, 0) + 1;

2 several rows: They come from the rules in lines 1 and 2.
{PLAIN}
{PLAIN[:-2]}, sensor:), sensor.clock > 2;

3 several rows: Robot has 2 rows for Ada
Speed("slow", 0.1);
Speed("fast", 0.5);
Speed("slow", 0.2);
Robot(robot_name:, desire: {{left_engine: x, right_engine: x}}, memory: "") :-
  Sensor(robot_name:), kind == "slow", Speed(kind, x);

2 no row: First at tick 4, 6 times in total
{PLAIN[:-2]}, sensor:),
  sensor.clock < 4;

3 bad engine: `Near(sensor.radar)` was null
Near(radar) = Min{{ray.distance :-
  ray in radar, ray.distance < 0}};
Robot(robot_name:, desire: {{left_engine: Near(sensor.radar), right_engine: 0}},
  memory: "") :- Sensor(robot_name:, sensor:);
"""


@pytest.mark.parametrize("mistake", MISTAKES.strip().split("\n\n"))
async def test_a_mistake_is_told_with_its_line(level: Level, mistake: str) -> None:
    finding, _, text = mistake.partition("\n")
    place, _, words = finding.partition(": ")
    diagnosis = await diagnosed(level, text)
    assert place in [f"{line} {kind}" for kind, line in places(diagnosis)]
    assert any(words in finding.message for finding in diagnosis.findings)


async def test_where_the_values_of_an_engine_that_is_null_came_from_is_told(level: Level) -> None:
    text = """Angle(radar, name) = Avg{ray.angle :- ray in radar, ray.label == name};
    Met(robot_name:, other:) :-
      Sensor(robot_name:), Memory(robot_name: other);
    Guide(robot_name:, guide? Max= other) distinct :- Met(robot_name:, other:);
    Robot(robot_name:, memory: "",
      desire: {left_engine: Angle(sensor.radar, guide), right_engine: 0}) :-
      Sensor(robot_name:, sensor:), Guide(robot_name:, guide:);"""
    finding, span = the(await diagnosed(level, text), "bad engine")
    assert span.line == 6
    assert {span.line for span in finding.related} == {1, 3, 4, 7}


COPIED = f"""Far(r) :- r.distance > 9000;
Other(r) :- r.distance > 8000;
Seen(robot_name:) distinct :- Sensor(robot_name:, sensor:), r in sensor.radar, Far(r);
Spotted := Seen(Far: Other);
{PLAIN[:-1]}, ~Seen(robot_name:), ~Spotted(robot_name:);"""


async def test_of_a_made_predicate_the_conditions_are_told_that_it_really_has(level: Level) -> None:
    messages = str([finding.message for finding in (await diagnosed(level, COPIED)).findings])
    assert "`r.distance > 8000` never held in Spotted in the" in messages
    assert "`r.distance > 9000` never held in Spotted" not in messages


async def test_a_program_with_copies_of_any_kind_can_be_watched(level: Level) -> None:
    for rules in (  # of a made predicate, of a recursion
        "A(x: 1); B(x: 2); P(x:) :- A(x:); C := P(A: B); Q(x:) :- C(x:), A(x:); D := Q(A: B);",
        "@Recursive(T, 5); T(x: 1) distinct; T(x: y + 1) distinct :- T(x: y), y < 4; D := T();",
    ):
        assert (await diagnosed(level, f"{rules}\n{PLAIN[:-1]}, ~D(x: 7);", 2)).findings


async def test_of_a_pattern_that_is_only_copied_nothing_is_told(level: Level) -> None:
    both = COPIED.replace("> 8000", "< 9000").replace("~Spotted", "Spotted")
    copied = await diagnosed(level, both.replace(", ~Seen(robot_name:)", ""))
    assert set(kinds(copied)) <= {"never false"}
    assert ("never true", 1) in places(await diagnosed(level, both))


ONCE = (
    'Turn(word) = (if word == "left" then 0.2 else 0.1);\n'
    "Robot(robot_name:, desire: {left_engine: x, right_engine: 0.1}, memory: {word:}) :-\n"
    "  Sensor(robot_name:, sensor:),\n"
    '  word = (if sensor.clock < 50 then "left" else "lamp"),\n'
    "  x = (if sensor.clock ASKED then Turn(word) else 0.1);"
)


@pytest.mark.parametrize("asked", ["== 50", "> 52", "> 49 || sensor.clock == 2"])
async def test_what_never_held_is_told_with_the_cases_that_asked(level: Level, asked: str) -> None:
    findings = (await diagnosed(level, ONCE.replace("ASKED", asked), 60)).findings
    notes = [(note.severity, note.message) for note in findings if '"left"' in note.message]
    message = '`word == "left"` never held in the 16 cases evaluated, first at tick 53.'
    assert notes == ([("note", message)] if asked == "> 52" else [])


async def test_causes_are_told_before_what_follows_from_them(level: Level) -> None:
    text = f"""Nearer(robot_name:) :- Near(robot_name:);
Near(robot_name:) :- Sensor(robot_name:, sensor:),
  sensor.clock > 9000;
Robot(robot_name:, {ENGINES}, memory: "") :-
  Sensor(robot_name:),
  ~Nearer(robot_name:);"""
    findings = [("no rows", 3), ("no rows", 1), ("never false", 6)]
    assert places(await diagnosed(level, text)) == findings


async def test_a_condition_and_its_negation_are_one(level: Level) -> None:
    text = f"{PLAIN[:-2]}, sensor:),\n  !(sensor.clock > 9000);"
    assert places(await diagnosed(level, text)) == [("never true", 2)]


async def test_what_happens_in_one_tick_of_many_is_not_said_never_to_happen(level: Level) -> None:
    text = """Robot(robot_name:, desire: {left_engine: if sensor.clock == 1234 then 0.2 else 0,
      right_engine: if sensor.clock == 9234 then 0.2 else 0},
      memory: "") :- Sensor(robot_name:, sensor:);"""
    diagnosis = await diagnosed(level, text, 1300)
    assert diagnosis.last == 1300
    never = [place for place in places(diagnosis) if place[0].startswith("never")]
    assert never == [("never true", 2)]


async def test_nothing_is_said_of_what_is_too_much_to_ask(level: Level) -> None:
    text = f"Big(x:) :- x in Range(1500), y == 3000,\n  x == y - 1;\n{PLAIN[:-1]}, ~Big();"
    diagnosis = await diagnosed(level, text)
    assert diagnosis.left_out == 1
    assert 2 not in [line for _, line in places(diagnosis)]
    assert "too expensive to examine: 1." in extent(diagnosis)
    assert ("no rows", 2) in places(await diagnosed(level, text.replace("1500", "500")))


async def test_only_the_ticks_of_the_present_program_count(play: Play) -> None:
    game = play(f"{PLAIN}\n{PLAIN.replace('0.1', '0.2')}")
    await game.run_until(tick=3)
    assert kinds(await diagnose(game)) == ["several rows"]
    game.use(Program.compile(PLAIN))
    await game.run_until(tick=5)
    diagnosis = await diagnose(game)
    assert (diagnosis.first, diagnosis.last, diagnosis.findings) == (4, 5, ())


async def test_it_can_be_stopped_and_tells_how_far_it_is(play: Play) -> None:
    game = play(PLAIN)
    await game.run_until(tick=200)
    steps: list[tuple[int, int]] = []
    begun = asyncio.Event()

    def report(done: int, of_all: int) -> None:
        steps.append((done, of_all))
        begun.set()

    text = "Odd(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock == -1;"
    game.use(Program.compile(f"{text}\n{PLAIN}"))
    task = asyncio.create_task(diagnose(game, report=report))
    await begun.wait()
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert steps
    assert all(done <= of_all for done, of_all in steps)
    game.back(30)  # and another future ends it
    game.use(Program.compile(PLAIN.replace("0.1", "0.2")))
    await game.run_until(tick=201)
    game.use(Program.compile(f"Odd(robot_name:) :- Sensor(robot_name:), 1 == 2;\n{PLAIN}"))
    with pytest.raises(Superseded):
        await diagnose(game, report=lambda _done, _all: game.history.change_branch())


NO_DOOR = read_native(HALL.split("[[areas]]")[0], "no door", "")


async def test_who_stands_still_goes_round_or_pushes_against_a_wall_is_told_of() -> None:
    for left, right, kind, words in (
        (0, 0, "still", "Ada stood still from tick 1 to 300"),
        (1, -1, "circle", "Ada goes round in a circle of"),
        (1, 1, "blocked", "Ada was blocked from tick"),
    ):
        text = f"""Go() =
  {{left_engine: {left}, right_engine: {right}}};
Robot(robot_name:, desire: Go(),
  memory: "") :- Sensor(robot_name:);"""
        finding, span = the(await diagnosed(NO_DOOR, text, 300), kind)
        assert finding.message.startswith(words)
        assert span.line == 3
        assert {span.line for span in finding.related} <= {1, 2}


async def test_who_has_just_got_stuck_is_not_on_its_way() -> None:
    text = "Robot(robot_name:, desire: {left_engine: E, right_engine: E}) :- Sensor(robot_name:);"
    for engine, is_on_way in (("0.1", True), ("1", False)):
        told = kinds(await diagnosed(NO_DOOR, text.replace("E", engine), 200))
        assert ("unfinished" in told, "blocked" in told) == (is_on_way, False)


VARIANTS = [pytest.param(*case, marks=pytest.mark.slow) for case in ((1, "blocked"), (2, "still"))]


@pytest.mark.parametrize(("last", "kind"), [(0, "circle"), *VARIANTS])
async def test_of_several_rows_the_rule_whose_row_counts_is_told_of(last: int, kind: str) -> None:
    rules = [
        'Robot(robot_name:, memory: "", desire:) :- Sensor(robot_name:),\n'
        f"  desire = {{left_engine: {left}, right_engine: {right}}};"
        for left, right in ((1, -1), (1, 1), (0, 0))
    ]
    rules.append(rules.pop(last))
    _, span = the(await diagnosed(NO_DOOR, "\n".join(rules), 300), kind)
    assert span.line == 6


COPIES = """Near(ray) :- ray.distance < 0;
Far(ray) :- ray.distance > 0;
Stop() = {left_engine: 0, right_engine: 0};
Go() = {left_engine: 0.1, right_engine: 0.1};
Worker(robot_name:, desire:) :-
  Sensor(robot_name:, sensor:), seen = Max{1 :- ray in sensor.radar, Near(ray)},
  desire = (if seen is not null
    then Stop()
    else Go());
Sleeper := Worker(Near: Far);
Robot(robot_name: "Ada", desire:, memory: "") :- Sleeper(robot_name: "Ada", desire:);
Robot(robot_name: "Bo", desire:, memory: "") :- Worker(robot_name: "Bo", desire:);
"""


async def test_who_stands_still_does_so_by_the_rule_that_gave_its_row_copied_or_not() -> None:
    finding, span = the(await diagnosed(NO_DOOR, COPIES, 300), "still")
    assert (finding.robot, span.line, span.text) == ("Ada", 8, "Stop()")


STATES = """Plan(state: "wait", limit: 9000, next: "go");
Plan(state: "go", limit: 9000, next: "wait");
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {state:, name:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  Plan(state: now, limit:, next:), now == Coalesce(memory.state, "wait"),
  name = Coalesce(memory.name, robot_name),
  state = (if sensor.clock > limit then next else now);
"""


async def test_who_makes_no_progress_in_a_state_is_told_of_where_the_state_is_set() -> None:
    diagnosis = await diagnosed(NO_DOOR, STATES, 300)
    assert kinds(diagnosis).count("unchanged") == 1
    finding, span = the(diagnosis, "unchanged")
    assert finding.message == 'Ada\'s memory.state stayed "wait" from tick 1 to 300.'
    assert span.line == 7
    assert 5 in {span.line for span in finding.related}
