"""``logical-robots origin``: the ticks, rules and readings that a value comes from."""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import Commands, cut, harmless
from logical_robots_tui.cli.runs.common import new_run_command, open_run, run_shown, show
from logical_robots_tui.cli.runs.why import add_row, read_row
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask
    from logical_robots_tui.explain.why.explanation import Path, Source
    from logical_robots_tui.game.debugging.origin import Link, Origin
    from logical_robots_tui.mind import Program
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level

_LONGEST = 60  # characters of a value
_WIDEST = 100  # columns


def declare(commands: Commands) -> None:
    command = new_run_command(
        commands, "origin", start, first_tick=1, robot="in whose mind", needs_robot=True
    )
    add_row(command)
    command.add_argument(
        "--value",
        type=_part,
        metavar="PART",
        help="a column or a part of it, such as memory.plan.at, memory.seen[0] or "
        "desire.left_engine (default: the memory, or the only column)",
    )


def start(options: argparse.Namespace) -> int:
    """trace a value back to the rules and readings that it comes from

    Run a program to a tick, then trace a value back to where it was made.

    examples:
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value memory.visited
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value 'memory.visited[0]'
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value desire.left_engine
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 380 --robot Crow \\
        --predicate Next --value ray.distance

    A value in a memory, as it is after the tick, comes from the tick of its last
    change; any other value of a predicate is made in the tick itself. The chain
    goes on with what it was made from, through rules, earlier ticks and the
    memories of other robots, to rays, sensor fields, facts or the start. What only
    passes a value on is left out.

    exit status: 0 found, 2 bad level, program, robot or value
    """
    level, program = open_run(options)
    asked = read_row(program, options.predicate, dict(options.given), options.within)
    origin = asyncio.run(_search(level, program, asked, options))
    data = {"complete": origin.complete, "links": [*map(_data, origin.links)]}
    show(options, data, origin_lines(origin))
    return 0


async def _search(
    level: Level, program: Program, asked: Ask, options: argparse.Namespace
) -> Origin:
    from logical_robots_tui.explain.why.explanation import Subject
    from logical_robots_tui.game import origin_in_run

    default = "memory" if asked.predicate == "Robot" else ""
    column, path = options.value or (default, ())
    async with run_shown(level, program, options.tick) as (run, show):
        subject = Subject(asked, column, path)
        return await origin_in_run(run, options.robot, subject, options.tick, show)


def origin_lines(origin: Origin) -> Iterator[str]:
    from logical_robots_tui.game.debugging.origin import INCOMPLETE, link_lines

    for number, link in enumerate(origin.links):
        if number:
            yield ""
        yield harmless(f"{number + 1}. {link.name} = {_written(link.value)}")
        yield from (cut(harmless(f"   {line}"), _WIDEST) for line in link_lines(link, _written))
    if not origin.complete:
        yield from ("", INCOMPLETE)


def _written(value: Value) -> str:
    return cut(spell(value, _LONGEST, is_rounded=True), _LONGEST)


def _data(link: Link) -> dict[str, Any]:
    source = link.source
    span = source.span if source else None
    return {
        "robot": link.robot,
        "name": link.name,
        "part": _part_text(link),
        "value": link.value,
        "tick": link.tick,
        "until": link.until,
        "rule_line": source.rule.line if source and source.rule else None,
        "line": span.line if span else None,
        "text": span.text if span else None,
        "conditions": [
            {"line": each.span.line, "text": each.span.text, "holds": each.holds}
            for each in (source.conditions if source else ())
        ],
        "steps": _steps(link),
        "from": [*map(_input, link.inputs, link.before)],
        "more": source.more if source else 0,
        "problem": link.problem or None,
    }


def _steps(link: Link) -> dict[str, Any] | None:
    steps = link.steps
    if steps is None:
        return None
    times = {"by": steps.by, "since": steps.since, "times": steps.times}
    return {**times, "from": steps.begin, "link": link.began}


def _part_text(link: Link) -> str | None:
    from logical_robots_tui.game.debugging.inquiry import path_text

    return path_text(link.path) if link.path is not None else None


def _input(source: Source, link: int | None) -> dict[str, Any]:
    from logical_robots_tui.game.debugging.inquiry import path_text

    read = source.read
    return {
        "name": path_text(read.path, read.what) if read else source.name,
        "robot": read.robot if read else None,
        "value": read.value if read else source.value,
        "link": link,
    }


def _part(text: str) -> tuple[str, Path]:
    from logical_robots_tui.game.debugging.origin import read_part

    try:
        return read_part(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
