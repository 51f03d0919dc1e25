"""Highlights what the inspector's cursor is on, in the program and in the labyrinth."""

from __future__ import annotations

from collections.abc import Mapping
from math import isclose
from typing import TYPE_CHECKING, Any

from textual.message import Message

from logical_robots_tui.tui.labyrinth.drawing.look import Highlight

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Node, Program
    from logical_robots_tui.values import Value

__all__ = ["Placed", "Sighted", "definition", "sight"]


class Placed(Message):
    """Highlight a place in the program.

    Attributes:
        program: The program's text.
        place: Offsets of its first character and behind its last one.
    """

    def __init__(self, program: str, place: tuple[int, int]) -> None:
        super().__init__()
        self.program, self.place = program, place


class Sighted(Message):
    """Highlight a robot or a ray in the labyrinth, or nothing.

    Attributes:
        highlight: The robot or the ray, or None.
        frame: The tick that it belongs to.
    """

    def __init__(self, highlight: Highlight | None, frame: Frame) -> None:
        super().__init__()
        self.highlight, self.frame = highlight, frame


def sight(node: Node, robot: str, frame: Frame) -> Highlight | None:
    """The robot or the ray that a node of a proof is about, or None.

    Args:
        node: The node.
        robot: The robot whose reasoning it belongs to; equal rays are taken to be this robot's.
        frame: The tick.
    """
    if node.robot:
        return Highlight(node.robot)
    value = node.values[0] if len(node.values) == 1 else None
    if isinstance(value, Mapping) and "angle" in value:
        rows = sorted(frame.sensors, key=lambda row: row["robot_name"] != robot)
        for row in rows:
            for ray in row["sensor"]["radar"]:
                if _is_same(value, ray):
                    return Highlight(row["robot_name"], ray["angle"])
    return None


def _is_same(value: Mapping[str, Value], ray: Mapping[str, Any]) -> bool:
    """Whether a value is a ray; SQLite may change the last digits of its angle."""
    angle = value["angle"]
    return (
        value.keys() == ray.keys()
        and isinstance(angle, int | float)
        and isclose(angle, ray["angle"], abs_tol=1e-9)
        and all(value[name] == ray[name] for name in ray if name != "angle")
    )


def definition(program: Program | None, name: str) -> Placed | None:
    """Where a predicate is defined, or None if that is not in the program."""
    predicate = None if program is None else program.predicate(name)
    if program is None or predicate is None or predicate.line is None:
        return None
    lines = program.text.split("\n")
    start = sum(len(line) + 1 for line in lines[: predicate.line - 1])
    return Placed(program.text, (start, start + len(name)))
