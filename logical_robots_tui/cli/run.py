"""``logical-robots run``: a level under a program, without a screen."""

from __future__ import annotations

import asyncio
import sys
from contextlib import nullcontext
from time import perf_counter
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import (
    add_json,
    add_level_and_program,
    new_command,
    number_from,
    opened,
    prefers_json,
)

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.cli.outcome import Outcome
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["declare", "play_out"]

WON, NOT_WON = 0, 1
DEFAULT_TICKS = 5000

EPILOG = """\
examples:
  logical-robots run 01-first-steps first-steps            say how it went
  logical-robots run 01-first-steps first-steps --json     say it as JSON
  logical-robots run 01-first-steps first-steps | jq .won  piped, it is JSON
  logical-robots run my-level.toml my-program.l --ticks 900

exit status: 0 won, 1 not won within the ticks, 2 bad level or program
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "run",
        start=start,
        wants_json=prefers_json,
        summary="run a program in a level without a screen",
        description="Run a program in a level without a screen, as fast as the machine can.",
        epilog=EPILOG,
    )
    add_level_and_program(command)
    command.add_argument(
        "--ticks",
        type=number_from(1),
        default=DEFAULT_TICKS,
        metavar="N",
        help="give up after this many ticks (default: %(default)s)",
    )
    add_json(command)
    command.add_argument("--times", action="store_true", help="tell in JSON, too, how long it took")


def start(options: argparse.Namespace) -> int:
    """Run the program in the level and say how it went."""
    level, program = opened(options)
    with _progress(level.title, options.ticks) as show:
        outcome = asyncio.run(play_out(level, program, options.program, options.ticks, show))
    print(outcome.as_json(times=options.times) if prefers_json(options) else outcome.in_words())
    return WON if outcome.won_at is not None else NOT_WON


async def play_out(
    level: Level,
    program: Program,
    program_name: str,
    ticks: int,
    show: Callable[[int], object] = lambda _tick: None,
) -> Outcome:
    """Run until the level is won or the ticks are over.

    Args:
        level: Where it happens.
        program: What the robots think.
        program_name: What to call it in the outcome.
        ticks: How many ticks to try.
        show: Told each finished tick.
    """
    from logical_robots_tui.cli.outcome import Outcome, Tally
    from logical_robots_tui.game import Game

    game = Game(level, program, history=1)
    tally = Tally()

    def look(frame: Frame) -> None:
        tally.count(frame)
        show(frame.tick)

    game.listen(look)
    began = perf_counter()
    try:
        frame = await game.run_until(tick=ticks)
    finally:
        await game.close()
    return Outcome(level, program_name, frame, tally, perf_counter() - began)


def _progress(title: str, ticks: int) -> AbstractContextManager[Callable[[int], object]]:
    if sys.stderr.isatty():
        from logical_robots_tui.cli.progress import progress_bar

        return progress_bar(title, ticks)
    return nullcontext(lambda _tick: None)
