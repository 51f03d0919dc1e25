"""How and why two branches differ from the tick where they part, as a page."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.game import NoSuchTickError, Superseded
from logical_robots_tui.game.debugging.proof_difference import Comparison, compare_proofs
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.plots import format_value
from logical_robots_tui.tui.inspector.questions import BackgroundQuery
from logical_robots_tui.tui.learning.reader import TextReader
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import Desire
from logical_robots_tui.wording import clip, one_line, visible

if TYPE_CHECKING:
    from logical_robots_tui.game import BranchDifference, Divergence, Game
    from logical_robots_tui.game.history.branch import Matter

_LONGEST = 600  # characters of a value
_LONGEST_TEXT = 160  # of a piece of a program
_MOST_LINES = 200  # of two proofs
_BRANCHES = {
    " ": ("     ", INK.text),
    "-": ("here ", INK.key),
    "+": ("there", INK.key),
    "@": ("…    ", INK.dim),
}
"""The branch that a line of a diff belongs to, and how the line is shown."""


class DivergencePage(TextReader):
    """Shows all differences, and before them what differs in the proofs once they are compared."""

    def __init__(self, game: Game, divergence: Divergence) -> None:
        self._game, self._divergence = game, divergence
        self._differences = describe_divergence(divergence)
        self._text_shown = Static(self._differences)
        self._waiting = BackgroundQuery(game.clock)
        super().__init__(f"The two branches differ from tick {divergence.tick}", self._text_shown)

    def on_mount(self) -> None:
        in_background(self, self._compare, "compare")

    async def _compare(self) -> None:
        try:
            work = compare_proofs(self._game, self._divergence)
            comparison = await self._waiting.run(work, lambda: "comparing the proofs", self._say)
        except Superseded:
            return
        except (NoSuchTickError, QueryError) as error:
            self._say(Content.styled(one_line(str(error)), INK.warn))
            return
        self._say(None if comparison is None else describe_comparison(comparison))

    def _say(self, words: Content | None) -> None:
        parts = [self._differences] if words is None else [words, Content(""), self._differences]
        self._text_shown.update(Content("\n").join(parts))


def describe_comparison(comparison: Comparison) -> Content:
    robot = one_line(comparison.robot)
    if not comparison.lines:
        return Content(f"The proofs of {robot}'s decision are equal as far as they go.")
    lines = [Content(f"The proofs of what {robot} decides differ:")]
    for line in comparison.lines[:_MOST_LINES]:
        branch, style = _BRANCHES[line[0]]
        statement = line[1:].lstrip()
        indent = " " * (len(line) - 1 - len(statement))
        text = indent + clip(one_line(statement), _LONGEST_TEXT)
        lines.append(Content.assemble((f"  {branch}  ", INK.dim), (text, style)))
    if (remainder := len(comparison.lines) - _MOST_LINES) > 0:
        lines.append(Content.styled(f"  and {remainder:,} more lines", INK.dim))
    return Content("\n").join(lines)


def describe_divergence(divergence: Divergence) -> Content:
    robots = dict.fromkeys(difference.robot_name for difference in divergence.differences)
    lines = [] if robots else [Content("No robot differs, but an area does.")]
    for robot in robots:
        lines.append(Content.styled(one_line(robot), f"bold {INK.title}"))
        for difference in divergence.differences:
            if difference.robot_name == robot:
                lines.append(Content.styled(f"  {difference.matter}", INK.key))
                for branch, text in zip(("here ", "there"), _sides(difference), strict=True):
                    lines.append(Content.assemble((f"    {branch}  ", INK.dim), (text, INK.text)))
        lines.append(Content(""))
    return Content("\n").join(lines)


def _sides(difference: BranchDifference) -> list[str]:
    """Return both values, with enough digits to see the difference."""
    texts: list[str] = []
    for digits in (6, 17):
        values = (difference.value, difference.other_value)
        texts = [_describe_matter(difference.matter, value, digits) for value in values]
        if texts[0] != texts[1]:
            break
    return texts


def _describe_matter(matter: Matter, value: Any, digits: int) -> str:
    if isinstance(value, Desire):
        return f"left {value.left_engine:.{digits}g}, right {value.right_engine:.{digits}g}"
    if matter == "position":
        x, y, angle = value
        return f"{x:.{digits}g}, {y:.{digits}g}, looking to {degrees(angle):.{digits}g}°"
    if matter == "notices":
        return visible(" ".join(value)) or "none"
    return "none" if matter == "desire" else format_value(value, _LONGEST)
