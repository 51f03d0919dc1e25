"""Print which mutants the diagnosis finds: ``python -m tests.mutants``."""

from __future__ import annotations

import sys
import time

from tests.mutants.planted import FIRST, MUTANTS, diagnosis_of, first_difference, rank


def main() -> None:
    """Print a line for each mutant, and how many were found."""
    wanted = sys.argv[1:]
    named = 0
    print("kind                program               line  differs  won   findings  rank  of")
    for number, mutant in enumerate(MUTANTS, 1):
        if wanted and str(number) not in wanted:
            continue
        began = time.monotonic()
        differs = first_difference(mutant)
        found = diagnosis_of(mutant.level, mutant.text)
        place = rank(found.findings, mutant.line)
        named += place is not None and place[0] <= FIRST
        told = f"{place[0]:4}  {'the finding' if place[1] else 'its places'}" if place else "   -"
        print(
            f"{number:2} {mutant.kind:18}  {mutant.program:20}  {mutant.line:4}  {differs!s:7}  "
            f"{found.won_at!s:5} {len(found.findings):8}  {told}  {time.monotonic() - began:.0f} s",
            flush=True,
        )
        if wanted:
            for each in found.findings:
                lines = [span.line for span in each.others]
                own = each.span.line if each.span else None
                print(f"     {each.severity} {each.kind} line {own} tick {each.tick}: {each.message} {each.hint} {lines}")
    print(f"{named} of {len(wanted or MUTANTS)} named within the first {FIRST} findings")


if __name__ == "__main__":
    main()
