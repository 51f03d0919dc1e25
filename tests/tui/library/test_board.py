"""The board on the screen: joining it, the histogram, racing others, and asking for help."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from logical_robots_tui.game.run import level_digest
from logical_robots_tui.game.source import load_program
from logical_robots_tui.player.board import NOTICE
from logical_robots_tui.player.opening import Opening
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.tui.commands.keymap import commands
from logical_robots_tui.tui.labyrinth.results import ResultsDialog
from logical_robots_tui.tui.library.board import GhostPicker, JoinDialog
from logical_robots_tui.world import load_level
from tests.tui.conftest import Opened, showing
from tests.virtual_time import VirtualClock

LEVEL = "01-first-steps"


def board_of(folder: Path, player: str) -> Board:
    board = Board(folder, player)
    board.create()
    return board


@asynccontextmanager
async def seated(
    data_dir: Path, board: Board | None, *, is_class: bool = False, size: tuple[int, int] = (80, 24)
) -> AsyncIterator[Opened]:
    source = load_program("first-steps")
    text = f"{source.text}\n# mine\n"
    opening = Opening(
        load_level(LEVEL), {"": source}, data_dir, text=text, clock=VirtualClock(), board=board
    )
    async with showing(opening._replace(is_class=is_class), size) as game:
        yield game


async def win(game: Opened) -> None:
    await game.until(lambda: game.session.state.phase == "applied")
    game.session.restart()
    game.session.run_until(10_000)
    await game.until(lambda: isinstance(game.app.screen, ResultsDialog))
    await game.sees("Again")


async def test_after_the_first_victory_a_name_is_asked_for_and_the_histogram_is_shown(
    data_dir: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "board"
    ben = board_of(folder, "ben")
    ben.join(BoardMembership(is_listed=True, name="[b]Ben"))
    ben.add(LEVEL, level_digest(load_level(LEVEL)), "engine", "text", Measures(9, 9, 9.0))
    async with seated(data_dir, board_of(folder, "ada")) as game:
        await win(game)
        assert not game.shows("[b]Ben")
        await game.press("escape")
        await game.until(lambda: isinstance(game.app.screen, JoinDialog))
        await game.sees("others may race my best run")
        await game.fill("[B]ben")
        await game.press("enter", sees="Another player is called [B]ben. Choose another one.")
        await game.fill("  Ada ")
        await game.press("ctrl+g", sees="☑")
        await game.press("enter")
        await game.until(lambda: len(game.main.player.board.standings) == 2)
        assert ben.ghosts(level_digest(load_level(LEVEL)))[0].name == "Ada"
        await game.press("m")
        await game.sees("2 of 2")
        await game.sees("best 9 [b]Ben")
        await game.press("escape", "l")
        await game.sees("best 9 [b]Ben")


async def test_whoever_stays_off_is_not_asked_again_and_may_change_that(
    data_dir: Path, tmp_path: Path
) -> None:
    board = board_of(tmp_path / "board", "ada")
    async with seated(data_dir, board) as game:
        await win(game)
        await game.press("escape")
        await game.until(lambda: isinstance(game.app.screen, JoinDialog))
        await game.press("ctrl+n", sees="You are not on the board.")
        await win(game)
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        await game.command("board")
        await game.until(lambda: isinstance(game.app.screen, JoinDialog))
        await game.press("enter")
        await game.until(lambda: board.membership() == BoardMembership(is_listed=True))


async def test_the_run_of_another_player_is_raced_against(data_dir: Path, tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with seated(data_dir / "ben", board_of(folder, "ben")) as game:
        await win(game)
        await game.press("escape")
        await game.until(lambda: isinstance(game.app.screen, JoinDialog))
        await game.press("ctrl+g", "enter")
        await game.until(lambda: game.main.player.board.standings)
    async with seated(data_dir / "ada", board_of(folder, "ada")) as game:
        await game.command("race_player")
        await game.sees("Win First steps first")
        await win(game)
        await game.press("escape")
        await game.until(lambda: isinstance(game.app.screen, JoinDialog))
        await game.press("escape")
        await game.command("race_player")
        await game.until(lambda: isinstance(game.app.screen, GhostPicker))
        await game.press("enter", sees="the robots of the run of anonymous")
        assert game.main.labyrinth.view.ghost is not None


async def test_a_class_is_told_what_is_seen_and_may_ask_for_help(
    data_dir: Path, tmp_path: Path
) -> None:
    board = board_of(tmp_path / "board", "ada")
    async with seated(data_dir, board, is_class=True, size=(120, 40)) as game:
        await game.sees("In this class the teacher sees which level you play")
        assert NOTICE.endswith("only while you ask for help.")
        await game.press("escape")
        await game.command("ask_help")
        await game.sees("The teacher sees that you need help")
        assert board.shown_program("ada") == game.editor.text
        await game.command("ask_help")
        await game.sees("You no longer ask for help.")
        assert board.shown_program("ada") is None


@pytest.mark.parametrize(("has_board", "is_class"), [(False, False), (True, False), (True, True)])
async def test_the_palette_has_what_there_is_to_be_used(
    data_dir: Path, tmp_path: Path, *, has_board: bool, is_class: bool
) -> None:
    board = board_of(tmp_path / "board", "ada") if has_board else None
    async with seated(data_dir, board, is_class=is_class):
        available = {entry.id for entry in commands("screen")}
        assert ("board" in available, "race_player" in available) == (has_board, has_board)
        assert ("ask_help" in available) == is_class


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("board", "There is no board"),
        ("race_player", "There is no board"),
        ("ask_help", "Nobody watches this game"),
    ],
)
async def test_without_a_board_or_a_class_its_commands_say_so(
    data_dir: Path, name: str, message: str
) -> None:
    async with seated(data_dir, None) as game:
        await game.command(name)
        await game.sees(message)
