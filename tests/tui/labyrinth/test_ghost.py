"""The ghost: the player's best run, or a replay, beside the present one."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.game.replay import gather
from logical_robots_tui.player.best_runs import BestRuns
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.ghost import GhostController
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from tests.player.test_best_runs import win
from tests.player.test_session import Table, table
from tests.short import AHEAD
from tests.tui.conftest import Opened, Size, opened

SLOWER = AHEAD.replace("0.5", "0.1")


@dataclass
class Race:
    at: Table
    best: BestRuns
    controller: GhostController
    view: LabyrinthView

    @property
    def length(self) -> int | None:
        return self.view.ghost.last if self.view.ghost else None

    async def win(self, text: str = AHEAD) -> int:
        await self.at.apply(text)
        return await win(self.at)

    async def toggle(self) -> str:
        await self.controller.toggle()
        return self.at.ui.said[-1]

    async def run_to(self, tick: int) -> None:
        self.at.session.run_until(tick)
        await self.at.until(lambda: not self.at.session.busy)

    async def choose(self, patch: pytest.MonkeyPatch) -> str:
        assert self.at.session.history is not None
        replay = await gather(self.at.session.history, write_native, lambda _: "mine")

        async def answer(_: object) -> object:
            return replay

        patch.setattr(self.at.ui, "ask", answer)
        await self.controller.choose()
        return self.at.ui.said[-1]


@asynccontextmanager
async def racing(tmp_path: Path) -> AsyncIterator[Race]:
    KEY_MAP.set(KeyMap(COMMANDS))
    async with table(tmp_path) as at:
        best, view = BestRuns(at.session, at.ui, tmp_path / "best-runs"), LabyrinthView()
        controller = GhostController(at.session, at.ui, view, best, tmp_path / "replays")
        at.session.listeners += [best, controller]
        yield Race(at, best, controller, view)


async def test_a_better_run_replaces_the_ghost_and_a_worse_one_does_not(tmp_path: Path) -> None:
    async with racing(tmp_path) as race:
        assert "Win this level; then" in await race.toggle()
        assert race.length is None
        slow = await race.win(SLOWER)
        assert f"your best run, {slow} ticks" in await race.toggle()
        quick = await race.win()
        assert race.length == quick < slow
        await race.win(SLOWER)
        assert race.length == quick
        assert "off" in await race.toggle()
        assert race.length is None
        assert f"your best run, {quick} ticks" in await race.toggle()
        level = replace(race.at.session.opened, name="another", source="another.toml")
        race.at.session.open_level(level, {"": race.at.session.source}, AHEAD)
        assert race.length is None


async def test_reaching_an_area_is_compared_once_a_run(tmp_path: Path) -> None:
    async with racing(tmp_path) as race:
        session, said = race.at.session, race.at.ui.said
        won = await race.win()
        await race.toggle()
        late = await race.win(SLOWER)
        words = f"Pip reached Door {late - won} ticks after your best run."
        assert said.count(words) == 1
        session.go_to(late - 1)
        for tick in (late, late + 1):
            await race.run_to(tick)
        assert said.count(words) == 1
        await race.win()
        assert said[-1] == "Pip reached Door in the same tick as your best run."


async def test_a_damaged_best_run_is_told_and_nothing_is_lost(tmp_path: Path) -> None:
    async with racing(tmp_path) as race:
        await race.win()
        path = race.best.path(race.at.session.opened)
        path.write_bytes(path.read_bytes()[:-1])
        assert "Your best run can't be read" in await race.toggle()
        won = await race.win()
        assert f"{won} ticks" in await race.toggle()
        assert len(list(path.parent.iterdir())) == 2


async def test_a_changed_level_has_no_ghost(tmp_path: Path) -> None:
    async with racing(tmp_path) as race:
        session = race.at.session
        won = await race.win()
        (pip,) = session.opened.robots
        changed = replace(session.opened, robots=(replace(pip, x=14),))
        session.open_level(changed, {"": session.source}, AHEAD)
        assert "this level has changed since" in await race.toggle()
        assert race.length is None
        await race.at.until(lambda: session.state.applied == AHEAD)
        assert await race.win() < won
        await race.toggle()
        assert race.length is not None
        assert race.length < won


async def test_an_honest_replay_is_raced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with racing(tmp_path) as race:
        await race.run_to(20)
        assert "the replay, 20 ticks" in await race.choose(monkeypatch)
        assert await race.win(SLOWER) > 20
        assert race.at.ui.said[-1] == "Pip reached Door, which the replay never did."
        await race.toggle()
        race.at.session.restart()
        await race.run_to(3)
        race.at.session.place_robot("Pip", (30.0, 12.0, 0.5))
        await race.run_to(5)
        assert "can't be raced against" in await race.choose(monkeypatch)
        assert race.length is None


def ghosts(game: Opened) -> list[int]:
    view = game.main.labyrinth.view
    signs = view.drawing.glyphs.ghosts
    return [column for row in view._cells.plain() for column, c in enumerate(row) if c in signs]


async def ghosts_at(game: Opened, tick: int) -> list[int]:
    await game.run_until(tick)
    await game.until(lambda: game.main.labyrinth.view._frame is game.session.frame)
    return ghosts(game)


@pytest.mark.parametrize("size", [pytest.param((80, 24), marks=pytest.mark.slow), (120, 40)])
async def test_a_ghost_is_drawn_at_the_tick_shown(data_dir: Path, short: Path, size: Size) -> None:
    async with opened(data_dir, level=short, text=AHEAD, size=size, ready=True) as game:
        game.session.run_until(1000)
        await game.sees("Again")
        await game.press("escape")
        await game.settled()
        won = game.tick
        await game.app.run_action("screen.command('save_replay')")
        await game.sees("bytes).")
        await game.apply(SLOWER)
        await game.press("escape", "r", "G", sees=f"ghost: {won} ticks")
        assert not ghosts(game)  # the robot stands there
        (halfway,) = await ghosts_at(game, won // 2)
        (there,) = await ghosts_at(game, won)
        assert there > halfway
        assert await ghosts_at(game, won + 5) == [there]
        game.session.go_to(won // 2)
        await game.until(lambda: ghosts(game) == [halfway])
        await game.press("G", sees="The ghost is off.", sees_no="ghost: ")
        assert not ghosts(game)
        await game.app.run_action("screen.command('race_replay')")
        await game.until(lambda: game.shows("Race a replay") and game.shows(f"{won} ticks"))
        await game.press("enter", sees=f"ghost: {won} ticks")
        await game.until(lambda: ghosts(game) == [halfway])
