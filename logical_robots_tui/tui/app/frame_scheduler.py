"""Scheduling of pictures, on a computer whose cores may be busy."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.tui.terminal.textual_internals import handle_exception

if TYPE_CHECKING:
    from textual.widget import Widget

    from logical_robots_tui.game import Pace


_USUAL = 0.3  # seconds waited per second of computing on an idle machine
_LEAVE = 0.02  # seconds between pictures, for each second waited per second of computing
_MUCH = 2.7  # seconds waited per second of computing from which keys begin to suffer
_FIRST_PAUSE = 0.02  # seconds, after the first picture that waited longer
_LENGTHEN, _SHORTEN = 1.15, 0.87  # factors of the pause, after a picture that waited longer, or not
_LONGEST = 1.0  # seconds between pictures
_MOST = 10.0  # seconds waited per second of computing; more makes no difference
_SMOOTH = 0.1  # the weight of the last picture
_HURRY = 0.1  # seconds after a key press


class FrameRate:
    """Draws less often on a busy computer, so that keys are answered promptly.

    Where computing takes three times as long as alone, about 15 pictures a second. Where it takes
    longer still, the pause between pictures grows until it doesn't, because other games pause in
    the same way, or until it is a second. All times are in seconds. If `clock` can't tell how long
    the thread waited, time not spent computing was spent waiting.
    """

    def __init__(self, clock: Clock = CLOCK) -> None:
        self.frames = 30
        self._clock = clock
        self._last = clock.processor_times()
        self._strain = 0.0  # seconds waited per second of computing
        self._pause = 0.0  # seconds
        self._drawn_at = self._hurried_at = float("-inf")

    @property
    def spacing(self) -> float:
        """Seconds to pause between two frames in addition to the usual pause."""
        return min(_LEAVE * max(self._strain - _USUAL, 0.0) + self._pause, _LONGEST)

    @property
    def idle_seconds(self) -> float:
        """Seconds since the last frame."""
        return self._clock.now() - self._drawn_at

    @property
    def wait(self) -> float:
        """Seconds until the next frame may be drawn; not above 0 if it may be drawn now."""
        return 1 / self.frames + (0.0 if self.is_hurried else self.spacing) - self.idle_seconds

    @property
    def is_hurried(self) -> bool:
        return self.calm < _HURRY

    @property
    def calm(self) -> float:
        """Seconds since the last key or click."""
        return self._clock.now() - self._hurried_at

    def hurry(self) -> None:
        self._hurried_at = self._clock.now()

    @contextmanager
    def drawing(self) -> Iterator[None]:
        self._drawn_at, start = self._clock.now(), self._clock.computed()
        yield
        computed = self._clock.computed() - start
        waited = self.idle_seconds - computed
        if self._last and (times := self._clock.processor_times()):
            computed, waited = times[0] - self._last[0], times[1] - self._last[1]
            self._last = times
        if computed > 0:
            strain = min(max(waited / computed, 0.0), _MOST)
            self._strain += _SMOOTH * (strain - self._strain)
            if strain > _MUCH:
                self._pause = min(max(_LENGTHEN * self._pause, _FIRST_PAUSE), _LONGEST)
            else:
                self._pause *= _SHORTEN


class FrameScheduler:
    """Draws soon after a change, at most as `FrameRate` allows; sends exceptions to `widget`."""

    def __init__(self, widget: Widget, draw: Callable[[], None], clock: Clock = CLOCK) -> None:
        self.rate = FrameRate(clock)
        self._widget = widget
        self._draw = draw
        self.pace: Pace | None = None
        self._due: asyncio.TimerHandle | None = None

    def soon(self) -> None:
        if self._due is None and self._widget.is_mounted:
            # Textual's timers are tasks, and start too slowly.
            loop = asyncio.get_running_loop()
            self._due = loop.call_later(max(self.rate.wait, 0.0), self._now)

    def hasten(self) -> None:
        """Draw pending changes without a pause, because the player pressed a key."""
        self.rate.hurry()
        if self._due is not None:
            self._due.cancel()
            self._due = None
            self.soon()

    def _now(self) -> None:
        self._due = None
        if not self._widget.is_running:
            return
        try:
            with self.rate.drawing():
                self._draw()
            if self.pace is not None:
                self.pace.spacing = self.rate.spacing
        except Exception as error:  # like Textual's timers
            handle_exception(self._widget.app, error)
