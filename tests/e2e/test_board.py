"""The teacher at a terminal watches the class at work."""

from logical_robots_tui.progress.board import Board, timestamp
from tests.e2e.conftest import Player

LEVEL = "01-first-steps"


def test_a_class_is_watched_and_the_program_of_who_asks_for_help_is_read(player: Player) -> None:
    tmux, folder = player.tmux, player.folder / "board"
    ada, ben = Board(folder, "ada"), Board(folder, "ben")
    for board in (ada, ben):
        board.create()
        board.report(level=LEVEL, since=timestamp())
    tmux.start(player.command, "board", "watch", folder)
    screen = tmux.wait_for("2 at work", "ada", "ben")
    assert max(map(len, screen.splitlines())) <= 80
    ben.show_program("Robot([bold]) :- Help(\x1b[2J);")
    ben.report(help_since=timestamp(), trouble="Line 1: unexpected end")
    screen = tmux.wait_for("help   ben", "ada: 01-first-steps")  # who was chosen still is
    assert screen.index("help   ben") < screen.index("ada")
    assert "[bold]" not in screen
    tmux.press("Up", sees="Robot([bold]) :- Help(␛[2J);")
    tmux.resize(120, 30)
    tmux.wait_for("Line 1: unexpected end", "Robot([bold])")
    ada.report(is_open=False)
    tmux.wait_for("1 at work", "gone")
    tmux.press("q", sees_no="at work")
    tmux.wait_until(lambda _: not tmux.is_running, "it has ended")
