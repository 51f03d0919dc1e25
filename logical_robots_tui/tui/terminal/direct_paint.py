"""The spot where a widget stands on the terminal, to be painted without Textual's compositor.

The compositor renders every widget between the first and the last line that changed, a sixtieth of
a second later. A widget that is drawn anew many times a second, and knows what changed, says so at
its `Spot` instead; all else still goes through the compositor, which finds the widget as it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.labyrinth.drawing.cells import PAPER
from logical_robots_tui.tui.terminal.diff_app import SparingApp

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from textual.geometry import Region
    from textual.widget import Widget

    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.terminal.cell_diff import Cell, Difference

__all__ = ["Spot", "repaint", "spot_of"]


class Spot:
    """Where a widget stands.

    Args:
        terminal: What the terminal is to show.
        region: The widget with its borders, in cells of the terminal.
        over: What lies over it.
    """

    def __init__(self, terminal: Difference, region: Region, over: Sequence[Region]) -> None:
        self._terminal = terminal
        self._region = region
        self._over = over

    def put(self, cells: Cells, spans: Sequence[tuple[int, int, int]]) -> None:
        """Show cells of a widget without borders.

        Args:
            cells: Of the whole widget.
            spans: (row, first column, column after the last) of those that changed.
        """
        looks = self._terminal.looks
        for row, first, stop in spans:
            for start, end in self._free(row, first, stop):
                line: list[Cell] = [
                    # A blank looks the same in any ink.
                    (text, looks[style if text != " " else style & PAPER])
                    for text, style in cells.row(row, start, end)
                ]
                if cells.is_cut(row, start):
                    line[0] = " ", line[0][1]
                if cells.is_cut(row, end):
                    line[-1] = " ", line[-1][1]
                self._terminal.put(self._region.y + row, self._region.x + start, line)

    def paint(self, widget: Widget) -> bool:
        """Show all of the widget; False if something lies over it."""
        if self._over:
            return False
        # What `Widget.refresh` does before it waits for the compositor.
        widget._layout_cache.clear()
        widget._set_dirty()
        lines = widget.render_lines(self._region.size.region)
        self._terminal.take(
            (row, self._region.x, list(line)) for row, line in enumerate(lines, self._region.y)
        )
        return True

    def _free(self, row: int, first: int, stop: int) -> Iterator[tuple[int, int]]:
        """Return the parts of a span that nothing lies over."""
        x, y = self._region.offset
        for region in sorted(self._over):
            if region.y <= y + row < region.bottom:
                if first < min(stop, region.x - x):
                    yield first, min(stop, region.x - x)
                first = max(first, region.right - x)
        if first < stop:
            yield first, stop


def spot_of(widget: Widget) -> Spot | None:
    """Return where a widget stands; None if it isn't all in sight, or is about to move."""
    app = widget.app
    if not isinstance(app, SparingApp) or not widget.is_attached or widget.screen is not app.screen:
        return None
    if widget.screen._layout_required or (terminal := app.terminal()) is None:
        return None
    over: list[Region] = []
    for other, (region, clip) in widget.screen._compositor.visible_widgets.items():
        if other is widget:
            over = [found for each in over if (found := each.intersection(region))]
            return Spot(terminal, region, over) if clip.contains_region(region) else None
        over.append(region.intersection(clip))
    return None


def repaint(widget: Widget) -> None:
    """Show a widget as it is now, at once if that can be done."""
    spot = spot_of(widget)
    if spot is None or not spot.paint(widget):
        widget.refresh()
