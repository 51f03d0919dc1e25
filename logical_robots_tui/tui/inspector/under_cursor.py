"""What the inspector's cursor is on: a value to pin, to open as a tree, or to trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from logical_robots_tui.explain import Ask, Node
from logical_robots_tui.explain.why.sources import Subject
from logical_robots_tui.game import MIND, ROBOT_COLUMNS, Frame, Pin, pin_of_cell, read_part
from logical_robots_tui.tui.inspector.predicate_list import ASK, DECISION, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.value_tree import Branch
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.tui.inspector.widgets.proof_view import WhyView
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

_OF_A_ROBOT = (ROBOTS, DECISION, WHY)


@dataclass(frozen=True, slots=True)
class Traced:
    """A value in a robot's reasoning in a tick, whose origin is asked for.

    A part of a memory is the one after the tick; tick 0 is the start.
    """

    robot: str
    subject: Subject
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


def traced_pin(pin: Pin | None, robot: str, tick: int) -> Traced | None:
    """The value that a pin reads, in the reasoning of its robot or else of a given one."""
    if pin is None or pin.is_question or not pin.column:
        return None
    row = dict(pin.where)
    return _traced(pin.predicate, row, pin.column, robot, tick, Subject(path=pin.path))


def traced_cell(predicate: str, table: ValueTable | None, robot: str, tick: int) -> Traced | None:
    """The value under a table's cursor, in the reasoning of the row's robot or a given one."""
    if table is None or not table.has_focus or table.place is None or predicate == ASK:
        return None
    number, column = table.place
    row = dict(zip(table.all.columns, table.all.rows[number], strict=True))
    return _traced(predicate, row, column, robot, tick, Subject())


def _traced(
    predicate: str, row: dict[str, Value], column: str, robot: str, tick: int, subject: Subject
) -> Traced | None:
    """`Memory` holds memories as of the tick before, `Robot` as of this tick."""
    whose = next((row[name] for name in (MIND, "robot_name") if name in row), robot)
    if predicate == "Sensor" or not isinstance(whose, str):
        return None
    if predicate == "Memory":
        return Traced(whose, subject, max(0, tick - 1)) if column == "memory" else None
    if predicate == "Robot" and column == "memory":
        return Traced(whose, subject, tick)
    asked = Ask(predicate, {name: value for name, value in row.items() if name != MIND})
    return Traced(whose, replace(subject, asked=asked, column=column), tick)


def traced_in_proof(view: WhyView, question: Ask, robot: str, tick: int) -> Traced | None:
    """The value under the cursor of a proof: of a column, a call, an expression or a variable."""
    if view.line is None:
        return None
    node, above = view.line.node, view.above
    rule = next((n for n, each in enumerate(above) if each.kind == "rule"), None)
    if rule is None:
        return None
    asked = next((each.asked for each in above[rule:] if each.asked is not None), question)
    if node.kind == "read" and above[0].text.startswith("Memory("):
        return _memory_read(node.text, above[0].robot or robot, tick)
    if node.kind in ("column", "aggregate") and node.asked is None and above[0].kind == "rule":
        column = node.text.split(":")[0]
        if asked.predicate == "Robot" and column == "memory":
            return Traced(robot, Subject(), tick)
        return Traced(robot, Subject(asked, column), tick)
    if len(node.values) != 1:
        return None
    (value,) = node.values
    if node.span is not None:
        return Traced(robot, Subject(asked, "", span=node.span, value=value), tick)
    if node.kind == "value":
        return Traced(robot, Subject(asked, "", variable=node.text, value=value), tick)
    return None


def _memory_read(text: str, robot: str, tick: int) -> Traced | None:
    try:
        path = read_part(text)[1]
    except ValueError:
        return None
    return Traced(robot, Subject(path=path), max(0, tick - 1))


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
