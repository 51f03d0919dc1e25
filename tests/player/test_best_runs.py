"""The best run of each level, kept as a replay."""

import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from logical_robots_tui.confinement import WRITABLE
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.ghost import ghost_of
from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.player import best_runs
from logical_robots_tui.player.best_runs import BestRuns
from logical_robots_tui.world import load_level
from tests.player.test_session import FAST, Table, table
from tests.short import AHEAD


@asynccontextmanager
async def kept(tmp_path: Path) -> AsyncIterator[tuple[Table, BestRuns, list[str]]]:
    """Sit down at a level whose best runs are kept; the list grows with each."""
    async with table(tmp_path) as at:
        best, news = BestRuns(at.session, at.ui, tmp_path / "runs"), list[str]()
        best.kept = lambda: news.append("kept")
        at.session.listeners.append(best)
        await at.apply(AHEAD)
        yield at, best, news


async def win(at: Table) -> int:
    at.session.restart()
    tick = await at.win()
    await at.ui.done(but="measure")
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
            assert ghost.at(tick)[0] == pytest.approx((robot.x, robot.y, robot.angle))
        assert (ghost.at(slow + 9) == ghost.at(slow)).all()
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
        at.session.put("Pip", (20.0, 12.5, 0.0))
        await at.win()
        await at.ui.done(but="measure")
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
