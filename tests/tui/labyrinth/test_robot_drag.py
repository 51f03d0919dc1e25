"""Pointing at robots with the mouse, dragging and turning them while the game is played."""

import math
from pathlib import Path

import pytest
from textual import events

from logical_robots_tui.world import RobotState
from tests.short import AHEAD
from tests.tui.conftest import STILL, cell_of, opened


async def test_a_robot_is_dragged_and_turned_while_it_runs(data_dir: Path, room_file: Path) -> None:
    async with opened(data_dir, level=room_file, text=STILL, ready=True) as game:
        view = game.main.labyrinth.view

        def robot() -> RobotState:
            return game.session.frame.after.robots[0]

        await game.press("space", until=lambda: game.tick > 2)
        before = view.view
        await game.drag((40, 50), (90, 60), (150, 60))
        await game.until(lambda: robot().x > 140 and view.robot_at(*cell_of(view, (150, 60))))
        assert game.session.running
        assert not game.main.editing.is_on
        assert view.view == before
        assert abs(robot().y - 60) < 8
        x = robot().x
        await game.drag((150, 60), (150, 80), button=3)
        await game.until(lambda: robot().angle > 1)
        assert robot().angle == pytest.approx(math.pi / 2, abs=0.4)
        assert (robot().x, game.session.level.robots[0].x) == (x, 40)
        await game.press("space", until=lambda: not game.session.running)
        await game.press("r", tick=0)
        assert robot().x == 40

        # Empty ground, and a setting, drag the map.
        view.zoom(2, (40, 50))
        before = view.view
        await game.drag((80, 60), (70, 60))
        await game.until(lambda: view.view != before)
        assert robot().x == 40
        game.app.change_setting("drag_robots", False)
        before = view.view
        await game.drag((40, 50), (60, 50))
        await game.until(lambda: view.view != before)
        assert robot().x == 40


async def test_a_robot_pointed_at_shows_its_card(data_dir: Path, room_file: Path) -> None:
    async with opened(data_dir, level=room_file, text=AHEAD, ready=True) as game:
        await game.press("n", tick=1)
        view, card = game.main.labyrinth.view, game.main.labyrinth.card
        assert not card.display
        x = game.session.frame.after.robots[0].x
        await game.mouse(events.MouseMove, (x, 50))
        await game.until(lambda: card.display and game.shows("engines"))
        await game.sees("battery")
        assert view.selected is None
        await game.mouse(events.MouseMove, (150, 80))
        await game.until(lambda: not card.display)
        await game.mouse(events.MouseMove, (x, 50))
        await game.until(lambda: card.display)
        await game.press("M", until=lambda: view.overlay is not None)
        assert view.pointed is not None
        assert not card.display
        await game.mouse(events.MouseMove, (150, 80))
        await game.until(lambda: view.pointed is None)


@pytest.mark.parametrize("ticks", [pytest.param(0, marks=pytest.mark.slow), 1])
async def test_with_a_drag_no_victory_counts(data_dir: Path, room_file: Path, ticks: int) -> None:
    async with opened(data_dir, level=room_file, text=AHEAD, ready=True) as game:
        await game.press(*["n"] * ticks, tick=ticks)
        await game.drag((game.session.frame.after.robots[0].x, 50), (100, 50), (200, 50))
        await game.until(lambda: game.session.frame.after.robots[0].x > 190)
        game.session.run_until(1000)
        await game.sees("a robot moved by hand", "changed (M),", "press r and space.")
        assert game.main.recorder.record.state != "won"
