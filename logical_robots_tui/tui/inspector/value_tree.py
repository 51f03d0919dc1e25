"""A value as an expandable tree: records and lists, and a plot of a radar."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rich.text import Text
from textual import on
from textual.containers import Horizontal
from textual.content import Content
from textual.widgets import Static, Tree

from logical_robots_tui.schema import ray_angle
from logical_robots_tui.tui.inspector.plots import ink_value, radar_plot
from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.theme.themes import INK, rich_style
from logical_robots_tui.values import Value
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from textual.widgets.tree import TreeNode

    from logical_robots_tui.game import Path, Pin

_GROUP = 100  # most parts under one node
_PREVIEW = 60  # characters of a collapsed record or list
_OPEN = 12  # branches with at most so many parts are expanded at first
_PICTURE_ROWS = 8


@dataclass(frozen=True, slots=True)
class ValueBranch:
    """A value with its name, and a pin for it if it can be pinned."""

    title: str
    value: Value
    pin: Pin | None = None


@dataclass(frozen=True, slots=True)
class _ValuePart:
    """A node: a value, or the parts `within` a range of a long list or record."""

    value: Value
    branch: ValueBranch
    path: Path
    within: range | None = None
    radar: Sequence[Mapping[str, Any]] | None = None


class ValueTree(Dialog[None]):
    """A dialog with values; `pin` toggles a pin, `follow` traces a value to its origin."""

    DEFAULT_CSS = """
    ValueTree > #box { height: 90%; max-width: 110; }
    ValueTree Tree { width: 1fr; height: 1fr; background: $surface; padding: 1 0 0 0; }
    ValueTree Tree:focus { background-tint: $foreground 0%; }
    ValueTree Tree > .tree--guides { color: $ink-faint; }
    ValueTree #radar { width: auto; height: auto; padding: 1 1; display: none; }
    """

    BINDINGS = [("at", "pin"), ("less_than_sign", "origin"), ("q,X", "leave")]

    keys = "↑↓ move   enter or space fold   @ pin   < where from   esc close"

    def __init__(
        self,
        title: str,
        branches: Sequence[ValueBranch],
        pin: Callable[[Pin], None],
        follow: Callable[[Pin], bool],
    ) -> None:
        self._branches = branches
        self._pin, self._follow = pin, follow
        self._tree: Tree[_ValuePart] = Tree("", id="tree")
        self._tree.show_root = False
        self._tree.guide_depth = 2
        self._picture = Static(id="radar")
        super().__init__(title, Horizontal(self._tree, self._picture))

    def on_mount(self) -> None:
        for branch in self._branches:
            part = _ValuePart(branch.value, branch, (), radar=_radar(branch.value))
            node = self._add(self._tree.root, branch.title, part)
            if len(self._branches) == 1 or _size(branch.value) <= _OPEN:
                node.expand()
        self._tree.cursor_line = 0
        self._tree.focus()

    def action_pin(self) -> None:
        pin = self._pointed
        if pin is None:
            self.notify("Only a value of a predicate can be pinned.", markup=False)
        else:
            self._pin(pin)

    def action_origin(self) -> None:
        pin = self._pointed
        if pin is not None and self._follow(pin):
            self.dismiss(None)
        else:
            self.notify("Only a value of the program has an origin.", markup=False)

    @property
    def _pointed(self) -> Pin | None:
        node = self._tree.cursor_node
        part = node.data if node is not None else None
        if part is None or part.within is not None or part.branch.pin is None:
            return None
        return part.branch.pin.deeper(part.path)

    @on(Tree.NodeExpanded)
    def _grow(self, event: Tree.NodeExpanded[_ValuePart]) -> None:
        event.stop()
        node = event.node
        if node.data is not None and not node.children:
            for name, part in _inside(node.data):
                self._add(node, name, part)

    @on(Tree.NodeHighlighted)
    def _moved(self, event: Tree.NodeHighlighted[_ValuePart]) -> None:
        event.stop()
        radar = event.node.data.radar if event.node.data is not None else None
        self._picture.display = radar is not None and self.size.width >= 10 * _PICTURE_ROWS
        if radar is not None:
            self._picture.update(Content("\n").join(radar_plot(radar, _PICTURE_ROWS)))

    def _add(self, node: TreeNode[_ValuePart], name: str, part: _ValuePart) -> TreeNode[_ValuePart]:
        has_parts = bool(_size(part.value))
        label = Text.assemble(
            (one_line(name), rich_style(INK.text if has_parts else INK.dim)), "  "
        )
        if part.within is None:
            text, colour = ink_value(part.value, _PREVIEW)
            label.append(text, rich_style(INK.dim if has_parts else colour))
        return node.add(label, part, allow_expand=has_parts)


def _size(value: Value) -> int:
    return len(value) if isinstance(value, Mapping | list | tuple) else 0


def _inside(part: _ValuePart) -> Iterator[tuple[str, _ValuePart]]:
    value = part.value
    if not isinstance(value, Mapping | list | tuple):
        return
    items: list[tuple[str | int, Value]]
    items = list(value.items() if isinstance(value, Mapping) else enumerate(value))
    if part.within is None and len(items) > _GROUP:
        for start in range(0, len(items), _GROUP):
            group = range(start, min(start + _GROUP, len(items)))
            yield f"{group[0]} to {group[-1]}", replace(part, within=group)
        return
    among = part.within or range(len(items))
    for step, member in items[among.start : among.stop]:
        radar = _radar(member) or part.radar
        yield str(step), _ValuePart(member, part.branch, (*part.path, step), radar=radar)


def _radar(value: Value) -> Sequence[Mapping[str, Any]] | None:
    if not isinstance(value, list | tuple) or not value:
        return None
    return None if any(ray_angle(ray) is None for ray in value) else value
