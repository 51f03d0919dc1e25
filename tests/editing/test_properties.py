"""What belongs to a level as a whole."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from logical_robots_tui.editing.things import resize, set_words
from logical_robots_tui.world import Area, Beacon, LevelError, Robot, Visibility
from tests.editing.making import drawn, room, sketch


def test_texts_and_visibility_are_set_as_they_will_be_loaded() -> None:
    level = set_words(
        room(), title="Über", briefing="\nGo.\n\nNow.\n", hints=("a", "b"), idea="New."
    )
    level = set_words(level, visibility=Visibility("all", "own"), starter="wander")
    assert (level.title, level.briefing, level.hints) == ("Über", "Go.\n\nNow.", ("a", "b"))
    assert (level.visibility, level.starter, level.idea) == (
        Visibility("all", "own"),
        "wander",
        "New.",
    )
    assert set_words(level, briefing="Go.\n\nNow.") is level


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"title": ""}, '"title" is empty.'),
        ({"title": "t" * 61}, "longer than 60"),
        ({"briefing": "b" * 20_001}, "longer than 20000"),
        ({"hints": ("\x1b",)}, "can't be shown"),
        ({"visibility": Visibility("none")}, '"memory" must be'),  # type: ignore[arg-type] # as it is tested
        ({"width": 5}, "A level has no property width."),
    ],
)
def test_a_text_out_of_bounds_is_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(LevelError, match=message):
        set_words(room(), **values)


def test_another_size_keeps_what_there_was_and_everything_moves_along() -> None:
    level = drawn("#..", "..#")
    wider = resize(level, 5, 4, left=1, top=2)
    assert sketch(wider) == [".....", ".....", ".#...", "...#."]
    assert (wider.robots[0].x, wider.robots[0].y) == (2.5, 2.5)
    assert sketch(resize(level, 2, 3, left=-1, wall=True)) == ["..", ".#", "##"]
    assert sketch(resize(level, 2, 2, left=-9, wall=True)) == ["##", "##"]


def test_the_same_size_is_the_level_itself() -> None:
    level = room()
    assert resize(level, level.width, level.height) is level


@pytest.mark.parametrize(
    ("size", "message"),
    [
        ((0, 5), '"width" must be 1 or more'),
        ((5, 4001), "The labyrinth is 5 x 4001 units; at most 4000 x 4000 is allowed."),
    ],
)
def test_a_size_out_of_bounds_is_refused(size: tuple[int, int], message: str) -> None:
    with pytest.raises(LevelError, match=message):
        resize(room(), *size)


def test_nothing_is_moved_further_than_a_file_can_say() -> None:
    kinds: list[dict[str, Any]] = [
        {"robots": (Robot("B", 1e6, 0),)},
        {"beacons": (Beacon("b", 0, 1e6),)},
        {"areas": (Area("a", 1e6, 0, 1),)},
    ]
    for things in kinds:
        level = replace(room(), **things)
        with pytest.raises(LevelError, match="too far outside the labyrinth"):
            resize(level, 120, 81, left=1, top=1)


def test_the_largest_size_is_allowed() -> None:
    level = resize(room(), 4000, 4000, wall=True)
    assert np.count_nonzero(~level.walls) == 120 * 80
