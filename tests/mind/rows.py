"""Sensor rows to think about."""

from __future__ import annotations

import math
from typing import Any

from logical_robots_tui.mind import Decision, Limits, Mind, Program

ROBOT = (
    "Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: m) :- "
    "Sensor(robot_name:, sensor:), "
)

PAPER = """\
FreedomMotion(radar) = WeightedAverage {
  x.distance -> x.angle :- x in radar
};
Robot(robot_name:, desire:, memory: "I am a robot") :-
  Sensor(robot_name:, sensor:),
  freedom = FreedomMotion(sensor.radar),
  speed = 0.5,
  desire = {
    left_engine:  speed - freedom + 0.1,
    right_engine: speed + freedom
  };
"""


def ray(index: int, distance: int = 200, seen: str = "none", label: str = "nothing") -> Any:
    return {
        "angle": math.radians(60 - 4 * index),
        "distance": distance,
        "object": seen,
        "label": label,
    }


def row(name: str, *, clock: int = 1, sees: dict[int, tuple[int, str, str]] | None = None) -> Any:
    """A sensor row; `sees` maps the index of a ray to distance, object and label."""
    sees = sees or {}
    return {
        "robot_name": name,
        "sensor": {
            "forward_distance": 200,
            "forward_object": "none",
            "forward_label": "nothing",
            "radar": [ray(i, *sees.get(i, ())) for i in range(31)],
            "self": {
                "can_charge": False,
                "has_battery": False,
                "battery_level": 0.0,
                "battery_capacity": 0.0,
            },
            "clock": clock,
        },
    }


def think(text: str, rows: list[Any], memories: dict[str, Any], **options: Any) -> list[Decision]:
    """Decisions of a program for one moment."""
    limits = options.pop("limits", Limits(think_seconds=10))
    mind = Mind(Program.compile(text), limits=limits, **options)
    try:
        return mind.think(rows, memories)
    finally:
        mind.close()


def remembered(expression: str, memory: Any = "", *, rules: str = "") -> Any:
    """What a robot remembers when its memory is to be an expression of `sensor` and `memory`."""
    text = f"{rules}\n{ROBOT} Memory(robot_name:, memory:), m = ({expression});"
    (decision,) = think(text, [row("Ada")], {"Ada": memory})
    assert not decision.notices, decision.notices
    return decision.memory
