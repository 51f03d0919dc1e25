"""Painting a widget on the terminal without Textual's compositor.

That renders all widgets between changed lines, a sixtieth of a second later. It still sees
the current state of a widget that uses a `PaintTarget`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from textual.geometry import Region
from textual.widget import Widget

from logical_robots_tui.tui.labyrinth.drawing.cells import PAPER, Cells
from logical_robots_tui.tui.terminal.cell_diff import Cell, Difference
from logical_robots_tui.tui.terminal.diff_app import DiffApp


class PaintTarget:
    """A widget's place on the terminal, with borders, in cells, and what covers it."""

    def __init__(self, terminal: Difference, region: Region, over: Sequence[Region]) -> None:
        self._terminal = terminal
        self._region = region
        self._over = over

    def put(self, cells: Cells, spans: Sequence[tuple[int, int, int]]) -> None:
        """Show changed spans, (row, first column, column after the last), of a widget's cells."""
        looks = self._terminal.looks
        for row, first, stop in spans:
            for start, end in self._free(row, first, stop):
                line: list[Cell] = [
                    # A blank looks the same in any foreground colour.
                    (text, looks[style if text != " " else style & PAPER])
                    for text, style in cells.row(row, start, end)
                ]
                if cells.is_cut(row, start):
                    line[0] = " ", line[0][1]
                if cells.is_cut(row, end):
                    line[-1] = " ", line[-1][1]
                self._terminal.put(self._region.y + row, self._region.x + start, line)

    def paint(self, widget: Widget) -> bool:
        """Show the whole widget; return False if something covers it."""
        if self._over:
            return False
        # Like `Widget.refresh` before it waits for the compositor.
        widget._layout_cache.clear()
        widget._set_dirty()
        lines = widget.render_lines(self._region.size.region)
        self._terminal.take(
            (row, self._region.x, list(line)) for row, line in enumerate(lines, self._region.y)
        )
        return True

    def _free(self, row: int, first: int, stop: int) -> Iterator[tuple[int, int]]:
        x, y = self._region.offset
        for region in sorted(self._over):
            if region.y <= y + row < region.bottom:
                if first < min(stop, region.x - x):
                    yield first, min(stop, region.x - x)
                first = max(first, region.right - x)
        if first < stop:
            yield first, stop


def paint_target_of(widget: Widget) -> PaintTarget | None:
    """Return a widget's place; None if it is partly hidden, or about to move."""
    app = widget.app
    if not isinstance(app, DiffApp) or not widget.is_attached or widget.screen is not app.screen:
        return None
    if widget.screen._layout_required or (terminal := app.terminal()) is None:
        return None
    over: list[Region] = []
    for other, (region, clip) in widget.screen._compositor.visible_widgets.items():
        if other is widget:
            over = [found for each in over if (found := each.intersection(region))]
            return PaintTarget(terminal, region, over) if clip.contains_region(region) else None
        over.append(region.intersection(clip))
    return None


def repaint(widget: Widget) -> None:
    spot = paint_target_of(widget)
    if spot is None or not spot.paint(widget):
        widget.refresh()
