"""How and why two branches differ from the tick where they part, as a page."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING, Any, Literal

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.explain import Node
from logical_robots_tui.game import NoSuchTickError, Superseded
from logical_robots_tui.game.debugging.proof_difference import Comparison, compare_proofs
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.plots import format_value
from logical_robots_tui.tui.inspector.questions import BackgroundQuery
from logical_robots_tui.tui.learning.reader import Reader
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import Desire
from logical_robots_tui.wording import clip, one_line, visible

if TYPE_CHECKING:
    from logical_robots_tui.game import Difference, Divergence, Game
    from logical_robots_tui.game.history.branch import Matter

_LONGEST = 600  # characters of a value
_LONGEST_TEXT = 160  # of a piece of a program
_LONGEST_ARGUMENT = 24


class DivergencePage(Reader):
    """Shows the first differing derivation once it is found, and all differences."""

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
            found = await self._waiting.run(work, lambda: "comparing the proofs", self._say)
        except Superseded:
            return
        except (NoSuchTickError, QueryError) as error:
            self._say(Content.styled(one_line(str(error)), INK.warn))
            return
        self._say(None if found is None else derivation(found))

    def _say(self, words: Content | None) -> None:
        parts = [self._differences] if words is None else [words, Content(""), self._differences]
        self._text_shown.update(Content("\n").join(parts))


def derivation(comparison: Comparison) -> Content:
    found, robot = comparison.differing, one_line(comparison.robot)
    if found is None:
        return Content(f"The proofs of {robot}'s decision are equal as far as they go.")
    given = ", ".join(
        f"{'' if name.startswith('col') and name[3:].isdigit() else f'{name}: '}"
        f"{format_value(value, _LONGEST_ARGUMENT)}"
        for name, value in found.asked.given.items()
    )
    what = one_line(f"{found.asked.predicate}({given})")
    lines = [Content.assemble(f"What {robot} decides differs first in ", (what, INK.title))]
    for where, node in (("here ", found.here), ("there", found.there)):
        lines.append(Content.assemble((f"  {where}  ", INK.dim), _node(node, found.kind)))
    if comparison.condition is not None:
        node, side = comparison.condition
        words = "there and not here" if side == "there" else "here and not there"
        text = clip(one_line(node.text), _LONGEST_TEXT)
        lines.append(Content.assemble("  ", (text, INK.key), f" holds {words}."))
    return Content("\n").join(lines)


def _node(node: Node | None, kind: Literal["rule", "step", "value"]) -> Content:
    if node is None:
        return Content.styled("missing here", INK.dim)
    line = f"line {node.span.line}  " if node.span is not None else ""
    text = Content.assemble((line, INK.key), (clip(one_line(node.text), _LONGEST_TEXT), INK.text))
    if kind == "value" or node.kind == "column":
        values = " or ".join(format_value(value, _LONGEST_TEXT) for value in node.values)
        return text.append(Content.styled(f" = {values}" if values else "", INK.number))
    if node.holds is False:
        return text.append(Content.styled("  does not hold", INK.bad))
    return text


def describe_divergence(divergence: Divergence) -> Content:
    robots = dict.fromkeys(each.robot_name for each in divergence.differences)
    lines = [] if robots else [Content("No robot differs, but an area does.")]
    for robot in robots:
        lines.append(Content.styled(one_line(robot), f"bold {INK.title}"))
        for each in divergence.differences:
            if each.robot_name == robot:
                lines.append(Content.styled(f"  {each.matter}", INK.key))
                for where, said in zip(("here ", "there"), _sides(each), strict=True):
                    lines.append(Content.assemble((f"    {where}  ", INK.dim), (said, INK.text)))
        lines.append(Content(""))
    return Content("\n").join(lines)


def _sides(each: Difference) -> list[str]:
    """Return both values, with enough digits to see the difference."""
    said: list[str] = []
    for digits in (6, 17):
        said = [_describe_matter(each.matter, side, digits) for side in (each.here, each.there)]
        if said[0] != said[1]:
            break
    return said


def _describe_matter(matter: Matter, value: Any, digits: int) -> str:
    if isinstance(value, Desire):
        return f"left {value.left_engine:.{digits}g}, right {value.right_engine:.{digits}g}"
    if matter == "position":
        x, y, angle = value
        return f"{x:.{digits}g}, {y:.{digits}g}, looking to {degrees(angle):.{digits}g}°"
    if matter == "notices":
        return visible(" ".join(value)) or "none"
    return "none" if matter == "desire" else format_value(value, _LONGEST)
