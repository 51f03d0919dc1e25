"""What a game writes on the board: victories, and in a class what the player does."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.run import level_digest
from logical_robots_tui.game.source import load_program
from logical_robots_tui.player.board import BoardRecorder
from logical_robots_tui.progress.board import Activity, Board, BoardMembership
from logical_robots_tui.world import load_level
from tests.player.test_best_runs import win
from tests.player.test_session import Table, table
from tests.short import AHEAD

LEVEL = "01-first-steps"
LISTED = BoardMembership(is_listed=True, name="Ada", shares=True)


@asynccontextmanager
async def listed(
    tmp_path: Path, folder: Path | None, *, is_class: bool = False
) -> AsyncIterator[tuple[Table, BoardRecorder]]:
    async with table(tmp_path) as at:
        board = None if folder is None else Board(folder, "ada")
        if board is not None:
            board.create()
        session, recorder = at.session, at.recorder
        listener = BoardRecorder(board, session, at.ui, recorder, lambda: None, is_class=is_class)
        session.listeners.append(listener)
        source = load_program("first-steps")
        session.open_level(load_level(LEVEL), {"": source}, source.text)
        await at.apply(f"{source.text}\n# mine\n")
        yield at, listener
        await listener.close()


async def test_the_first_victory_waits_until_a_name_is_chosen(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        tick = await win(at)
        assert listener.must_ask
        assert Board(folder).entries() == []
        await listener.join(LISTED)
        assert not listener.must_ask
        (standing,) = listener.standings
        assert (standing.name, standing.is_me, standing.ticks) == ("Ada", True, tick)
        await win(at)
        assert not listener.must_ask
        assert await listener.ghosts() == []  # one's own runs are raced otherwise
        (entry,) = Board(folder).ghosts(level_digest(load_level(LEVEL)))
        assert (entry.name, entry.ticks) == ("Ada", tick)
        replay = await listener.ghost(entry)
        assert (replay.last, replay.has_programs) == (tick, False)


async def test_victories_in_several_levels_wait_for_a_name(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        await win(at)
        source = load_program("open-space")
        at.session.open_level(load_level("02-open-space"), {"": source}, source.text)
        await at.apply(f"{source.text}\n# mine\n")
        await win(at)
        await listener.join(LISTED)
        assert [entry.level for entry in Board(folder).entries()] == [LEVEL, "02-open-space"]


async def test_whoever_stays_off_the_board_is_not_asked_again(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        await win(at)
        await listener.join(BoardMembership(is_listed=False))
        await win(at)
        assert not listener.must_ask
        assert Board(folder).entries() == []


async def test_a_victory_is_entered_before_its_run_and_never_on_the_event_loop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, ghosts, add = tmp_path / "board", list[bool](), Board.add

    def watched_add(board: Board, *entry: Any) -> None:
        assert threading.current_thread() is not threading.main_thread()
        ghosts.append(entry[-1] is not None)
        add(board, *entry)

    monkeypatch.setattr(Board, "add", watched_add)
    async with listed(tmp_path, folder) as (at, listener):
        await listener.join(LISTED)
        await win(at)
        assert ghosts == [False, True]
        await listener.join(LISTED._replace(shares=False))
        await win(at)
        assert ghosts == [False, True, False]
        assert len(Board(folder).entries()) == 1


async def test_standings_are_empty_before_a_victory(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        await win(at)
        await listener.join(LISTED)
    (tmp_path / "ben").mkdir()
    async with listed(tmp_path / "ben", folder) as (at, listener):
        await at.ui.drain(skip="measure")
        assert listener.standings == ()
        await win(at)
        assert len(listener.standings) == 1


async def test_a_reference_program_is_not_entered(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        await at.apply(load_program("first-steps").text)
        await win(at)
        assert not listener.must_ask


async def test_a_board_that_fails_is_told_once_and_the_game_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, listener):
        await win(at)
        await listener.join(LISTED)
        Board(folder).file.write_bytes(b"damaged" * 1000)
        await win(at)
        await win(at)
        warnings = [message for message in at.ui.said if "The board" in message]
        assert len(warnings) == 1
        assert warnings[0].endswith("it is damaged. The game goes on without it.")
        assert at.recorder.record.state == "won"


async def test_without_a_board_nothing_is_asked_or_told(tmp_path: Path) -> None:
    async with listed(tmp_path, None, is_class=True) as (at, listener):
        await win(at)
        assert not listener.must_ask
        assert await listener.standings_of(at.session.opened) == ()
        with pytest.raises(InputError, match="There is no board"):
            await listener.ghosts()


def activity_in(folder: Path) -> Activity:
    (activity,) = Board(folder).activities()
    return activity


async def test_a_class_sees_levels_runs_victories_and_trouble(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder, is_class=True) as (at, _):
        await win(at)
        activity = activity_in(folder)
        assert (activity.player, activity.level, activity.won_level) == ("ada", LEVEL, LEVEL)
        assert (activity.runs, activity.is_open, activity.trouble) == (0, True, "")
        at.session.apply("Robot(")
        at.session.run()
        await at.until(lambda: at.session.state.phase == "mistake")
        await at.until(lambda: activity_in(folder).trouble.startswith("Line 1: "))
    assert not activity_in(folder).is_open


async def test_a_program_is_shown_to_whom_help_was_asked_of(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder, is_class=True) as (at, listener):
        await at.until(lambda: Board(folder).activities())
        await listener.ask_for_help("my text")
        await at.until(lambda: activity_in(folder).help_since)
        assert Board(folder).shown_program("ada") == "my text"
        at.session.apply("Robot(")
        at.session.run()
        await at.until(lambda: at.session.state.phase == "mistake")
        await at.ui.drain(skip="measure")
        assert Board(folder).shown_program("ada") == "Robot("
        await at.apply(AHEAD)
        await at.until(lambda: Board(folder).shown_program("ada") == AHEAD)
        await listener.ask_for_help("my text")
        await at.until(lambda: not activity_in(folder).help_since)
        assert Board(folder).shown_program("ada") is None


async def test_a_game_in_which_nothing_happens_reports_that_it_is_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "board"
    monkeypatch.setattr("logical_robots_tui.player.board._HEARTBEAT", 0.01)
    async with listed(tmp_path, folder, is_class=True) as (at, _):
        await at.ui.drain(skip="measure")
        Board(folder, "ada").report(last_seen="long ago")
        await at.until(lambda: activity_in(folder).is_open)


async def test_a_game_that_was_killed_no_longer_asks_for_help(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    before = Board(folder, "ada")
    before.create()
    before.report(help_since="2026-11-28T10:00:00+00:00")
    async with listed(tmp_path, folder, is_class=True) as (at, _):
        await at.ui.drain(skip="measure")
        assert not activity_in(folder).asks_for_help


async def test_a_program_of_a_game_that_was_killed_is_no_longer_shown(tmp_path: Path) -> None:
    board = Board(tmp_path / "board", "ada")
    board.create()
    board.show_program("my text")
    board.report(help_since="2026-01-01T00:00:00+00:00")
    async with listed(tmp_path, tmp_path / "board", is_class=True) as (at, _):
        await at.ui.drain(skip="measure")
        assert board.shown_program("ada") is None
        assert not activity_in(tmp_path / "board").help_since


async def test_outside_a_class_nobody_is_watched(tmp_path: Path) -> None:
    folder = tmp_path / "board"
    async with listed(tmp_path, folder) as (at, _):
        await win(at)
    assert Board(folder).activities() == []
