"""``logical-robots diagnose``: likely mistakes in a whole run, and where they are."""

from __future__ import annotations

import argparse
import asyncio
import shutil
import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import Commands, harmless, line_of_json, prefers_json
from logical_robots_tui.cli.runs.common import (
    SOON,
    new_run_command,
    open_run,
    progress_bar,
    run_shown,
)

if TYPE_CHECKING:
    from logical_robots_tui.explain.diagnosis.telling import Finding
    from logical_robots_tui.game.diagnosing import Diagnosis
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

    Warnings come first. A note may well be intended. Ctrl+C ends the search, and
    what was found by then is printed.

    exit status: 0 no warnings, 1 warnings, 2 bad level or program
    """
    level, program = open_run(options)
    printer = Printer(is_silent=prefers_json(options))
    found = asyncio.run(_diagnose(level, program, options.ticks, printer))
    if prefers_json(options):
        print(line_of_json(_data(found)))
    else:
        printer.finish(found)
    return FOUND if any(each.severity == "warning" for each in found.findings) else NOTHING


async def _diagnose(level: Level, program: Program, ticks: int, printer: Printer) -> Diagnosis:
    from logical_robots_tui.game.diagnosing import diagnose_run

    async with run_shown(level, program, ticks) as (run, ran):
        with progress_bar("Examining", ticks, after=SOON) as report:
            try:
                return await diagnose_run(run, ticks, ran=ran, report=report, show=printer.show)
            except asyncio.CancelledError:
                if printer.found is None:
                    raise
                return printer.found  # interrupted


class Printer:
    """Prints findings as soon as they are sure."""

    def __init__(self, *, is_silent: bool) -> None:
        self._is_silent = is_silent
        self._has_begun = False
        self._printed = 0
        self.found: Diagnosis | None = None

    def show(self, found: Diagnosis) -> None:
        self.found = found
        if not self._is_silent and found.sure:
            self._print(found, found.findings[: found.sure])

    def finish(self, found: Diagnosis) -> None:
        from logical_robots_tui.game.diagnosing import shortcomings

        self._print(found, found.findings)
        if not found.findings:
            print("Nothing stands out.")
        if left := shortcomings(found).strip():
            print("", *textwrap.wrap(left, _width()), sep="\n")

    def _print(self, found: Diagnosis, findings: Sequence[Finding]) -> None:
        from logical_robots_tui.game.diagnosing import ticks_of

        if not self._has_begun:
            self._has_begun = True
            print(ticks_of(found))
        for each in findings[self._printed :]:
            print("", *_lines(each), sep="\n", flush=True)
            self._printed += 1


def _width() -> int:
    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 0)).columns))


def _lines(each: Finding) -> Iterator[str]:
    line = f"line {each.span.line}" if each.span is not None else "the run"
    head = f"{each.severity}, {line}, tick {each.tick}: "
    said = harmless(f"{each.message} {each.hint}")
    yield from textwrap.wrap(f"{head}{said}", _width(), subsequent_indent="  ")
    if each.others:
        lines = ", ".join(dict.fromkeys(str(span.line) for span in each.others))
        yield f"  See also line{'s' if ',' in lines else ''} {lines}."


def _data(found: Diagnosis) -> dict[str, Any]:
    return {
        "first": found.first,
        "last": found.last,
        "won_at": found.won_at,
        "looked_at_every": found.step,
        "looked_for_what_never_happened_every": found.second_step,
        "left_out": found.left_out,
        "reliable": found.is_reliable,
        "examined": found.examined,
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
