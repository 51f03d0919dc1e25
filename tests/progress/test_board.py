"""The board: many games write one file, and each changes only what is its own."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import stat
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.progress import Measures, board
from logical_robots_tui.progress.board import Board, BoardMembership, BoardStanding

LEVEL, DIGEST, ENGINE = "01-first-steps", "level", "engine"
LISTED = BoardMembership(is_listed=True)


def board_of(folder: Path, player: str, name: str | None = None) -> Board:
    players_board = Board(folder, player)
    players_board.create()
    players_board.join(BoardMembership(is_listed=True, name=name))
    return players_board


def win(players_board: Board, text: str, ticks: int, size: int = 9, distance: float = 5.0) -> None:
    measures = Measures(ticks, size, distance)
    players_board.add(LEVEL, DIGEST, ENGINE, text, measures)


def texts(folder: Path, player: str) -> set[str]:
    return {path.read_text() for path in (folder / "programs" / player).iterdir()}


def test_standings_have_the_bests_of_each_player(tmp_path: Path) -> None:
    ada, ben = board_of(tmp_path, "ada", "Ada"), board_of(tmp_path, "ben")
    win(ada, "fast", 100, size=20)
    win(ada, "short", 200, size=10)
    win(ben, "other", 150, size=15)
    assert ada.standings(DIGEST) == [
        BoardStanding("Ada", True, 100, 10, 5.0),
        BoardStanding(None, False, 150, 15, 5.0),
    ]
    assert ada.standings("an earlier version") == []


def test_only_bests_are_kept_with_their_texts(tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    for text, ticks in (("first", 300), ("second", 200), ("slower", 250)):
        win(ada, text, ticks)
    assert [entry.ticks for entry in ada.entries()] == [200, 300]  # 300 was the first of its size
    assert texts(tmp_path, "ada") == {"first", "second"}


def test_whoever_leaves_takes_entries_and_texts_along(tmp_path: Path) -> None:
    ada, ben = board_of(tmp_path, "ada"), board_of(tmp_path, "ben")
    win(ada, "a", 1)
    win(ben, "b", 2)
    ada.join(BoardMembership(is_listed=False))
    assert [entry.player for entry in ada.entries()] == ["ben"]
    assert texts(tmp_path, "ada") == set()
    assert ada.membership() == BoardMembership(is_listed=False)


def test_a_name_belongs_to_one_player(tmp_path: Path) -> None:
    board_of(tmp_path, "ada", "Ada")
    ben = board_of(tmp_path, "ben", "Ben")
    with pytest.raises(InputError, match="Another player is called ADA"):
        ben.join(BoardMembership(is_listed=True, name="ADA"))
    assert ben.membership() == BoardMembership(is_listed=True, name="Ben")


def test_ghosts_are_there_while_their_player_shares_them(tmp_path: Path) -> None:
    ada, ben = board_of(tmp_path, "ada"), board_of(tmp_path, "ben")
    ada.join(LISTED._replace(shares=True))
    ada.add(LEVEL, DIGEST, ENGINE, "a", Measures(7, 9, 5.0), b"replay")
    (ghost,) = ben.ghosts(DIGEST)
    assert (ghost.ticks, ben.ghost(ghost.number)) == (7, b"replay")
    ada.join(LISTED)
    assert ben.ghosts(DIGEST) == []
    assert ben.ghost(ghost.number) is None


def test_what_does_not_hold_is_struck_out_until_it_is_won_again(tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    win(ada, "a", 7)
    (entry,) = ada.entries()
    ada.judge(entry, ENGINE, "the program does not win")
    assert ada.standings(DIGEST) == []
    win(ada, "a", 7)
    assert len(ada.standings(DIGEST)) == 1


def test_a_program_that_was_changed_is_not_played(tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    win(ada, "a", 7)
    (entry,) = ada.entries()
    assert ada.program(entry.player, entry.program) == "a"
    (tmp_path / "programs" / "ada" / f"{entry.program}.l").write_text("b")
    with pytest.raises(InputError, match="missing, or was changed"):
        ada.program(entry.player, entry.program)


def test_an_account_may_begin_with_an_underscore(tmp_path: Path) -> None:
    service = board_of(tmp_path, "_service")
    win(service, "a", 7)
    (entry,) = Board(tmp_path).entries()
    assert Board(tmp_path).program(entry.player, entry.program) == "a"


@pytest.mark.parametrize("change", ["ticks = 'many'", "won = x'ff'", "distance = 'far'"])
def test_no_program_of_a_player_gives_a_column_another_type(change: str, tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    win(ada, "a", 7)
    with (
        contextlib.closing(sqlite3.connect(ada.file)) as connection,
        pytest.raises(sqlite3.IntegrityError, match="cannot store"),
    ):
        connection.execute(f"UPDATE entry SET {change}")


def test_a_ghost_that_is_larger_than_any_game_writes_is_not_read(tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    ada.add(LEVEL, DIGEST, ENGINE, "a", Measures(7, 9, 5.0), b"replay")
    (entry,) = ada.entries()
    with contextlib.closing(sqlite3.connect(ada.file)) as connection, connection:
        connection.execute("UPDATE entry SET ghost = zeroblob(?)", (board.MOST_GHOST_BYTES + 1,))
    assert ada.ghost(entry.number) is None


def test_activity_keeps_what_was_not_reported_anew(tmp_path: Path) -> None:
    ada = board_of(tmp_path, "ada")
    ada.report(level=LEVEL, since="1", runs=2)
    ada.report(trouble="No rows.", help_since="2")
    board_of(tmp_path, "ben").report(level=LEVEL, since="1")
    activity, other = Board(tmp_path).activities()
    assert (activity.player, activity.runs, activity.trouble) == ("ada", 2, "No rows.")
    assert (other.player, other.help_since, other.is_open) == ("ben", None, True)


def test_a_program_is_shown_only_while_help_is_asked_for(tmp_path: Path) -> None:
    ada, reader = board_of(tmp_path, "ada"), Board(tmp_path)
    assert reader.shown_program("ada") is None
    ada.show_program("text")
    win(ada, "a", 7)
    assert reader.shown_program("ada") == "text"
    ada.show_program(None)
    assert reader.shown_program("ada") is None


def _damage(file: Path) -> None:
    file.write_bytes(b"not a database" * 1000)


def _take_away(file: Path) -> None:
    file.unlink()


def _of_another_kind(file: Path) -> None:
    file.unlink()
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.execute("CREATE TABLE mine (a)")


def _of_a_newer_game(file: Path) -> None:
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.execute("PRAGMA user_version = 99")


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (_damage, "it is damaged"),
        (_take_away, "it is missing"),
        (_of_another_kind, "it is not a board"),
        (_of_a_newer_game, "a newer version of the game wrote it"),
    ],
)
def test_a_board_that_cannot_be_used_is_a_sentence(
    tmp_path: Path, spoil: Callable[[Path], None], reason: str
) -> None:
    ada = board_of(tmp_path, "ada")
    spoil(ada.file)
    with pytest.raises(InputError, match=f"The board .* can't be used: {reason}"):
        win(ada, "a", 7)


def test_a_locked_board_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ada = board_of(tmp_path, "ada")
    monkeypatch.setattr(board, "BUSY_SECONDS", 0.05)
    with contextlib.closing(sqlite3.connect(ada.file, isolation_level=None)) as connection:
        connection.execute("BEGIN IMMEDIATE")
        assert ada.standings(DIGEST) == []  # reading goes on
        with pytest.raises(InputError, match="another program is using it"):
            win(ada, "a", 7)


def test_the_file_is_for_whom_its_folder_is(tmp_path: Path) -> None:
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared").chmod(0o770)
    (tmp_path / "own").mkdir(0o700)
    modes = []
    for name in ("shared", "own"):
        players_board = board_of(tmp_path / name, "ada")
        modes.append(stat.S_IMODE(players_board.file.stat().st_mode))
        assert stat.S_IMODE(players_board.places[1].stat().st_mode) == 0o700
    assert modes == [0o660, 0o600]


_WRITE = """
import sys
from pathlib import Path
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardMembership

folder, *players = sys.argv[1:]
sys.stdin.read()  # all begin together
for player in players:
    board = Board(Path(folder), player)
    board.create()
    board.join(BoardMembership(True, player))
    for ticks in (30, 20, 10):
        board.add("level", "digest", "engine", f"{player} {ticks}", Measures(ticks, ticks, 1.0))
"""


def test_many_games_that_write_at_once_lose_nothing(tmp_path: Path) -> None:
    players = [f"player{number}" for number in range(60)]
    path = {**os.environ, "PYTHONPATH": str(Path(board.__file__).parents[2])}
    start, barrier = os.pipe()
    games = [
        subprocess.Popen(
            [sys.executable, "-c", _WRITE, str(tmp_path), *players[part::6]], stdin=start, env=path
        )
        for part in range(6)
    ]
    os.close(start)
    os.close(barrier)
    assert [game.wait(timeout=60) for game in games] == [0] * 6
    standings = Board(tmp_path).standings("digest")
    assert {(standing.name, standing.ticks) for standing in standings} == {
        (player, 10) for player in players
    }
