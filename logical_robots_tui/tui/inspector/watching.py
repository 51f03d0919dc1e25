"""Keeping the page that watches up to date: the tick at hand first, then those around it."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from time import perf_counter
from typing import TYPE_CHECKING

from logical_robots_tui.game import NoSuchTickError, Superseded
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.inspector.widgets.samples import Samples
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.view import LabyrinthView

if TYPE_CHECKING:
    from collections.abc import Mapping

    from textual.worker import Worker

    from logical_robots_tui.game import Frame, Pin, Reading
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["Watching"]

_PAUSE = 0.03  # seconds between two past ticks while the robots run, which comes first
_PICTURE = 0.1  # seconds between two pictures while past ticks are read


class Watching:
    """Reads the pins.

    Args:
        session: Whose ticks.
        questions: Whom to ask.
    """

    def __init__(self, session: Session, questions: Questions) -> None:
        self._session = session
        self._samples = Samples(session, questions)
        self.view = WatchView(self._samples)
        self._shown: tuple[int, Mapping[Pin, Reading]] = 0, {}
        self._is_reading = False
        self._filler: Worker[None] | None = None

    async def follow(self, frame: Frame) -> None:
        """Show a tick, and begin to read those around it."""
        self._is_reading = True
        try:
            self._shown = frame.tick, await self._samples.read(self.view.pins, frame)
        except Superseded:
            self._shown = frame.tick, {}
        finally:
            self._is_reading = False
        self._show()
        if self._filler is None or self._filler.is_finished:
            self._filler = in_background(self.view, self._fill, "watch")

    async def _fill(self) -> None:
        """Read the past ticks of the lines one after the other, as long as they are looked at."""
        shown_at = perf_counter()
        while self.view.display and (lacking := self._lacking()):
            tick, pins = lacking
            if not self._is_reading:
                with suppress(Superseded, NoSuchTickError):
                    await self._samples.read_past(pins, tick)
            if perf_counter() > shown_at + _PICTURE:
                shown_at = perf_counter()
                self._show()
            await asyncio.sleep(_PAUSE if self._session.running or self._is_reading else 0)
        self._show()

    def _lacking(self) -> tuple[int, list[Pin]] | None:
        return self._samples.lacking(self.view.pins, self.view.ticks)

    def _show(self) -> None:
        views = self.view.screen.query(LabyrinthView)
        is_plain = any(view.drawing is Drawing.ASCII for view in views)
        self.view.show(*self._shown, plain=is_plain)
