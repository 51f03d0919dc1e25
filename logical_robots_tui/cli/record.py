"""``logical-robots record``: film a run, without a screen."""

from __future__ import annotations

import argparse
import asyncio
import re
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import (
    add_level_and_program,
    new_command,
    number_from,
    opened,
)
from logical_robots_tui.cli.text import harmless
from logical_robots_tui.errors import InputError
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

LEAST, MOST = (20, 6), (500, 200)

EPILOG = """\
examples:
  logical-robots record 01-first-steps first-steps -o run.cast
  logical-robots record 01-first-steps first-steps -o run.cast --ticks 300 --size 120x40 --speed 80
  asciinema play run.cast

exit status: 0 recorded, won or not; 2 bad level or program, or the file can't be written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "record",
        start=start,
        summary="record a run as an asciicast",
        description="Record a run of a program in a level as an asciicast, without a screen.",
        epilog=EPILOG,
    )
    add_level_and_program(command)
    command.add_argument(
        "-o", "--output", type=Path, metavar="FILE", required=True, help="the file to write"
    )
    command.add_argument(
        "--ticks",
        type=number_from(1),
        default=2000,
        metavar="N",
        help="end after this many ticks, or with victory (default: %(default)s)",
    )
    command.add_argument(
        "--size",
        type=_size,
        default=(80, 24),
        metavar="WxH",
        help="columns and rows (default: 80x24)",
    )
    command.add_argument(
        "--speed",
        type=number_from(1),
        default=40,
        metavar="N",
        help="ticks a second (default: %(default)s)",
    )


def start(options: argparse.Namespace) -> int:
    """Record the run and say what became of it."""
    level, program = opened(options)
    from logical_robots_tui.tui.film import film

    lines: list[str] = []
    frame = asyncio.run(
        film(
            level,
            program,
            lines.append,
            size=options.size,
            ticks=options.ticks,
            speed=options.speed,
        )
    )
    try:
        write_atomically(options.output, "".join(lines))
    except OSError as error:
        raise InputError(f"{error.strerror}.", place=str(options.output)) from error
    seconds = frame.tick / options.speed
    won = ", won" if frame.after.won_at is not None else ""
    print(f"{harmless(str(options.output))}: {frame.tick} ticks in {seconds:.0f} s{won}.")
    return 0


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text)
    size = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (LEAST[0] <= size[0] <= MOST[0] and LEAST[1] <= size[1] <= MOST[1]):
        least, most = (f"{columns}x{rows}" for columns, rows in (LEAST, MOST))
        raise argparse.ArgumentTypeError(f"{text!r} is not a size from {least} to {most}")
    return size
