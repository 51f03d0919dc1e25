"""Replays on the screen: saved from the timeline, and opened as a branch of their own."""

from contextlib import AbstractAsyncContextManager
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.game.replay import Replay, ReplayProgram, Stage, load_replay
from logical_robots_tui.player.opening import Opening, level_of, sources_of
from logical_robots_tui.tui.library.chooser import Chooser
from logical_robots_tui.world import World, load_level
from tests.short import AHEAD
from tests.tui.conftest import STILL, Opened, opened, showing
from tests.virtual_time import VirtualClock


def played(replay: Replay, data_dir: Path) -> AbstractAsyncContextManager[Opened]:
    level, sources = level_of(replay), sources_of(replay, data_dir / "programs")
    return showing(Opening(level, sources, data_dir, replay=replay, clock=VirtualClock()))


async def saved(game: Opened) -> Replay:
    game.main.action_command("save_replay")
    folder = game.data_dir / "replays"
    await game.sees("bytes).")
    (path,) = folder.iterdir()
    await game.sees(f"Saved {path.name} in")
    return load_replay(path)


async def test_runs_are_saved_and_opened_again(data_dir: Path, short: Path, tmp_path: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.command("save_replay", sees="There is nothing to save")
        assert not (data_dir / "replays").exists()
        await game.press("n", "n", "n", tick=3)
        game.session.place_robot("Pip", (30.0, 12.0, 0.5))
        await game.apply(STILL)
        await game.press("escape", "n", "n", tick=5)
        assert game.session.game is not None
        there = [game.session.game.frame_at(tick) for tick in range(6)]
        await game.press("p")
        replay = await saved(game)

        await game.apply(AHEAD)
        await game.press("escape", "r")
        await game.command("open_replay")
        await game.until(lambda: isinstance(game.app.screen, Chooser) and game.shows("5 ticks"))
        await game.press("enter", sees="Replay of 5 ticks")
        await game.until(lambda: game.tick == replay.last and not game.session.busy)
        assert game.session.state.applied == STILL
    async with played(replay, tmp_path / "elsewhere") as game:
        await game.until(lambda: game.tick == 5 and not game.session.busy)
        await game.sees("Replay of 5 ticks")
        assert game.editor.text == STILL
        for frame in reversed(there):
            game.session.go_to(frame.tick)
            assert game.session.frame == frame


async def test_a_replay_s_victory_is_nobody_s(data_dir: Path, short: Path, tmp_path: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        game.session.run_until(100)
        await game.sees("Again")
        await game.press("escape")
        replay = await saved(game)
    async with played(replay, tmp_path / "elsewhere") as game:
        await game.sees("Replay of")
        assert game.session.won_at == replay.last
        assert game.main.recorder.record.state != "won"
        await game.sees_no("Again")


def test_a_shipped_level_and_program_are_recognised(tmp_path: Path) -> None:
    path = tmp_path / "a.replay"
    ticks = ["--ticks", "5", "-o", str(path)]
    assert main(["replay", "record", "01-first-steps", "first-steps", *ticks]) == 0
    replay = load_replay(path)
    assert level_of(replay).source == load_level("01-first-steps").source
    assert sources_of(replay, tmp_path)[""].shipped


@pytest.mark.parametrize("name", ["../../etc/passwd", "a\nb", "", "x" * 300, "first-steps"])
def test_a_program_of_any_name_is_one_of_the_player_s_folder(tmp_path: Path, name: str) -> None:
    level = load_level("01-first-steps")
    stage = Stage(write_native(level), World(level).save(), "{}", False, ())
    replay = Replay("x", 1, (stage,), (ReplayProgram(1, name, STILL),), {})
    source = sources_of(replay, tmp_path)[""]
    assert source.path.parent == tmp_path
    assert not source.shipped
    assert len(source.path.name) < 60
