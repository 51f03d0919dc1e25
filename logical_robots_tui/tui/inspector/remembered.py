"""Which part of whose memory the cursor of the inspector is on, and after which tick."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.game import Pin, read_path
from logical_robots_tui.tui.inspector.choice import DECISION, ROBOTS, WATCH, WHY
from logical_robots_tui.tui.inspector.pinning import pin_here

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Path
    from logical_robots_tui.tui.inspector.pages.why import WhyView
    from logical_robots_tui.tui.inspector.pane import InspectorPane

__all__ = ["Remembered", "remembered", "remembered_here"]


@dataclass(frozen=True, slots=True)
class Remembered:
    """A part of a memory.

    Attributes:
        robot: Whose memory.
        path: The part of it.
        tick: The tick after which the robot has it; 0 is the start.
    """

    robot: str
    path: Path
    tick: int


def remembered(pin: Pin | None, tick: int) -> Remembered | None:
    """What a pin reads of a memory at a tick, or None if it reads something else.

    `Memory` has what robots remember from the tick before, `Robot` what they remember from then on.
    """
    robot = dict(pin.where).get("robot_name") if pin is not None else None
    if pin is None or not isinstance(robot, str) or pin.column != "memory":
        return None
    if pin.predicate == "Memory":
        return Remembered(robot, pin.path, max(0, tick - 1))
    return Remembered(robot, pin.path, tick) if pin.predicate == "Robot" else None


def remembered_here(inspector: InspectorPane, frame: Frame) -> Remembered | None:
    """What the cursor is on, or all that a robot remembers where only robots are shown."""
    name, pages = inspector.inspected, inspector.pages
    if name == WHY:
        return _in_proof(pages.reasons.view, frame.tick)
    if name == WATCH:
        return remembered(pages.pins.pointed, frame.tick)
    if name in (ROBOTS, DECISION):
        return Remembered(inspector.robot, (), frame.tick)
    return remembered(pin_here(name, inspector.shown_table, inspector.robot), frame.tick)


def _in_proof(view: WhyView, tick: int) -> Remembered | None:
    """What the node under the cursor has read of a memory."""
    line = view.line
    if line is None or line.node.kind != "read":
        return None
    before = view.lines[: view.lines.index(line)]
    parent = next(each.node for each in reversed(before) if each.depth < line.depth)
    if not parent.robot or not parent.text.startswith("Memory("):
        return None
    name = line.node.text.split(".")[0].split("[")[0]
    try:
        path = read_path(f"memory{line.node.text.removeprefix(name)}")
    except ValueError:
        return None
    return Remembered(parent.robot, path, max(0, tick - 1))
