"""The course tells what the game tells."""

from __future__ import annotations

from docs.learn import FOLDER, PICTURES, files


def test_the_course_is_up_to_date() -> None:
    for path, text in files().items():
        assert path.read_text("utf-8") == text, "`make learn` writes it anew"


def test_there_is_no_picture_of_a_level_that_is_gone() -> None:
    assert {p for p in files() if p.suffix == ".svg"} == set((FOLDER / PICTURES).iterdir())
