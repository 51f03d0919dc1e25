"""Highlights what the inspector's cursor is on, in the program and in the labyrinth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isclose
from typing import TYPE_CHECKING, Any

from textual.message import Message

from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Node, Program

__all__ = ["Placed", "Sighted", "definition", "sight"]


@dataclass
class Placed(Message):
    """Highlight a place in the program.

    Attributes:
        program: The program's text.
        place: Offsets of its first character and behind its last one.
    """

    program: str
    place: tuple[int, int]


@dataclass
class Sighted(Message):
    """Highlight a robot or a ray in the labyrinth, or nothing.

    Attributes:
        highlight: The robot or the ray, or None.
        frame: The tick that it belongs to.
    """

    highlight: Highlight | None
    frame: Frame


def sight(node: Node, robot: str, frame: Frame) -> Highlight | None:
    """The robot or the ray that a node of a proof is about, or None.

    Args:
        node: The node.
        robot: The robot whose reasoning it belongs to; equal rays are taken to be this robot's.
        frame: The tick.
    """
    if node.robot:
        return Highlight(node.robot)
    if node.ray is not None and len(node.values) == 1:
        rows = sorted(frame.sensors, key=lambda row: row["robot_name"] != robot)
        for row in rows:
            for ray in row["sensor"]["radar"]:
                if _is_same(node, ray):
                    return Highlight(row["robot_name"], ray["angle"])
    return None


def _is_same(node: Node, ray: Mapping[str, Any]) -> bool:
    """Whether a node's value is a ray; SQLite may change the last digits of its angle."""
    value = node.values[0]
    return (
        isinstance(value, Mapping)
        and node.ray is not None
        and value.keys() == ray.keys()
        and isclose(node.ray, ray["angle"], abs_tol=1e-9)
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
