"""Hints, followed literally, lead to where they say."""

import re
from collections.abc import Callable
from math import dist
from typing import Any

import pytest

from tests.levels.moments import Moment, at, step
from tests.levels.playing import (
    LEVELS,
    LONGEST,
    load_level,
    measured,
    program_text,
    slow,
    squeezed,
    ticks_to_win,
)

# What hints say.


def test_only_the_last_hint_gives_code_and_those_before_it_ask() -> None:
    for name in LEVELS:
        *first, last = load_level(name).hints
        assert re.search(r"[Ll]ook at|how (long|small|far)", first[0]), name
        for hint in first:
            assert "?" in hint
            assert not re.search(r"`|:-|[{}=]|Min\{", hint)
        assert "`" in last, name


def test_the_code_of_the_last_hint_is_in_the_program_that_results() -> None:
    for name in LEVELS:
        text = squeezed(step(name, "hint"))
        for code in re.findall(r"`([^`]+)`", load_level(name).hints[-1]):
            parts = map(squeezed, code.split("..."))
            assert all(part.rstrip(";") in text for part in parts), (name, code)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=slow(name > "03", measured(name).ticks * robots > LONGEST))
        for name in LEVELS
        for robots in [len(load_level(name).robots)]
    ],
)
def test_the_program_that_results_from_the_last_hint_wins(name: str) -> None:
    ticks = 2 * measured(name).ticks
    assert ticks_to_win(load_level(name), step(name, "hint"), ticks)


# What is to be seen where a hint says "look".


def engines(moment: Moment) -> list[tuple[float, float]]:
    table = moment.tables["Robot"]
    desires: list[Any] = [row[table.columns.index("desire")] for row in table.rows]
    return [(desire["left_engine"], desire["right_engine"]) for desire in desires]


def chosen(moment: Moment, predicate: str) -> dict[str, str]:
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
    return bool(near < 75 and far > 90 and left == right)


def ruby_sees_home() -> bool:
    (moment,) = at("04-everybody-home", [750])
    seen = {(ray["object"], ray["label"]) for ray in moment.radar("Ruby")}
    return ("beacon", "Home") in seen and {kind for kind, _ in seen} <= {"beacon", "wall", "none"}


def ships_choose_any_light() -> bool:
    before, after = (chosen(m, "Course") for m in at("05-lighthouse", [400, 800], "Course"))
    return before["Otter"] == "White" and after == {"Otter": "Blue", "Heron": "Wreck"}


def hansel_turns_back_to_spelt() -> bool:
    (moment,) = at("06-breadcrumbs", [1200], "Last", "Next")
    last = {row[0]: row[1] for row in moment.tables["Last"].rows}
    return last["Hansel"] == "barley" and chosen(moment, "Next")["Hansel"] == "spelt"


def fay_goes_round_a_pillar() -> bool:
    found = at("07-station-management", [300, 800], "Post", "PostInSight")
    sees = any(ray["object"] == "beacon" for moment in found for ray in moment.radar("Fay"))
    posts = {row[-1] for row in found[0].tables["Post"].rows}
    fays = [robot for moment in found for robot in moment.state.robots if robot.name == "Fay"]
    near = all(dist((robot.x, robot.y), (145, 300)) < 90 for robot in fays)
    return near and not sees and posts == {"Mine"}


def coral_sees_teal_and_goes_astray() -> bool:
    found = at("08-formation", [1, 200])
    sees = {
        name: {ray["label"] for ray in found[0].radar(name) if ray["object"] == "robot"}
        for name in ("Coral", "Teal")
    }
    (coral,) = (robot for robot in found[1].state.robots if robot.name == "Coral")
    return sees == {"Coral": {"Olive", "Teal"}, "Teal": {"Amber"}} and coral.x > 230 < coral.y


def ada_circles_the_torch() -> bool:
    found = at("11-the-gate", range(500, 1501, 50))
    states = {moment.memories["Ada"]["phase"] for moment in found}
    return states == {"out"} and max(moment.to("Torch", "Ada") for moment in found) < 30


def beryl_sees_several_beacons() -> bool:
    (moment,) = at("10-distributed-mapping", [100])
    rays = moment.radar("Beryl")
    return len({ray["label"] for ray in rays if ray["object"] == "beacon"}) > 1


def volta_charges_a_little() -> bool:
    powers = [
        row["sensor"]["self"]["battery_level"]
        for moment in at("12-power-line", range(450, 801, 10))
        for row in moment.rows
        if row["robot_name"] == "Volta"
    ]
    return bool(max(powers) > max(powers[0], powers[-1]) + 20)


def nobody_settles_any_more() -> bool:
    before, after = (
        sum(memory["settled"] for memory in moment.memories.values())
        for moment in at("13-swarm", [300, 400])
    )
    return bool(before == after < 50)


def two_have_the_door_and_meet() -> bool:
    two = {"Moss", "Aster"}
    early, late = at("14-right-of-way", [100, 250])
    inside = {name for name, memory in early.memories.items() if memory["place"] == "door"}
    return inside == two and all(late.to("Door", name) < 10 for name in two)


def five_want_the_pump_and_nobody_the_crane() -> bool:
    (moment,) = at("15-auction", [30])
    jobs = [memory["job"] for memory in moment.memories.values()]
    wanted = {job: jobs.count(job) for job in ("Pump", "Crane", "Oven", "Lathe")}
    return wanted == {"Pump": 5, "Crane": 0, "Oven": 1, "Lathe": 1}


def ida_goes_back_and_forth() -> bool:
    found = at("09-doors", [300, 400])
    return [moment.memories["Ida"]["room"] for moment in found] == ["attic", "gallery"]


LOOKS: list[tuple[str, int, str, Callable[[], bool]]] = [
    # a level, the number of a hint, words of it, and whether that is to be seen
    ("01-first-steps", 1, "forward_distance|tick 400", ada_touches_the_wall),
    ("02-open-space", 1, "Robot|tick 100|same power", both_engines_are_equal),
    ("02-open-space", 2, "rays|tick 150|stuck", the_long_rays_are_on_the_right),
    ("03-the-long-hall", 1, "first door|tick 60", the_door_is_far_on_the_right),
    ("04-everybody-home", 1, "Ruby|tick 750", ruby_sees_home),
    ("05-lighthouse", 1, "Course|tick 400|tick 800|Otter turn back", ships_choose_any_light),
    ("06-breadcrumbs", 1, "Hansel|Last|Next|tick 1200", hansel_turns_back_to_spelt),
    ("07-station-management", 1, "Fay|pillar|tick 300|tick 800", fay_goes_round_a_pillar),
    ("08-formation", 1, "Memory|tick 1,|tick 200", coral_sees_teal_and_goes_astray),
    ("11-the-gate", 1, "Memory|circles|tick 500", ada_circles_the_torch),
    ("10-distributed-mapping", 1, "Beryl|tick 100", beryl_sees_several_beacons),
    ("12-power-line", 1, "Volta|tick 450|tick 800", volta_charges_a_little),
    ("13-swarm", 1, "settled|tick 400|tick 300", nobody_settles_any_more),
    ("09-doors", 1, "Memory|Ida|tick 300|tick 400", ida_goes_back_and_forth),
    ("14-right-of-way", 1, "Memory|tick 100|tick 250", two_have_the_door_and_meet),
    ("15-auction", 1, "Memory|tick 30", five_want_the_pump_and_nobody_the_crane),
]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "number", "words", "is_seen"),
    [pytest.param(*look, marks=slow(look[0] > "04")) for look in LOOKS],
)
def test_what_a_hint_says_to_look_at_is_to_be_seen(
    name: str, number: int, words: str, is_seen: Callable[[], bool]
) -> None:
    hint = load_level(name).hints[number - 1]
    assert [word for word in words.split("|") if word not in hint] == []
    assert is_seen()


def test_every_tick_that_a_hint_names_is_looked_at() -> None:
    named = {
        (name, number)
        for name in LEVELS
        for number, hint in enumerate(load_level(name).hints, 1)
        if re.search(r"tick \d", hint)
    }
    assert named == {(name, number) for name, number, _, _ in LOOKS}


@pytest.mark.slow
@pytest.mark.parametrize(("distance", "wins"), [(20, False), (60, True), (120, False)])
def test_between_20_and_120_there_is_a_distance_that_wins(distance: int, wins: bool) -> None:
    level = load_level("01-first-steps")
    assert not wins or ("20" in level.hints[1] and "120" in level.hints[1])
    text = program_text(level.starter).replace("_distance < 1", f"_distance < {distance}")
    assert bool(ticks_to_win(level, text, 5000)) is wins
