"""Values of the pinned expressions around the current tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.questions import MOST_ROBOTS
from logical_robots_tui.tui.inspector.widgets.plots import Sample

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.game import Frame, Pin, Reading
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["PinHistory", "window"]

_MOST_TICKS = 2000


def window(before: range, width: int, tick: int, last: int) -> range:
    """The ticks to plot; they stay the same while the current tick is among them."""
    stop = max(before.stop, tick + 1)
    if tick < stop - width:
        stop = tick + width // 2
    stop = max(min(stop, last + 1), tick + 1)
    return range(max(0, stop - width), stop)


class PinHistory:
    """Reads pins at ticks and keeps their values until the program or the run is another one."""

    def __init__(self, session: Session, questions: Questions) -> None:
        self._session = session
        self._questions = questions
        self._about: object = None
        self._ticks: dict[int, dict[Pin, Sample]] = {}

    def of(self, pin: Pin, ticks: range) -> list[Sample | None]:
        """The known values of a pin at each tick."""
        return [self._ticks.get(tick, {}).get(pin) for tick in ticks]

    def missing(self, pins: Sequence[Pin], ticks: range) -> tuple[int, list[Pin]] | None:
        """The nearest tick at which pins are still to be read, and which ones."""
        game, here = self._session.game, self._session.frame.tick
        if game is None or len(self._session.level.robots) > MOST_ROBOTS:
            return None
        for tick in sorted(ticks, key=lambda tick: abs(tick - here)):
            known = self._ticks.get(tick, {})
            wanted = [pin for pin in pins if pin not in known]
            if wanted and game.history.first <= tick <= game.history.last:
                return tick, wanted
        return None

    async def read(self, pins: Iterable[Pin], frame: Frame) -> dict[Pin, Reading]:
        """Read pins at a frame.

        Raises:
            Superseded: There is no program yet, or other pins were asked for meanwhile.
        """
        game = self._session.game
        about = None if game is None else (game, game.program, game.history.turns)
        if about != self._about:
            self._about, self._ticks = about, {}
        inquiry, program = self._questions.about()
        readings = await inquiry.readings(program, frame, list(pins))
        if about == self._about:
            known = self._ticks.setdefault(frame.tick, {})
            known.update({pin: _sample(reading) for pin, reading in readings.items()})
            if len(self._ticks) > _MOST_TICKS:
                del self._ticks[next(iter(self._ticks))]
        return readings

    async def read_past(self, pins: Iterable[Pin], tick: int) -> None:
        """Read pins at a tick of the history.

        Raises:
            NoSuchTickError: The history does not hold it.
            Superseded: As `read` does.
        """
        if self._session.game is not None:
            await self.read(pins, self._session.game.frame_at(tick))


def _sample(reading: Reading) -> Sample:
    if reading.problem:
        return Sample(None, None)
    return Sample(reading.number, hash(repr(reading.value)))
