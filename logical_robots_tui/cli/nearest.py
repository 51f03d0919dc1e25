"""``logical-robots nearest``: which one change would have given a rule a row."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import (
    add_json,
    add_level_and_program,
    new_command,
    number_from,
    opened,
    prefers_json,
)
from logical_robots_tui.cli.moment import check_name, frame_at
from logical_robots_tui.cli.text import harmless, line_of_json

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.mind import Program
    from logical_robots_tui.mind.diagnosis.nearest import Suggestion
    from logical_robots_tui.world import Level

__all__ = ["declare"]

FOUND, NOTHING = 0, 1

EPILOG = """\
examples:
  logical-robots nearest 06-breadcrumbs breadcrumbs --tick 300 --robot Crow --predicate Drive

Each change was tried: with it alone the rule has a row. The smallest one comes first.

exit status: 0 there is such a change, 1 there is none, 2 bad level, program or name
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "nearest",
        start=start,
        wants_json=prefers_json,
        summary="say what would have to differ for a rule to have a row",
        description="Run a program to a tick, then say which one change of a rule that gave "
        "nothing would have given it a row.",
        epilog=EPILOG,
    )
    add_level_and_program(command)
    command.add_argument("--tick", type=number_from(1), required=True, metavar="N", help="the tick")
    command.add_argument("--robot", required=True, metavar="R", help="in whose mind")
    command.add_argument(
        "--predicate", default="Robot", metavar="P", help="whose rules (default: %(default)s)"
    )
    add_json(command)


def start(options: argparse.Namespace) -> int:
    """Say what would have to differ."""
    level, program = opened(options)
    check_name("robot", options.robot, (robot.name for robot in level.robots))
    own = [predicate.name for predicate in program.predicates if predicate.kind == "program"]
    check_name("predicate", options.predicate, own)
    found = asyncio.run(_ask(level, program, options))
    if prefers_json(options):
        print(line_of_json([_data(*each) for each in found]))
    else:
        print(
            *(_lines(found) if found else ["No single change would have given it a row."]), sep="\n"
        )
    return FOUND if found else NOTHING


async def _ask(
    level: Level, program: Program, options: argparse.Namespace
) -> list[tuple[int, Suggestion]]:
    """What would have to differ, each with the line of the rule."""
    from logical_robots_tui.game import Inquiry

    frame = await frame_at(level, program, options.tick, options.engine)
    inquiry = Inquiry(level)
    try:
        return await inquiry.nearest(program, options.robot, frame, options.predicate)
    finally:
        await inquiry.close()


def _lines(found: list[tuple[int, Suggestion]]) -> Iterator[str]:
    for rule in dict.fromkeys(line for line, _ in found):
        yield f"For the rule in line {rule} to have a row, one of:"
        for line, each in found:
            if line == rule:
                change = f"write {each.change}" if each.change else "leave it out"
                what = f"line {each.span.line}, {each.span.text}: {change}"
                yield harmless(f"  {each.text}")
                yield harmless(f"    {what}")


def _data(line: int, each: Suggestion) -> dict[str, Any]:
    return {
        "rule": line,
        "line": each.span.line,
        "text": each.span.text,
        "change": each.change,
        "said": each.text,
    }
