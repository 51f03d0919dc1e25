"""Generated levels of any size for measuring; the same arguments give the same level."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.world import Area, Beacon, Level, Robot

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["halls", "open_room"]

HALL = 100  # map units from one wall to the next
THICKNESS = 6
DOOR = (35, 70)  # its extent along a wall
DOORS = 0.8  # the share of walls with a door
MARGIN = 12  # between a hall's walls and its content


def open_room(width: int, height: int) -> Level:
    """Return a room without inner walls and with one robot."""
    walls = np.zeros((height, width), dtype=np.bool_)
    return _level("open", walls, (Robot("R0", width / 2 + 0.3, height / 2 + 0.7, 0.5),))


def halls(width: int, height: int, *, robots: int, beacons: int = 0, areas: int = 0) -> Level:
    """Return halls in rows, with doors in most walls, and everything at seeded random positions.

    Half of the robots have a battery and a few of those can charge others. A tenth of the beacons
    are charging stations. Every second area is solid, and every third is switched by a beacon.
    """
    random = Random(width * height)  # the walls first, so that they are the same for any crowd
    walls = _walls(width, height, random)
    return _level(
        f"halls {width}x{height}",
        walls,
        tuple(
            Robot(
                f"R{i}",
                *_place(width, height, random),
                random.uniform(0, 6.28),
                has_battery=i % 2 == 0,
                can_charge=i % 20 == 0,
                battery_capacity=100.0,
                battery_consumption_rate=0.1,
            )
            for i in range(robots)
        ),
        tuple(
            Beacon(f"B{i}", *_place(width, height, random), charging_station=i % 10 == 0)
            for i in range(beacons)
        ),
        tuple(
            Area(
                f"A{i}",
                *_place(width, height, random),
                radius=20.0,
                on_beacon=f"B{i}" if i % 3 == 0 else "",
                impenetrable=i % 2 == 0,
            )
            for i in range(areas)
        ),
    )


def _walls(width: int, height: int, random: Random) -> NDArray[np.bool_]:
    walls = np.zeros((height, width), dtype=np.bool_)
    for along in (walls, walls.T):
        along[:THICKNESS] = along[-THICKNESS:] = True
        for start in range(HALL, len(along) - HALL // 2, HALL):
            along[start : start + THICKNESS] = True
    for along in (walls, walls.T):
        for start in range(HALL, len(along) - HALL // 2, HALL):
            for hall in range(0, along.shape[1], HALL):
                if random.random() < DOORS:
                    door = slice(hall + DOOR[0], hall + DOOR[1])
                    along[start : start + THICKNESS, door] = False
    return walls


def _place(width: int, height: int, random: Random) -> tuple[float, float]:
    return _coordinate(width, random), _coordinate(height, random)


def _coordinate(size: int, random: Random) -> float:
    hall = random.randrange(size // HALL) * HALL
    return hall + random.uniform(THICKNESS + MARGIN, HALL - MARGIN)


def _level(
    name: str,
    walls: NDArray[np.bool_],
    robots: tuple[Robot, ...],
    beacons: tuple[Beacon, ...] = (),
    areas: tuple[Area, ...] = (),
) -> Level:
    walls.flags.writeable = False
    height, width = walls.shape
    return Level(name, name, width, height, walls, robots, beacons, areas)
