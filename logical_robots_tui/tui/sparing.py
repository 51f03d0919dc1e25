"""An app that sends only those cells that differ from what its terminal shows.

Textual paints a region again as a whole, with the full style of every segment: eight times as much
as needed here. There is no public hook for this, so ``App._display`` is overridden; Textual is
pinned, and a test compares what a terminal shows with a full rendering of the same lines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.color import ColorSystem
from textual import events
from textual._compositor import ChopsUpdate, CompositorUpdate, LayoutUpdate

from logical_robots_tui.tui.crash import CarefulApp
from logical_robots_tui.tui.difference import Difference

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import RenderableType
    from rich.segment import Segment
    from textual.screen import Screen

__all__ = ["SparingApp"]

_SYSTEMS = {
    "truecolor": ColorSystem.TRUECOLOR,
    "256": ColorSystem.EIGHT_BIT,
    "standard": ColorSystem.STANDARD,
}


class SparingApp(CarefulApp):
    """Sends what changed, and nothing if nothing did."""

    _shown: Difference | None = None
    _cursor_shown: tuple[int, int] | None = None

    def forget_terminal(self) -> None:
        """Send everything again the next time: the terminal may show something else."""
        self._shown = None

    async def on_event(self, event: events.Event) -> None:
        """Handle an event; a terminal that was resized or came back shows anything."""
        if isinstance(event, events.Resize):
            self.forget_terminal()
        await super().on_event(event)

    def _resume_signal(self) -> None:
        self.forget_terminal()
        super()._resume_signal()

    def _display(self, screen: Screen[Any], renderable: RenderableType | None) -> None:
        driver = self._driver
        if (
            not isinstance(renderable, LayoutUpdate | ChopsUpdate)
            or self._batch_count
            or not self._running
            or self._closed
            or driver is None
            or driver.is_inline
            or self.is_headless
        ):
            if isinstance(renderable, CompositorUpdate):
                self.forget_terminal()
            super()._display(screen, renderable)
            return
        columns, rows = self.size
        if self._shown is None or (self._shown.columns, self._shown.rows) != (columns, rows):
            colours = _SYSTEMS.get(self.console.color_system or "")
            self._shown = Difference(columns, rows, colours)
            self._cursor_shown = None
        sent = self._shown.sequence(_pieces(renderable))
        cursor = self.screen.outer_size.clamp_offset(self.cursor_position)
        if sent or cursor != self._cursor_shown:
            self._cursor_shown = cursor
            self._begin_update()
            driver.write(f"{sent}\x1b[{cursor[1] + 1};{cursor[0] + 1}H")
            self._end_update()
            driver.flush()
        self.post_display_hook()


def _pieces(
    update: LayoutUpdate | ChopsUpdate,
) -> Iterator[tuple[int, int, Sequence[Segment]]]:
    """Return the (row, first column, segments) that an update of Textual's paints."""
    if isinstance(update, LayoutUpdate):
        for y, strips in enumerate(update.strips, update.region.y):
            yield y, update.region.x, [segment for strip in strips for segment in strip]
        return
    for y, first, stop in update.spans:
        for end, (x, strip) in zip(update.chop_ends[y], update.chops[y].items(), strict=False):
            # Parts of a line that reach out of the span are up to date as a whole.
            if strip is not None and x < stop and end > first:
                yield y, x, list(strip)
