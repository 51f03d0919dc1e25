"""Offering the labyrinth of a day, and the level to begin with."""

from __future__ import annotations

from datetime import date, timedelta
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import measuring as robustness
from logical_robots_tui.game import source
from logical_robots_tui.game.measuring import LateError, Played
from logical_robots_tui.player.library import daily_level
from logical_robots_tui.player.opening import level_to_begin_with
from logical_robots_tui.player.recorder import note_level
from logical_robots_tui.progress import Progress
from logical_robots_tui.world import load_level
from logical_robots_tui.world.levels.labyrinths import DAILY_SIZES, Daily, DailySize
from tests.short import LEVEL

TODAY = date(2026, 11, 22)


@pytest.fixture
def progress() -> Progress:
    return Progress(None)


@pytest.mark.parametrize(
    ("day", "size"),
    [
        pytest.param(
            TODAY + timedelta(days), size, marks=[pytest.mark.slow] * (days > 0 or size != "small")
        )
        for days in range(4)
        for size in DAILY_SIZES
    ],
)
def test_our_program_wins_what_is_offered(day: date, size: DailySize, progress: Progress) -> None:
    level = daily_level(progress, day, size)
    assert level.name == Daily(day, size).name
    assert int(progress.fact(f"won {level.name}") or 0) > 100


def test_it_is_offered_where_solutions_are_hidden(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(source, "_hiding", [progress])
    monkeypatch.setattr(robustness, "play_through", lambda *_: Played(900, 0.0))
    assert daily_level(progress, TODAY, "small").name == "daily-2026-11-22-small"


def test_what_was_shown_once_is_not_shown_again(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    progress.set_fact("won daily-2026-11-22-small", "1234")
    monkeypatch.delattr(robustness, "play_through")
    monkeypatch.setattr(robustness, "play_through", None, raising=False)
    assert daily_level(progress, TODAY, "small").name == "daily-2026-11-22-small"


def test_a_labyrinth_that_is_not_won_is_not_offered(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = iter([Played(None, 0.0), Played(900, 0.0)])
    monkeypatch.setattr(robustness, "play_through", lambda *_: next(results))
    assert daily_level(progress, TODAY, "small").name == "daily-2026-11-22-small-2"


def test_a_machine_that_is_too_busy_says_so(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(*_: object) -> Played:
        raise LateError

    monkeypatch.setattr(robustness, "play_through", late)
    with pytest.raises(InputError, match="too busy"):
        daily_level(progress, TODAY, "small")


def test_the_level_played_last_is_the_one_to_begin_with(progress: Progress, tmp_path: Path) -> None:
    assert level_to_begin_with(progress).name == "01-first-steps"
    own = tmp_path / "own.toml"
    own.write_text(LEVEL, encoding="utf-8")
    for name in ("03-the-long-hall", "daily-2026-11-22-small", str(own)):
        note_level(progress, load_level(name))
        assert level_to_begin_with(progress).name == load_level(name).name


@pytest.mark.parametrize("text", [None, "walls = 5"])
def test_a_level_that_can_no_longer_be_read_is_not(
    text: str | None, progress: Progress, tmp_path: Path
) -> None:
    own = tmp_path / "own.toml"
    own.write_text(LEVEL, encoding="utf-8")
    note_level(progress, load_level(own))
    own.unlink() if text is None else own.write_text(text, encoding="utf-8")
    assert level_to_begin_with(progress).name == "01-first-steps"
