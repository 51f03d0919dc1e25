"""The board in lines of text."""

from pathlib import Path

import pytest

from logical_robots_tui.game.run import level_digest
from logical_robots_tui.game.source import load_program
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.world import load_level
from tests.cli.running import Ask, Command

LEVEL = "01-first-steps"


@pytest.fixture
def board(tmp_path: Path) -> Board:
    """The board of Ada, on which somebody called [b]Ben has won the first level."""
    ben = Board(tmp_path / "board", "ben")
    ben.create()
    ben.join(BoardMembership(is_listed=True, name="[b]Ben"))
    ben.add(LEVEL, level_digest(load_level(LEVEL)), "engine", "text", Measures(9, 9, 9.0))
    return Board(tmp_path / "board", "ada")


@pytest.fixture
def typed(command: Command, tmp_path: Path, board: Board) -> Ask:
    program = tmp_path / "mine.l"
    program.write_text(f"{load_program('first-steps').text}\n# mine\n", "utf-8")
    options = ("--data-dir", tmp_path / "data", "--board", board.file.parent, "--player", "ada")
    words = ("play", LEVEL, program, *options, "--plain")
    return lambda *lines: command(*words, "--class", typed=lines)


def test_whoever_has_won_chooses_a_name_and_sees_the_others(typed: Ask, board: Board) -> None:
    names = ("board [B]ben", "board \u202eada", f"board {'a' * 21}")
    lines = typed("ok", "board", "run", *names, "board  Ada  L. ", "board").success.splitlines()
    for sentence in (
        "Win this level first, then the board shows who else has.",
        "Another player is called [B]ben. Choose another one.",
        "A name has only letters, digits and signs.",
        "A name has at most 20 characters.",
        "You are on the board as Ada L..",
    ):
        assert lines.count(sentence) == 1
    assert not any("[b]Ben" in line for line in lines[: lines.index(lines[-3])])
    assert [line.split()[:3] for line in lines[-2:]] == [["1", "[b]Ben", "9"], ["you", "2", "Ada"]]


def test_another_name_keeps_what_is_shared_and_leaving_deletes_all(
    typed: Ask, board: Board
) -> None:
    typed("ok", "run", "board Ada")
    board.join(BoardMembership(is_listed=True, name="Ada", shares=True))
    assert "as anonymous." in typed("ok", "board Anonymous").success
    assert board.membership() == BoardMembership(is_listed=True, name=None, shares=True)
    assert len(board.entries()) == 2
    assert "It has no entries of yours." in typed("ok", "board leave").success
    assert [entry.player for entry in board.entries()] == ["ben"]


def test_others_may_race_the_runs_of_whoever_shares_them(typed: Ask, board: Board) -> None:
    assert "as Ada. Others may race your runs." in typed("board Ada", "board share").success
    assert board.membership() == BoardMembership(is_listed=True, name="Ada", shares=True)
    typed("ok", "run")
    rival = Board(board.file.parent, "ben")
    (entry,) = [entry for entry in board.entries() if entry.player == "ada"]
    assert [ghost.number for ghost in rival.ghosts(entry.level_digest)] == [entry.number]
    assert "You are on the board as Ada.\n" in typed("ok", "board private").success
    assert rival.ghosts(entry.level_digest) == []


def test_a_program_is_shown_to_the_teacher_until_the_game_ends(typed: Ask, board: Board) -> None:
    out = typed("ok", "teacher").success
    assert "In this class the teacher sees which level you play" in out
    assert "The teacher sees that you need help, and your program. Type teacher to end it." in out
    assert board.shown_program("ada") is None
    (activity,) = board.activities()
    assert activity.help_since is None
