"""A level is won by its idea: not without sensing, and not by programs made for other levels.

Engines that sense nothing need no mind and no radar, only the rules of driving, which makes them
fast enough to try hundreds.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import TypeAlias

import pytest

from logical_robots_tui import Desire, Level, World
from logical_robots_tui.game.measuring import vary_start
from logical_robots_tui.paths import shipped_names
from logical_robots_tui.world.dynamics import Mover, drive, is_inside
from tests.levels.playing import (
    LEVELS,
    is_small,
    load_level,
    measured,
    program_text,
    shipped_program,
    slow,
    solution_of,
    ticks_to_win,
)

Engines: TypeAlias = tuple[float, float]
Script: TypeAlias = tuple[tuple[int, Engines], ...]
"""Engines and for how many ticks, again and again."""

TICKS = 5000
TICKS_OF_A_WORLD = 1200  # where areas switch and batteries drain, and each tick takes longer
POWERS = (-0.5, -0.3, -0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.97, 1.0)
STRAIGHT = (20, 40, 60, 100, 150, 200, 300, 500)
TURNING = (8, 16, 24, 31, 40, 47, 62)
TURNS = ((0.5, -0.5), (-0.5, 0.5), (1.0, 0.2), (0.2, 1.0))

CONSTANT: list[Script] = [((1, (left, right)),) for left, right in product(POWERS, POWERS)]
PERIODIC: list[Script] = [
    ((ahead, (1.0, 1.0)), (aside, turn)) for ahead, aside, turn in product(STRAIGHT, TURNING, TURNS)
]
OF_ISSUE: list[Script] = [((1, pair),) for pair in ((0.9, 1.0), (1.0, 0.7), (0.8, 1.0))]
"""These once won the first level."""

HAVE_THE_IDEA = {
    # Whoever steers by what is ahead has the idea of the first level: all that look where to go.
    "01-first-steps": (
        *("breadcrumbs", "distributed-mapping", "distributed-mapping-starter", "everybody-home"),
        *("everybody-home-starter", "formation", "formation-starter", "herd", "obstacle-avoider"),
        *("open-space", "power-line", "power-line-starter", "station-management-starter", "swarm"),
        *("steering", "swarm-starter", "the-gate", "the-gate-starter", "the-long-hall"),
        "wall-crawler",
    ),
    # One angle or distance out of many rays.
    "02-open-space": (
        *("distributed-mapping", "distributed-mapping-starter", "everybody-home-starter"),
        *("formation", "formation-starter", "obstacle-avoider", "power-line", "power-line-starter"),
        *("swarm", "swarm-starter"),
    ),
    # A hand on the wall.
    "03-the-long-hall": ("station-management-starter", "steering", "wall-crawler"),
    # They stop at a beacon that is called "Home", too, or drive through it one behind another.
    "04-everybody-home": ("formation-starter", "power-line", "power-line-starter"),
}
"""Programs of other levels that win a level, because they have its idea."""

THOUGHTS = 450  # of all robots together, which are enough for a look
THOUGHTS_OF_A_PROOF = 18_000

OTHERS = [
    pytest.param(level.name, program, marks=slow(False, not is_small(program)))
    for level in map(load_level, LEVELS)
    for program in shipped_names("programs", ".l")
    if program not in (level.solution, level.starter)
]

each_level = pytest.mark.parametrize("name", LEVELS)


def is_simple(level: Level) -> bool:
    """Whether only walls and goals matter to robots that sense nothing."""
    goals = [area for area in level.areas if area.victory_robots]
    return not any(
        [
            *(area.impenetrable for area in level.areas),
            *(area.on_beacon or area.off_beacon for area in goals),
            *(robot.has_battery for robot in level.robots),
        ]
    )


def played(script: Script, ticks: int) -> Iterator[Engines]:
    one_round = [engines for duration, engines in script for _ in range(duration)]
    for tick in range(ticks):
        yield one_round[tick % len(one_round)]


def win_by_driving(level: Level, script: Script, ticks: int) -> int | None:
    """The tick in which all are in a goal if every robot follows the script in a simple level."""
    movers = {r.name: Mover(r.x, r.y, r.angle, r.battery_capacity) for r in level.robots}
    goals = [
        (area, [movers[name] for name in area.victory_robots])
        for area in level.areas
        if area.victory_robots
    ]
    for tick, (left, right) in enumerate(played(script, ticks), 1):
        for mover in movers.values():
            drive(mover, left, right, level)
        if any(all(is_inside(mover, area) for mover in those) for area, those in goals):
            return tick
    return None


def win_in_a_world(level: Level, script: Script, ticks: int) -> int | None:
    world = World(level)
    for left, right in played(script, ticks):
        world.act(dict.fromkeys((r.name for r in level.robots), Desire(left, right)))
        if world.won:
            return world.won_at
    return None


def winners(name: str, scripts: list[Script]) -> dict[Script, int]:
    level = load_level(name)
    win, ticks = (win_by_driving, TICKS) if is_simple(level) else (win_in_a_world, TICKS_OF_A_WORLD)
    ticks = ticks // math.ceil(len(level.robots) / 20)
    return {script: won for script in scripts if (won := win(level, script, ticks)) is not None}


def with_goal(level: Level, x: float, y: float) -> Level:
    goal = replace(level.areas[0], x=x, y=y, radius=2.0, victory_robots=(level.robots[0].name,))
    return replace(level, areas=(goal,))


def test_driving_alone_leads_where_the_world_does() -> None:
    level = load_level("01-first-steps")
    for script in (CONSTANT[-2], PERIODIC[40]):
        world = World(level)
        for left, right in played(script, 200):
            world.act({"Ada": Desire(left, right)})
        there = with_goal(level, world.robots[0].x, world.robots[0].y)
        won = win_by_driving(there, script, 300)
        assert won == win_in_a_world(there, script, 300)
        assert won is not None


@pytest.mark.sampled
@each_level
def test_a_few_engines_that_sense_nothing_do_not_win(name: str) -> None:
    scripts = [*OF_ISSUE, *CONSTANT[-3:], *PERIODIC[::97]]
    assert winners(name, scripts if is_simple(load_level(name)) else scripts[:4]) == {}


@pytest.mark.proof
@each_level
def test_no_constant_engines_win(name: str) -> None:
    assert len(CONSTANT) > 200
    assert winners(name, CONSTANT) == {}


@pytest.mark.proof
@each_level
def test_no_periodic_engines_win(name: str) -> None:
    assert winners(name, PERIODIC if is_simple(load_level(name)) else PERIODIC[::7]) == {}


def wins(level: Level, program: str, thoughts: int) -> bool:
    ticks = thoughts // len(level.robots)
    return ticks_to_win(level, shipped_program(program), ticks) is not None


@pytest.mark.sampled
@pytest.mark.parametrize(("name", "program"), OTHERS)
def test_a_program_of_another_level_does_not_win_soon(name: str, program: str) -> None:
    assert not wins(load_level(name), program, THOUGHTS)


@pytest.mark.proof
@pytest.mark.parametrize(("name", "program"), OTHERS)
def test_a_program_of_another_level_wins_only_if_it_has_the_idea(name: str, program: str) -> None:
    has_it = program in HAVE_THE_IDEA.get(name, ())
    assert wins(load_level(name), program, THOUGHTS_OF_A_PROOF) is has_it


@pytest.mark.proof
@pytest.mark.parametrize("seed", range(20))
def test_the_starter_of_the_swarm_does_not_happen_to_come_home(seed: int) -> None:
    assert not wins(vary_start(load_level("04-everybody-home"), seed), "swarm-starter", 9000)


LEFT_HAND = (
    ("ray.angle < -0.6", "ray.angle > 0.6"),
    ("{left_engine: -0.5, right_engine: 0.5}", "{left_engine: 0.5, right_engine: -0.5}"),
    ("(WallAngle(radar) + 1.05) + (45", "(WallAngle(radar) - 1.05) - (45"),
)
FASTER = (("0.8 - angle", "1 - angle"), ("0.8 + angle", "1 + angle"))
FULL_SPEED = (("Steer(0.8", "Steer(1"),)
VARIATIONS: dict[str, list[tuple[tuple[str, str], ...]]] = {
    "01-first-steps": [(("distance < 40", "distance < 80"),)],
    "02-open-space": [(("ray.distance ->", "ray.distance * ray.distance ->"),)],
    "03-the-long-hall": [LEFT_HAND, FASTER],
    "04-everybody-home": [(("0.9 - angle", "1 - angle"), ("0.9 + angle", "1 + angle"))],
    "05-lighthouse": [(("Steer(0.9", "Steer(1"),)],
    "06-breadcrumbs": [FULL_SPEED],
    "07-station-management": [FULL_SPEED],
    "08-formation": [(("else 0.6)", "else 0.8)"),)],
    "11-the-gate": [FULL_SPEED, (("80 else", "40 else"),)],
    "10-distributed-mapping": [(("then Turn(-1)", "then Turn(1)"),)],
    "13-swarm": [(("near < 4", "near < 8"),)],
    "09-doors": [(("Steer(0.9", "Steer(1"),)],
    "14-right-of-way": [(("radar) < 25", "radar) < 20"),)],
    "15-auction": [(("Steer(0.5", "Steer(0.8"),)],
}
"""Easy changes to solutions: a text of it, and another in its place."""


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("name", "changes"),
    [
        pytest.param(name, changes, marks=slow(name > "03", name > "05"))
        for name, variations in VARIATIONS.items()
        for changes in variations
    ],
)
def test_no_easy_variation_is_twice_as_fast_as_the_solution(
    name: str, changes: tuple[tuple[str, str], ...]
) -> None:
    text = program_text(solution_of(name))
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    assert ticks_to_win(load_level(name), text, measured(name).ticks // 2) is None
