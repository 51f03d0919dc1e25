"""What can be pinned, and opened as a tree, where the cursor is in the inspector."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game import ROBOT_COLUMNS, Pin, pin_of_cell
from logical_robots_tui.tui.inspector.choice import ASK, DECISION, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.tree import Branch

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Node
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

__all__ = ["branches_here", "branches_of", "pin_here"]

_OF_A_ROBOT = (ROBOTS, DECISION, WHY)


def pin_here(inspected: str, table: ValueTable | None, robot: str) -> Pin | None:
    """What there is to pin: a value in a table, a number of rows, or a robot's memory.

    Args:
        inspected: The page or predicate that is inspected.
        table: The table on the screen, if there is one.
        robot: Name of the robot that is told of.

    Returns:
        The pin, or None if there is nothing, or nothing tells the value's row from others.
    """
    if inspected in _OF_A_ROBOT:
        return Pin("Memory", "memory", (("robot_name", robot),))
    if table is None or inspected == ASK:
        return None
    if table.has_focus and table.place is not None:
        row, column = table.place
        return pin_of_cell(inspected, table.all.columns, table.all.rows, row, column)
    named = next((name for name in ROBOT_COLUMNS if name in table.all.columns), "")
    only = table.how.robot if named else ""
    return Pin(inspected, where=((named, only),) if only else ())


def branches_of(node: Node) -> tuple[str, Sequence[Branch]]:
    """A title and the values of a node of a proof, by their number if there are several."""
    title = f"{node.text} (and {node.more:,} more)" if node.more else node.text
    if len(node.values) == 1:
        return title, (Branch(node.text, node.values[0]),)
    return title, [Branch(f"{number}", each) for number, each in enumerate(node.values, 1)]


def branches_here(
    inspected: str, table: ValueTable | None, robot: str, frame: Frame
) -> tuple[str, Sequence[Branch]]:
    """What there is to open as a tree: a value in a table, or all that a decision came from.

    Args:
        inspected: The page or predicate that is inspected.
        table: The table on the screen, if there is one.
        robot: Name of the robot that is told of.
        frame: The tick on the screen.

    Returns:
        A title, and the values by their names, or none.
    """
    if inspected in _OF_A_ROBOT:
        return f"Decision of {robot}", _decision(frame, robot)
    if table is None or table.pointed is None:
        return "", ()
    name, value = table.pointed
    pin = None
    if inspected != ASK and table.place is not None:
        row, column = table.place
        pin = pin_of_cell(inspected, table.all.columns, table.all.rows, row, column)
    return "Answer" if inspected == ASK else inspected, (Branch(name, value, pin),)


def _decision(frame: Frame, robot: str) -> Sequence[Branch]:
    sensor = next(row["sensor"] for row in frame.sensors if row["robot_name"] == robot)
    before = frame.memories_before.get(robot)
    whose = (("robot_name", robot),)
    branches = [
        Branch("sensor", sensor, Pin("Sensor", "sensor", whose)),
        Branch("memory before", before, Pin("Memory", "memory", whose)),
    ]
    decision = next((each for each in frame.decisions if each.robot_name == robot), None)
    if decision is not None and decision.desire is not None:
        desire = {
            "left_engine": decision.desire.left_engine,
            "right_engine": decision.desire.right_engine,
        }
        branches.append(Branch("desire", desire, Pin("Robot", "desire", whose)))
    if decision is not None:
        branches.append(Branch("memory after", decision.memory, Pin("Robot", "memory", whose)))
    return branches
