"""What tests of minds share: sensor rows to think about, a mark of cases, a fresh Python."""

import math
import sys
from collections.abc import Collection, Sequence
from contextlib import closing
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.mind import Decision, Limits, Mind, Program
from tests.processes import run_command

slow = partial(pytest.param, marks=pytest.mark.slow)
"""A case like another one, which the quick choice leaves out."""

VISIBILITIES = [
    ("own", "own"),
    ("seen", "all"),
    *(slow(*pair) for pair in (("own", "all"), ("seen", "own"), ("all", "own"), ("all", "all"))),
]
"""Which memories and sensors of others a robot sees."""

ROBOT = (
    "Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: m) :- "
    "Sensor(robot_name:, sensor:), "
)

PAPER = Path(__file__).with_name("paper.l").read_text("utf-8")


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
    """Decisions of a program for one moment, the same whether it is tuned or not."""
    limits = options.pop("limits", Limits())
    program = Program.compile(text)
    tuned, plain = (
        _decisions(Mind(program, limits=limits, plain=plain, **options), rows, memories)
        for plain in (False, True)
    )
    assert nearly_same(
        [asdict(replace(d, weight=0)) for d in tuned], [asdict(replace(d, weight=0)) for d in plain]
    )
    return tuned


def _decisions(mind: Mind, rows: list[Any], memories: dict[str, Any]) -> list[Decision]:
    with closing(mind):
        return mind.think(rows, memories)


def decision_of(mind: Mind, memory: Any = "kept", **seen: Any) -> Decision:
    """What Ada decides, who remembers this; then the mind is closed."""
    (decision,) = _decisions(mind, [row("Ada", **seen)], {"Ada": memory})
    return decision


def nearly_same(one: Any, other: Any) -> bool:
    """Equal, numbers within 1e-12: text that is JSON has 15 digits only."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-12, abs_tol=1e-12)
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(nearly_same(one[k], other[k]) for k in one)
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(nearly_same, one, other))
    return bool(one == other)


def remembered(expression: str, memory: Any = "", *, rules: str = "") -> Any:
    """What a robot remembers when its memory is to be an expression of `sensor` and `memory`."""
    text = f"{rules}\n{ROBOT} Memory(robot_name:, memory:), m = ({expression});"
    (decision,) = think(text, [row("Ada")], {"Ada": memory})
    assert not decision.notices, decision.notices
    return decision.memory


def cases(expressions: Sequence[str]) -> tuple[str, dict[str, str]]:
    """Rules that make a function of each expression, in which names are its own, and its calls.

    Returns:
        The rules, and calls by names for columns or fields.
    """
    rules = "".join(f"\nCase{n}(sensor, memory) = ({text});" for n, text in enumerate(expressions))
    return rules, {f"c{n}": f"Case{n}(sensor, memory)" for n in range(len(expressions))}


def all_remembered(
    expressions: Collection[str], memory: Any = "", *, rules: str = ""
) -> dict[str, Any]:
    functions, calls = cases([*expressions])
    record = ", ".join(f"{name}: {call}" for name, call in calls.items())
    values = remembered(f"{{{record}}}", memory, rules=rules + functions)
    return {text: values[name] for text, name in zip(expressions, calls, strict=True)}


def python(script: str, *arguments: str) -> str:
    """What a script prints in a Python of its own, which ends well and complains of nothing."""
    done = run_command([sys.executable, "-c", script, *arguments])
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout
