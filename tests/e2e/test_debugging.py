"""The walk through a mistake, as the page tells it: Diagnosis, Why, a search, Watch, Ask."""

import shutil

import pytest

from docs.debugging import LEVEL, PAGE, PICTURES, PROGRAM, page, play
from tests.e2e.conftest import Seat


@pytest.mark.slow
def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text("utf-8") == page(), "`make debugging` writes it anew"
    assert {path.stem for path in LEVEL.parent.glob("*.svg")} == set(PICTURES)


@pytest.mark.slow
def test_the_mistake_is_found_and_mended_as_the_page_says(seat: Seat) -> None:
    with seat(120, 40) as player:
        shutil.copy(LEVEL, player.folder)
        shutil.copy(PROGRAM, player.folder)
        player.play("play", LEVEL.name, PROGRAM.name)
        pictures = [
            step.picture for step in play(player.tmux.type, player.tmux.wait_for) if step.picture
        ]
        assert pictures == list(PICTURES)
