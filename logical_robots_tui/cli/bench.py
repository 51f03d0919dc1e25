"""``logical-robots bench``: how fast the levels run on this machine."""

from __future__ import annotations

import argparse
import asyncio
import json
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import new_command, prefers_json

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.game.speed import Speed
    from logical_robots_tui.world import Level

__all__ = ["declare"]

MOST_SECONDS = 60.0


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "bench",
        start=start,
        wants_json=prefers_json,
        summary="say how fast the levels run on this machine",
        description="Run levels flat out under their reference programs, without a screen, and "
        "say how fast that was.",
    )
    command.add_argument(
        "levels", nargs="*", metavar="LEVEL", help="names of levels; all when none is named"
    )
    command.add_argument(
        "--seconds",
        type=_seconds,
        default=1.0,
        metavar="S",
        help="how long to run each level (default: %(default)g)",
    )
    command.add_argument(
        "--json", action="store_true", help="print JSON even when a terminal is looking"
    )


def start(options: argparse.Namespace) -> int:
    """Run the levels one after another and print how fast they were."""
    from logical_robots_tui.cli.text import columns
    from logical_robots_tui.world import LevelError, list_levels, load_level

    levels = [load_level(name) for name in options.levels or list_levels()]
    for level in levels:
        if options.levels and not level.solution:
            raise LevelError(
                "This level names no reference program to run.",
                place=level.name,
                hint='A key such as solution = "steering" at the top of its file names one.',
            )
    found = [(level, _measured(level, options.seconds)) for level in levels if level.solution]
    if prefers_json(options):
        print(json.dumps([_as_json(level, speed) for level, speed in found], indent=2))
        return 0
    rows = [
        (
            level.name,
            str(len(level.robots)),
            f"{speed.ticks_per_second:,.0f}",
            f"{speed.tick_milliseconds:.2f}",
            f"{speed.think_milliseconds:.2f}",
        )
        for level, speed in found
    ]
    head = ("LEVEL", "ROBOTS", "TICKS/S", "MS/TICK", "OF IT THINKING")
    print(*columns([head, *rows]), sep="\n")
    return 0


def _measured(level: Level, seconds: float) -> Speed:
    from logical_robots_tui.game import load_program
    from logical_robots_tui.game.speed import measure_speed
    from logical_robots_tui.mind import Program

    program = Program.compile(load_program(level.solution).text)
    return asyncio.run(measure_speed(level, program, seconds))


def _as_json(level: Level, speed: Speed) -> dict[str, object]:
    return {
        "level": level.name,
        "robots": len(level.robots),
        "ticks": speed.ticks,
        "seconds": speed.seconds,
        "ticks_per_second": speed.ticks_per_second,
        "think_milliseconds": speed.think_milliseconds,
    }


def _seconds(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0 < number <= MOST_SECONDS:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a number of seconds up to {MOST_SECONDS:g}"
        )
    return number
