"""What "Try first" leads to. The first three levels are won by it; see test_levels."""

from math import dist

import pytest

from tests.levels.moments import STEPS, at, moments, step
from tests.levels.playing import LEVELS, load_level


def each_comes_home_at_some_time() -> bool:
    name, robots = "04-everybody-home", ("Ruby", "Jade", "Lapis")
    seen = moments(name, step(name, "briefing"), 2200)
    ways = zip(*([moment.to("Home", robot) for robot in robots] for moment in seen), strict=True)
    return all(min(way) < 10 for way in ways)


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


def all_hear_of_amber_and_two_only_from_each_other() -> bool:
    *_, last = moments("08-formation", step("08-formation", "briefing"), 800)
    guides = {name: memory["guide"] for name, memory in last.memories.items()}
    circle = (guides["Coral"], guides["Olive"]) == ("Olive", "Coral")
    return circle and {memory["leader"] for memory in last.memories.values()} == {"Amber"}


def ada_sees_the_key() -> bool:
    found = list(moments("11-the-gate", step("11-the-gate", "briefing"), 1500))
    gate = next(area for area in found[-1].state.areas if area.name == "Gate")
    return not gate.active and min(moment.to("Key", "Ada") for moment in found) < 40


def all_remember_roads_of_true_lengths() -> bool:
    name = "10-distributed-mapping"
    *_, last = moments(name, step(name, "briefing"), 200)
    places = {beacon.name: (beacon.x, beacon.y) for beacon in load_level(name).beacons}
    roads = [memory["roads"] for memory in last.memories.values()]
    return min(map(len, roads)) > 50 and all(
        road["length"] == pytest.approx(dist(places[road["start"]], places[road["finish"]]), abs=12)
        for road in roads[0]
    )


def volta_gets_home() -> bool:
    *_, last = moments("12-power-line", step("12-power-line", "briefing"), 1300)
    return last.state.areas[0].visitors == ("Volta",)


def more_settle_and_all_stay_settled() -> bool:
    before: set[str] = set()
    for moment in moments("13-swarm", step("13-swarm", "briefing"), 301):
        settled = {n for n, memory in moment.memories.items() if memory and memory["settled"]}
        if not before <= settled:
            return False
        before = settled
    (starter,) = at("13-swarm", [301])
    return len(before) > len([m for m in starter.memories.values() if m["settled"]])


def reach_grows_from_the_archive() -> bool:
    """Whether Reach has the rooms that a walk through open doors comes to, and no others."""
    past = moments("09-doors", step("09-doors", "briefing"), 3)
    _, _, moment = (next(past) for _ in range(3))
    found, ways = (
        moment.mind.query(p, moment.rows, moment.memories).rows for p in ("Reach", "Open")
    )
    reached, before = {"archive"}, set[str]()
    while before != reached:
        before = set(reached)
        reached |= {str(room) for room, other, _ in ways if other in before}
    return {room for (room,) in found} == reached and {"gallery", "yard"} < reached


def two_still_meet_in_the_door() -> bool:
    *_, last = moments("14-right-of-way", step("14-right-of-way", "briefing"), 800)
    places = sorted(memory["place"] for memory in last.memories.values())
    return places == ["door", "door", "gate", "gate", "road", "road"]


def only_the_oven_is_done() -> bool:
    """Whether the jobs of worn-out batteries stay undone, each begun by one robot."""
    *_, last = moments("15-auction", step("15-auction", "briefing"), 700)
    jobs = sorted(filter(None, (memory["job"] for memory in last.memories.values())))
    done = [area.name for area in last.state.areas if not area.active]
    return jobs == ["Crane", "Lathe", "Oven", "Pump"] and done == ["Green gate"]


TRIED = {
    "04-everybody-home": ("steer to the beacon", each_comes_home_at_some_time),
    "05-lighthouse": ("keep wreckers out", no_ship_stays_at_a_wreckers_light),
    "07-station-management": ("Firefighter := Worker", the_fire_stays_out),
    "08-formation": ("hear of the leader", all_hear_of_amber_and_two_only_from_each_other),
    "11-the-gate": ('begin phase "fetch" and seek only the key', ada_sees_the_key),
    "10-distributed-mapping": ("let all remember the roads", all_remember_roads_of_true_lengths),
    "12-power-line": ("drive to a station in sight", volta_gets_home),
    "13-swarm": ("once settled, stay settled", more_settle_and_all_stay_settled),
    "09-doors": ("a predicate Reach has the archive", reach_grows_from_the_archive),
    "14-right-of-way": ("wait at the gate", two_still_meet_in_the_door),
    "15-auction": ("of all bids for a job the least wins", only_the_oven_is_done),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TRIED)
def test_what_is_to_be_tried_first_does_what_the_briefing_promises(name: str) -> None:
    words, is_kept = TRIED[name]
    assert words in load_level(name).briefing.replace("\n", " ").partition("Try first: ")[2]
    assert is_kept()


def test_a_briefing_says_what_to_try_first() -> None:
    for name in LEVELS:
        assert "Try first:" in load_level(name).briefing.replace("\n", " "), name


def test_every_step_belongs_to_a_level_and_says_so() -> None:
    for path in STEPS.iterdir():
        name, _, which = path.stem.rpartition("-")
        level = load_level(name)
        assert which in ("briefing", "hint")
        assert path.read_text("utf-8").startswith(f"# {level.title}, the starter ")
