"""In what two futures differ where they part, as a page to read."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.dialogs.reader import Reader
from logical_robots_tui.tui.inspector.cells import written
from logical_robots_tui.tui.plain import one_line, visible
from logical_robots_tui.tui.theme import INK
from logical_robots_tui.values import Desire

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game import Difference, Parting
    from logical_robots_tui.game.parting import Matter

__all__ = ["parting_page", "told"]

_LONGEST = 600  # characters of a value


def parting_page(parting: Parting) -> Reader:
    """A dialog that tells all differences, robot by robot."""
    return Reader(f"The two futures part in tick {parting.tick}", Static(told(parting)))


def told(parting: Parting) -> Content:
    """All differences as text."""
    return Content("\n").join(list(_lines(parting)))


def _lines(parting: Parting) -> Iterator[Content]:
    robots = dict.fromkeys(each.robot_name for each in parting.differences)
    if not robots:
        yield Content("No robot differs, but an area does.")
    for robot in robots:
        yield Content.styled(one_line(robot), f"bold {INK.title}")
        for each in parting.differences:
            if each.robot_name == robot:
                yield Content.styled(f"  {each.matter}", INK.key)
                for where, told in zip(("here ", "there"), _sides(each), strict=True):
                    yield Content.assemble((f"    {where}  ", INK.dim), (told, INK.text))
        yield Content("")


def _sides(each: Difference) -> tuple[str, str]:
    """What it is here and there, with so many digits that one sees the difference."""
    here, there = _told(each.matter, each.here, 6), _told(each.matter, each.there, 6)
    if here == there:
        here, there = _told(each.matter, each.here, 17), _told(each.matter, each.there, 17)
    return here, there


def _told(matter: Matter, value: Any, digits: int) -> str:
    if isinstance(value, Desire):
        return f"left {value.left_engine:.{digits}g}, right {value.right_engine:.{digits}g}"
    match matter:
        case "position":
            x, y, angle = value
            return f"{x:.{digits}g}, {y:.{digits}g}, looking to {degrees(angle):.{digits}g}°"
        case "notices":
            return visible(" ".join(value)) or "none"
        case "desire":
            return "none"
    return written(value, _LONGEST)
