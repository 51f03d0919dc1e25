"""Asking why, for tests."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import row

if TYPE_CHECKING:
    from logical_robots_tui.mind.why.explanation import Explanation, PartFound, RuleFound

__all__ = ["REST", "part", "why"]

REST = """
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :- Sensor(robot_name:);
"""
"""A rule that makes a program of any rules."""


def why(
    text: str,
    predicate: str = "Robot",
    robot: str = "Ada",
    *,
    rows: list[Any] | None = None,
    memories: dict[str, Any] | None = None,
    given: dict[str, Any] | None = None,
    within: str = "",
    **visibility: Any,
) -> Explanation:
    """Why a predicate of a program has its rows."""
    program = Program.compile(text)
    with closing(Mind(program, **visibility)) as mind:
        probing = program.take_apart(predicate, within)
        return mind.why(probing, robot, rows or [row("Ada")], memories or {}, given=given)


def part(rule: RuleFound, text: str) -> PartFound:
    """What a part of a rule gave, found by the beginning of its text."""
    return next(each for each in rule.found if each.part.span.text.startswith(text))
