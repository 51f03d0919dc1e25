"""Values that the cursor can be on: their origin, and what a decision is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from logical_robots_tui.explain import Ask
from logical_robots_tui.explain.why.explanation import Subject
from logical_robots_tui.game import MIND, Frame, Path, Pin
from logical_robots_tui.tui.inspector.widgets.value_tree import Branch
from logical_robots_tui.values import Value


@dataclass(frozen=True, slots=True)
class Traced:
    """A value in a robot's reasoning in a tick, whose origin is asked for.

    A part of a memory is the one after the tick; tick 0 is the start.
    """

    robot: str
    subject: Subject
    tick: int


def traced_pin(pin: Pin | None, robot: str, tick: int) -> Traced | None:
    """The value that a pin reads, in the reasoning of its robot or else of a given one."""
    if pin is None or pin.is_question or not pin.column:
        return None
    return traced_value(pin.predicate, dict(pin.where), pin.column, robot, tick, pin.path)


def traced_value(
    predicate: str,
    row: Mapping[str, Value],
    column: str,
    robot: str,
    tick: int,
    path: Path = (),
) -> Traced | None:
    """A value of a row, in the reasoning of the row's robot or else of a given one.

    `Memory` holds memories as of the tick before, `Robot` as of this tick.
    """
    subject = Subject(path=path)
    whose = next((row[name] for name in (MIND, "robot_name") if name in row), robot)
    if predicate == "Sensor" or not isinstance(whose, str):
        return None
    if predicate == "Memory":
        return Traced(whose, subject, max(0, tick - 1)) if column == "memory" else None
    if predicate == "Robot" and column == "memory":
        return Traced(whose, subject, tick)
    asked = Ask(predicate, {name: value for name, value in row.items() if name != MIND})
    return Traced(whose, replace(subject, asked=asked, column=column), tick)


def decision_branches(frame: Frame, robot: str) -> Sequence[Branch]:
    """The inputs and outputs of a robot's decision."""
    sensor = next(row["sensor"] for row in frame.sensors if row["robot_name"] == robot)
    whose = (("robot_name", robot),)
    branches = [
        Branch("sensor", sensor, Pin("Sensor", "sensor", whose)),
        Branch("memory before", frame.memories_before.get(robot), Pin("Memory", "memory", whose)),
    ]
    decision = frame.decision_of(robot)
    if decision is None:
        return branches
    if (given := decision.desire) is not None:
        desire = {"left_engine": given.left_engine, "right_engine": given.right_engine}
        branches.append(Branch("desire", desire, Pin("Robot", "desire", whose)))
    branches.append(Branch("memory after", decision.memory, Pin("Robot", "memory", whose)))
    return branches
