"""What could be read off the pins in the ticks around the one on the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.questions import MOST_ROBOTS
from logical_robots_tui.tui.inspector.widgets.sparkline import Sample

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.game import Frame, Pin, Reading
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["Samples"]

_MOST_TICKS = 2000


class Samples:
    """Reads pins at ticks and keeps what lines need, as long as it is about the same program.

    Args:
        session: Whose ticks.
        questions: Whom to ask.
    """

    def __init__(self, session: Session, questions: Questions) -> None:
        self._session = session
        self._questions = questions
        self._about: object = None
        self._ticks: dict[int, dict[Pin, Sample]] = {}
        self._window = range(0)

    def window(self, width: int) -> range:
        """The ticks that lines show: they stay the same as long as the present one is in them.

        Args:
            width: How many there may be.
        """
        game, tick = self._session.game, self._session.frame.tick
        last = tick if game is None else game.history.last
        stop = max(self._window.stop, tick + 1)
        if tick < stop - width:
            stop = tick + width // 2
        stop = max(min(stop, last + 1), tick + 1)
        self._window = range(max(0, stop - width), stop)
        return self._window

    def of(self, pin: Pin, ticks: range) -> list[Sample | None]:
        """What is known of a pin at each tick."""
        return [self._ticks.get(tick, {}).get(pin) for tick in ticks]

    def lacking(self, pins: Sequence[Pin], ticks: range) -> tuple[int, list[Pin]] | None:
        """The tick nearest to the present one at which something is not known yet, and what."""
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
        self._forget_if_other()
        about = self._about
        readings = await self._questions.readings(frame, list(pins))
        if about == self._about:
            self._ticks.setdefault(frame.tick, {}).update(
                {pin: _sample(reading) for pin, reading in readings.items()}
            )
            if len(self._ticks) > _MOST_TICKS:
                del self._ticks[next(iter(self._ticks))]
        return readings

    async def read_past(self, pins: Iterable[Pin], tick: int) -> None:
        """Read pins at a tick of history.

        Raises:
            NoSuchTickError: History does not hold it.
            Superseded: As `read` does.
        """
        if self._session.game is not None:
            await self.read(pins, self._session.game.frame_at(tick))

    def _forget_if_other(self) -> None:
        """Forget what was read of another program, or of ticks that went otherwise."""
        game = self._session.game
        about = None if game is None else (game, game.program, game.history.turns)
        if about != self._about:
            self._about, self._ticks = about, {}


def _sample(reading: Reading) -> Sample:
    if reading.problem:
        return Sample(None, None)
    return Sample(reading.number, hash(repr(reading.value)))
