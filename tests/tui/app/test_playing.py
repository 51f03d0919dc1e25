"""Running, pausing, stepping, and what the status line says about it."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING

import pytest
from textual import events
from textual.widgets import Button
from textual.widgets._toast import Toast

from logical_robots_tui.game.source import load_program
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.paths import shipped_folder
from tests.game.playing import SLOW as ENDLESS
from tests.tui.conftest import PAPER, SLOW, STILL, WRONG, opened
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import RenderableType
    from textual.screen import Screen

    from tests.tui.conftest import Opened


async def test_space_runs_and_pauses(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        assert "PAUSED" in game.status
        await game.press("space")
        await game.until(
            lambda: game.tick > 3 and game.session.running and "RUNNING" in game.status
        )
        await game.press("space")
        await game.until(lambda: "PAUSED" in game.status)
        stopped_at = game.tick
        assert f"tick {stopped_at}" in game.status
        await game.later(1)
        assert game.tick == stopped_at


async def test_space_before_the_program_is_compiled_runs_as_soon_as_it_is(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("space")
        await game.until(lambda: game.tick > 0)


async def test_stepping_forward_and_back_shows_the_same_tick_again(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await game.press("n", "n")
        await game.until(lambda: game.tick == 3)
        third = game.session.frame
        await game.press("p")
        await game.until(lambda: game.tick == 2)
        await game.press("full_stop")
        await game.until(lambda: game.tick == 3)
        assert game.session.frame.after == third.after
        await game.press("comma", "comma", "comma", "comma")
        await game.until(lambda: game.tick == 0)


async def test_a_step_while_running_stops_after_one_more_tick(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 2)
        await game.press("n")
        await game.until(lambda: not game.session.busy)
        stopped_at = game.tick
        await game.press("n")
        await game.until(lambda: game.tick == stopped_at + 1)


async def test_restart_goes_to_the_start_and_stands_still(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 2)
        await game.press("r")
        await game.until(lambda: game.tick == 0 and not game.session.running)
        assert game.session.frame.decisions == ()


async def test_plus_and_minus_change_the_speed_up_to_flat_out(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        assert "40/s" in game.status
        await game.press("minus")
        await game.until(lambda: "20/s" in game.status)
        await game.press(*["plus"] * 9)
        await game.until(lambda: "flat out" in game.status)
        await game.ready()
        await game.press("space")
        await game.until(lambda: "flat out " in game.status and "/s" in game.status)


@pytest.mark.slow
async def test_a_slow_thought_leaves_the_keys_alone_and_can_be_stopped(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    patient = Limits(think_steps=10**12, think_seconds=10 * PATIENCE)
    monkeypatch.setattr("logical_robots_tui.game.game.Limits", lambda: patient)
    async with opened(data_dir, text=ENDLESS) as game:
        await game.ready()
        with game.impatient():
            await game.press("space")
            await game.until(lambda: "thinking…" in game.status)
            thought = game.session.thinking_for
            await game.press("y")
            await game.press("2", "x")
            await game.until(
                lambda: game.editor.before_cursor == "x" and game.session.thinking_for > thought
            )  # the same one
            await game.until(lambda: "F5 stops it" in game.status)
            assert game.tick == 0
            await game.press("f5")
        await game.until(lambda: not game.session.busy and "PAUSED" in game.status)
        assert game.tick == 0


@pytest.mark.slow
async def test_a_slow_step_can_be_stopped_too(data_dir: Path) -> None:
    async with opened(data_dir, text=SLOW) as game:
        await game.ready()
        with game.impatient():
            await game.press("n")
            await game.until(lambda: game.session.thinking_for)
            await game.press("space")
        await game.until(lambda: not game.session.busy)
        await game.write(STILL)
        await game.until(lambda: game.session.state.applied == STILL)
        await game.press("n")
        await game.until(lambda: game.tick == 1)


async def test_the_goal_shows_who_is_in_and_victory_is_celebrated_once(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        await game.ready()
        assert "needs all: R · P · Q ·" in game.status
        await game.press(*["plus"] * 6, "space")
        await game.until(lambda: game.session.won_at is not None)
        await game.until(lambda: not game.session.running)
        await game.until(lambda: "needs all: R ✓ P ✓ Q ✓" in game.status)
        assert "WON" in game.status
        await game.sees("Again")
        await game.sees("Everyone made it")
        await game.sees(f"{game.session.won_at} ticks")
        await game.press("escape")
        await game.until(lambda: not game.shows("Everyone made it"))
        await game.press("p", "n")
        await game.until(lambda: game.session.won_at is not None)
        await game.sees_no("Everyone made it")
        await game.press("r")
        await game.until(lambda: game.tick == 0)
        await game.press("space")
        await game.sees("Everyone made it")


@pytest.mark.usefixtures("trials")
async def test_the_buttons_of_a_victory_can_be_clicked(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        await game.ready()
        await game.press(*["plus"] * 6, "space")
        await game.sees("Again")
        recorder = game.main.recorder  # whose trial of varied starts has a line that goes
        await game.until(lambda: recorder.latest and recorder.latest.wins is not None)
        await game.until(lambda: not game.shows("so far"))
        lines = game.screen().splitlines()
        row = next(row for row, line in enumerate(lines) if "Again" in line and "Stay" in line)
        await game.click(offset=(lines[row].index("Again") + 1, row))
        await game.until(lambda: game.tick == 0)
        await game.sees_no("Everyone made it")


async def test_a_run_never_lays_the_screen_out_anew(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 3)
        layouts: list[object] = []
        game.main.screen_layout_refresh_signal.subscribe(game.main, layouts.append)
        begun = game.tick
        await game.until(lambda: game.tick > begun + 20)
        assert not layouts


async def test_names_of_a_level_are_text_and_nothing_else(data_dir: Path, tmp_path: Path) -> None:
    wicked = {
        "width": 100,
        "height": 50,
        "walls": "0" * 5000,
        "robots": [{"name": "[b]A[/b]", "x": 30, "y": 20, "color": "[red]"}],
        "beacons": [{"name": "[@click=app.quit]B", "x": 60, "y": 20}],
        "areas": [
            {
                "name": "[/]C",
                "x": 80,
                "y": 30,
                "radius": 10,
                "color": "green",
                "victory_robots": ["[b]A[/b]"],
            }
        ],
    }
    (tmp_path / "[link].json").write_text(json.dumps(wicked))
    text = STILL.replace("memory: 1", 'memory: "\x1b[2J[red]"')
    async with opened(data_dir, level=str(tmp_path / "[link]"), text=text) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        assert "\x1b" not in game.screen()
        await game.sees("[link]")
        assert "[/]C: [b]A[/b] ·" in game.status
        await game.sees(r"[b]A[/b] remembers '\u001b[2J[red]'")


async def test_victory_takes_no_key_from_somebody_who_types(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        await game.ready()
        await game.press(*["plus"] * 6, "space", "2", "r")
        await game.until(lambda: game.session.won_at is not None)
        await game.press("greater_than_sign", "space")
        await game.until(lambda: game.editor.text.startswith("r> "))
        assert not game.shows("Everyone made it")
        await game.sees("Everyone made it")
        await game.press("r", "greater_than_sign", "enter")  # too early to be an answer
        await game.sees("Again")
        assert game.session.won_at is not None
        assert game.editor.text.startswith("r> Free")
        await game.press("r")
        await game.until(lambda: game.tick == 0)
        assert game.app.screen is game.main


async def test_the_arrows_move_between_the_answers_to_a_victory(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        await game.ready()
        await game.press(*["plus"] * 6, "space")
        await game.sees("Next level")
        for key, label in (("right", "Again"), ("right", "Stay"), ("left", "Again")):
            await game.press(key)
            await game.until(partial(answers, game, label))
        await game.press("left", "left", "enter")
        await game.until(lambda: game.app.screen is game.main)
        assert game.session.won_at is not None


def answers(game: Opened, label: str) -> bool:
    focused = game.app.focused
    return isinstance(focused, Button) and str(focused.label).startswith(label)


async def test_one_key_leads_from_a_victory_to_the_next_level(data_dir: Path) -> None:
    file = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=file, text=load_program("first-steps").text) as game:
        await game.ready()
        game.session.pace.speed = None
        await game.press("2", "f5")
        await game.sees("Next level")
        await game.press("greater_than_sign")
        await game.until(lambda: game.session.level.name == "02-open-space")
        assert game.app.screen is game.main
        assert ">" not in game.editor.text.splitlines()[0]


async def test_two_messages_stand_apart(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        game.main.tell("One.")
        game.main.tell("Two.")

        def are_apart() -> bool:
            regions = sorted((toast.region for toast in game.main.query(Toast)), key=lambda r: r.y)
            return len(regions) == 2 and regions[1].y > regions[0].bottom > 0

        await game.until(are_apart)


async def test_a_program_that_is_wrong_from_the_start_says_so_when_run(data_dir: Path) -> None:
    async with opened(data_dir, text=WRONG) as game:
        await game.ready()
        await game.press("space")
        await game.sees("an error in line 3")
        assert not game.session.busy
        await game.write(PAPER)
        await game.until(lambda: game.session.game is not None)
        await game.press("1", "n")
        await game.until(lambda: game.tick == 1)


async def test_nothing_is_drawn_when_nothing_changes(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.later(1)
        drawn: list[object] = []
        display = game.app._display

        def note(screen: Screen[object], renderable: RenderableType | None) -> None:
            drawn.append(renderable)
            display(screen, renderable)

        monkeypatch.setattr(game.app, "_display", note)
        await game.later(60)
        assert not drawn


async def test_the_mouse_at_what_has_just_gone_away_does_nothing(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        game.main.tell("This goes away soon.")
        await game.sees("This goes away soon.")
        toast = game.main.query_one(Toast)
        x, y = toast.region.center
        holder = toast.parent
        toast._detach()  # as when its time is over; the screen is laid out anew after that
        for kind in (events.MouseDown, events.MouseMove, events.MouseUp):
            await game.app.on_event(kind(None, x, y, 0, 0, 1, False, False, False, x, y))
        toast._parent = holder
        await game.press("n")
        await game.until(lambda: game.tick == 1)
