"""Figures of the package that may only fall; whoever makes one smaller lowers its bound here."""

import pytest

from tests.house.figures import Figures, figures_of
from tests.installed import CHECKOUT

MOST_VAGUE = 31
MOST_AMBIGUOUS = 3
MOST_LINES = 73_300
MOST_LINES_OF_A_MODULE = 600
MOST_MODULES = 20  # in a room, besides `__init__`
LEAST_BODY = 7.3  # lines of a function, in the mean: shorter ones are hops


@pytest.fixture(scope="module")
def figures() -> Figures:
    return figures_of(CHECKOUT / "logical_robots_tui")


def test_names_say_what_they_hold(figures: Figures) -> None:
    assert figures.vague.total() <= MOST_VAGUE, figures.vague.most_common(8)


def test_the_name_of_a_class_means_one_thing(figures: Figures) -> None:
    assert len(figures.ambiguous) <= MOST_AMBIGUOUS, figures.ambiguous


def test_the_package_does_not_grow(figures: Figures) -> None:
    assert sum(figures.lines.values()) <= MOST_LINES
    assert round(sum(figures.bodies) / len(figures.bodies), 1) >= LEAST_BODY


def test_modules_and_rooms_are_of_one_idea(figures: Figures) -> None:
    assert {m: n for m, n in figures.lines.items() if n > MOST_LINES_OF_A_MODULE} == {}
    assert {room: n for room, n in figures.modules.items() if n > MOST_MODULES} == {}
