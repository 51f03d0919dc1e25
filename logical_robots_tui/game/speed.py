"""How fast a level runs under a program on this machine."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

from logical_robots_tui.game.game import Game

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["Speed", "measure_speed"]


@dataclass(frozen=True, slots=True)
class Speed:
    """What was measured: world, mind and history together, without a screen.

    Attributes:
        ticks: How many ticks were computed.
        seconds: How long that took.
        think_seconds: How much of it was thinking.
    """

    ticks: int
    seconds: float
    think_seconds: float

    @property
    def ticks_per_second(self) -> float:
        """Ticks in one second."""
        return self.ticks / self.seconds

    @property
    def tick_milliseconds(self) -> float:
        """What one tick takes."""
        return 1000 * self.seconds / self.ticks

    @property
    def think_milliseconds(self) -> float:
        """What thinking takes of that."""
        return 1000 * self.think_seconds / self.ticks


async def measure_speed(level: Level, program: Program, seconds: float) -> Speed:
    """Run a level flat out for a while; when it is won, it begins again.

    Args:
        level: Where.
        program: What the robots think.
        seconds: How long, after a first tick that counts for nothing.
    """
    game = Game(level, program)
    ticks, think_milliseconds = 0, 0.0

    def count(frame: Frame) -> None:
        nonlocal ticks, think_milliseconds
        if frame.tick:
            ticks += 1
            think_milliseconds += frame.think_milliseconds

    try:
        await game.step()
        game.listen(count)
        began = perf_counter()
        until = began + seconds
        while perf_counter() < until:
            await game.run_until(condition=lambda _: perf_counter() >= until)
            if game.won_at is not None:
                game.restart()
                game.forget_future()
        return Speed(ticks, perf_counter() - began, think_milliseconds / 1000)
    finally:
        await game.close()
