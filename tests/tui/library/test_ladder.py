"""The ladder of an arena: a program is handed in, and a match of it is watched."""

from dataclasses import replace
from pathlib import Path

import pytest

from logical_robots_tui.cli.ladder import _replay
from logical_robots_tui.game.source import load_program
from logical_robots_tui.player.opening import Opening
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.progress.ladder import Ladder, LadderRank
from logical_robots_tui.progress.store import program_digest
from logical_robots_tui.tui.library.board import LadderDialog
from logical_robots_tui.world import load_level
from tests.tui.conftest import STILL, showing
from tests.virtual_time import VirtualClock

ARENA = "16-high-ground"
FIRST = LadderRank("1", 0.9, 0.85, 0.95, 310.0)
LAST = LadderRank("2-3", 0.1, 0.05, 0.15, -310.0)


def board_of(folder: Path, player: str, name: str | None) -> Board:
    board = Board(folder, player)
    board.create()
    board.join(BoardMembership(is_listed=True, name=name))
    return board


@pytest.fixture
def match() -> bytes:
    level = replace(load_level(ARENA), match_ticks=7)
    content = _replay(level, load_program(level.starter).text, STILL)
    assert content is not None
    return content


async def test_a_program_is_handed_in_and_its_match_is_watched(
    data_dir: Path, tmp_path: Path, match: bytes
) -> None:
    level = load_level(ARENA)
    ada = board_of(tmp_path / "board", "ada", "Ada")
    ben = Ladder(board_of(tmp_path / "board", "ben", "[b]Ben"), ARENA)
    ben.hand_in(STILL)
    sources = {team.name: load_program(level.starter) for team in level.teams}
    opening = Opening(level, sources, data_dir, board=ada, clock=VirtualClock())
    async with showing(opening) as game:
        await game.command("hand_in")
        await game.sees("Handed in.")
        digest = program_digest(game.editor.text)
        assert ben.programs() == {"ada": digest, "ben": program_digest(STILL)}
        await game.command("ladder")
        await game.until(lambda: isinstance(game.app.screen, LadderDialog))
        await game.sees("waits for its first match")
        await game.press("escape")
        ben.rank(ben.programs(), {"ada": FIRST, "ben": LAST})
        ben.keep_matches([("ada", "ben")], {("ada", "ben"): ("", match)})
        await game.command("ladder")
        await game.sees("2-3  [b]Ben                 10.0%  5.0 to 15.0       -310")
        await game.press("down", "enter", sees="Replay of 7 ticks")
        await game.until(lambda: game.tick == 7 and not game.session.busy)


async def test_a_level_without_a_ladder_and_a_game_without_a_board_say_so(
    data_dir: Path, short: Path, tmp_path: Path
) -> None:
    ada = board_of(tmp_path / "board", "ada", None)
    sources = {"": load_program("first-steps")}
    opening = Opening(load_level(short), sources, data_dir, board=ada, clock=VirtualClock())
    async with showing(opening) as game:
        await game.command("hand_in")
        await game.sees("A short way has no ladder. Open an arena.")
    async with showing(opening._replace(board=None)) as game:
        await game.command("ladder")
        await game.sees("There is no board:")
