"""A run of a program, filmed without a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.segment import Segment
from rich.style import Style

from logical_robots_tui.game import Game, goals
from logical_robots_tui.tui.camera import Camera
from logical_robots_tui.tui.cast import Cast
from logical_robots_tui.tui.drawing.look import Look
from logical_robots_tui.tui.drawing.picture import Picture
from logical_robots_tui.tui.drawing.traces import Traces
from logical_robots_tui.tui.plain import clip, one_line
from logical_robots_tui.tui.theme import hex_colour

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["film"]

_PICTURES = 20  # a second, at most
_LAST = 3.0  # seconds for which the last picture stays


async def film(
    level: Level,
    program: Program,
    write: Callable[[str], object],
    *,
    size: tuple[int, int],
    ticks: int,
    speed: float,
    look: Look | None = None,
) -> Frame:
    """Run until the level is won or the ticks are over, and film it as an asciicast.

    Args:
        level: Where it happens.
        program: What the robots think.
        write: Takes each line of the asciicast, with its end.
        size: Columns and rows; the last row tells the tick and who is in a goal.
        ticks: How many ticks to film at most.
        speed: Ticks a second.
        look: How to draw.

    Returns:
        The last frame.
    """
    cast = Cast(write, *size, one_line(level.title))
    studio = _Studio(level, size, look or Look())
    game = Game(level, program, history=1)
    every = max(1, round(speed / _PICTURES))

    def shoot(frame: Frame) -> None:
        if frame.tick % every == 0 or frame.after.won_at == frame.tick or frame.tick == ticks:
            cast.show(frame.tick / speed, studio.lines(frame))

    shoot(game.frame)
    game.listen(shoot)
    try:
        frame = await game.run_until(tick=ticks)
    finally:
        await game.close()
    cast.wait(frame.tick / speed + _LAST)
    return frame


class _Studio:
    """Draws frames into lines."""

    def __init__(self, level: Level, size: tuple[int, int], look: Look) -> None:
        self._level, self._look = level, look
        self._columns = size[0]
        self._viewport = Camera().viewport(level, size[0], size[1] - 1)
        self._picture, self._traces = Picture(), Traces()

    def lines(self, frame: Frame) -> list[list[Segment]]:
        """The picture, and below it a line of words."""
        self._traces.record(frame)
        cells = self._picture.draw(self._level, frame, self._viewport, self._look, self._traces)
        rows = [list(cells.strip(row)) for row in range(self._viewport.rows)]
        return [*rows, [self._words(frame)]]

    def _words(self, frame: Frame) -> Segment:
        inside = [
            f"{one_line(goal.area_name) or 'goal'} {len(goal.inside)}/{len(goal.wanted)}"
            for goal in goals(self._level, frame.after)
        ]
        won = ["★ won"] if frame.after.won_at is not None else []
        parts = [one_line(self._level.title), f"tick {frame.tick}", *inside, *won]
        text = clip(f" {'   '.join(parts)}", self._columns)
        palette = self._look.palette
        style = Style(color=hex_colour(palette.bright), bgcolor=hex_colour(palette.rock))
        return Segment(f"{text:<{self._columns}}", style)
