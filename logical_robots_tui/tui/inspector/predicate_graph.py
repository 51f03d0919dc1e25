"""What predicates use and cost: the call graph, and the SQL with its query plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from textual import events
from textual.content import Content
from textual.geometry import Region
from textual.widgets import Static

from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.pane import MARKS
from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line, visible

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program, QueryPlan

_USERS, _MIDDLE, _USED = 0, 1, 2
_JOINTS = {
    "": " ", "e": "─", "w": "─", "ew": "─", "ns": "│", "n": "│", "s": "│",
    "es": "╭", "en": "╰", "sw": "╮", "nw": "╯",
    "ens": "├", "nsw": "┤", "esw": "┬", "enw": "┴", "ensw": "┼",
}  # fmt: skip
_NOBODY, _NOTHING = "nobody", "nothing"
_HERE = "reverse"
_ARROWS = 10  # columns for the two joints with their arrows


class GraphView(LinesView):
    """A predicate in the middle, its users and the predicates it uses at the sides."""

    BINDINGS = [
        ("up", "choose(-1)"),
        ("down", "choose(1)"),
        ("left", "along(-1)"),
        ("right", "along(1)"),
        ("enter", "open"),
    ]

    def __init__(self, program: Program, name: str, opened: Callable[[str], object]) -> None:
        super().__init__(id="graph")
        self._program, self._opened = program, opened
        self._tops: tuple[int, ...] = (0, 0, 0)
        self._widths: tuple[int, ...] = (0, 0, 0)
        self.centre(name)

    @property
    def chosen_name(self) -> str:
        column, row = self._at
        return self._columns[column][row]

    def centre(self, name: str) -> None:
        uses = self._program.uses
        users = [user for user, used in uses.items() if name in used]
        self.middle = name
        self._columns: tuple[Sequence[str], ...] = (users, (name,), uses.get(name, ()))
        self._at = (_MIDDLE, 0)
        self.redraw()

    def on_click(self, event: events.Click) -> None:
        """Move a predicate to the middle; open the one that is already there."""
        row, column, x = event.y + self.scroll_offset.y, _USERS, event.x
        while column < _USED and x >= self._widths[column]:
            x -= self._widths[column] + _ARROWS // 2
            column += 1
        place = row - self._tops[column]
        if x >= 0 and 0 <= place < len(self._columns[column]):
            if column == _MIDDLE:
                self._opened(self.middle)
            else:
                self.centre(self._columns[column][place])

    def action_choose(self, down: int) -> None:
        column, row = self._at
        self._at = (column, max(0, min(row + down, len(self._columns[column]) - 1)))
        self.redraw()

    def action_along(self, right: int) -> None:
        column = self._at[0] + right
        if not _USERS <= column <= _USED:
            self.centre(self.chosen_name)
        elif self._columns[column]:
            row = self._tops[self._at[0]] + self._at[1] - self._tops[column]
            self._at = (column, max(0, min(row, len(self._columns[column]) - 1)))
            self.redraw()

    def action_open(self) -> None:
        self._opened(self.chosen_name)

    def draw(self) -> None:
        labels = [[self._label(name) for name in names] for names in self._columns]
        labels[_USERS] = labels[_USERS] or [Content.styled(_NOBODY, INK.dim)]
        labels[_USED] = labels[_USED] or [Content.styled(_NOTHING, INK.dim)]
        limit = (self.columns - _ARROWS) // 3
        height = max(map(len, labels))
        self._tops = tuple((height - len(side)) // 2 for side in labels)
        self._widths = tuple(
            min(limit, max(label.cell_length for label in side)) for side in labels
        )
        self.paint([self._line(row, labels) for row in range(height)])
        column, row = self._at
        area = Region(0, self._tops[column] + row, 1, 1)
        self.scroll_to_region(area, animate=False, force=True)

    def _line(self, row: int, labels: Sequence[Sequence[Content]]) -> Content:
        parts = []
        for column, (top, width) in enumerate(zip(self._tops, self._widths, strict=True)):
            place = row - top
            label = Content("")
            if 0 <= place < len(labels[column]):
                label = labels[column][place].truncate(width, ellipsis=True)
                if (column, place) == self._at:
                    label = label.stylize(_HERE)
            gap = width - label.cell_length
            parts.append(label.pad_left(gap) if column == _USERS else label.pad_right(gap))
        for column in (_USED, _USERS):
            top = self._tops[column]
            ends = range(top, top + len(self._columns[column]))
            sides = joint(row, ends, self._tops[_MIDDLE], to_right=column == _USERS)
            link = f" {'─' if 'w' in sides else ' '}{_JOINTS[sides]}{'▶' if 'e' in sides else ' '} "
            parts.insert(max(column, _MIDDLE), Content.styled(link, INK.faint))
        return Content("").join(parts)

    def _label(self, name: str) -> Content:
        predicate = self._program.predicate(name)
        mark, colour = MARKS[predicate.kind] if predicate is not None else (" ", INK.dim)
        style = f"bold {INK.title}" if name == self.middle else INK.text
        text = clip(one_line(name), self.columns)
        return Content.assemble((f"{mark} ", colour), (text, style))


def joint(row: int, ends: range, middle: int, *, to_right: bool) -> str:
    """The connector's directions, of ``ensw``, from rows `ends` to `middle`."""
    if not ends:
        return ""
    top, bottom = min(ends[0], middle), max(ends[-1], middle)
    outer, inner = ("w", "e") if to_right else ("e", "w")
    sides = {
        outer: row in ends,
        inner: row == middle,
        "n": top < row <= bottom,
        "s": top <= row < bottom,
    }
    return "".join(sorted(side for side, is_there in sides.items() if is_there))


class Graph(Dialog[str]):
    """A dialog with the graph; returns the name of the predicate to open."""

    DEFAULT_CSS = """
    Graph > #box { height: 80%; max-width: 110; }
    Graph #graph { margin: 1 0 0 0; }
    """

    BINDINGS = [("q,R", "leave")]

    heading = "Users → predicate → what it uses"
    keys = "↑↓ choose   ← → go along   enter open in the inspector   esc close"

    def __init__(self, program: Program, name: str) -> None:
        self.view = GraphView(program, name, self.dismiss)
        super().__init__("", self.view)


_BAR = 24  # columns of the longest bar


def query_plan_text(plans: Sequence[QueryPlan], predicate: str) -> Static:
    """How long each predicate takes, and SQL and plan of one, otherwise the slowest."""
    main_plan = next((plan for plan in plans if plan.predicate == predicate), plans[0])
    lines = [Content.styled("Milliseconds, including dependencies", f"bold {INK.title}")]
    longest = max(plan.milliseconds for plan in plans) or 1.0
    for plan in plans:
        bar = "▇" * max(1, round(plan.milliseconds / longest * _BAR))
        lines.append(
            Content.assemble(
                (f"{plan.milliseconds:8.2f}  ", INK.number),
                (f"{bar:<{_BAR}}  ", INK.faint),
                (one_line(plan.predicate), f"bold {INK.key}" if plan is main_plan else INK.text),
            )
        )
    generated, tuned = (tuple(sql.splitlines()) for sql in (main_plan.generated, main_plan.tuned))
    sections = [(f"SQLite's plan for {one_line(main_plan.predicate)}", main_plan.plan, INK.record)]
    sections += [("Optimised SQL, which is run", tuned, INK.text)] * bool(tuned)
    title = "Generated SQL" if tuned else "Generated SQL, which is run"
    sections.append((title, generated, INK.dim if tuned else INK.text))
    for title, text, colour in sections:
        lines += [Content(""), Content.styled(title, f"bold {INK.title}")]
        lines += [Content.styled(f"  {visible(line)}", colour) for line in text if line.strip()]
    return Static(Content("\n").join(lines))
