"""``logical-robots diagnose``: likely mistakes in a whole run, and where they are."""

from __future__ import annotations

import argparse
import asyncio
import shutil
import sys
import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import Commands, harmless
from logical_robots_tui.cli.runs.common import new_run_command, open_run, show

if TYPE_CHECKING:
    from logical_robots_tui.explain.diagnosis.telling import Finding
    from logical_robots_tui.game.diagnosis.diagnosing import Diagnosis
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

NOTHING, FOUND = 0, 1
DEFAULT_TICKS = 3000
NARROWEST, WIDEST = 40, 96  # columns


def declare(commands: Commands) -> None:
    new_run_command(
        commands,
        "diagnose",
        start,
        ticks=(DEFAULT_TICKS, "stop after this many ticks, or at victory"),
    )


def start(options: argparse.Namespace) -> int:
    """scan a whole run for likely mistakes

    Run a program, watch all its rules and conditions, and print what stands out.

    examples:
      logical-robots diagnose 06-breadcrumbs breadcrumbs --ticks 300
      logical-robots diagnose 01-first-steps first-steps --json | jq .findings

    Warnings come first. A note may well be intended.

    exit status: 0 no warnings, 1 warnings, 2 bad level or program
    """
    level, program = open_run(options)
    found = asyncio.run(_diagnose(level, program, options.ticks))
    show(options, _data(found), _lines(found))
    return FOUND if any(each.severity == "warning" for each in found.findings) else NOTHING


async def _diagnose(level: Level, program: Program, ticks: int) -> Diagnosis:
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.diagnosis.diagnosing import diagnose

    game = Game(level, program, history=ticks)
    try:
        await game.run_until(tick=ticks)
        return await diagnose(game, report=_report)
    finally:
        if sys.stderr.isatty():
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        await game.close()


def _report(done: int, of_all: int) -> None:
    if sys.stderr.isatty() and not done % 20:
        print(f"\r{done} of {of_all} ticks", end="", file=sys.stderr, flush=True)


def _lines(found: Diagnosis) -> Iterator[str]:
    from logical_robots_tui.game.diagnosis.diagnosing import extent

    wide = max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 0)).columns))
    yield from textwrap.wrap(extent(found), wide)
    for each in found.findings:
        line = f"line {each.span.line}" if each.span is not None else "the run"
        head = f"{each.severity}, {line}, tick {each.tick}: "
        said = harmless(f"{each.message} {each.hint}")
        yield from ("", *textwrap.wrap(f"{head}{said}", wide, subsequent_indent="  "))
        if each.others:
            lines = ", ".join(dict.fromkeys(str(span.line) for span in each.others))
            yield f"  See also line{'s' if ',' in lines else ''} {lines}."
    if not found.findings:
        yield "Nothing stands out."


def _data(found: Diagnosis) -> dict[str, Any]:
    return {
        "first": found.first,
        "last": found.last,
        "won_at": found.won_at,
        "looked_at_every": found.step,
        "looked_for_what_never_happened_every": found.second_step,
        "left_out": found.left_out,
        "reliable": found.is_reliable,
        "findings": [_finding(each) for each in found.findings],
    }


def _finding(each: Finding) -> dict[str, Any]:
    return {
        "severity": each.severity,
        "kind": each.kind,
        "line": each.span.line if each.span else None,
        "text": each.span.text if each.span else None,
        "tick": each.tick,
        "robot": each.robot or None,
        "message": each.message,
        "hint": each.hint,
        "see_also": list(dict.fromkeys(span.line for span in each.others)),
    }
