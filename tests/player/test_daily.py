"""Offering the labyrinth of a day, and the level to begin with."""

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


DAYS = [(TODAY + timedelta(days), size) for days in range(4) for size in DAILY_SIZES]
TOMORROW = len(DAILY_SIZES)
LATER = [
    *(pytest.param(*day, marks=pytest.mark.slow) for day in DAYS[1:TOMORROW]),
    *(pytest.param(*day, marks=pytest.mark.proof) for day in DAYS[TOMORROW:]),
]


@pytest.mark.parametrize(("day", "size"), [(TODAY, "small"), *LATER])
def test_our_program_wins_what_is_offered(day: date, size: DailySize, progress: Progress) -> None:
    level = daily_level(progress, day, size)
    assert level.name == Daily(day, size).name
    assert int(progress.fact(f"won {level.name}") or 0) > 100


NAME = "daily-2026-11-22-small"
WON = Played(900, 0.0)


def test_it_is_offered_once_won_even_where_solutions_are_hidden(
    progress: Progress, monkeypatch: pytest.MonkeyPatch
) -> None:
    results: list[Played] = []
    monkeypatch.setattr(source, "_hiding", [progress])
    monkeypatch.setattr(robustness, "play_through", lambda *_: results.pop(0))
    for won, played, offered in (
        ("", [WON], NAME),
        ("1234", [], NAME),  # what was shown once is not played again
        ("", [Played(None, 0.0), WON], f"{NAME}-2"),  # what is not won is not offered
    ):
        fresh = Progress(None)
        if won:
            fresh.set_fact(f"won {NAME}", won)
        results[:] = played
        assert daily_level(fresh, TODAY, "small").name == offered
        assert not results


def test_a_busy_machine_says_so(progress: Progress, monkeypatch: pytest.MonkeyPatch) -> None:
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

    own.write_text("walls = 5", encoding="utf-8")  # it can no longer be read
    assert level_to_begin_with(progress).name == "01-first-steps"
    own.unlink()
    assert level_to_begin_with(progress).name == "01-first-steps"
