"""What the inspector's cursor is on: a value to pin, to open as a tree, or a memory to trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.explain import Node
from logical_robots_tui.game import ROBOT_COLUMNS, Frame, Pin, pin_of_cell, read_path
from logical_robots_tui.tui.inspector.predicate_list import ASK, DECISION, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.value_tree import Branch

if TYPE_CHECKING:
    from logical_robots_tui.game import Path
    from logical_robots_tui.tui.inspector.widgets.proof_view import WhyView
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

_OF_A_ROBOT = (ROBOTS, DECISION, WHY)


@dataclass(frozen=True, slots=True)
class MemoryPart:
    """A part of a memory after a tick; 0 is the start."""

    robot: str
    path: Path
    tick: int


def pin_here(inspected: str, table: ValueTable | None, robot: str) -> Pin | None:
    """The pin for a cell, a number of rows or a memory; None if the row can't be told apart."""
    if inspected in _OF_A_ROBOT:
        return Pin("Memory", "memory", (("robot_name", robot),))
    if table is None or inspected == ASK:
        return None
    if table.has_focus and table.place is not None:
        return _pin_of_cell(inspected, table)
    named = next((name for name in ROBOT_COLUMNS if name in table.all.columns), "")
    only = table.how.robot if named else ""
    return Pin(inspected, where=((named, only),) if only else ())


def branches_of(node: Node) -> tuple[str, Sequence[Branch]]:
    title = f"{node.text} (and {node.more:,} more)" if node.more else node.text
    if len(node.values) == 1:
        return title, (Branch(node.text, node.values[0]),)
    return title, [Branch(f"{number}", each) for number, each in enumerate(node.values, 1)]


def branches_here(
    inspected: str, table: ValueTable | None, robot: str, frame: Frame
) -> tuple[str, Sequence[Branch]]:
    """Return what to open as a tree: a cell's value, or a decision's inputs and outputs."""
    if inspected in _OF_A_ROBOT:
        return f"Decision of {robot}", _decision(frame, robot)
    if table is None or table.pointed is None:
        return "", ()
    pin = _pin_of_cell(inspected, table) if inspected != ASK else None
    return "Answer" if inspected == ASK else inspected, (Branch(*table.pointed, pin),)


def memory_of(pin: Pin | None, tick: int) -> MemoryPart | None:
    """The part of a memory that a pin reads, or None.

    `Memory` holds memories as of the tick before, `Robot` as of this tick.
    """
    robot = dict(pin.where).get("robot_name") if pin is not None else None
    if pin is None or not isinstance(robot, str) or pin.column != "memory":
        return None
    if pin.predicate == "Memory":
        return MemoryPart(robot, pin.path, max(0, tick - 1))
    return MemoryPart(robot, pin.path, tick) if pin.predicate == "Robot" else None


def memory_in_proof(view: WhyView, tick: int) -> MemoryPart | None:
    line = view.line
    if line is None or line.node.kind != "read":
        return None
    parent = view.parent_pointed
    if parent is None or not parent.robot or not parent.text.startswith("Memory("):
        return None
    name = line.node.text.split(".")[0].split("[")[0]
    try:
        path = read_path(f"memory{line.node.text.removeprefix(name)}")
    except ValueError:
        return None
    return MemoryPart(parent.robot, path, max(0, tick - 1))


def _pin_of_cell(predicate: str, table: ValueTable) -> Pin | None:
    if table.place is None:
        return None
    row, column = table.place
    return pin_of_cell(predicate, table.all.columns, table.all.rows, row, column)


def _decision(frame: Frame, robot: str) -> Sequence[Branch]:
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
