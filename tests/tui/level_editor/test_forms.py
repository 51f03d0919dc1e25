"""The forms of the level editor: an object, the level, a new level."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest
from textual.widgets import Checkbox, Input, Select, TextArea

from logical_robots_tui.paths import ARENAS, shipped_folder
from logical_robots_tui.tui.level_editor.forms import LevelForm, ThingForm, Ticks
from logical_robots_tui.world import Visibility
from tests.tui.app.test_key_queue import press_at_once
from tests.tui.conftest import opened
from tests.tui.level_editor.conftest import replace_in, studio

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


def focuses(game: Opened, line: Input) -> bool:
    return game.app.focused is line


async def test_a_form_takes_what_was_typed_before_it_was_applied(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("shift+tab")
        for name, field in (("Zoe", "name"), ("31", "radius")):
            await s.press("i")
            await s.game.until(lambda: isinstance(s.game.app.screen, ThingForm))
            form = s.game.app.screen
            line = form.query_one(f"#{field}", Input)
            line.focus()
            await s.game.until(partial(focuses, s.game, line))
            press_at_once(s.game, "ctrl+u", *name, "f2")
            await s.game.until(lambda: s.game.app.screen is s.game.main)
        area = s.level.areas[0]
        assert (area.name, area.radius) == ("Zoe", 31)


async def test_typing_replaces_the_text_of_a_field(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("shift+tab", "i")
        await s.game.until(lambda: isinstance(s.game.app.screen, ThingForm))
        await s.press(*"Zoe", "tab", "tab", "tab", *"31", "enter")
        await s.game.until(lambda: s.game.app.screen is s.game.main)
        area = s.level.areas[0]
        assert (area.name, area.x, area.radius) == ("Zoe", 240, 31)


async def test_a_box_can_be_seen_when_it_is_off(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("shift+tab", "i")
        await s.game.sees("[ ] robots can't drive into it")
        await s.press("tab", "tab", "tab", "tab", "tab", "space")
        await s.game.sees("[X] robots can't drive into it")
        await s.press("f2")
        await s.game.until(lambda: s.level.areas[0].impenetrable)


async def test_fields_show_the_digits_that_matter_and_keep_the_others(
    data_dir: Path, room_file: Path
) -> None:
    replace_in(room_file, "x = 40", "x = 40.123456")
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("tab")
        await s.game.sees("Robot Pip at 40.1, 50")
        await s.press("i")
        await s.game.until(lambda: isinstance(s.game.app.screen, ThingForm))
        assert s.game.app.screen.query_one("#x", Input).value == "40.12"
        await s.press(*"Pat", "f2")
        await s.game.until(lambda: s.level.robots[0].name == "Pat")
        assert s.level.robots[0].x == 40.123456


async def test_properties_are_set_in_forms_with_the_choices_there_are(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        game = s.game
        await s.press("shift+tab", "i")
        await game.until(lambda: isinstance(game.app.screen, ThingForm))
        form = game.app.screen
        form.query_one("#name", Input).value = "Gate"
        form.query_one("#radius", Input).value = "wide"
        await s.press("f2")
        await game.sees("The radius must be a number")
        form.query_one("#radius", Input).value = "22"
        form.query_one("#impenetrable", Checkbox).value = True
        form.query_one("#off_beacon", Select).value = "Lamp"
        form.query_one("#victory_robots", Ticks).toggle("Pip")
        await s.press("f2")
        await game.until(lambda: game.app.screen is game.main)
        area = s.level.areas[0]
        assert (area.name, area.radius, area.impenetrable) == ("Gate", 22, True)
        assert (area.off_beacon, area.victory_robots) == ("Lamp", ())
        await s.press("tab", "i")
        await game.until(lambda: isinstance(game.app.screen, ThingForm))
        form = game.app.screen
        form.query_one("#has_battery", Checkbox).value = True
        form.query_one("#battery_capacity", Input).value = "300"
        form.query_one("#angle", Input).value = "90"
        await s.press("enter")
        await game.until(lambda: game.app.screen is game.main)
        robot = s.level.robots[0]
        assert (robot.has_battery, robot.battery_capacity) == (True, 300)
        assert robot.angle == pytest.approx(1.5708, abs=1e-4)
        await s.press("m")
        await game.until(lambda: isinstance(game.app.screen, LevelForm))
        form = game.app.screen
        form.query_one("#width", Input).value = "300"
        form.query_one("#briefing", TextArea).text = "Go there."
        form.query_one("#hints", TextArea).text = "Turn.\n\nGo on."
        form.query_one("#sensor", Select).value = "all"
        form.query_one("#shared_names", Input).value = "Lamp,  red light"
        await s.press("f2")
        await game.until(lambda: game.app.screen is game.main)
        assert s.live.width == 300
        assert s.live.briefing == "Go there."
        assert s.live.hints == ("Turn.", "Go on.")
        assert s.live.visibility == Visibility("own", "all")
        assert s.live.shared_names == ("Lamp", "red light")


async def test_a_robot_joins_one_of_the_teams_there_are(data_dir: Path, tmp_path: Path) -> None:
    file = tmp_path / "match.toml"
    shipped = (shipped_folder("levels") / ARENAS / "16-high-ground.toml").read_text("utf-8")
    file.write_text(shipped, "utf-8")
    async with studio(data_dir, file) as s:
        await s.press("tab", "i")
        await s.game.until(lambda: isinstance(s.game.app.screen, ThingForm))
        form = s.game.app.screen
        assert form.query_one("#team", Select).value == "red"
        form.query_one("#team", Select).value = "blue"
        await s.press("f2")
        await s.game.until(lambda: s.game.app.screen is s.game.main)
        assert [robot.team for robot in s.level.robots] == ["blue", "red", "red", *["blue"] * 3]


@pytest.mark.slow
async def test_the_form_of_a_robot_under_way_moves_what_was_changed(
    data_dir: Path, room_file: Path
) -> None:
    async with studio(data_dir, room_file) as s:
        game, session = s.game, s.game.session

        async def form() -> ThingForm:
            await s.press("i")
            await game.until(lambda: isinstance(game.app.screen, ThingForm))
            shown = game.app.screen
            assert isinstance(shown, ThingForm)
            await game.until(lambda: shown.query("#color"))
            return shown

        async def close() -> None:
            await s.press("f2")
            await game.until(lambda: game.app.screen is game.main)

        await s.press("N")
        await game.until(lambda: game.tick == 10)
        await s.press("tab")
        await s.settled()
        before = session.frame.after.robots[0]
        assert before.x > 44
        shown = await form()
        assert float(shown.query_one("#x", Input).value) == pytest.approx(before.x, abs=0.01)
        assert shown.query_one("#start_x", Input).value == "40"
        await close()
        assert session.frame.after.robots[0] == before
        assert not s.editor.edits.can_undo
        shown = await form()
        shown.query_one("#color", Input).value = "red"
        shown.query_one("#start_y", Input).value = "60"
        await close()
        assert (s.level.robots[0].x, s.level.robots[0].y) == (40, 60)
        assert session.frame.after.robots[0] == before
        shown = await form()
        shown.query_one("#x", Input).value = "150"
        shown.query_one("#name", Input).value = "Pat"
        await close()
        after = session.frame.after.robots[0]
        assert (after.name, after.x, after.y, after.angle) == ("Pat", 150, before.y, before.angle)
        assert (s.level.robots[0].x, s.level.robots[0].y) == (40, 60)
        shown = await form()
        shown.query_one("#y", Input).value = "1e9"
        await s.press("f2")
        await game.until(lambda: shown.query_one("#complaint").display)
        assert session.frame.after.robots[0] == after


async def test_enter_leads_through_the_form_of_a_new_level_and_creates_it(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("H")
        await game.until(lambda: game.shows("Create") and game.shows("Cancel"))
        form = game.app.screen
        await game.until(lambda: form.focused is form.query_one("#kind"))
        for field in ("title", "width", "height", "wall"):
            await game.press("enter")
            wanted = form.query_one(f"#{field}")
            await game.until(partial(lambda wanted: form.focused is wanted, wanted))
        assert not form.query_one("#kind", Select).expanded
        form.query_one("#width", Input).value = "wide"
        await game.press("enter")
        await game.sees("The width must be a number")
        form.query_one("#width", Input).value = "300"
        await game.press("enter")
        await game.until(lambda: game.main.editing.is_on)
        assert game.session.level.width == 300
