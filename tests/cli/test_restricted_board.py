"""What a restricted game can do to a board, and what not."""

import sys
from pathlib import Path

from tests.attempts import ATTEMPT
from tests.cli.test_restricted import finished

AT_THE_BOARD = (
    ATTEMPT
    + """\
import json, pathlib, sys
from logical_robots_tui.cli.play import restrict
from logical_robots_tui.game.source import load_program
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.progress.ladder import Ladder

folder, own = map(pathlib.Path, sys.argv[1:])
ben, ada = Board(folder, "ben"), Board(folder, "ada")
for board in ben, ada:
    board.create()
    board.join(BoardMembership(True))
    board.add("level", "digest", "engine", f"text of {board.player}", Measures(1, 1, 1.0))
restrict(own, ada.places)
attempt("win", lambda: ada.add("level", "digest", "engine", "other", Measures(0, 2, 1.0)))
attempt("standings", lambda: ada.standings("digest"))
attempt("hand in", lambda: Ladder(ada, "arena").hand_in("text"))
attempt("ask for help", lambda: ada.show_program("text"))
attempt("leave", lambda: ada.join(BoardMembership(False)))
entry = next(entry for entry in ada.entries() if entry.player == "ben")
attempt("read another's program", lambda: ada.program("ben", entry.program))
attempt("list another's programs", lambda: list(ben.places[1].iterdir()))
attempt("list the players", lambda: list(ben.places[1].parent.iterdir()))
attempt("write another's program", lambda: ben.show_program("mine"))
attempt("open a program of the board", lambda: load_program(ada.places[1] / "mine.l"))
attempt("write beside the board", lambda: (folder / "mine.l").write_text(""))
print(json.dumps(found))
"""
)


def test_a_restricted_game_uses_the_board_and_reaches_no_program_of_others(tmp_path: Path) -> None:
    own = tmp_path / "players" / "ada"
    found = finished([sys.executable, "-c", AT_THE_BOARD, tmp_path / "board", own]).data
    assert found == {
        **dict.fromkeys(("win", "standings", "hand in", "ask for help", "leave"), "done"),
        **dict.fromkeys(("read another's program", "write another's program"), "InputError"),
        **dict.fromkeys(("list another's programs", "list the players"), "PermissionError"),
        "open a program of the board": "InputError",
        "write beside the board": "PermissionError",
    }
