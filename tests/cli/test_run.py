"""``logical-robots run``: won, not won, in words and as JSON."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest

from tests.cli.running import in_terminal, shown

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command


def test_a_level_that_is_won_ends_with_status_0(command: Command, level: Path, ahead: Path) -> None:
    told = command("run", level, ahead, "--json")
    assert (told.status, told.err) == (0, "")
    assert told.data["won"] is True
    assert 0 < told.data["ticks"] < 100


def test_the_json_tells_where_the_robots_are_and_what_they_remember(
    command: Command, level: Path, ahead: Path
) -> None:
    data = command("run", level, ahead, "--json").data
    assert data["level"] == "short"
    assert data["program"] == str(ahead)
    (pip,) = data["robots"]
    assert (pip["name"], pip["memory"], pip["battery_level"]) == ("Pip", "on my way", None)
    assert abs(pip["x"] - 42) < 6
    assert data["goals"] == [{"area": "Door", "wanted": ["Pip"], "inside": ["Pip"]}]
    assert data["notices"] == {"count": 0, "kinds": {}, "first": []}
    assert data["reliable"] is True


def test_how_long_it_took_is_told_when_asked_for(
    command: Command, level: Path, ahead: Path
) -> None:
    data = command("run", level, ahead, "--times").data
    assert data["milliseconds_per_tick"] > data["think_milliseconds_per_tick"] > 0


def test_a_level_that_is_not_won_ends_with_status_1_after_the_given_ticks(
    command: Command, level: Path, still: Path
) -> None:
    told = command("run", level, still, "--ticks", 7, "--json")
    assert told.status == 1
    assert (told.data["won"], told.data["ticks"]) == (False, 7)


def test_the_output_is_json_whenever_nobody_is_looking(
    command: Command, level: Path, ahead: Path
) -> None:
    assert command("run", level, ahead).data["won"] is True


@pytest.mark.parametrize("what", ["run", "trace"])
def test_equal_runs_are_equal_bytes(what: str, command: Command, level: Path, ahead: Path) -> None:
    first, second = (command(what, level, ahead).out for _ in range(2))
    assert first == second


def test_notices_are_counted_and_the_first_ones_told(
    command: Command, level: Path, tmp_path: Path
) -> None:
    silent = tmp_path / "silent.l"
    silent.write_text(
        'Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") :-\n'
        '  Sensor(robot_name:), robot_name == "Nobody";\n'
    )
    notices = command("run", level, silent, "--ticks", 30).data["notices"]
    assert notices["count"] == 30
    assert notices["kinds"] == {"no row": 30}
    assert [notice["tick"] for notice in notices["first"]] == list(range(1, 11))


def test_memories_that_json_has_no_word_for_become_null(
    command: Command, level: Path, tmp_path: Path
) -> None:
    huge = tmp_path / "huge.l"
    huge.write_text(
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 1e308 * 10) :-\n"
        "  Sensor(robot_name:);\n"
    )
    told = command("run", level, huge, "--ticks", 2)
    assert told.data["robots"][0]["memory"] is None


def test_a_program_saved_in_the_game_is_found_by_its_name(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    own = tmp_path / "data" / "programs"
    own.mkdir(parents=True)
    ahead.rename(own / "mine.l")
    assert command("run", level, "mine", "--data-dir", tmp_path / "data").status == 0


def test_on_a_terminal_the_outcome_is_told_in_words(level: Path, ahead: Path) -> None:
    told = shown("run", level, ahead)
    assert told.status == 0
    assert "A short way: won at tick" in told.text
    assert "Pip" in told.text
    assert "ticks/s" in told.text


def test_in_words_a_level_not_won_says_who_is_missing(level: Path, still: Path) -> None:
    told = shown("run", level, still, "--ticks", 5)
    assert told.status == 1
    assert "not won within 5 ticks. Door is still missing Pip." in told.text


def test_json_can_be_had_on_a_terminal_too(level: Path, ahead: Path) -> None:
    told = shown("run", level, ahead, "--json")
    assert '"won": true' in told.text
    assert "won at tick" not in told.text


def test_what_a_level_says_is_not_read_as_markup(level: Path, ahead: Path) -> None:
    level.write_text(level.read_text().replace("A short way", "[/red] [bold]no[/bold]"))
    told = shown("run", level, ahead)
    assert told.status == 0
    assert "[/red] [bold]no[/bold]: won" in told.text


def test_a_bar_shows_the_progress_until_control_c_ends_the_run_without_a_word_of_python(
    level: Path, still: Path
) -> None:
    with in_terminal("run", level, still, "--ticks", 10**9) as terminal:
        terminal.wait_for("ticks/s")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.finish() == 130
    assert "of 1000000000" in terminal.everything
    assert "of 1000000000" not in terminal.text
    assert "Traceback" not in terminal.everything
