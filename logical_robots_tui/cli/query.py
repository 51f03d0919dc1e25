"""``logical-robots query``, ``when``, ``diagnose``: queries about a run, and likely mistakes."""

from __future__ import annotations

import argparse
import asyncio
import shutil
import sys
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from logical_robots_tui import game, mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    UNRELIABLE,
    columns,
    cut,
    harmless,
    line_of_json,
    prefers_json,
    progress_bar,
)
from logical_robots_tui.cli.run import (
    BAR_DELAY,
    DEFAULT_TICKS,
    frame_at,
    mistakes_in,
    open_run,
    place_of,
    run_args,
    show,
    with_run,
)
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.diagnosis.telling import Finding
    from logical_robots_tui.game.diagnosing import Diagnosis

FOUND, NOTHING = 0, 1
NARROWEST, WIDEST = 40, 96  # columns of a diagnosis

_WIDEST_CELL = 60  # characters of a value in a table


@command.declare(
    "query",
    run_args(first_tick=0, robot="only rows in this robot's mind"),
    command.option("query", "QUERY", "a call, an expression, or whole rules"),
)
def query(options: argparse.Namespace) -> int:
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
    with mistakes_in("query"):
        table = asyncio.run(_ask(level, program, options.query, options.tick))
    has_minds = bool(table.viewers)
    table = table.in_mind_of(options.robot)
    if prefers_json(options):
        document = {
            "tick": options.tick,
            "columns": table.columns,
            "rows": table.rows,
            "minds": table.viewers if has_minds else None,
            "truncated": table.truncated,
        }
        print(line_of_json(document))
    elif table.rows:
        print(*table_lines(table), sep="\n")
    else:
        print("No rows.", file=sys.stderr)
    return FOUND if table.rows else NOTHING


def table_lines(table: mind.ResultTable) -> list[str]:
    rows = [tuple(cut(spell(value), _WIDEST_CELL) for value in row) for row in table.rows]
    head = table.columns
    if table.viewers:
        head = ("IN THE MIND OF", *head)
        rows = [(viewer, *row) for viewer, row in zip(table.viewers, rows, strict=True)]
    return columns([head, *rows])


async def _ask(
    level: world.Level, program: mind.Program, query: str, tick: int
) -> mind.ResultTable:
    await asyncio.to_thread(program.question, query)  # reports mistakes before the run
    frame = await frame_at(level, program, tick)
    inquiry = game.Inquiry(level)
    try:
        return await inquiry.ask(program, query, frame)
    finally:
        await inquiry.close()


@command.declare(
    "when",
    run_args(
        ticks=(DEFAULT_TICKS, "stop after this many ticks"), robot="only rows in this robot's mind"
    ),
    command.option("query", "QUERY", "a call, an expression, conditions, or whole rules"),
)
def when(options: argparse.Namespace) -> int:
    """find the ticks of a run in which something holds

    Answer a query in Logica at every tick of a run, and print where it holds.

    examples:
      logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 Fresh
      logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 \\
        'Fresh(robot_name: "Crow")'
      logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 --robot Crow \\
        'Sensor(sensor:), sensor.forward_distance < 30'
      logical-robots when 06-breadcrumbs breadcrumbs --ticks 300 \\
        'Drive("Crow").left_engine > 1'

    QUERY is anything that `query` accepts. It holds in the ticks in which it has
    rows; an expression holds where it is not null, false or 0. The run ends at
    victory, or after N ticks.

    exit status: 0 found, 1 it never holds, 2 bad level, program or query
    """
    level, program = open_run(options)
    with mistakes_in("query"):
        question = program.question(options.query)
    ticks, robot = options.ticks, options.robot or ""
    matches = asyncio.run(
        with_run(
            level,
            program,
            ticks,
            lambda run, show: game.find_matches(run, question, ticks, robot, show),
        )
    )
    if matches.failed_in == matches.ticks:
        raise mind.QueryError(f"It failed in every tick: {matches.reason}")
    show(options, _data(options.query, matches), _lines(options.query, matches))
    return FOUND if matches.stretches else NOTHING


def _lines(query: str, matches: game.Matches) -> list[str]:
    extent = f"{matches.ticks} tick{'' if matches.ticks == 1 else 's'}"
    extent += ", up to victory" if matches.won_at is not None else ""
    lines = []
    if stretches := matches.stretches:
        first, last = stretches[0][0], stretches[-1][1]
        rows = [(str(start), str(end), str(end - start + 1)) for start, end in stretches]
        lines += [
            f"{harmless(query)}",
            f"holds in {matches.holds_in} of {extent}: first in tick {first}, last in tick {last}.",
            "",
            *columns([("FROM", "TO", "TICKS"), *rows]),
        ]
    else:
        lines.append(f"{harmless(query)} never holds in {extent}.")
    if matches.failed:
        (first, last), *later = matches.failed
        interval = f"tick {first}" if first == last else f"ticks {first} to {last}"
        suffix = f" and in {matches.failed_in - (last - first + 1)} more" if later else ""
        lines += ["", f"It failed in {interval}{suffix}: {harmless(matches.reason)}"]
    if not matches.is_reliable:
        lines += ["", UNRELIABLE]
    return lines


def _data(query: str, matches: game.Matches) -> dict[str, Any]:
    stretches = matches.stretches
    return {
        "query": query,
        "ticks": matches.ticks,
        "won_at": matches.won_at,
        "first": stretches[0][0] if stretches else None,
        "last": stretches[-1][1] if stretches else None,
        "holds_in": matches.holds_in,
        "stretches": stretches,
        "failed_in": matches.failed,
        "failure": matches.reason or None,
        "reliable": matches.is_reliable,
    }


@command.declare(
    "diagnose", run_args(ticks=(DEFAULT_TICKS, "stop after this many ticks, or at victory"))
)
def diagnose(options: argparse.Namespace) -> int:
    """scan a whole run for likely mistakes

    Run a program, watch all its rules and conditions, and print what stands out.

    examples:
      logical-robots diagnose 06-breadcrumbs breadcrumbs --ticks 300
      logical-robots diagnose 01-first-steps first-steps --json | jq .findings

    Warnings come first. A note may well be intended. Ctrl+C stops the scan and
    prints the findings so far.

    exit status: 0 no warnings, 1 warnings, 2 bad level or program
    """
    level, program = open_run(options)
    printer = Printer(is_silent=prefers_json(options))
    diagnosis = asyncio.run(_diagnose(level, program, options.ticks, printer))
    if prefers_json(options):
        print(line_of_json(_diagnosis(diagnosis)))
    else:
        printer.finish(diagnosis)
    return int(any(finding.severity == "warning" for finding in diagnosis.findings))


async def _diagnose(
    level: world.Level, program: mind.Program, ticks: int, printer: Printer
) -> Diagnosis:
    from logical_robots_tui.game.diagnosing import diagnose_run

    async def examine(run: game.Run, draw: Callable[..., None]) -> Diagnosis:
        with progress_bar("Examining", ticks, delay=BAR_DELAY) as report:
            try:
                return await diagnose_run(
                    run, ticks, on_tick=draw, report=report, show=printer.show
                )
            except asyncio.CancelledError:
                if printer.diagnosis is None:
                    raise
                return printer.diagnosis  # interrupted

    return await with_run(level, program, ticks, examine)


class Printer:
    """Prints findings as soon as they are sure."""

    def __init__(self, *, is_silent: bool) -> None:
        self._is_silent = is_silent
        self._has_begun = False
        self._printed = 0
        self.diagnosis: Diagnosis | None = None

    def show(self, diagnosis: Diagnosis) -> None:
        self.diagnosis = diagnosis
        if not self._is_silent and diagnosis.sure:
            self._print(diagnosis, diagnosis.findings[: diagnosis.sure])

    def finish(self, diagnosis: Diagnosis) -> None:
        from logical_robots_tui.game.diagnosing import shortcomings

        self._print(diagnosis, diagnosis.findings)
        if not diagnosis.findings:
            print("Nothing stands out.")
        if remarks := shortcomings(diagnosis).strip():
            print("", *textwrap.wrap(remarks, _width()), sep="\n")

    def _print(self, diagnosis: Diagnosis, findings: Sequence[Finding]) -> None:
        from logical_robots_tui.game.diagnosing import ticks_of

        if not self._has_begun:
            self._has_begun = True
            print(ticks_of(diagnosis))
        for finding in findings[self._printed :]:
            place = f"line {finding.span.line}" if finding.span is not None else "the run"
            head = f"{finding.severity}, {place}, tick {finding.tick}: "
            sentence = harmless(f"{finding.message} {finding.hint}")
            lines = textwrap.wrap(f"{head}{sentence}", _width(), subsequent_indent="  ")
            if finding.see_also:
                lines.append(f"  {finding.see_also}")
            print("", *lines, sep="\n", flush=True)
            self._printed += 1


def _width() -> int:
    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 0)).columns))


def _diagnosis(diagnosis: Diagnosis) -> dict[str, Any]:
    return {
        "first": diagnosis.first,
        "last": diagnosis.last,
        "won_at": diagnosis.won_at,
        "looked_at_every": diagnosis.step,
        "second_step": diagnosis.second_step,
        "left_out": diagnosis.left_out,
        "reliable": diagnosis.is_reliable,
        "examined": diagnosis.examined,
        "findings": [
            {
                "severity": finding.severity,
                "kind": finding.kind,
                **place_of(finding.span),
                "tick": finding.tick,
                "robot": finding.robot or None,
                "message": finding.message,
                "hint": finding.hint,
                "see_also": list(dict.fromkeys(span.line for span in finding.related)),
            }
            for finding in diagnosis.findings
        ],
    }
