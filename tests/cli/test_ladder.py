"""Ladders: what players hand in is ranked in the background, and can be watched."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from logical_robots_tui.cli import ladder
from logical_robots_tui.cli.main import main
from logical_robots_tui.game.replay import read_replay
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.processes.lifeline import LIFELINE
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.progress.ladder import HOUSE, Ladder
from tests.waiting import until

ARENA = "16-high-ground"
STAND = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :- Sensor(robot_name:);
"""


@pytest.fixture
def board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(ladder, "_STARTS", 0)
    monkeypatch.setattr(ladder, "_LOWEST_PRIORITY", 0)
    return tmp_path / "board"


def hand_in(folder: Path, player: str, text: str) -> Ladder:
    players_board = Board(folder, player)
    players_board.create()
    players_board.join(BoardMembership(is_listed=True, name=player.title()))
    standings = Ladder(players_board, ARENA)
    standings.hand_in(text)
    return standings


def test_programs_are_ranked_and_their_matches_can_be_watched(
    board: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ada = hand_in(board, "ada", f"{shipped_texts()['high-ground']}\n# mine\n")
    hand_in(board, "ben", STAND)
    hand_in(board, "cem", "Robot(")
    assert all(challenger.is_new for challenger in ada.challengers())
    assert main(["ladder", str(board), "--once"]) == 0
    assert capsys.readouterr().out == "High ground: 4 programs ranked.\n"
    first, *others = ada.challengers()
    assert (first.player, first.name, first.is_me, first.is_new) == ("ada", "Ada", True, False)
    assert {other.player for other in others} == {"ben", "cem", HOUSE}
    assert others[-1].result.problem == "line 1: This '(' is never closed"
    content = ada.match("ada", "ben")
    assert content is not None
    assert b"# mine" not in content
    replay = read_replay(content)
    assert (replay.name, replay.has_programs) == (ARENA, False)
    assert ada.match("ben", "ada") == content
    assert ada.match("ada", "cem") is None


def test_a_ladder_plays_only_what_is_new(board: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ada = hand_in(board, "ada", STAND)
    assert main(["ladder", str(board), "--once"]) == 0
    match = ada.match(*next(iter(ada.matches())))

    def refuse(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(ladder, "_replay", refuse)
    monkeypatch.setattr("logical_robots_tui.lab.coordinating.Coordinator._task", refuse)
    assert main(["ladder", str(board), "--once"]) == 0
    assert ada.match(*next(iter(ada.matches()))) == match


def test_an_interrupt_is_how_a_ladder_ends(board: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(_: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("time.sleep", interrupt)
    assert main(["ladder", str(board)]) == 0


@pytest.mark.slow
def test_whoever_leaves_the_board_leaves_the_ladder(board: Path) -> None:
    ada = hand_in(board, "ada", STAND)
    hand_in(board, "ben", f"{STAND}\n# other\n")
    assert main(["ladder", str(board), "--once"]) == 0
    Board(board, "ada").join(BoardMembership(is_listed=False))
    assert {challenger.player for challenger in ada.challengers()} == {"ben", HOUSE}
    assert main(["ladder", str(board), "--once"]) == 0
    assert all("ada" not in pair for pair in ada.matches())


@pytest.mark.slow
def test_a_program_that_is_gone_is_said_and_the_others_play(board: Path) -> None:
    ada = hand_in(board, "ada", STAND)
    hand_in(board, "ben", f"{STAND}\n# other\n")
    shutil.rmtree(board / "programs" / "ada")
    assert main(["ladder", str(board), "--once"]) == 0
    problems = {c.player: c.result.problem for c in ada.challengers()}
    assert problems == {"ada": "The program is missing, or was changed", "ben": "", HOUSE: ""}


def test_a_second_ladder_in_the_same_board_is_refused(
    board: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from logical_robots_tui.lab.folder import Folder

    with Folder(board / ladder.FOLDER_NAME).lock():
        assert main(["ladder", str(board), "--once"]) == 2
    assert "Another process is at work in this folder" in capsys.readouterr().err


def test_a_ladder_ends_with_its_host(tmp_path: Path) -> None:
    read_end, write_end = os.pipe()
    process = subprocess.Popen(
        [sys.executable, "-m", "logical_robots_tui", "ladder", str(tmp_path / "board")],
        env=os.environ | {LIFELINE: str(read_end)},
        pass_fds=[read_end],
    )
    try:
        until((tmp_path / "board" / ladder.FOLDER_NAME / ".lock").exists)
        os.close(write_end)
        assert process.wait(timeout=60) < 0
    finally:
        process.kill()
        os.close(read_end)
