"""``logical-robots why``: which rule gave a robot's decision, and what stopped the others."""

from __future__ import annotations

import argparse
import asyncio
import json
import shlex
import shutil
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
from logical_robots_tui.cli.text import harmless, line_of_json, written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.mind import Ask, Explanation, Line, Program
    from logical_robots_tui.world import Level

__all__ = ["declare"]

GAVE, GAVE_NOT = 0, 1
WIDEST = 100  # columns, where nobody says how wide the terminal is

EPILOG = """\
examples:
  logical-robots why LEVEL PROGRAM --tick 300 --robot Pip
  logical-robots why LEVEL PROGRAM --tick 300 --robot Pip --predicate Next
  logical-robots why LEVEL PROGRAM --tick 300 --robot Pip --predicate Steer --given col0=0.5

Each rule, part by part: + holds, - does not. The arguments of a function are called col0, col1 ...

exit status: 0 there is a row, 1 there is none, 2 bad level, program or name
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "why",
        start=start,
        wants_json=prefers_json,
        summary="say why a robot did what it did, or why not",
        description="Run a program to a tick, then tell for each rule which parts of it held.",
        epilog=EPILOG,
    )
    add_level_and_program(command)
    command.add_argument("--tick", type=number_from(1), required=True, metavar="N", help="the tick")
    command.add_argument("--robot", required=True, metavar="R", help="in whose mind")
    command.add_argument(
        "--predicate", default="Robot", metavar="P", help="which predicate (default: %(default)s)"
    )
    command.add_argument(
        "--given",
        type=_given,
        action="append",
        default=[],
        metavar="COLUMN=VALUE",
        help="only rows with this value, as JSON; for a function its arguments",
    )
    command.add_argument(
        "--within", default="", metavar="P", help="in the rules of P, which is made with ':='"
    )
    add_json(command)


def start(options: argparse.Namespace) -> int:
    """Say why."""
    level, program = opened(options)
    check_name("robot", options.robot, (robot.name for robot in level.robots))
    own = [predicate.name for predicate in program.predicates if predicate.kind == "program"]
    check_name("predicate", options.predicate, own)
    explanation = asyncio.run(_explain(level, program, options))
    if prefers_json(options):
        print(line_of_json(_data(explanation, options.tick)))
    else:
        print(*_lines(explanation, options.tick), sep="\n")
    return GAVE if any(rule.rows for rule in explanation.rules) else GAVE_NOT


async def _explain(level: Level, program: Program, options: argparse.Namespace) -> Explanation:
    from logical_robots_tui.game import Inquiry

    frame = await frame_at(level, program, options.tick, options.engine)
    inquiry = Inquiry(level)
    try:
        return await inquiry.why(
            program,
            options.robot,
            frame,
            predicate=options.predicate,
            given=dict(options.given) or None,
            within=options.within,
        )
    finally:
        await inquiry.close()


def _lines(explanation: Explanation, tick: int) -> Iterator[str]:
    from logical_robots_tui.mind import tell

    wide = shutil.get_terminal_size((WIDEST, 0)).columns
    yield f"{explanation.predicate} for {harmless(explanation.robot)} at tick {tick}"
    lines = list(tell(explanation))
    for line in lines:
        mark = {True: "+", False: "-", None: " "}[line.holds]
        yield _cut(f"{'  ' * line.depth}{mark} ", line, wide)
    asked = (line.asked for line in lines if line.asked is not None)
    if deeper := dict.fromkeys(_deeper(ask) for ask in asked):
        yield from ("", "Deeper with one of:", *(f"  {options}" for options in deeper))


def _deeper(ask: Ask) -> str:
    """The options with which the question goes on."""
    given = [f"--given {shlex.quote(f'{c}={written(v)}')}" for c, v in ask.given.items()]
    within = [f"--within {ask.within}"] if ask.within else []
    return harmless(" ".join([f"--predicate {ask.predicate}", *given, *within]))


def _cut(before: str, line: Line, wide: int) -> str:
    place = f"line {line.span.line}: " if line.kind == "rule" and line.span is not None else ""
    said = f"  ({line.said})" if line.said else ""
    if line.kind == "value":
        values = (_truth(value) if line.is_truth else written(value) for value in line.values)
        said = f" = {' or '.join(values)}"
    room = max(20, wide - len(before) - len(place) - len(said))
    text = harmless(line.text)
    text = text if len(text) <= room else f"{text[: room - 3]}..."
    told, wide = f"{before}{place}{text}{said}", max(wide, 40)
    return told if len(told) <= wide else f"{told[: wide - 3]}..."


def _truth(value: Any) -> str:
    return "null" if value is None else "true" if value else "false"


def _data(explanation: Explanation, tick: int) -> dict[str, Any]:
    """The explanation for scripts: rules with their rows, and the lines of each."""
    from logical_robots_tui.mind import tell

    return {
        "tick": tick,
        "robot": explanation.robot,
        "predicate": explanation.predicate,
        "made_from": explanation.made_from or None,
        "rules": [
            {
                "line": rule.rule.span.line,
                "text": rule.rule.span.text,
                "rows": rule.rows,
                "examples": rule.examples,
                "stopped_by": rule.stopped_by.part.span.text if rule.stopped_by else None,
                "stopped_at_line": rule.stopped_by.part.span.line if rule.stopped_by else None,
            }
            for rule in explanation.rules
        ],
        "lines": [
            {
                "depth": line.depth,
                "kind": line.kind,
                "text": line.text,
                "said": line.said,
                "holds": line.holds,
                "values": line.values,
                "line": line.span.line if line.span else None,
                "asked": line.asked
                and {"predicate": line.asked.predicate, "given": line.asked.given},
            }
            for line in tell(explanation)
        ],
    }


def _given(text: str) -> tuple[str, Any]:
    column, sign, value = text.partition("=")
    if not sign or not column:
        raise argparse.ArgumentTypeError(f"{text!r} is not COLUMN=VALUE")
    try:
        return column, json.loads(value)
    except ValueError:
        return column, value
