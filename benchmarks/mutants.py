"""Print which mutants the diagnosis finds: ``python -m benchmarks.mutants [NUMBER ...]``."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from tests.mutants.planted import (
    FIRST,
    MUTANTS,
    diagnosis_of,
    first_difference,
    rank,
    suggestions,
)

if TYPE_CHECKING:
    from logical_robots_tui.game.diagnosing import Diagnosis

HEAD = "    kind               program               line  differs  findings  named by   nearest"


def main() -> None:
    """Print a line for each mutant, and how many were found; more of those that are named."""
    wanted = [int(number) for number in sys.argv[1:]] or range(1, len(MUTANTS) + 1)
    by_diagnosis = by_either = 0
    print(HEAD)
    for number in wanted:
        mutant = MUTANTS[number - 1]
        there = first_difference(mutant)
        found = diagnosis_of(mutant.level, mutant.text, mutant.ticks)
        place = rank(found.findings, mutant.line)
        nearest = suggestions(mutant, there) if there is not None else []
        named = [each for each in nearest if each.span.line == mutant.line]
        is_named = place is not None and place[0] <= FIRST
        by_diagnosis += is_named
        by_either += is_named or bool(named)
        how = f"{place[0]} {'itself' if place[1] else 'places'}" if place else "-"
        print(
            f"{number:2}  {mutant.kind:17}  {mutant.program:20}  {mutant.line:4}  "
            f"{there.tick if there else '-':>7}  {len(found.findings):8}  {how:9}  "
            f"{len(named)} of {len(nearest)}",
            flush=True,
        )
        if sys.argv[1:]:
            _tell(found)
            for each in nearest:
                print(f"     nearest line {each.span.line}: {each.text} -> {each.change}")
    print(f"{by_diagnosis} of {len(wanted)} are named within the first {FIRST} findings,")
    print(f"{by_either} by these or by a nearest miss.")


def _tell(found: Diagnosis) -> None:
    for each in found.findings:
        line = each.span.line if each.span else None
        others = [span.line for span in each.others]
        print(f"     {each.severity} line {line} tick {each.tick}: {each.message} {others}")


if __name__ == "__main__":
    main()
