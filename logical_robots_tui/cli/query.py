"""``logical-robots query`` and ``when``: questions about one tick of a run, or about all."""

from __future__ import annotations

import argparse
import asyncio
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import (
    UNRELIABLE,
    Commands,
    columns,
    cut,
    harmless,
    line_of_json,
    prefers_json,
)
from logical_robots_tui.cli.failure import ProgramFileError
from logical_robots_tui.cli.runs.common import frame_at, new_run_command, open_run, run_shown, show
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.game import Matches
    from logical_robots_tui.mind import Program, Question, Table
    from logical_robots_tui.world import Level

FOUND, NOTHING = 0, 1
DEFAULT_TICKS = 5000
WIDEST = 60  # characters of a value in a table


def declare(commands: Commands) -> None:
    query = new_run_command(
        commands, "query", _query, first_tick=0, robot="only rows in this robot's mind"
    )
    query.add_argument("query", metavar="QUERY", help="a call, an expression, or whole rules")
    when = new_run_command(
        commands,
        "when",
        _when,
        ticks=(DEFAULT_TICKS, "stop after this many ticks"),
        robot="only rows in this robot's mind",
    )
    when.add_argument(
        "question", metavar="QUESTION", help="a call, an expression, conditions, or whole rules"
    )


@contextmanager
def _mistakes_in(what: str) -> Iterator[None]:
    from logical_robots_tui.mind import ProgramError

    try:
        yield
    except ProgramError as error:
        raise ProgramFileError(what, error) from error


def _query(options: argparse.Namespace) -> int:
    """query one tick of a run

    Run a program to a tick, then answer a query in Logica about that tick.

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
    level, program = open_run(options)
    with _mistakes_in("query"):
        table = asyncio.run(_ask(level, program, options.query, options.tick))
    has_minds = bool(table.viewers)
    table = table.in_mind_of(options.robot)
    if prefers_json(options):
        data = {
            "tick": options.tick,
            "columns": table.columns,
            "rows": table.rows,
            "minds": table.viewers if has_minds else None,
            "truncated": table.truncated,
        }
        print(line_of_json(data))
    elif table.rows:
        print(*table_lines(table), sep="\n")
    else:
        print("No rows.", file=sys.stderr)
    return FOUND if table.rows else NOTHING


def table_lines(table: Table) -> list[str]:
    rows = [tuple(cut(spell(value), WIDEST) for value in row) for row in table.rows]
    head = table.columns
    if table.viewers:
        head = ("IN THE MIND OF", *head)
        rows = [(viewer, *row) for viewer, row in zip(table.viewers, rows, strict=True)]
    return columns([head, *rows])


async def _ask(level: Level, program: Program, query: str, tick: int) -> Table:
    from logical_robots_tui.game import Inquiry

    await asyncio.to_thread(program.question, query)  # reports mistakes before the run
    frame = await frame_at(level, program, tick)
    inquiry = Inquiry(level)
    try:
        return await inquiry.ask(program, query, frame)
    finally:
        await inquiry.close()


def _when(options: argparse.Namespace) -> int:
    """find the ticks of a run in which something holds

    Ask a question in Logica at every tick of a run, and print where it holds.

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
    from logical_robots_tui.mind import QueryError

    level, program = open_run(options)
    with _mistakes_in("question"):
        question = program.question(options.question)
    found = asyncio.run(_search(level, program, question, options))
    if found.failed_in == found.ticks:
        raise QueryError(f"It failed in every tick: {found.reason}")
    show(options, _data(options.question, found), _lines(options.question, found))
    return FOUND if found.stretches else NOTHING


async def _search(
    level: Level, program: Program, question: Question, options: argparse.Namespace
) -> Matches:
    from logical_robots_tui.game import find_matches

    async with run_shown(level, program, options.ticks) as (run, show):
        return await find_matches(run, question, options.ticks, options.robot or "", show)


def _lines(question: str, found: Matches) -> list[str]:
    extent = f"{found.ticks} tick{'' if found.ticks == 1 else 's'}"
    extent += ", up to victory" if found.won_at is not None else ""
    lines = []
    if stretches := found.stretches:
        first, last = stretches[0][0], stretches[-1][1]
        rows = [(str(start), str(end), str(end - start + 1)) for start, end in stretches]
        lines += [
            f"{harmless(question)}",
            f"holds in {found.holds_in} of {extent}: first in tick {first}, last in tick {last}.",
            "",
            *columns([("FROM", "TO", "TICKS"), *rows]),
        ]
    else:
        lines.append(f"{harmless(question)} never holds in {extent}.")
    if found.failed:
        (first, last), *more = found.failed
        where = f"tick {first}" if first == last else f"ticks {first} to {last}"
        others = f" and in {found.failed_in - (last - first + 1)} more" if more else ""
        lines += ["", f"It failed in {where}{others}: {harmless(found.reason)}"]
    if not found.is_reliable:
        lines += ["", UNRELIABLE]
    return lines


def _data(question: str, found: Matches) -> dict[str, Any]:
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
