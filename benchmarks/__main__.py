"""``python -m benchmarks``: the numbers that matter, as a table and as JSON."""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from benchmarks.answers import answers
from benchmarks.breakpoints import breakpoints
from benchmarks.classes import classes, large_classes
from benchmarks.editing import editing
from benchmarks.first_frame import first_frame
from benchmarks.folding import folding
from benchmarks.functions import functions
from benchmarks.history import history
from benchmarks.inspector import inspector
from benchmarks.lab import laboratory
from benchmarks.machine import machine
from benchmarks.measure import Effort, Measurement
from benchmarks.memory import memory
from benchmarks.mind import compiling, thinking
from benchmarks.proofs import proofs
from benchmarks.replays import replays
from benchmarks.schemas import schemas
from benchmarks.ssh import processor, ssh
from benchmarks.swarm import swarms
from benchmarks.teams import teams
from benchmarks.tournament import tournament
from benchmarks.whole_game import whole_game
from benchmarks.with_screen import traffic, with_screen
from benchmarks.world import crowds
from logical_robots_tui.garbage import collect_seldom

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

BENCHMARKS = {
    "world": crowds,
    "compile": compiling,
    "think": thinking,
    "functions": functions,
    "schemas": schemas,
    "swarms": swarms,
    "teams": teams,
    "game": whole_game,
    "breakpoints": breakpoints,
    "editing": editing,
    "history": history,
    "replays": replays,
    "memory": memory,
    "inspector": inspector,
    "folding": folding,
    "answers": answers,
    "proofs": proofs,
    "screen": with_screen,
    "traffic": traffic,
    "ssh": ssh,
    "class": classes,
    "large-class": large_classes,
    "lab": laboratory,
    "tournament": tournament,
    "processor": processor,
    "first-frame": first_frame,
}
LONGEST = {"large-class", "lab", "tournament"}
"""Left out of a run that names no benchmarks."""
LONG = {"functions", "memory", "traffic", "ssh", "class", "processor", "teams"}
"""Left out of a quick run as well."""

THOROUGH = Effort(repeats=5, ticks=100)
QUICK = Effort(repeats=2, ticks=60, is_quick=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print a table, and write JSON on request."""
    parser = _parser()
    options = parser.parse_args(arguments)
    try:
        earlier = _medians(options.compare) if options.compare else {}
    except (OSError, ValueError, KeyError, TypeError) as error:
        parser.error(f"{options.compare} was not written by --json: {error}")
    collect_seldom()  # as the commands do
    os.environ["LOGICAL_ROBOTS_CACHE_DIR"] = ""  # cached programs would make the numbers too good
    effort = QUICK if options.quick else THOROUGH
    left_out = LONGEST | LONG if options.quick else LONGEST
    names = options.only or [name for name in BENCHMARKS if name not in left_out]
    found = _measure(names, effort)
    wide = None if sys.stdout.isatty() else 120
    Console(width=wide).print(_table(found, earlier))
    if options.json:
        numbers = {"machine": machine(), "measurements": [asdict(one) for one in found]}
        text = json.dumps(numbers, indent=2) + "\n"
        if options.json == Path("-"):
            sys.stdout.write(text)
        else:
            options.json.write_text(text, encoding="utf-8")


def _measure(names: Sequence[str], effort: Effort) -> list[Measurement]:
    """Run benchmarks and print each number as soon as it is measured."""
    found: list[Measurement] = []
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:
        bar = progress.add_task("", total=len(names))
        for name in names:
            progress.update(bar, description=name)
            for one in BENCHMARKS[name](effort):
                found.append(one)
                progress.console.print(
                    f"{one.group}, {one.subject}: {one.value:,.2f} {one.unit}"
                    + (f" ({one.required})" if one.required else ""),
                    markup=False,
                    highlight=False,
                )
            progress.advance(bar)
    return found


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    names = f"{', '.join(BENCHMARKS)}; by default all but {', '.join(sorted(LONGEST))}"
    parser.add_argument("only", nargs="*", metavar="BENCHMARK", help=names)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write JSON to a file")
    parser.add_argument(
        "--compare", type=Path, metavar="FILE", help="also show the numbers of an earlier --json"
    )
    without = f"fewer repeats, less exact; by default without {', '.join(sorted(LONG))} as well"
    parser.add_argument("--quick", action="store_true", help=without)
    return parser


def _medians(path: Path) -> dict[tuple[str, str], float]:
    """Return an earlier run's median for each subject."""
    numbers: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return {(one["group"], one["subject"]): float(one["value"]) for one in numbers["measurements"]}


def _table(found: list[Measurement], earlier: Mapping[tuple[str, str], float]) -> Table:
    facts = "\n".join(f"{name}: {fact}" for name, fact in machine().items())
    table = Table(title="Numbers that matter (medians)", caption=facts, caption_justify="left")
    table.add_column("what")
    table.add_column("on")
    for number in ("median", "lowest", "highest", *(("before", "change") if earlier else ())):
        table.add_column(number, justify="right")
    table.add_column("unit")
    table.add_column("required")
    last = ""
    for one in found:
        if last and one.group != last:
            table.add_section()
        numbers = [f"{number:,.2f}" for number in (one.value, one.lowest, one.highest)]
        if earlier:
            before = earlier.get((one.group, one.subject))
            numbers += _compared(one.value, before)
        group = "" if one.group == last else one.group
        table.add_row(group, one.subject, *numbers, one.unit, one.required)
        last = one.group
    return table


def _compared(now: float, before: float | None) -> tuple[str, str]:
    if before is None:
        return "", "new"
    return f"{before:,.2f}", f"{now / before - 1:+.0%}" if before else ""


if __name__ == "__main__":
    main()
