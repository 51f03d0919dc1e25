"""The board of a server: shown, checked, and a class at work watched."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from logical_robots_tui.game import load_program
from logical_robots_tui.game.run import level_digest, simulation_digest
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import GONE_AFTER, Board, BoardMembership, timestamp
from logical_robots_tui.progress.class_view import pupils
from logical_robots_tui.world import load_level
from tests.cli.running import Command
from tests.cli.test_progress import LEVEL, achieved
from tests.terminal import hear_signals
from tests.waiting import PATIENCE

ENGINE = simulation_digest().hex()
TEXT = load_program("first-steps").text.replace("distance < 90", "distance < 80")


def player(folder: Path, login: str, name: str | None = None) -> Board:
    board = Board(folder, login)
    board.create()
    board.join(BoardMembership(is_listed=True, name=name))
    return board


def add(board: Board, text: str, measures: Measures, level: str = LEVEL) -> None:
    board.add(level, level_digest(load_level(level)), ENGINE, text, measures)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The board of Ada, who has won the first level in two ways, and Ben, who is anonymous."""
    folder = tmp_path / "board"
    ada, ben = player(folder, "ada", "Ada"), player(folder, "ben")
    add(ada, "fast", Measures(200, 50, 700.5))
    add(ada, "short", Measures(300, 20, 900.0))
    add(ben, "tie", Measures(200, 40, 800.0))
    ben.add(LEVEL, "an earlier version", ENGINE, "old", Measures(5, 1, 1.0))
    return folder


def rows_of(text: str) -> list[list[str]]:
    return [line.split() for line in text.splitlines()]


def test_each_level_has_a_table_and_earlier_versions_stand_apart(
    command: Command, folder: Path
) -> None:
    title, _, *rows, _, earlier, _, old = rows_of(command("board", "show", folder).success)
    assert title == [LEVEL]
    assert [row[:3] for row in rows] == [
        ["1", "Ada", "200"],
        ["1", "anonymous", "200"],
        ["Ada", "300", "20"],  # only the fastest entry of a player has a rank
    ]
    assert all(row[-1] == "unchecked" for row in rows)
    assert earlier[1:] == ["an", "earlier", "version", "of", "the", "level"]
    assert old[:3] == ["1", "anonymous", "5"]


def test_the_board_is_exported(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    player(folder, "eve", "=evil()")
    add(Board(folder, "eve"), "e", Measures(900, 60, 900.0))
    monkeypatch.setenv("LOGICAL_ROBOTS_BOARD", str(folder))
    rows = list(csv.DictReader(io.StringIO(command("board", "show", "--csv").success)))
    assert [row["name"] for row in rows] == ["Ada", "", "Ada", "'=evil()", ""]
    first, *_, last = command("board", "show", "--json", "--level", "1").data
    assert (first["rank"], first["name"], first["ticks"]) == (1, "Ada", 200)
    assert (last["is_current"], last["name"]) == (False, None)
    assert command("board", "show", "--json", "--level", "2").data == []


def test_names_of_players_send_no_control_characters(command: Command, folder: Path) -> None:
    add(player(folder, "eve", "\x1b[2Jeve"), "e", Measures(900, 60, 900.0))
    assert r"\x1b[2Jeve" in command("board", "show", folder).success


def test_what_holds_is_confirmed_and_the_rest_is_struck_out(
    command: Command, tmp_path: Path
) -> None:
    ada, ben = player(tmp_path, "ada", "Ada"), player(tmp_path, "ben", "Ben")
    measures = achieved(LEVEL, TEXT)
    add(ada, TEXT, measures)
    add(ben, f"{TEXT}\n# mine", measures._replace(ticks=3))
    add(player(tmp_path, "cat", "Cat"), "Robot(", measures)
    dan = player(tmp_path, "dan", "Dan")
    add(dan, "changed", measures)
    for path in dan.places[1].iterdir():
        path.write_text("other")
    dan.add(LEVEL, "an earlier version", ENGINE, TEXT, measures)
    results = command("board", "check", tmp_path, "--json", status=1).data["results"]
    verdicts = {(result["name"], result["verdict"]): result["reason"] for result in results}
    assert verdicts == {
        ("Ada", "confirmed"): "",
        ("Ben", "struck"): f"ticks: 3 claimed, {measures.ticks:,} found",
        ("Cat", "struck"): verdicts["Cat", "struck"],
        ("Dan", "struck"): "The program is missing, or was changed",
        ("Dan", "earlier version"): verdicts["Dan", "earlier version"],
    }
    assert verdicts["Cat", "struck"].startswith("line 1: ")
    assert "it can't be played again" in verdicts["Dan", "earlier version"]
    shown = command("board", "show", tmp_path).success
    assert f"{LEVEL}, an earlier version" in shown
    assert "struck: ticks: 3 claimed" in shown
    assert shown.splitlines()[2].endswith("confirmed")
    assert "1 earlier version" in command("board", "check", tmp_path, status=0).out


def test_an_entry_without_time_to_play_it_stays_as_it_is(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("logical_robots_tui.game.verification.FileBudget.remaining", 0.0)
    told = command("board", "check", folder, "--seconds", "1", status=1)
    assert "undecided: given up after 1 processor second" in told.out
    assert all(entry.confirmed is None for entry in Board(folder).entries())


def test_an_interrupted_check_keeps_what_was_decided(
    command: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcomes = iter([Measures(200, 50, 700.5)])

    async def play(*_: object, **__: object) -> Measures:
        for outcome in outcomes:
            return outcome
        raise KeyboardInterrupt

    monkeypatch.setattr("logical_robots_tui.cli.board.play_again", play)
    assert command("board", "check", folder).status == 130
    assert [entry.confirmed == ENGINE for entry in Board(folder).entries()].count(True) == 1


def damage(folder: Path) -> None:
    Board(folder).file.write_bytes(b"damaged" * 1000)


def take_away(folder: Path) -> None:
    Board(folder).file.unlink()


@contextlib.contextmanager
def watching(folder: Path, option: str) -> Iterator[Callable[[], str]]:
    """The lines of a class at work, as they are printed."""
    words = ["-m", "logical_robots_tui", "board", "watch", str(folder), option]
    with subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.PIPE, text=True, preexec_fn=hear_signals
    ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0
        finally:
            process.kill()


def test_a_class_at_work_is_lines_of_json_and_who_asks_for_help_is_first(folder: Path) -> None:
    ada, ben = Board(folder, "ada"), Board(folder, "ben")
    ada.report(level=LEVEL, since=timestamp(), runs=2, trouble="Pip: No rows.")
    ben.report(level=LEVEL, help_since=timestamp())
    ben.show_program("my program")
    ada.show_program("nobody's business")  # without asking for help
    with watching(folder, "--json") as line:
        first, second = json.loads(line()), json.loads(line())
        assert (first["player"], first["program"]) == ("ben", "my program")
        assert first["asks_for_help"]
        assert (second["player"], second["runs"], second["trouble"]) == ("ada", 2, "Pip: No rows.")
        assert second["program"] is None
        ben.report()  # that the game is still open is no change
        ada.report(won_level=LEVEL, won=timestamp(), runs=0)
        third = json.loads(line())
        assert (third["player"], third["won_level"], third["runs"]) == ("ada", LEVEL, 0)


def test_a_class_at_work_is_a_table_and_then_lines_of_text(folder: Path) -> None:
    ada = Board(folder, "ada")
    ada.report(level="02-open-space", since=timestamp(), trouble="\x1b[2J")
    with watching(folder, "--plain") as line:
        assert line().split() == [
            "STATE",
            "PLAYER",
            "LEVEL",
            "SINCE",
            "RUNS",
            "LAST",
            "WIN",
            "TROUBLE",
        ]
        assert line().split()[:2] == ["ada", "02-open-space"]
        ada.show_program("first line\nsecond\x1b line")
        ada.report(help_since=timestamp())
        assert re.fullmatch(
            r"\d\d:\d\d ada: 02-open-space since .*, asks for help since .*\n", line()
        )
        assert (line(), line()) == ("  first line\n", "  second\\x1b line\n")
        ada.report(is_open=False)
        assert "gone since" in line()


def test_a_game_that_ended_without_a_word_is_gone_and_its_program_hidden(folder: Path) -> None:
    ada = Board(folder, "ada")
    ada.show_program("text")
    ada.report(level=LEVEL, help_since=timestamp(), last_seen=timestamp(-2 * GONE_AFTER))
    (pupil,) = pupils(ada)
    assert (pupil.cells()[0], pupil.program) == ("gone", None)


@pytest.mark.parametrize("words", ["show", "check", "watch --plain", "watch --json"])
@pytest.mark.parametrize("spoil", [damage, take_away])
def test_a_board_that_cannot_be_used_is_a_sentence(
    words: str, spoil: Callable[[Path], None], command: Command, folder: Path
) -> None:
    spoil(folder)
    name, *options = words.split()
    refusal = command("board", name, folder, *options).refusal
    reason = "it is damaged" if spoil is damage else "it is missing"
    assert refusal == f"logical-robots: The board {Board(folder).file} can't be used: {reason}\n"


def test_without_a_folder_it_asks_for_one(command: Command) -> None:
    assert "set LOGICAL_ROBOTS_BOARD" in command("board", "show").refusal
