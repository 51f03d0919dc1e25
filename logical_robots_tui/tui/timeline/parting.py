"""In what two futures differ where they part, as a page to read."""

from __future__ import annotations

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

__all__ = ["parting_page"]

_LONGEST = 600  # characters of a value


def parting_page(parting: Parting) -> Reader:
    """A dialog that tells all differences, robot by robot."""
    lines = list(_lines(parting))
    title = f"The two futures part in tick {parting.tick}"
    return Reader(title, Static(Content("\n").join(lines)))


def _lines(parting: Parting) -> Iterator[Content]:
    robots = dict.fromkeys(each.robot_name for each in parting.differences)
    if not robots:
        yield Content("No robot differs, but an area does.")
    for robot in robots:
        yield Content.styled(one_line(robot), f"bold {INK.title}")
        for each in parting.differences:
            if each.robot_name == robot:
                yield Content.styled(f"  {each.matter}", INK.key)
                yield _side("here ", each, each.here)
                yield _side("there", each, each.there)
        yield Content("")


def _side(where: str, difference: Difference, value: Any) -> Content:
    return Content.assemble((f"    {where}  ", INK.dim), (_told(difference, value), INK.text))


def _told(difference: Difference, value: Any) -> str:
    if isinstance(value, Desire):
        return f"left {value.left_engine:.6g}, right {value.right_engine:.6g}"
    match difference.matter, value:
        case "position", (float(x), float(y), float(angle)):
            return f"{x:.6g}, {y:.6g}, looking to {angle:.6g}"
        case "notices", tuple(notices):
            return visible(" ".join(map(str, notices))) or "none"
        case "desire", _:
            return "none"
    return written(value, _LONGEST)
