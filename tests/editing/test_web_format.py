"""Levels of the web platform, there and back."""

from __future__ import annotations

import json
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.level_text import write_native, write_web
from logical_robots_tui.world.levels.load import read_web
from logical_robots_tui.world.levels.native import read_native

PLACED = {
    "name": st.text(st.sampled_from("abc"), min_size=1),
    "x": st.integers(0, 9),
    "y": st.integers(0, 9),
}
COLORED = {**PLACED, "color": st.just("red")}
FLAGS = st.booleans()
WEB_LEVELS = st.fixed_dictionaries(
    {
        "width": st.just(3),
        "height": st.just(2),
        "walls": st.text("01", min_size=6, max_size=6),
        "robots": st.lists(
            st.fixed_dictionaries(
                COLORED,
                optional={
                    "angle": st.floats(-9, 9),
                    "has_battery": FLAGS,
                    "can_charge": FLAGS,
                    "battery_capacity": st.integers(0, 9),
                    "battery_consumption_rate": st.floats(0, 9),
                },
            ),
            min_size=1,
            unique_by=lambda robot: robot["name"],
        ),
        "beacons": st.lists(st.fixed_dictionaries(PLACED, optional={"charging_station": FLAGS})),
        "areas": st.lists(
            st.fixed_dictionaries(
                {**COLORED, "radius": st.integers(0, 9), "victory_robots": st.just(["a"])},
                optional={
                    "on_beacon": st.sampled_from(["", "a"]),
                    "off_beacon": st.sampled_from(["", "a"]),
                    "sticky_switch": FLAGS,
                    "impenetrable": FLAGS,
                },
            )
        ),
    }
)


@settings(deadline=None)
@given(WEB_LEVELS)
def test_nothing_is_added_to_a_level_of_the_platform_on_its_way_there_and_back(
    written: dict[str, Any],
) -> None:
    level = read_web(json.dumps(written), "level", "")
    again = json.loads(write_web(read_native(write_native(level), "level", "")))
    assert again.keys() == written.keys()
    assert again["walls"] == written["walls"]
    for kind in ("robots", "beacons", "areas"):
        for one, other in zip(again[kind], written[kind], strict=True):
            assert one.items() <= other.items()
