"""The course tells what the game tells."""

import re

from docs.learn import FOLDER, PICTURES, files
from tests.levels.playing import LEVELS, program_text, solution_of


def test_the_course_is_up_to_date() -> None:
    for path, text in files().items():
        assert path.read_text("utf-8") == text, "`make learn` writes it anew"


def test_the_course_comes_without_solutions() -> None:
    page = (FOLDER / "learn.md").read_text("utf-8")
    solutions = (FOLDER / "solutions.md").read_text("utf-8")
    for name in LEVELS:
        text = program_text(solution_of(name)).strip()
        assert text in solutions
        assert text not in page


def test_there_is_no_picture_of_a_level_that_is_gone() -> None:
    assert {p for p in files() if p.suffix == ".svg"} == set((FOLDER / PICTURES).iterdir())


def test_code_in_hints_is_shown_as_it_is_typed() -> None:
    page = files()[FOLDER / "learn.md"]
    code = re.findall(r"`[^`\n]+`", page)
    assert code
    assert not [piece for piece in code if re.search("&(lt|gt|amp);", piece)]
