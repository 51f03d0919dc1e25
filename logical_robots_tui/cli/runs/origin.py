"""``logical-robots origin``: the tick and the rule that made a value in a memory."""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import Commands, cut, harmless
from logical_robots_tui.cli.runs.common import new_run_command, open_run, run_shown, show
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.sourcing import Path, Read
    from logical_robots_tui.game.debugging.origin import Link, Origin
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

_LONGEST = 60  # characters of a value
_SHOWN_READS = 5


def declare(commands: Commands) -> None:
    command = new_run_command(
        commands, "origin", start, first_tick=1, robot="whose memory", needs_robot=True
    )
    command.add_argument(
        "--value",
        type=_path,
        default=(),
        metavar="PART",
        help="a part of it, such as memory.plan.at or memory.seen[0] (default: all of it)",
    )


def start(options: argparse.Namespace) -> int:
    """trace a value in a memory to the rule that made it

    Run a program to a tick, then trace a value back to where it was made.

    examples:
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value memory.visited
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value 'memory.visited[0]'

    The value is the one that the robot remembers after the tick. It is traced back
    through the ticks that only kept it, and through the memories of other robots,
    to the tick and the rule that made it, and from there to what it was made from.

    exit status: 0 found, 2 bad level, program, robot or value
    """
    level, program = open_run(options)
    origin = asyncio.run(_search(level, program, options))
    data = {"complete": origin.complete, "links": [*map(_data, origin.links)]}
    show(options, data, _lines(origin))
    return 0


async def _search(level: Level, program: Program, options: argparse.Namespace) -> Origin:
    from logical_robots_tui.game import origin_in_run

    async with run_shown(level, program, options.tick) as (run, show):
        await run.frame(options.tick, show)
        return await origin_in_run(run, options.robot, options.value, options.tick, show)


def _lines(origin: Origin) -> Iterator[str]:
    for number, link in enumerate(origin.links):
        if number:
            yield ""
        yield from _link(number, link)
    if not origin.complete:
        yield from ("", "This is not complete: some of the values that were read are not traced.")


def _link(number: int, link: Link) -> Iterator[str]:
    from logical_robots_tui.game.debugging.pins import path_text

    name = f"{link.robot}'s {path_text(link.path)}"
    yield harmless(f"{number + 1}. {name} = {cut(spell(link.value), _LONGEST)}")
    if link.tick == 0:
        yield f"   there from the start until tick {link.until}"
        return
    kept = f", kept until tick {link.until}" if link.until > link.tick else ""
    line = f" in line {link.rule.line}" if link.rule is not None else ""
    yield f"   set in tick {link.tick} by the rule{line}{kept}"
    if link.span is not None:
        yield harmless(f"   line {link.span.line}: {cut(link.span.text, _LONGEST)}")
    for read in link.reads[:_SHOWN_READS]:
        yield harmless(f"   from {_read(read)}")
    if more := len(link.reads) - _SHOWN_READS:
        yield from [f"   and from {more} more"] * (more > 0)
    if link.before:
        yield f"   continued in {', '.join(f'{each + 1}.' for each in link.before)}"


def _read(read: Read) -> str:
    from logical_robots_tui.game.debugging.pins import path_text

    return f"{read.robot}'s {path_text(read.path, read.what)} = {cut(spell(read.value), _LONGEST)}"


def _data(link: Link) -> dict[str, Any]:
    from logical_robots_tui.game.debugging.pins import path_text

    return {
        "robot": link.robot,
        "value": link.value,
        "part": path_text(link.path),
        "tick": link.tick,
        "until": link.until,
        "rule_line": link.rule.line if link.rule else None,
        "line": link.span.line if link.span else None,
        "text": link.span.text if link.span else None,
        "reads": [
            {"robot": read.robot, "part": path_text(read.path, read.what), "value": read.value}
            for read in link.reads
        ],
        "before": link.before,
    }


def _path(text: str) -> Path:
    from logical_robots_tui.game.debugging.origin import read_path

    try:
        return read_path(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
