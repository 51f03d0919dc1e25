"""The pictures of the README show the game as it is."""

import re

import pytest

from docs.screenshot import DOCS, PICTURES

LARGEST = 300_000


def steady(picture: str) -> str:
    """The first frame of a picture without the rules for its motion; what others show varies."""
    first, _, _ = picture.partition('<g class="f1">')
    return re.sub(r"<style>.*</style>", "", first, flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_shows_the_game_as_it_is(name: str) -> None:
    assert steady(PICTURES[name]()) == steady((DOCS / f"{name}.svg").read_text("utf-8"))


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_small(name: str) -> None:
    assert len((DOCS / f"{name}.svg").read_bytes()) < LARGEST
