"""What is around a robot, in words."""

import math
from dataclasses import replace

import pytest

from logical_robots_tui.game.advancing import start_frame
from logical_robots_tui.player.surroundings import surroundings
from logical_robots_tui.world import Level, list_shipped, load_level
from logical_robots_tui.world.level import Area, Beacon, Cycle, Robot
from logical_robots_tui.world.sensing import Senses
from tests.tui.labyrinth.drawing.scenes import room

ROOM = room(100, 60, robots=(Robot("Pip", 25, 25),))
ROOM.walls[30:40, 50:60] = True


def around(level: Level, name: str = "Pip") -> list[str]:
    return [*surroundings(level, start_frame(level).after, name)]


def placed(*beacons: Beacon, angle: float = 0.0) -> Level:
    (pip,) = ROOM.robots
    return replace(ROOM, robots=(replace(pip, angle=angle),), beacons=beacons)


def test_things_are_told_by_direction_from_the_heading_the_nearest_first() -> None:
    far, near = Beacon("Far", 75, 25), Beacon("Near", 25, 40)
    there = around(placed(far, near))[1:]
    assert there == ["90° right: beacon Near at 15.", "ahead: beacon Far at 50."]
    turned = around(placed(far, near, angle=math.pi / 2))[1:]
    assert turned == ["ahead: beacon Near at 15.", "90° left: beacon Far at 50."]
    assert around(placed(far, angle=math.pi))[1:] == ["behind: beacon Far at 50."]
    behind_a_wall = around(placed(Beacon("Hidden", 88, 46)))[1:]
    assert behind_a_wall == ["18° right: beacon Hidden at 66, out of sight."]


def test_areas_are_told_with_whom_they_are_a_goal_for_and_whether_they_are_on() -> None:
    cycle = Cycle(400, 201, 400)
    area = Area("Door", 65, 25, 6, victory_robots=("Pip",), cycle=cycle)
    gate = Area("Gate", 25, 45, 4, on_beacon="Key", impenetrable=True)
    assert around(replace(ROOM, areas=(area, gate)))[1:] == [
        "90° right: area Gate at 20, radius 4, solid, switched off.",
        "ahead: area Door at 40, radius 6, goal of Pip, on in ticks 201 to 400 of every 400, "
        "switched off.",
    ]


def test_other_robots_are_told_and_oneself_is_not() -> None:
    ahead, *rest = around(replace(ROOM, robots=(*ROOM.robots, Robot("Bo", 45, 25))))
    assert ahead.startswith("ahead: robot Bo at 12; ")
    assert rest == ["ahead: robot Bo at 20."]


@pytest.mark.sampled
@pytest.mark.parametrize("name", list_shipped())
def test_the_way_ahead_is_what_the_sensor_reports(name: str) -> None:
    level = load_level(name)
    state = start_frame(level).after
    rows, _ = Senses(level).sense(state.robots, state.areas, 1)
    for robot, row in zip(state.robots[:3], rows, strict=False):
        ahead = around(level, robot.name)[0].split(";")[0]
        distance = row["sensor"]["forward_distance"]
        assert ahead.rstrip(".").endswith((f" {distance}", f"within {distance}"))
