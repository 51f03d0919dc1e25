"""Print which planted bugs the diagnosis finds: ``python -m benchmarks.mutants [NUMBER ...]``.

The table is in ``docs/diagnose.md``.
"""

from __future__ import annotations

import sys

from tests.mutants.planted import (
    FIRST,
    HEAD,
    MUTANTS,
    Mutant,
    diagnosis_of,
    first_difference,
    suggestions,
    verdict,
)


def main() -> None:
    """Print a line for each mutant, with details for the named ones, and the totals."""
    wanted = [int(number) for number in sys.argv[1:]] or range(1, len(MUTANTS) + 1)
    by_diagnosis = by_either = 0
    print(HEAD)
    for number in wanted:
        found = verdict(number)
        print(found.line, flush=True)
        by_diagnosis += found.by_diagnosis
        by_either += found.by_either
        if sys.argv[1:]:
            _tell(MUTANTS[number - 1])
    print(f"{by_diagnosis} of {len(wanted)} are named within the first {FIRST} findings,")
    print(f"{by_either} by these or by a nearest miss.")


def _tell(mutant: Mutant) -> None:
    for each in diagnosis_of(mutant.level, mutant.text, mutant.ticks).findings:
        lines = [span.line for span in (each.span, *each.related) if span is not None]
        print(f"     {each.severity} lines {lines} tick {each.tick}: {each.message}")
    there = first_difference(mutant)
    for nearest in suggestions(mutant, there) if there is not None else ():
        print(f"     nearest line {nearest.span.line}: {nearest.text} -> {nearest.change}")


if __name__ == "__main__":
    main()
