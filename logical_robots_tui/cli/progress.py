"""``logical-robots progress``: list a player's results, export them, check an export."""

from __future__ import annotations

import argparse
import asyncio
import csv
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any

import msgspec

from logical_robots_tui import world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import columns, drawn_bar, harmless, open_progress, print_json
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.verification import (
    SECONDS,
    FileBudget,
    check_size,
    differences,
    load_public_level,
    play_again,
)
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.paths import read_text
from logical_robots_tui.progress import LevelRecord, Measures, Progress

FORMAT = 1
"""The version of the exported document."""

CONFIRMED, NOT_CONFIRMED = 0, 1
CELLS = ("state", "hints", "ticks", "size", "distance", "wins", "starts", "goals", "rules")


@command.declare(
    "progress",
    command.one_of(
        command.flag("--json", "print JSON, with your programs"), command.flag("--csv", "print CSV")
    ),
    command.option(
        "--check",
        "FILE",
        "play the programs of an exported JSON file again, and compare the results",
        type=Path,
    ),
    command.number(
        "--seconds", command.number_from(1), SECONDS, "give up after so many processor seconds"
    ),
    command.DATA_DIR,
)
def progress(options: argparse.Namespace) -> int:
    """list and export your results, or check an export

    List your results in each level, export them, or check an exported file.

    examples:
      logical-robots progress                     list your results
      logical-robots progress --json > ada.json   export them with your programs
      logical-robots progress --check ada.json    play those programs again

    exit status: 0 done or all confirmed, 1 a result is not confirmed, 2 bad file
    """
    if options.check is not None:
        return _check(options.check, options.seconds, as_json=options.json)
    with closing(open_progress(options)) as record:
        _list(record, options)
    return CONFIRMED


def _list(progress: Progress, options: argparse.Namespace) -> None:
    files = (level for level in progress.levels() if _is_file_name(level))
    levels = dict.fromkeys([*world.list_levels(), *files])
    records = {level: progress.record(level) for level in levels}
    if options.json:
        documents = [_as_data(progress, level, record) for level, record in records.items()]
        print_json({"format": FORMAT, "levels": documents})
    elif options.csv:
        table = csv.writer(sys.stdout, lineterminator="\n")
        table.writerow(["level", *CELLS])
        for level, record in records.items():
            values = {**record.bests._asdict(), "goals": "; ".join(record.bests.goals)}
            cells = (record.state, record.hints, *values.values())
            table.writerow([level, *("" if cell is None else cell for cell in cells)])
    else:
        rows: list[tuple[str, ...]] = [
            ("LEVEL", "STATE", "HINTS", "TICKS", "SIZE", "DISTANCE", "ROBUST", "GOALS")
        ]
        for level, record in records.items():
            bests = record.bests
            robust = "" if bests.wins is None else f"{bests.wins} of {bests.starts}"
            distance = "" if bests.distance is None else f"{bests.distance:,.0f}"
            texts = ("" if n is None else str(n) for n in (bests.ticks, bests.size))
            counts = str(record.hints or ""), str(len(bests.goals) or "")
            rows.append((level, record.state, counts[0], *texts, distance, robust, counts[1]))
        print(*columns(rows), sep="\n")


def _is_file_name(level: str) -> bool:
    """Return whether a level is shipped, or a file; one that was never saved has no suffix."""
    return not Path(level).is_absolute() or bool(Path(level).suffix)


def _as_data(progress: Progress, level: str, record: LevelRecord) -> dict[str, Any]:
    def is_best(measures: Measures) -> bool:
        pairs = zip(measures[:4], record.bests[:4], strict=True)
        return bool(measures.goals) or any(n is not None and n == best for n, best in pairs)

    return {
        "level": level,
        "state": record.state,
        "hints": record.hints,
        "best": record.bests._asdict(),
        "victories": [
            {"program": version.text, **version.measures._asdict()}
            for version in progress.versions(level)
            if version.measures is not None and is_best(version.measures)
        ],
    }


_MOST_BYTES = 20_000_000

_Count = Annotated[int, msgspec.Meta(ge=0, le=1_000_000_000)]


class _VictoryExport(msgspec.Struct):
    program: str
    ticks: _Count
    distance: Annotated[float, msgspec.Meta(ge=0)]
    size: _Count | None = None
    wins: _Count | None = None
    starts: _Count = 0
    goals: tuple[str, ...] = ()

    def claim(self) -> Measures:
        """Return the measures; the size is the program's where an earlier version counted rules."""
        size = size_of(self.program) if self.size is None else self.size
        return Measures(self.ticks, size, self.distance, self.wins, self.starts, self.goals)


class _LevelExport(msgspec.Struct):
    level: str
    victories: list[_VictoryExport]


class _Export(msgspec.Struct):
    format: int
    levels: list[_LevelExport]


def read_claims(file: Path) -> Iterator[tuple[str, str, Measures]]:
    """Yield level, program and measures of each victory in an exported file.

    Raises InputError, naming the wrong key, if the file is unreadable or another one.
    """
    try:
        content = read_text(file, _MOST_BYTES)
    except OSError as error:
        raise InputError(f"can't be read: {error.strerror or error}.", place=str(file)) from error
    try:
        export = msgspec.json.decode(content, type=_Export)
    except (msgspec.DecodeError, RecursionError) as error:
        raise InputError(
            f"This is not an exported progress file: {error}",
            place=str(file),
            hint="logical-robots progress --json writes one.",
        ) from error
    if export.format != FORMAT:
        raise InputError(
            f"The file has format {export.format}; this version of the game reads {FORMAT}.",
            place=f"{file}: format",
        )
    return ((entry.level, v.program, v.claim()) for entry in export.levels for v in entry.victories)


def _check(file: Path, seconds: int, *, as_json: bool) -> int:
    claims = list(read_claims(file))
    try:
        check_size(len({claim[:2] for claim in claims}))
    except InputError as error:
        raise InputError(error.message, place=str(file)) from error
    budget = FileBudget(seconds)
    results: list[dict[str, Any]] = []
    outcomes: dict[tuple[str, str], Measures | str] = {}
    if not as_json:
        print(f"{'LEVEL':24}  {'TICKS':>6}  {'SIZE':>5}  {'DISTANCE':>8}  {'ROBUST':>8}  RESULT")
    for number, (level, text, claim) in enumerate(claims, 1):
        if (level, text) not in outcomes:
            part = f"victory {number:,} of {len(claims):,}"
            with drawn_bar(level) as draw:
                outcomes[level, text] = asyncio.run(_replay(level, text, budget, part, draw))
        outcome = outcomes[level, text]
        measures = None if isinstance(outcome, str) else outcome
        problem = str(outcome) if measures is None else "; ".join(differences(claim, measures))
        results.append(
            {
                "level": level,
                "confirmed": not problem,
                "problem": problem,
                "claimed": claim._asdict(),
                "found": measures and measures._asdict(),
            }
        )
        if not as_json:
            numbers = measures or claim
            robust = "" if numbers.wins is None else f"{numbers.wins} of {numbers.starts}"
            cells = f"{numbers.ticks:6}  {numbers.size:5}  {numbers.distance:8,.0f}  {robust:>8}"
            verdict = harmless(problem) or "confirmed"
            print(f"{harmless(level):24}  {cells}  {verdict}", flush=True)
    is_confirmed = all(result["confirmed"] for result in results)
    if as_json:
        print_json({"confirmed": is_confirmed, "results": results})
    elif not results:
        print("The file holds no victories.")
    return CONFIRMED if is_confirmed else NOT_CONFIRMED


async def _replay(
    level: str, text: str, budget: FileBudget, part: str, draw: Callable[[int, int, str, str], None]
) -> Measures | str:
    """Return a program's measures, or why there are none."""
    from logical_robots_tui.game.measuring import Trial

    def report(trial: Trial) -> None:
        draw(trial.tried, trial.of_all, part, f"start {trial.tried} of {trial.of_all}")

    report(Trial())
    try:
        return await play_again(load_public_level(level), text, budget, report)
    except InputError as error:
        return str(error)
