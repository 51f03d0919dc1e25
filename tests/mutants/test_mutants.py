"""The diagnosis names the lines of planted bugs, without knowing where they are."""

from collections import Counter

import pytest

from tests.installed import CHECKOUT
from tests.mutants import planted
from tests.mutants.planted import MUTANTS, Mutant

SMALL = ("02-open-space", "03-the-long-hall")  # where a mutant is diagnosed at once


def test_there_are_three_mutants_of_each_kind_and_each_changes_one_line() -> None:
    assert set(Counter(mutant.kind for mutant in MUTANTS).values()) == {3}
    assert len({mutant.kind for mutant in MUTANTS}) == 10
    for mutant in MUTANTS:
        assert mutant.new in mutant.text
        assert mutant.old != mutant.new


def is_named(mutant: Mutant) -> bool:
    """Whether one of the first findings names the line of the bug, or a nearest miss does."""
    found = planted.diagnosis_of(mutant.level, mutant.text, mutant.ticks)
    place = planted.rank(found.findings, mutant.line)
    if place is not None and place[0] <= planted.FIRST:
        return True
    there = planted.first_difference(mutant)
    return there is not None and any(
        miss.span.line == mutant.line for miss in planted.suggestions(mutant, there)
    )


@pytest.mark.sampled
@pytest.mark.parametrize(
    "mutant",
    [mutant for mutant in MUTANTS if mutant.level in SMALL and mutant.kind != "precedence"],
    ids=lambda mutant: f"{mutant.kind} in {mutant.program}",
)
def test_a_bug_in_a_small_program_is_named(mutant: Mutant) -> None:
    assert planted.first_difference(mutant) is not None
    assert is_named(mutant)


@pytest.mark.proof
def test_of_thirty_bugs_most_are_named_and_the_page_says_which() -> None:
    """`python -m benchmarks.mutants` prints the table of the page anew."""
    page = (CHECKOUT / "docs" / "diagnose.md").read_text()
    verdicts = [planted.verdict(number) for number in range(1, len(MUTANTS) + 1)]
    assert sum(verdict.by_either for verdict in verdicts) >= 26
    assert [verdict.line for verdict in verdicts if verdict.line not in page] == []
