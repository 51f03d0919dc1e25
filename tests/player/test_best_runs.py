"""The best run of each level as a replay; the labyrinth of a day, and the level to begin with."""

import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from datetime import date, timedelta
from pathlib import Path

import pytest

from logical_robots_tui.confinement import WRITABLE
from logical_robots_tui.errors import InputError
from logical_robots_tui.game import level_key, source
from logical_robots_tui.game import measuring as robustness
from logical_robots_tui.game.ghost import ghost_of
from logical_robots_tui.game.measuring import LateError, Played
from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.player import best_runs
from logical_robots_tui.player.best_runs import BestRuns
from logical_robots_tui.player.library import daily_level
from logical_robots_tui.player.opening import initial_level
from logical_robots_tui.player.recorder import LAST_LEVEL
from logical_robots_tui.progress import Progress
from logical_robots_tui.world import load_level
from logical_robots_tui.world.levels.labyrinths import DAILY_SIZES, Daily, DailySize
from tests.player.test_session import FAST, Table, table
from tests.short import AHEAD, LEVEL


@asynccontextmanager
async def kept(tmp_path: Path) -> AsyncIterator[tuple[Table, BestRuns, list[str]]]:
    async with table(tmp_path) as at:
        best, news = BestRuns(at.session, at.ui, tmp_path / "runs"), list[str]()
        best.on_kept = lambda: news.append("kept")
        at.session.listeners.append(best)
        await at.apply(AHEAD)
        yield at, best, news


async def win(at: Table) -> int:
    at.session.restart()
    tick = await at.win()
    await at.ui.drain(skip="measure")
    return tick


async def test_the_fastest_win_is_kept_with_where_the_robots_were(tmp_path: Path) -> None:
    async with kept(tmp_path) as (at, best, news):
        slow = await win(at)
        level = at.session.opened
        path = best.path(level)
        assert path.suffix in WRITABLE
        replay = load_replay(path)
        assert replay.last == slow
        with pytest.raises(InputError, match="another level"):
            ghost_of(replay, load_level("01-first-steps"), "best run")
        ghost = ghost_of(replay, level, "best run")
        assert (ghost.last, dict(ghost.arrivals)) == (slow, {0: slow})
        for tick in range(slow + 1):
            at.session.go_to(tick)
            (robot,) = at.session.frame.after.robots
            assert ghost.poses_at(tick)[0] == pytest.approx((robot.x, robot.y, robot.angle))
        assert (ghost.poses_at(slow + 9) == ghost.poses_at(slow)).all()
        await at.apply(FAST)
        quick = await win(at)
        assert load_replay(path).last == quick < slow
        await at.apply(AHEAD)
        await win(at)
        assert load_replay(path).last == quick
        assert news == ["kept", "kept"]


async def test_a_win_by_hand_is_not_kept(tmp_path: Path) -> None:
    async with kept(tmp_path) as (at, best, news):
        at.session.step()
        await at.until(lambda: at.session.frame.tick == 1 and not at.session.busy)
        at.session.place_robot("Pip", (20.0, 12.5, 0.0))
        await at.win()
        await at.ui.drain(skip="measure")
        assert not news
        assert not best.path(at.session.opened).exists()


async def test_the_runs_are_bounded_and_what_is_too_large_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with kept(tmp_path) as (at, best, _):
        await win(at)
        path = best.path(at.session.opened)
        others = [path.with_name(f"other-{n}.replay") for n in range(4)]
        for age, other in enumerate(others):
            other.touch()
            os.utime(other, (age, age))
        monkeypatch.setattr(best_runs, "MOST_RUNS", 3)
        await at.apply(FAST)
        await win(at)
        assert {*path.parent.iterdir()} == {path, *others[2:]}
        monkeypatch.setattr(best_runs, "MOST_BYTES", 10)
        path.unlink()
        await win(at)
        assert not path.exists()
        assert any("can't be kept to race against: It takes" in said for said in at.ui.said)


async def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "runs").touch()
    async with kept(tmp_path) as (at, _, news):
        await win(at)
        assert not news
        assert any("can't be kept to race against" in said for said in at.ui.said)


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
    assert initial_level(progress).name == "01-first-steps"
    own = tmp_path / "own.toml"
    own.write_text(LEVEL, encoding="utf-8")
    for name in ("03-the-long-hall", "daily-2026-11-22-small", str(own)):
        progress.set_fact(LAST_LEVEL, level_key(load_level(name)))
        assert initial_level(progress).name == load_level(name).name

    own.write_text("walls = 5", encoding="utf-8")  # it can no longer be read
    assert initial_level(progress).name == "01-first-steps"
    own.unlink()
    assert initial_level(progress).name == "01-first-steps"
