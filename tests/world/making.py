"""Levels for tests, drawn by hand or at random."""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from logical_robots_tui.world import Area, Beacon, Level, Robot, Sensors

NAMES = ("Ann", "Bob", "Cid", "Dot", "Eve")
SENSORS = st.just(Sensors()) | st.builds(
    Sensors,
    *(st.sampled_from([3, 7, 61]), st.sampled_from([40.5, 180, 181, 360])),
    *(st.integers(10, 200), st.sampled_from([0, 0, 2.5]), st.integers(0, 9)),
)
LABELS = ("lamp", "gate", "Ann", "home")


def make_level(
    robots: Iterable[Robot] = (Robot("Ann", 50.5, 50.5),),
    *,
    width: int = 300,
    height: int = 100,
    walls: Iterable[tuple[int, int]] = (),
    beacons: Iterable[Beacon] = (),
    areas: Iterable[Area] = (),
) -> Level:
    """Return a level without a rim; ``walls`` are (column, row) of single cells."""
    cells = np.zeros((height, width), dtype=np.bool_)
    for column, row in walls:
        cells[row, column] = True
    cells.flags.writeable = False
    return Level(
        name="test",
        title="Test",
        width=width,
        height=height,
        walls=cells,
        robots=tuple(robots),
        beacons=tuple(beacons),
        areas=tuple(areas),
    )


def _coordinates(size: int) -> st.SearchStrategy[float]:
    """Places in and around the map, many of them on the knife edges of the grid."""
    return st.one_of(
        st.floats(-20, size + 20, width=32),
        st.integers(-20, size + 20).map(float),
        st.integers(-40, 2 * size + 40).map(lambda n: n / 2),
    )


_angles = st.one_of(st.floats(-10, 10), st.integers(-8, 8).map(lambda n: n * math.pi / 4))


@st.composite
def levels(draw: st.DrawFn) -> Level:
    width, height = draw(st.integers(1, 260)), draw(st.integers(1, 120))
    walls = draw(
        st.lists(st.tuples(st.integers(0, width - 1), st.integers(0, height - 1)), max_size=30)
    )
    x, y = _coordinates(width), _coordinates(height)
    batteries = st.floats(0, 20)
    robots = [
        Robot(
            name,
            draw(x),
            draw(y),
            draw(_angles),
            has_battery=(has_battery := draw(st.booleans())),
            can_charge=has_battery and draw(st.booleans()),
            battery_capacity=draw(batteries),
            battery_consumption_rate=draw(st.sampled_from((0.0, 0.3, 2.0))),
        )
        for name in NAMES[: draw(st.integers(1, len(NAMES)))]
    ]
    label = st.sampled_from(LABELS)
    beacons = draw(st.lists(st.builds(Beacon, label, x, y, st.booleans()), max_size=5))
    switch = st.sampled_from(("", *LABELS))
    areas = draw(
        st.lists(
            st.builds(
                Area,
                label,
                x,
                y,
                st.one_of(st.floats(0, 60), st.integers(0, 60).map(float)),
                victory_robots=st.sampled_from(((), ("Ann",), ("Ann", "Bob"))),
                on_beacon=switch,
                off_beacon=switch,
                sticky_switch=st.booleans(),
                impenetrable=st.booleans(),
            ),
            max_size=5,
        )
    )
    level = make_level(
        robots, width=width, height=height, walls=walls, beacons=beacons, areas=areas
    )
    return replace(level, sensors=draw(SENSORS))
