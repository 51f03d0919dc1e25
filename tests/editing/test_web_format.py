"""Levels of the web platform pass through the editor as they are."""

import json
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.world.levels.load import read_web
from tests.editing.test_files import read, says_no_more

DIGITS, FLAGS, NAMES = st.integers(0, 9), st.booleans(), st.sampled_from(["", "a"])
PLACED = {"name": st.text(st.sampled_from("abc"), min_size=1), "x": DIGITS, "y": DIGITS}
COLORED = {**PLACED, "color": st.just("red")}
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
                    "battery_capacity": DIGITS,
                    "battery_consumption_rate": st.floats(0, 9),
                },
            ),
            min_size=1,
            unique_by=lambda robot: robot["name"],
        ),
        "beacons": st.lists(st.fixed_dictionaries(PLACED, optional={"charging_station": FLAGS})),
        "areas": st.lists(
            st.fixed_dictionaries(
                {**COLORED, "radius": DIGITS, "victory_robots": st.just(["a"])},
                optional={
                    "on_beacon": NAMES,
                    "off_beacon": NAMES,
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
    says_no_more(read(write_native(level)), written)
