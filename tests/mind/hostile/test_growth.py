"""Work for a text grows in proportion to its size."""

from collections.abc import Callable
from contextlib import suppress
from itertools import product

import pytest

from logical_robots_tui.language import package_patches
from logical_robots_tui.language.diagnostics import MOST_DIAGNOSTICS, ProgramError
from logical_robots_tui.language.source_text import prepare, size_of
from logical_robots_tui.mind import Program
from logical_robots_tui.mind.compiling.compiler import compile_text
from logical_robots_tui.mind.sqlite import casting
from tests.growth import few_of, growth_of
from tests.hostile_text import TEXTS


def compiled(text: str) -> None:
    package_patches.install()
    with suppress(ProgramError):
        compile_text(text)


def cast(text: str) -> None:
    casting.try_cast_like(f"{text} ", [{"a": 1.0}])
    casting.try_cast_like(f"{text} ", {"a": [1.0]})


WAYS_IN: dict[str, tuple[Callable[[str], object], int]] = {
    "a program": (compiled, 2_000),
    "a text prepared": (prepare, 20_000),
    "a size": (size_of, 20_000),
    "a text cast": (cast, 50_000),
    "a text shown": (casting.to_text, 50_000),
}
"""What reads texts of others, and a size for which that takes some milliseconds."""


@pytest.mark.parametrize(("family", "way_in"), few_of(product(TEXTS, WAYS_IN)))
def test_twice_the_text_is_at_most_two_and_a_half_times_the_work(family: str, way_in: str) -> None:
    work, size = WAYS_IN[way_in]
    assert growth_of(work, TEXTS[family], size) == ""


@pytest.mark.parametrize(("family", "more"), [("many ');'", 900), ("unknown predicates", 18)])
def test_the_first_hundred_problems_are_shown_and_the_number_of_the_others(
    family: str, more: int
) -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile(TEXTS[family](2_000))
    *shown, last = caught.value.diagnostics
    assert len(shown) == MOST_DIAGNOSTICS
    assert last.message == f"{more} more problems not shown"
