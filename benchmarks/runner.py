"""Run benchmarks, print their numbers, and say which targets are missed."""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from benchmarks.machine import machine
from benchmarks.measure import Effort, Measurement, Skipped

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

__all__ = ["Suite", "run"]

THOROUGH = Effort(repeats=5, ticks=100)
QUICK = Effort(repeats=2, ticks=60, is_quick=True)


@dataclass(frozen=True, slots=True)
class Suite:
    """Benchmarks to choose from.

    Attributes:
        benchmarks: All of them, in the order in which they run.
        named: Those that only run when they are named.
        thorough: Those that a quick run leaves out as well, unless they are named.
    """

    benchmarks: Mapping[str, Callable[[Effort], Iterable[Measurement]]]
    named: frozenset[str] = frozenset()
    thorough: frozenset[str] = frozenset()


@dataclass(slots=True)
class _Report:
    """Measurements; and for benchmarks why they were skipped or failed, and how long they took."""

    measurements: list[Measurement] = field(default_factory=list)
    skipped: dict[str, str] = field(default_factory=dict)
    failed: dict[str, str] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def summary(self) -> str:
        """Lines about what was skipped, what failed and which targets are missed."""
        lines = [f"{name} skipped: {reason}" for name, reason in self.skipped.items()]
        lines += [f"{name} failed: {error}" for name, error in self.failed.items()]
        judged = [(one, one.target) for one in self.measurements if one.target]
        missed = [
            f"  {one.group}, {one.subject}: {one.value:,.4g} {one.unit}, wanted {target}"
            for one, target in judged
            if not target.is_met(one.value)
        ]
        if missed:
            lines += [f"Targets: {len(missed)} of {len(judged)} missed:", *missed]
        elif judged:
            lines.append(f"Targets: {len(judged)}, all met.")
        lines.append(f"Benchmarks: {len(self.seconds)}, in {sum(self.seconds.values()):.0f} s.")
        return "\n".join(lines)


def run(suite: Suite, arguments: Sequence[str] | None = None) -> int:
    """Measure, print a table and a summary, and write JSON on request.

    Returns:
        The exit status: 1 if a benchmark failed. Skipped ones and missed targets don't matter.
    """
    parser = _parser(suite)
    options = parser.parse_args(arguments)
    names = options.only or _default(suite, is_quick=options.quick)
    if unknown := [name for name in names if name not in suite.benchmarks]:
        parser.error(f"no such benchmark: {', '.join(unknown)}")
    try:
        earlier = _earlier(options.compare) if options.compare else {}
    except (OSError, ValueError, KeyError, TypeError) as error:
        parser.error(f"{options.compare} was not written by --json: {error}")
    report = _measure(suite, names, QUICK if options.quick else THOROUGH)
    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(_table(report.measurements, earlier))
    console.print(report.summary, markup=False, highlight=False, soft_wrap=True)
    if options.json:
        text = json.dumps({"machine": machine(), **asdict(report)}, indent=2) + "\n"
        if options.json == Path("-"):
            sys.stdout.write(text)
        else:
            options.json.write_text(text, encoding="utf-8")
    return 1 if report.failed else 0


def _default(suite: Suite, *, is_quick: bool) -> list[str]:
    left_out = suite.named | suite.thorough if is_quick else suite.named
    return [name for name in suite.benchmarks if name not in left_out]


def _measure(suite: Suite, names: Sequence[str], effort: Effort) -> _Report:
    """Run benchmarks and print each number as soon as it is measured."""
    report = _Report()
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as progress:

        def tell(line: str) -> None:
            progress.console.print(line, markup=False, highlight=False)

        bar = progress.add_task("", total=len(names))
        for name in names:
            progress.update(bar, description=name)
            began = perf_counter()
            try:
                for one in suite.benchmarks[name](effort):
                    report.measurements.append(one)
                    tell(f"{one} ({one.target})" if one.target else str(one))
            except Skipped as reason:
                report.skipped[name] = str(reason)
                tell(f"{name} skipped: {reason}")
            except Exception as error:
                report.failed[name] = _in_one_line(error)
                tell("".join(traceback.format_exception(error)))
            report.seconds[name] = perf_counter() - began
            progress.advance(bar)
    return report


def _in_one_line(error: Exception) -> str:
    return traceback.format_exception_only(error)[-1].partition("\n")[0].removesuffix(": ")


def _parser(suite: Suite) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description="The numbers that matter, as a table and as JSON."
    )
    names = f"{', '.join(suite.benchmarks)}; by default all but {', '.join(sorted(suite.named))}"
    parser.add_argument("only", nargs="*", metavar="BENCHMARK", help=names)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write JSON to a file")
    parser.add_argument(
        "--compare", type=Path, metavar="FILE", help="also show the numbers of an earlier --json"
    )
    without = f"by default without {', '.join(sorted(suite.thorough))} as well"
    help_ = f"fewer repeats, less exact; {without}"
    parser.add_argument("--quick", action="store_true", help=help_)
    return parser


def _earlier(path: Path) -> dict[tuple[str, str], float]:
    """Return an earlier run's value for each subject."""
    numbers: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return {(one["group"], one["subject"]): float(one["value"]) for one in numbers["measurements"]}


def _table(found: Sequence[Measurement], earlier: Mapping[tuple[str, str], float]) -> Table:
    facts = "\n".join(f"{name}: {fact}" for name, fact in machine().items())
    table = Table(title="Numbers that matter", caption=facts, caption_justify="left")
    table.add_column("what")
    table.add_column("on")
    for number in ("value", "lowest", "highest", *(("before", "change") if earlier else ())):
        table.add_column(number, justify="right")
    table.add_column("unit")
    table.add_column("target")
    last = ""
    for one in found:
        if last and one.group != last:
            table.add_section()
        numbers = [f"{number:,.2f}" for number in (one.value, one.lowest, one.highest)]
        if earlier:
            numbers += _compared(one.value, earlier.get((one.group, one.subject)))
        group = "" if one.group == last else one.group
        table.add_row(group, one.subject, *numbers, one.unit, str(one.target or ""))
        last = one.group
    return table


def _compared(now: float, before: float | None) -> tuple[str, str]:
    if before is None:
        return "", "new"
    return f"{before:,.2f}", f"{now / before - 1:+.0%}" if before else ""
