"""``logical-robots when``: find the ticks of a run in which a question holds."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import UNRELIABLE, columns, harmless, line_of_json, prefers_json
from logical_robots_tui.cli.runs.common import new_run_command, opened, run_shown

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.game import Matches
    from logical_robots_tui.mind import Program, Question
    from logical_robots_tui.world import Level

__all__ = ["declare"]

FOUND, NEVER = 0, 1
DEFAULT_TICKS = 5000

EPILOG = """\
examples:
  logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 Fresh
  logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 \\
    'Fresh(robot_name: "Crow")'
  logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 --robot Crow \\
    'Sensor(sensor:), sensor.forward_distance < 30'
  logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 \\
    'Drive("Crow").left_engine > 1'

A question is anything that query accepts. It holds in the ticks in which it has
rows; an expression holds where it is not null, false or 0. The run ends at
victory, or after N ticks.

exit status: 0 found, 1 it never holds, 2 bad level, program or question
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_run_command(
        commands,
        "when",
        start=start,
        summary="find the ticks of a run in which something holds",
        description="Ask a question in Logica at every tick of a run, and print where it holds.",
        epilog=EPILOG,
        ticks=(DEFAULT_TICKS, "stop after this many ticks"),
        robot="only rows in this robot's mind",
    )
    command.add_argument(
        "question", metavar="QUESTION", help="a call, an expression, conditions, or whole rules"
    )


def start(options: argparse.Namespace) -> int:
    """Search the run and print the ticks."""
    from logical_robots_tui.cli.failure import ProgramFileError
    from logical_robots_tui.mind import ProgramError, QueryError

    level, program = opened(options)
    try:
        question = program.question(options.question)
    except ProgramError as error:
        raise ProgramFileError("question", error) from error
    found = asyncio.run(_search(level, program, question, options))
    if found.failed_in == found.ticks:
        raise QueryError(f"It failed in every tick: {found.reason}")
    if prefers_json(options):
        print(line_of_json(_data(options.question, found)))
    else:
        print(*_lines(options.question, found), sep="\n")
    return FOUND if found.stretches else NEVER


async def _search(
    level: Level, program: Program, question: Question, options: argparse.Namespace
) -> Matches:
    """Ask at every tick up to victory or the tick limit."""
    from logical_robots_tui.game import find_matches

    async with run_shown(level, program, options.ticks) as (run, show):
        return await find_matches(run, question, options.ticks, options.robot or "", show)


def _lines(question: str, found: Matches) -> list[str]:
    """Format the matches as text."""
    ticks = f"{found.ticks} {'tick' if found.ticks == 1 else 'ticks'}"
    end = f"{ticks}, up to victory" if found.won_at is not None else ticks
    lines = []
    if stretches := found.stretches:
        first, last = stretches[0][0], stretches[-1][1]
        lines += [
            f"{harmless(question)}",
            f"holds in {found.holds_in} of {end}: first in tick {first}, last in tick {last}.",
            "",
            *columns([("FROM", "TO", "TICKS"), *(_row(*each) for each in stretches)]),
        ]
    else:
        lines.append(f"{harmless(question)} never holds in {end}.")
    if found.failed:
        (first, last), *more = found.failed
        where = f"tick {first}" if first == last else f"ticks {first} to {last}"
        others = f" and in {found.failed_in - (last - first + 1)} more" if more else ""
        lines += ["", f"It failed in {where}{others}: {harmless(found.reason)}"]
    if not found.is_reliable:
        lines += ["", UNRELIABLE]
    return lines


def _row(first: int, last: int) -> tuple[str, str, str]:
    return str(first), str(last), str(last - first + 1)


def _data(question: str, found: Matches) -> dict[str, Any]:
    """Return the matches as data for scripts."""
    stretches = found.stretches
    return {
        "question": question,
        "ticks": found.ticks,
        "won_at": found.won_at,
        "first": stretches[0][0] if stretches else None,
        "last": stretches[-1][1] if stretches else None,
        "holds_in": found.holds_in,
        "stretches": stretches,
        "failed_in": found.failed,
        "failure": found.reason or None,
        "reliable": found.is_reliable,
    }
