"""Running, pausing, stepping, and what the status line says about it."""

import json
from functools import partial
from pathlib import Path

import pytest
from rich.console import RenderableType
from textual import events
from textual.screen import Screen
from textual.widgets import Button
from textual.widgets._toast import Toast

from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.world import list_levels
from tests.game.playing import SLOW as ENDLESS
from tests.game.playing import hall
from tests.short import AHEAD
from tests.tui.conftest import SLOW, STILL, Opened, opened
from tests.waiting import PATIENCE


async def test_the_robots_run_faster_and_slower_pause_restart_and_step(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        assert "40/s" in game.status
        await game.press("space")  # before the program is compiled
        await game.until(lambda: game.tick > 3 and game.session.running and game.shows("RUNNING"))
        await game.press("space", until=lambda: "PAUSED" in game.status)
        stopped_at = game.tick
        assert f"tick {stopped_at}" in game.status
        await game.later(1)
        assert game.tick == stopped_at

        await game.press("minus", until=lambda: "20/s" in game.status)
        await game.press(*["plus"] * 9, until=lambda: "flat out" in game.status)
        await game.press("space", until=lambda: "flat out " in game.status and "/s" in game.status)
        await game.press("n")  # one more tick
        await game.until(lambda: not game.session.busy)
        stopped_at = game.tick
        await game.press("n", until=lambda: game.tick == stopped_at + 1)

        await game.press("space", until=lambda: game.tick > stopped_at + 2)
        await game.press("r", until=lambda: game.tick == 0 and not game.session.running)
        assert game.session.frame.decisions == ()

        await game.press("n", tick=1)
        await game.press("n", "n", tick=3)
        third = game.session.frame
        await game.press("p", tick=2)
        await game.press("full_stop", tick=3)
        assert game.session.frame.after == third.after
        await game.press("comma", "comma", "comma", "comma", tick=0)


async def test_how_near_the_goal_the_robots_were_stays_told(data_dir: Path, tmp_path: Path) -> None:
    lone = AHEAD.replace(";", ', robot_name == "Ada";')
    path = Path(hall(tmp_path).source)
    async with opened(data_dir, level=path, text=lone, ready=True) as game:
        game.session.run_until(300)
        await game.until(lambda: game.tick == 300 and "most at once 1/2, tick 81" in game.status)
        game.session.go_to(81)
        await game.until(lambda: game.tick == 81 and "most" not in game.status)


@pytest.mark.slow
async def test_slow_thoughts_block_no_keys(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    patient = Limits(think_steps=10**12, think_seconds=10 * PATIENCE)
    monkeypatch.setattr("logical_robots_tui.game.game.Limits", lambda: patient)
    async with opened(data_dir, text=ENDLESS, ready=True) as game:
        with game.impatient():
            await game.press("space", until=lambda: "thinking…" in game.status)
            thought = game.session.thinking_for
            await game.press("y", "2", "x")
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
    async with opened(data_dir, text=SLOW, ready=True) as game:
        with game.impatient():
            await game.press("n", until=lambda: game.session.thinking_for)
            await game.press("space")
        await game.until(lambda: not game.session.busy)
        await game.apply(STILL)
        await game.press("n", tick=1)


async def test_victory_is_celebrated_once_takes_no_typed_key_and_leads_on(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", ready=True) as game:
        assert "needs all: R · P · Q ·" in game.status
        await game.press(*["plus"] * 6, "space", until=lambda: game.session.won_at is not None)
        await game.until(lambda: not game.session.running)
        await game.until(lambda: "needs all: R ✓ P ✓ Q ✓" in game.status and "WON" in game.status)
        await game.sees("Again", "Everyone made it", f"{game.session.won_at} ticks", "Next level")
        for key, label in (("right", "Again"), ("right", "Stay"), ("left", "Again")):
            await game.press(key, until=partial(answers, game, label))
        await game.press("left", "left", "enter", until=lambda: game.app.screen is game.main)
        assert game.session.won_at is not None, "the game stays there"
        await game.sees_no("Everyone made it")
        await game.press("p", "n", until=lambda: game.session.won_at is not None)
        await game.sees_no("Everyone made it")
        await game.press("r", tick=0)
        await game.press("space", sees="Everyone made it")
        await game.press("escape", sees_no="Everyone made it")

        await game.press("r", "space", "2", "r", until=lambda: game.session.won_at is not None)
        await game.press("greater_than_sign", "space")
        await game.until(lambda: game.editor.text.startswith("r> "))
        assert not game.shows("Everyone made it")
        await game.sees("Everyone made it")
        await game.press("r", "greater_than_sign", "enter")  # too early to be an answer
        await game.sees("Again")
        assert game.session.won_at is not None
        assert game.editor.text.startswith("r> Free")
        await game.press("r", tick=0)
        assert game.app.screen is game.main

        await game.press("f5", sees="Next level")
        await game.press("greater_than_sign")
        await game.until(lambda: game.session.level.name == list_levels()[0])
        assert game.app.screen is game.main
        assert ">" not in game.editor.text.splitlines()[0]


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_neither_a_run_nor_a_pause_lays_the_screen_out_and_a_pause_draws_nothing(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]
) -> None:
    async with opened(data_dir, ready=True, size=size) as game:
        await game.later(1)
        layouts: list[object] = []
        game.main.screen_layout_refresh_signal.subscribe(game.main, layouts.append)
        drawn: list[object] = []
        display = game.app._display

        def note(screen: Screen[object], renderable: RenderableType | None) -> None:
            drawn.append(renderable)
            display(screen, renderable)

        with monkeypatch.context() as patch:
            patch.setattr(game.app, "_display", note)
            await game.later(60)
        assert not drawn
        assert not layouts

        await game.press("space", until=lambda: game.tick > 3)
        layouts.clear()
        begun = game.tick
        await game.until(lambda: game.tick > begun + 20)
        assert not layouts


async def test_names_of_a_level_are_text_and_nothing_else(data_dir: Path, tmp_path: Path) -> None:
    area = {"name": "[/]C", "x": 80, "y": 30, "radius": 10, "color": "green"}
    wicked = {
        "width": 100,
        "height": 50,
        "walls": "0" * 5000,
        "robots": [{"name": "[b]A[/b]", "x": 30, "y": 20, "color": "[red]"}],
        "beacons": [{"name": "[@click=app.quit]B", "x": 60, "y": 20}],
        "areas": [area | {"victory_robots": ["[b]A[/b]"]}],
    }
    (tmp_path / "[link].json").write_text(json.dumps(wicked))
    text = STILL.replace("memory: 1", 'memory: "\x1b[2J[red]"')
    async with opened(data_dir, level=str(tmp_path / "[link]"), text=text, ready=True) as game:
        await game.press("n", tick=1)
        assert "\x1b" not in game.screen()
        assert "[/]C: [b]A[/b] ·" in game.status
        await game.sees("[link]", r"[b]A[/b] remembers '\u001b[2J[red]'")


def answers(game: Opened, label: str) -> bool:
    focused = game.app.focused
    return isinstance(focused, Button) and str(focused.label).startswith(label)


async def test_messages_stand_apart_and_a_click_on_a_past_one_is_nothing(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL, ready=True) as game:
        game.main.tell("One.")
        game.main.tell("Twice " * 40)
        panes = game.main.arrangement

        def are_apart() -> bool:
            regions = sorted((toast.region for toast in game.main.query(Toast)), key=lambda r: r.y)
            own = game.main.labyrinth.region if panes.layout.is_roomy else game.main.region
            return (
                len(regions) == 2
                and regions[1].y > regions[0].bottom > 0
                and all(own.contains_region(region) for region in regions)
            )

        await game.until(are_apart)
        for size in ((80, 24), (100, 30), (120, 60), (90, 50), (120, 40)):
            await game.resize(*size, until=are_apart)
            if size == (80, 24):  # a tab is whole, or wholly under a message
                await game.until(lambda: game.screen().splitlines()[1][:18].split() == ["1", "Map"])
        toast = game.main.query(Toast).first()
        x, y = toast.region.center
        holder = toast.parent
        toast._detach()  # as when its time is over; the screen is laid out anew after that
        for kind in (events.MouseDown, events.MouseMove, events.MouseUp):
            await game.app.on_event(kind(None, x, y, 0, 0, 1, False, False, False, x, y))
        toast._parent = holder
        await game.press("n", tick=1)
