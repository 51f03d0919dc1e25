"""``logical-robots query``: answer a query about one tick of a run."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import columns, line_of_json, prefers_json, written
from logical_robots_tui.cli.runs.common import frame_at, new_run_command, opened

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.mind import Program, Table
    from logical_robots_tui.world import Level

__all__ = ["declare"]

FOUND, NOTHING = 0, 1
WIDEST = 60  # characters of a value in a table

EPILOG = """\
examples:
  logical-robots query 06-breadcrumbs breadcrumbs --tick 90 Robot
  logical-robots query 06-breadcrumbs breadcrumbs --tick 110 \\
    'Next(robot_name: "Crow", ray:)'
  logical-robots query 06-breadcrumbs breadcrumbs --tick 90 \\
    'Drive("Crow").left_engine + 1'
  logical-robots query 06-breadcrumbs breadcrumbs --tick 90 \\
    'Sensor(robot_name:, sensor:), ray in sensor.radar, ray.distance < 40'

exit status: 0 rows found, 1 no rows, 2 bad level, program or query
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_run_command(
        commands,
        "query",
        start=start,
        summary="query one tick of a run",
        description="Run a program to a tick, then answer a query in Logica about that tick.",
        epilog=EPILOG,
        first_tick=0,
        robot="only rows in this robot's mind",
    )
    command.add_argument("query", metavar="QUERY", help="a call, an expression, or whole rules")


def start(options: argparse.Namespace) -> int:
    """Print the answer."""
    from logical_robots_tui.cli.failure import ProgramFileError
    from logical_robots_tui.mind import ProgramError

    level, program = opened(options)
    try:
        table = asyncio.run(_ask(level, program, options.query, options.tick))
    except ProgramError as error:
        raise ProgramFileError("query", error) from error
    viewers = table.viewers or ("",) * len(table.rows)
    found = [
        (viewer, row)
        for viewer, row in zip(viewers, table.rows, strict=True)
        if options.robot is None or not viewer or viewer == options.robot
    ]
    if prefers_json(options):
        data = {
            "tick": options.tick,
            "columns": table.columns,
            "rows": [row for _, row in found],
            "minds": [viewer for viewer, _ in found] if table.viewers else None,
            "truncated": table.truncated,
        }
        print(line_of_json(data))
    elif found:
        head = ("IN THE MIND OF", *table.columns) if table.viewers else table.columns
        lines = [
            ((viewer,) if table.viewers else ()) + tuple(written(value, WIDEST) for value in row)
            for viewer, row in found
        ]
        print(*columns([head, *lines]), sep="\n")
    else:
        print("No rows.", file=sys.stderr)
    return FOUND if found else NOTHING


async def _ask(level: Level, program: Program, query: str, tick: int) -> Table:
    from logical_robots_tui.game import Inquiry

    await asyncio.to_thread(program.question, query)  # reports mistakes before the run
    frame = await frame_at(level, program, tick)
    inquiry = Inquiry(level)
    try:
        return await inquiry.ask(program, query, frame)
    finally:
        await inquiry.close()
