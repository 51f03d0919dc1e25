"""Briefings and hints, followed literally, lead to where they say.

``steps`` has the program that results from each step that gives code or says what to do first; the
last hint of a level mostly results in its solution.
"""

from __future__ import annotations

import re
from functools import cache
from math import dist
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest

from logical_robots_tui import Mind, Program, World, load_level
from tests.levels.playing import LEVELS, measured, program_text, ticks_to_win

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from logical_robots_tui import Level
    from logical_robots_tui.mind.program import Table
    from logical_robots_tui.world.dynamics import WorldState

STEPS = Path(__file__).with_name("steps")
each_level = pytest.mark.parametrize("name", LEVELS)


NO_TABLES: Mapping[str, Table] = MappingProxyType({})


class Moment(NamedTuple):
    """The middle of a tick: robots have sensed and not yet decided."""

    level: Level
    tick: int
    state: WorldState
    rows: Any
    memories: dict[str, Any]
    mind: Mind
    tables: Mapping[str, Table] = NO_TABLES

    def radar(self, robot: str) -> list[Any]:
        (sensor,) = (row["sensor"] for row in self.rows if row["robot_name"] == robot)
        return list(sensor["radar"])

    def to(self, beacon: str, robot: str) -> float:
        """How far a robot is from the nearest beacon of a name."""
        (state,) = (r for r in self.state.robots if r.name == robot)
        beacons = [b for b in self.level.beacons if b.name == beacon]
        return min(dist((state.x, state.y), (b.x, b.y)) for b in beacons)


def moments(name: str, text: str, ticks: int) -> Iterator[Moment]:
    level = load_level(name)
    sees = level.visibility
    world = World(level)
    mind = Mind(Program.compile(text), memory=sees.memory, sensor=sees.sensor)
    memories: dict[str, Any] = {robot.name: "" for robot in level.robots}
    try:
        while world.tick < ticks:
            rows = world.sense()
            yield Moment(level, world.tick, world.save(), rows, memories, mind)
            decisions = mind.think(rows, memories)
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
    finally:
        mind.close()


def at(name: str, ticks: Sequence[int], *predicates: str) -> list[Moment]:
    """Some ticks of a level under its starter, with the tables of some predicates."""
    return [
        moment._replace(
            tables={p: moment.mind.query(p, moment.rows, moment.memories) for p in predicates}
        )
        for moment in moments(name, program_text(load_level(name).starter), max(ticks))
        if moment.tick in ticks
    ]


def squeezed(text: str) -> str:
    return "".join(text.split())


@cache
def step(name: str, which: str) -> str:
    """The program that results from the ``briefing`` or the last ``hint``."""
    path = STEPS / f"{name}-{which}.l"
    return path.read_text("utf-8") if path.exists() else program_text(load_level(name).solution)


# What hints say.


@each_level
def test_only_the_last_hint_gives_code_and_those_before_it_ask(name: str) -> None:
    *first, last = load_level(name).hints
    assert re.search(r"[Ll]ook at|how (long|small|far)", first[0])
    for hint in first:
        assert "?" in hint
        assert not re.search(r"`|:-|[{}=]|Min\{", hint)
    assert "`" in last


@each_level
def test_the_code_of_the_last_hint_is_in_the_program_that_results(name: str) -> None:
    text = squeezed(step(name, "hint"))
    for code in re.findall(r"`([^`]+)`", load_level(name).hints[-1]):
        parts = map(squeezed, code.split("..."))
        assert all(part.rstrip(";") in text for part in parts), code


@pytest.mark.sampled
@each_level
def test_the_program_that_results_from_the_last_hint_wins(name: str) -> None:
    ticks = 2 * measured(name).ticks
    assert ticks_to_win(load_level(name), step(name, "hint"), ticks)


# What is to be seen where a hint says "look".


def engines(moment: Moment) -> list[tuple[float, float]]:
    """The desires that ``Robot`` has at a moment."""
    table = moment.tables["Robot"]
    desires: list[Any] = [row[table.columns.index("desire")] for row in table.rows]
    return [(desire["left_engine"], desire["right_engine"]) for desire in desires]


def chosen(moment: Moment, predicate: str) -> dict[str, str]:
    """The labels of the rays that a predicate has for each robot."""
    table = moment.tables[predicate]
    name, ray = table.columns.index("robot_name"), table.columns.index("ray")
    rows: list[Any] = list(table.rows)
    return {row[name]: row[ray]["label"] for row in rows}


def ada_touches_the_wall() -> bool:
    (moment,) = at("01-first-steps", [400])
    return bool(moment.rows[0]["sensor"]["forward_distance"] == 1)


def both_engines_are_equal() -> bool:
    found = at("02-open-space", [1, 100, 180], "Robot")
    return all(left == pytest.approx(right) for m in found for left, right in engines(m))


def the_long_rays_are_on_the_right() -> bool:
    before, stuck = at("02-open-space", [150, 200])
    longest = sorted(before.radar("Ada"), key=lambda ray: -float(ray["distance"]))[:10]
    return all(ray["angle"] < 0 for ray in longest) and all(
        ray["distance"] == 1 for ray in stuck.radar("Ada")
    )


def the_door_is_far_on_the_right() -> bool:
    before, there = at("03-the-long-hall", [40, 60], "Robot")
    near, far = (
        min(ray["distance"] for ray in moment.radar("Ada") if ray["angle"] < -0.6)
        for moment in (before, there)
    )
    ((left, right),) = engines(there)
    return bool(near < 75 and far > 100 and left == right)


def ruby_sees_home() -> bool:
    (moment,) = at("04-everybody-home", [750])
    seen = {(ray["object"], ray["label"]) for ray in moment.radar("Ruby")}
    return ("beacon", "Home") in seen and {kind for kind, _ in seen} <= {"beacon", "wall", "none"}


def ships_choose_any_light() -> bool:
    before, after = (chosen(m, "Course") for m in at("05-lighthouse", [400, 800], "Course"))
    return set(before.values()) == {"White", "Blue"} and set(after.values()) == {"Wreck"}


def hansel_turns_back_to_oat() -> bool:
    (moment,) = at("06-breadcrumbs", [780], "Last", "Next")
    last = {row[0]: row[1] for row in moment.tables["Last"].rows}
    return last["Hansel"] == "wheat" and chosen(moment, "Next")["Hansel"] == "oat"


def fay_has_no_post_in_sight() -> bool:
    (moment,) = at("07-station-management", [950], "Post", "PostInSight")
    sees = any(ray["label"] == "Fire station" for ray in moment.radar("Fay"))
    posts = {row[-1] for row in moment.tables["Post"].rows}
    return sees and posts == {"Mine"} and "Fay" not in chosen(moment, "PostInSight")


def amber_and_teal_have_met() -> bool:
    found = at("08-formation", [503, 504, 520])
    sees = ["Teal" in {ray["label"] for ray in moment.radar("Amber")} for moment in found]
    leaders = {name: memory["leader"] for name, memory in found[-1].memories.items()}
    return sees == [False, True, True] and (leaders["Amber"], leaders["Teal"]) == ("Amber", "Teal")


def ada_circles_the_torch() -> bool:
    found = at("09-the-gate", range(500, 1501, 50))
    states = {moment.memories["Ada"]["phase"] for moment in found}
    return states == {"out"} and max(moment.to("Torch", "Ada") for moment in found) < 30


def beryl_sees_several_beacons() -> bool:
    (moment,) = at("10-distributed-mapping", [100])
    rays = moment.radar("Beryl")
    return len({ray["label"] for ray in rays if ray["object"] == "beacon"}) > 1


def volta_charges_a_little() -> bool:
    powers = [
        row["sensor"]["self"]["battery_level"]
        for moment in at("11-power-line", range(450, 601, 10))
        for row in moment.rows
        if row["robot_name"] == "Volta"
    ]
    return bool(max(powers) > max(powers[0], powers[-1]) + 20)


def nobody_settles_any_more() -> bool:
    before, after = (
        sum(memory["settled"] for memory in moment.memories.values())
        for moment in at("12-swarm", [300, 400])
    )
    return bool(before == after < 50)


def two_are_in_the_door() -> bool:
    (moment,) = at("13-right-of-way", [200])
    inside = [n for n, memory in moment.memories.items() if memory["place"] == "door"]
    return {"Moss", "Aster"} <= set(inside)


LOOKS: list[tuple[str, int, tuple[str, ...], Callable[[], bool]]] = [
    # a level, the number of a hint, words of it, and whether that is to be seen
    ("01-first-steps", 1, ("forward_distance", "tick 400"), ada_touches_the_wall),
    ("02-open-space", 1, ("Robot", "tick 100", "same power"), both_engines_are_equal),
    ("02-open-space", 2, ("rays", "tick 150", "stuck"), the_long_rays_are_on_the_right),
    ("03-the-long-hall", 1, ("first door", "tick 60"), the_door_is_far_on_the_right),
    ("04-everybody-home", 1, ("Ruby", "tick 750"), ruby_sees_home),
    ("05-lighthouse", 1, ("Course", "tick 400", "tick 800"), ships_choose_any_light),
    ("06-breadcrumbs", 1, ("Hansel", "Last", "Next", "tick 780"), hansel_turns_back_to_oat),
    ("07-station-management", 1, ("Fay", "PostInSight", "tick 950"), fay_has_no_post_in_sight),
    ("08-formation", 1, ("Memory", "tick 504", "tick 520"), amber_and_teal_have_met),
    ("09-the-gate", 1, ("Memory", "circles", "tick 500"), ada_circles_the_torch),
    ("10-distributed-mapping", 1, ("Beryl", "tick 100"), beryl_sees_several_beacons),
    ("11-power-line", 1, ("Volta", "tick 450", "tick 600"), volta_charges_a_little),
    ("12-swarm", 1, ("settled", "tick 400", "tick 300"), nobody_settles_any_more),
    ("13-right-of-way", 1, ("Memory", "tick 200", "in the door"), two_are_in_the_door),
]


@pytest.mark.sampled
@pytest.mark.parametrize(("name", "number", "words", "is_seen"), LOOKS)
def test_what_a_hint_says_to_look_at_is_to_be_seen(
    name: str, number: int, words: tuple[str, ...], is_seen: Callable[[], bool]
) -> None:
    hint = load_level(name).hints[number - 1]
    assert [word for word in words if word not in hint] == []
    assert is_seen()


def test_every_tick_that_a_hint_names_is_looked_at() -> None:
    named = {
        (name, number)
        for name in LEVELS
        for number, hint in enumerate(load_level(name).hints, 1)
        if re.search(r"tick \d", hint)
    }
    assert named == {(name, number) for name, number, _, _ in LOOKS}


@pytest.mark.sampled
@pytest.mark.parametrize(("distance", "wins"), [(20, False), (60, True), (120, False)])
def test_between_20_and_120_there_is_a_distance_that_wins(distance: int, wins: bool) -> None:
    level = load_level("01-first-steps")
    assert not wins or ("20" in level.hints[1] and "120" in level.hints[1])
    text = program_text(level.starter).replace("_distance < 1", f"_distance < {distance}")
    assert bool(ticks_to_win(level, text, 5000)) is wins


# What "Try first" leads to. The first three levels are won by it; see test_levels.


def home_is_where_they_stop() -> bool:
    name = "04-everybody-home"
    return bool(ticks_to_win(load_level(name), step(name, "briefing"), 3000))


def no_ship_stays_at_a_wreckers_light() -> bool:
    text = step("05-lighthouse", "briefing")
    return all(
        moment.to("Wreck", ship) > 30
        for moment in moments("05-lighthouse", text, 1500)
        if moment.tick % 10 == 0
        for ship in ("Otter", "Heron", "Gull")
    )


def the_fire_stays_out() -> bool:
    text = step("07-station-management", "briefing")
    fires = [m.state.areas[0].active for m in moments("07-station-management", text, 2500)]
    return any(fires) and not any(fires[900:])


def all_follow_amber() -> bool:
    *_, last = moments("08-formation", step("08-formation", "briefing"), 1500)
    return {memory["leader"] for memory in last.memories.values()} == {"Amber"}


def ada_sees_the_key() -> bool:
    text = step("09-the-gate", "briefing")
    *_, last = moments("09-the-gate", text, 1500)
    gate = next(area for area in last.state.areas if area.name == "Gate")
    return not gate.active and last.to("Key", "Ada") < 40


def atlas_has_a_map() -> bool:
    name = "10-distributed-mapping"
    *_, last = moments(name, step(name, "briefing"), 1200)
    far = {place["label"]: place["far"] for place in last.memories["Atlas"]["places"]}
    level = load_level(name)
    base, near = ((b.x, b.y) for b in level.beacons if b.name in ("Base", "B15"))
    return len(far) > 40 and far["B15"] == pytest.approx(dist(base, near), rel=0.1)


def volta_gets_home() -> bool:
    *_, last = moments("11-power-line", step("11-power-line", "briefing"), 1300)
    return last.state.areas[0].visitors == ("Volta",)


def more_settle_and_all_stay_settled() -> bool:
    before: set[str] = set()
    for moment in moments("12-swarm", step("12-swarm", "briefing"), 301):
        settled = {n for n, memory in moment.memories.items() if memory and memory["settled"]}
        if not before <= settled:
            return False
        before = settled
    (starter,) = at("12-swarm", [301])
    return len(before) > len([m for m in starter.memories.values() if m["settled"]])


def two_still_meet_in_the_door() -> bool:
    text = step("13-right-of-way", "briefing")
    *_, last = moments("13-right-of-way", text, 800)
    places = sorted(memory["place"] for memory in last.memories.values())
    return places == ["door", "door", "gate", "gate", "road", "road"]


TRIED = {
    "04-everybody-home": ("stop when the beacon", home_is_where_they_stop),
    "05-lighthouse": ("keep wreckers out", no_ship_stays_at_a_wreckers_light),
    "07-station-management": ("Firefighter := Worker", the_fire_stays_out),
    "08-formation": ("adopt the leader", all_follow_amber),
    "09-the-gate": ('begin phase "fetch" and seek only the key', ada_sees_the_key),
    "10-distributed-mapping": ("let Atlas put all", atlas_has_a_map),
    "11-power-line": ("drive to a station in sight", volta_gets_home),
    "12-swarm": ("once settled, stay settled", more_settle_and_all_stay_settled),
    "13-right-of-way": ("wait at the gate", two_still_meet_in_the_door),
}


@pytest.mark.sampled
@pytest.mark.parametrize("name", TRIED)
def test_what_is_to_be_tried_first_does_what_the_briefing_promises(name: str) -> None:
    words, is_kept = TRIED[name]
    assert words in load_level(name).briefing.replace("\n", " ").partition("Try first: ")[2]
    assert is_kept()


@each_level
def test_a_briefing_says_what_to_try_first(name: str) -> None:
    assert "Try first:" in load_level(name).briefing.replace("\n", " ")


def test_every_step_belongs_to_a_level_and_says_so() -> None:
    for path in STEPS.iterdir():
        name, _, which = path.stem.rpartition("-")
        level = load_level(name)
        assert which in ("briefing", "hint")
        assert path.read_text("utf-8").startswith(f"# {level.title}, the starter ")
