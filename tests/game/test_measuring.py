"""What is measured of a program that wins: ticks, size, distance, robustness, bonus goals."""

import asyncio
import math
import threading
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.reference import measure_reference
from logical_robots_tui import Program, list_levels, load_level
from logical_robots_tui.game import level_key, load_program, measuring, reference_for
from logical_robots_tui.game.measuring import (
    Trial,
    measure,
    mirror,
    play_through,
    start_of,
    try_starts,
    vary_start,
)
from logical_robots_tui.game.source import reference_names
from logical_robots_tui.game.victory import reference_table, victory_of
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.mind import Stopped
from logical_robots_tui.progress import Measures
from logical_robots_tui.world import Area, Beacon, Level, LevelError
from logical_robots_tui.world.level import SecondGoal, alike
from logical_robots_tui.world.levels.native import read_native
from tests.explain.asking import REST
from tests.game.playing import SLOW, Play
from tests.short import AHEAD
from tests.short import LEVEL as SHORT
from tests.waiting import until

STILL = REST.replace('""', "1")


@pytest.fixture
def level(tmp_path: Path) -> Level:
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    return load_level(path)


def test_the_size_is_the_number_of_names_literals_and_operators() -> None:
    for text, size in {
        AHEAD: 11,
        "# A(x) :- B(x);\n" + AHEAD: 11,
        '@Visible(Memory, "all");\n' + AHEAD: 11,
        "A(1);\nA(2);\n/* A(3); */\n" + AHEAD: 15,
        'A("a; b; c");\n' + AHEAD: 13,
        "F := G(A: B);\n" + AHEAD: 16,
        AHEAD.rstrip().removesuffix(";"): 11,
        "": 0,
        "A(x, y: -0.5 * r.z) :- B(..r), ~C(x), r.a is not null": 17,
        "A(x)=if x>=1 then 'it\\'s' else if !B(x) then `t` else true": 14,
        "A(k, n? Max= v, m? += 1) distinct :- k -> v in [1, 2.5]": 16,
        "A(x):-B(x),x!=1||x==2": 11,
    }.items():
        assert size_of(text) == size, text


async def test_the_distance_is_what_all_robots_have_driven(level: Level, play: Play) -> None:
    game = play(AHEAD, level)
    history = game.history
    await game.run_until(tick=10)
    driven = game.frame.after.robots[0].x - 12
    assert history.moment(10).driven == pytest.approx(driven)
    game.go_to(4)
    game.use(Program.compile(STILL))
    await game.step()
    assert history.moment(5).driven == history.moment(4).driven == pytest.approx(driven * 0.4)

    def programs(up_to: int) -> list[tuple[int, str]]:
        return [(tick, program.text) for tick, program in history.programs(up_to)]

    assert programs(4) == [(1, AHEAD)]
    assert programs(5) == [(1, AHEAD), (5, STILL)]
    game.restart()
    await game.step()
    assert programs(1) == [(1, STILL)]
    assert history.moment(1).driven == 0


def test_varied_starts_are_always_the_same_and_near_the_given_one(level: Level) -> None:
    (given,) = level.robots
    starts, again = ([vary_start(level, n).robots[0] for n in range(20)] for _ in range(2))
    assert starts == again
    assert len({start.x for start in starts}) == 20
    for start in starts:
        assert max(abs(start.x - given.x), abs(start.y - given.y)) <= 8
        assert abs(start.angle - given.angle) <= 0.2


def test_goals_bring_others_together_in_varied_starts_with_other_names() -> None:
    level = load_level("14-right-of-way")
    homes = {frozenset(area.victory_robots) for area in level.areas}
    starts = [vary_start(level, seed) for seed in range(100)]
    goals = [frozenset(frozenset(area.victory_robots) for area in start.areas) for start in starts]
    assert not any(homes & others for others in goals)
    assert len({*goals}) == 9
    for start in starts:
        west = {robot.name for robot in start.robots if robot.x < 300}
        assert [set(area.victory_robots) == west for area in start.areas] == [False, True]
    together = replace(level, areas=(replace(level.areas[0], victory_robots=("Moss", "Fern")),))
    together = replace(together, shuffled_names=("Moss", "Fern"))
    assert set(vary_start(together, 0).areas[0].victory_robots) == {"Moss", "Fern"}


async def test_a_program_is_measured_in_a_process_that_tells_how_far_it_is(level: Level) -> None:
    program = Program.compile(AHEAD)
    played = play_through(level, program, 1000)
    assert played.won_at is not None
    assert 40 < played.won_at < 60
    assert 20 < played.distance < 40
    assert play_through(level, program, 10).won_at is None
    assert measuring.patience_for(1000) >= 2000  # a varied start may take twice as long
    assert measuring.patience_for(19_000) <= 40_000
    assert play_through(level, Program.compile(STILL), 30).distance == 0
    won: dict[int, int] = {}
    wins = try_starts(level, program, 200, starts=5, report=won.__setitem__)
    assert list(won) == [1, 2, 3, 4, 5]
    assert won[5] == wins
    stop = threading.Event()
    with pytest.raises(Stopped):
        try_starts(level, program, 200, stop=stop, report=lambda _tried, _won: stop.set())
    trials: list[Trial] = []
    measures = await measure(level, program, None, trials.append)
    assert measures is not None
    assert measures[:3] == (played.won_at, 11, played.distance)
    assert measures.starts == 20
    assert trials[-1] == Trial(20, measures.wins or 0, 20)
    assert [trial.tried for trial in trials] == list(range(1, 21))


def test_known_measures_are_not_taken_again_and_who_does_not_win_has_none(
    level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = Measures(ticks=55, size=7, distance=1.0)
    measures = measuring._measure(level, Program.compile(AHEAD), known)
    assert measures is not None
    assert (*measures[:3], measures.starts) == (55, 7, 1.0, 20)
    monkeypatch.setattr(measuring, "MOST_TICKS", 50)
    assert measuring._measure(level, Program.compile(STILL), None) is None


@pytest.mark.proof
async def test_that_it_has_none_is_told_by_the_process(level: Level) -> None:
    assert await measure(level, Program.compile(STILL), None) is None


async def test_measuring_ends_with_its_process_when_it_is_cancelled(level: Level) -> None:
    task = asyncio.create_task(measure(level, Program.compile(SLOW), None))
    await asyncio.to_thread(until, measuring_processes)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    await asyncio.to_thread(until, lambda: not measuring_processes())


def measuring_processes() -> list[str]:
    commands = []
    for children in Path("/proc/self/task").glob("*/children"):
        for pid in children.read_text().split():
            with suppress(OSError):
                commands.append(Path(f"/proc/{pid}/cmdline").read_text())
    return [command for command in commands if "game.measuring" in command]


def test_progress_at_a_level_of_ones_own_is_kept_by_its_path(level: Level) -> None:
    assert level_key(level) == level.source
    assert level_key(load_level("01-first-steps")) == "01-first-steps"
    assert reference_for(level) is None


def test_there_are_references_for_each_level_that_has_a_solution() -> None:
    solved = {name: reference_names(load_level(name).solution) for name in list_levels()}
    assert {name: list(table) for name, table in reference_table().items()} == solved
    for table in reference_table().values():
        for program, measures in table.items():
            assert measures.size == size_of(load_program(program).text)
            assert 0 < measures.ticks <= 20_000


@pytest.mark.proof
@pytest.mark.parametrize("name", reference_table())
async def test_the_references_are_what_their_programs_do(name: str) -> None:
    for program, measures in reference_table()[name].items():
        found = await measure_reference(load_level(name), program)
        assert found == measures, f"{program}: run `make measures`"


def test_varied_starts_exchange_the_names_that_a_level_shuffles_wherever_they_stand() -> None:
    level = load_level("10-distributed-mapping")
    beacons = ("B01", "Base")
    lamps = tuple(Area(name, 10, 10, 5, on_beacon=name, off_beacon="B02") for name in beacons)
    robots = tuple(replace(each, team=each.color) for each in level.robots)
    level = replace(level, robots=robots, areas=(*level.areas, *lamps), shuffled_names=())
    plain = [vary_start(level, seed) for seed in range(20)]
    level = replace(level, shuffled_names=("B??", "[A-C]*[!e]"))
    starts = [vary_start(level, seed) for seed in range(20)]
    again = [vary_start(level, seed).robots for seed in range(20)]
    assert [start.robots for start in starts] == again
    for start, unnamed in zip(starts, plain, strict=True):
        for kind in ("robots", "beacons"):
            were, are = getattr(level, kind), getattr(start, kind)
            new = {was.name: now.name for was, now in zip(were, are, strict=True)}
            assert set(new) == set(new.values())
            kept = {name for name, other in new.items() if name == other}
            assert kept == ({"Base"} if kind == "beacons" else {"Dahlia", "Ebony", "Flint"})
            assert are == tuple(replace(one, name=new[one.name]) for one in getattr(unnamed, kind))
            if kind == "robots":
                names = new
        goal, *lamps_now = start.areas
        assert goal.victory_robots == tuple(names[name] for name in level.areas[0].victory_robots)
        assert [(lamp.on_beacon, lamp.off_beacon) for lamp in lamps_now] == [
            (new[name], new["B02"]) for name in beacons
        ]
    assert len({start.beacons for start in starts}) == 20


def test_one_name_stays_and_two_change_by_chance_and_the_given_start_is_as_in_the_file() -> None:
    level = read_native(SHORT, "short", "")
    two = (Beacon("one", 5, 5), Beacon("two", 9, 9), Beacon("other", 9, 5))
    level = replace(level, beacons=two, shuffled_names=("one", "t*", level.robots[0].name))
    starts = [vary_start(level, seed) for seed in range(20)]
    assert {start.robots[0].name for start in starts} == {level.robots[0].name}
    orders = {tuple(beacon.name for beacon in start.beacons) for start in starts}
    assert orders == {("one", "two", "other"), ("two", "one", "other")}
    assert start_of(level, 0) is level


def test_patterns_that_are_none_or_match_nothing_are_refused() -> None:
    for value, where, message in (
        ("true", "", '"shuffled_names" must be a list, not true or false.'),
        ("[3]", "[0]", "This must be text, not a number."),
        ('["*", "a"]', "[1]", '"shuffled_names" has "a", but no robot or beacon has such a name.'),
        (str(["*"] * 1001), "", "There are 1001 shuffled_names; at most 1000 are allowed."),
    ):
        with pytest.raises(LevelError) as raised:
            read_native(f"shuffled_names = {value}\n{SHORT}", "short", "short.toml")
        assert raised.value.message == message
        assert raised.value.place == f"short.toml: shuffled_names{where}"


GOALS = (
    "at most 11 symbols",
    "at most 60 ticks",
    "at most 30 units",
    "never blocked",
    "wins from all 20 starts",
    "wins in the mirrored labyrinth",
)
AT_ONCE, LATER = GOALS[:4], GOALS[5]
"""Those that a victory shows by itself, and one that takes another run."""
BACKWARDS = """\
Power(clock) = (if clock < 20 then -1 else 0.5);
Robot(robot_name:, desire: {left_engine: power, right_engine: power}, memory: 1) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:), power == Power(sensor.clock);
"""
"""It is blocked at first, then wins, and has more symbols."""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "goals.toml").write_text(f"second_goals = {list(GOALS)}\n{SHORT}", "utf-8")
    return tmp_path / "goals.toml"


OTHERS = ((BACKWARDS, (LATER,)), ("A(1);\n" + AHEAD, (*AT_ONCE[1:], LATER)))
SLOWER = [pytest.param(*other, marks=pytest.mark.slow) for other in OTHERS]


@pytest.mark.parametrize(("text", "reached"), [(AHEAD, (*AT_ONCE, LATER)), *SLOWER])
async def test_a_game_and_a_measuring_process_find_the_same(
    file: Path, text: str, reached: tuple[str, ...], play: Play
) -> None:
    level, program = load_level(file), Program.compile(text)
    game = play(program, level)
    await game.run_until(tick=500)
    victory = victory_of(game, level)
    assert victory is not None
    assert victory.measures is not None
    measured = await measure(level, program, None)
    assert measured is not None
    assert victory.measures.goals == tuple(goal for goal in reached if goal in AT_ONCE)
    assert measured.goals == reached
    assert measured.wins != 20
    known = victory.measures._replace(wins=20, starts=20)
    again = await measure(level, program, known)
    assert again == known._replace(goals=(*known.goals, *GOALS[4:]))


async def test_who_goes_back_before_a_wall_was_not_blocked(file: Path, play: Play) -> None:
    game = play(BACKWARDS, load_level(file))
    await game.run_until(tick=40)
    assert game.history.is_blocked_up_to(40)
    first = next(tick for tick in range(40) if game.history.is_blocked_up_to(tick))
    game.go_to(first - 1)
    game.use(Program.compile(AHEAD))
    await game.run_until(tick=first + 5)
    assert not game.history.is_blocked_up_to(first + 5)
    game.restart()
    await game.step()
    assert not game.history.is_blocked_up_to(1)


def test_a_goal_is_written_as_it_is_read_but_passed_over_if_it_is_no_more(file: Path) -> None:
    goals = [SecondGoal.parse(words) for words in GOALS]
    assert [goal and goal.words for goal in goals] == list(GOALS)
    earlier = '"at most 3 rules", "never blocked", "without memory", "at most 1 rule"'
    file.write_text(f"second_goals = [{earlier}]\n{SHORT}", "utf-8")
    assert [goal.words for goal in load_level(file).second_goals] == ["never blocked"]


def test_a_mirrored_level_is_the_same_from_the_other_side() -> None:
    level = load_level("06-breadcrumbs")
    mirrored = mirror(level)
    assert mirrored.robots[0].x == level.width - level.robots[0].x
    assert math.cos(mirrored.robots[0].angle) == pytest.approx(-math.cos(level.robots[0].angle))
    assert math.sin(mirrored.robots[0].angle) == pytest.approx(math.sin(level.robots[0].angle))
    assert (mirrored.walls == level.walls[:, ::-1]).all()
    assert not mirrored.walls.flags.writeable
    assert alike(replace(mirror(mirrored), robots=level.robots), level)


def test_what_is_not_a_second_goal_is_refused(file: Path) -> None:
    numbers = ("at most -1 symbols", "at most 1 symbols", "at most 1 symbol ", "at most many ticks")
    for words in (*numbers, "NEVER blocked", "fast"):
        file.write_text(f'second_goals = ["never blocked", "{words}"]\n{SHORT}', "utf-8")
        with pytest.raises(LevelError) as caught:
            load_level(file)
        assert caught.value.place == f"{file}: second_goals[1]"
        assert caught.value.message == f'"{words}" is not a bonus goal.'
