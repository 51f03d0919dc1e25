"""A class without solutions: each stays hidden until the player has won its level."""

from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.game.source import hide_solutions, reference_names
from logical_robots_tui.paths import ARENAS, shipped_folder, shipped_names
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import list_arenas, list_levels, load_level
from tests.cli.running import Command, in_terminal

REFERENCES = {
    program: name
    for name in (*list_levels(), *list_arenas())
    for program in reference_names(load_level(name).solution)
}
LISTED = {*shipped_names("programs", ".l"), *shipped_names("programs", ".l", ARENAS)}
SOLUTIONS = set(REFERENCES) & LISTED
UNREAD = "a solution of a level that you have not won yet"


@pytest.fixture(autouse=True)
def _for_this_test_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("logical_robots_tui.game.source._hiding", [])


@pytest.fixture
def progress(tmp_path: Path) -> Progress:
    return Progress(tmp_path / "data" / FILE_NAME)


def listed(command: Command, folder: Path, *options: str) -> set[str]:
    told = command("programs", "--json", "--data-dir", folder, *options)
    return {program["name"] for program in told.data}


def test_the_list_of_programs_leaves_out_solutions_and_everything_else_can_be_read(
    command: Command, progress: Progress, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert listed(command, tmp_path / "data") == LISTED
    progress.win("02-open-space", "text")
    left = LISTED - (SOLUTIONS - {"open-space"})
    assert listed(command, tmp_path / "data", "--no-solutions") == left
    monkeypatch.setenv("LOGICAL_ROBOTS_NO_SOLUTIONS", "1")
    assert not listed(command, tmp_path) & SOLUTIONS
    hide_solutions(progress)
    assert all(load_program(name).shipped for name in LISTED - SOLUTIONS)


@pytest.mark.sampled
@pytest.mark.parametrize("name", REFERENCES)
def test_a_solution_is_read_in_a_won_level(name: str, progress: Progress, tmp_path: Path) -> None:
    hide_solutions(progress)
    (file,) = shipped_folder("programs").rglob(f"{name}.l")
    link = tmp_path / "mine.l"
    link.symlink_to(file)
    for way in (name, file, link):
        with pytest.raises(InputError, match=r"not won yet|hidden here") as caught:
            load_program(way)
        assert REFERENCES[name] in caught.value.hint
    assert name not in list_programs()
    progress.win(REFERENCES[name], "text")
    assert load_program(link).text == load_program(name).text == file.read_text("utf-8")
    assert (name in list_programs()) is (name in SOLUTIONS)


@pytest.mark.parametrize(
    "words",
    [(name, "01-first-steps", "first-steps") for name in ("run", "trace")]
    + [("check", "first-steps")],
)
def test_commands_read_no_solution(
    words: tuple[str, ...], command: Command, progress: Progress, tmp_path: Path
) -> None:
    options = ("--no-solutions", "--data-dir", tmp_path / "data")
    assert UNREAD in command(*words, *options).refusal
    progress.win("01-first-steps", "text")
    assert command("check", "first-steps", *options).status == 0


def test_the_game_in_lines_opens_and_shows_no_solution(command: Command, tmp_path: Path) -> None:
    play = ("play", "--plain", "--no-solutions", "--data-dir", tmp_path, "01-first-steps")
    refusal = command(*play, "first-steps").refusal
    assert UNREAD in refusal
    assert "Win 01-first-steps" in refusal
    told = command(*play, typed=("solution",)).out
    assert "You can read the reference programs when you have won this level." in told


@pytest.mark.slow
def test_the_game_on_a_screen_shows_no_solution(tmp_path: Path) -> None:
    with in_terminal(
        *("play", "01-first-steps", "--no-solutions", "--data-dir", tmp_path), size=(100, 40)
    ) as terminal:
        terminal.wait_for("· applied")
        terminal.send("W")
        terminal.wait_for("You can read the reference")
        terminal.send("q")
        assert terminal.finish() == 0
