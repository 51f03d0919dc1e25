"""The forms of the level editor: an object, the level, a new level."""

from pathlib import Path
from typing import Any, TypeVar

import pytest
from textual.widgets import Input, Select

from logical_robots_tui.tui.level_editor.forms import Form, LevelForm, ThingForm, Ticks
from logical_robots_tui.world import Visibility
from logical_robots_tui.world.level import Cycle
from tests.tui.app.test_key_queue import press_at_once
from tests.tui.conftest import Opened, opened
from tests.tui.level_editor.conftest import Studio, fill, replace_in, studio

SomeForm = TypeVar("SomeForm", bound=Form)

TEAMS = 'team = "red"\n' + "".join(
    f'[[teams]]\nname = "{team}"\n[[robots]]\nname = "{name}"\nx = {x}\ny = 80\nteam = "{team}"\n'
    for team, name, x in [("red", "Pop", 40), ("blue", "Bo", 120)]
)


async def form(s: Studio, key: str, kind: type[SomeForm]) -> SomeForm:
    await s.press(key, on=kind)
    shown = s.game.app.screen
    assert isinstance(shown, kind)
    await s.game.until(lambda: shown.query("#take"))
    return shown


async def take(s: Studio, shown: Form, **values: Any) -> None:
    fill(shown, **values)
    await s.press("f2")
    await closed(s)


async def closed(s: Studio) -> None:
    await s.game.until(lambda: s.game.app.screen is s.game.main)


async def is_in(game: Opened, field: str) -> None:
    await game.until(lambda: game.app.focused is game.app.screen.query_one(f"#{field}"))


async def test_an_area_is_typed_ticked_and_chosen(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("shift+tab")
        await form(s, "i", ThingForm)
        await s.game.sees("[ ] robots can't drive into it")
        await s.press(*"Zoe", "tab", "tab", "tab", *"31")  # typing replaces what is there
        await s.press("tab", "tab", "space", sees="[X] robots can't drive into it")
        await s.press("shift+tab", "enter")
        await closed(s)
        area = s.level.areas[0]
        assert (area.name, area.x, area.radius, area.impenetrable) == ("Zoe", 240, 31, True)
        shown = await form(s, "i", ThingForm)
        shown.query_one("#name").focus()
        await is_in(s.game, "name")
        fill(shown, radius="wide")
        shown.query_one("#take").focus()
        await s.press("enter", sees="The radius must be a number")
        await s.press("tab", "enter")
        await closed(s)
        shown = await form(s, "i", ThingForm)
        fill(shown, radius="wide")
        await s.press("f2", sees="The radius must be a number")
        fill(shown, radius="22", cycle="1 to 2")
        await s.press("f2", sees="The ticks must be like")
        fill(shown, impenetrable=False, off_beacon="Lamp", cycle="1 to 2 of every 4")
        await s.press("f2", sees='A cycle switches this area, so it can\'t have "off_beacon"')
        shown.query_one("#off_beacon", Select).clear()
        shown.query_one("#victory_robots", Ticks).toggle("Pip")
        press_at_once(s.game, "ctrl+u", *"Gate", "f2")  # what was typed before it is applied counts
        await closed(s)
        area = s.level.areas[0]
        assert (area.name, area.radius, area.impenetrable) == ("Gate", 22, False)
        assert (area.cycle, area.victory_robots) == (Cycle(4, 1, 2), ())


async def test_properties_of_a_robot_and_a_level_are_set(data_dir: Path, room_file: Path) -> None:
    replace_in(room_file, "x = 40", "x = 40.123456")
    replace_in(room_file, "y = 50 # in the middle", f"y = 50\n{TEAMS}")
    async with studio(data_dir, room_file, size=(80, 24)) as s:
        await s.press("tab", sees="Robot Pip at 40.1, 50")
        robot_form = await form(s, "i", ThingForm)
        assert robot_form.query_one("#x", Input).value == "40.12"
        assert robot_form.query_one("#team", Select).value == "red"
        fill(robot_form, team="blue", has_battery=True, battery_capacity="300", angle="90")
        await s.press(*"Pat", "enter")
        await closed(s)
        robot = s.level.robots[0]
        assert (robot.name, robot.x) == ("Pat", 40.123456)  # all digits, though few are shown
        assert (robot.has_battery, robot.battery_capacity) == (True, 300)
        assert robot.angle == pytest.approx(1.5708, abs=1e-4)
        assert [robot.team for robot in s.level.robots] == ["blue", "red", "blue"]
        level_form = await form(s, "m", LevelForm)
        fill(level_form, briefing="Go there.", hints="Turn.\n\nGo on.", sensor="all")
        await take(s, level_form, width="300", shared_names="Lamp,  red light")
        assert (s.live.width, s.live.briefing) == (300, "Go there.")
        assert s.live.hints == ("Turn.", "Go on.")
        assert s.live.visibility == Visibility("own", "all")
        assert s.live.shared_names == ("Lamp", "red light")
        await s.press("M", sees="What should happen to your changes")
        answers = ("Save", "Keep as a level", "Just for this game", "Throw away")
        await s.game.until(lambda: all(s.game.shows(f" {answer} ") for answer in answers))


@pytest.mark.slow
async def test_a_form_moves_of_a_robot_only_what_changed(data_dir: Path, room_file: Path) -> None:
    async with studio(data_dir, room_file) as s:
        game, session = s.game, s.game.session
        await s.press("N", until=lambda: game.tick == 10)
        await s.do("tab")
        before = session.frame.after.robots[0]
        assert before.x > 44
        shown = await form(s, "i", ThingForm)
        assert float(shown.query_one("#x", Input).value) == pytest.approx(before.x, abs=0.01)
        assert shown.query_one("#start_x", Input).value == "40"
        await take(s, shown)
        assert session.frame.after.robots[0] == before
        assert not s.editor.edits.can_undo
        await take(s, await form(s, "i", ThingForm), color="red", start_y="60")
        assert (s.level.robots[0].x, s.level.robots[0].y) == (40, 60)
        assert session.frame.after.robots[0] == before
        await take(s, await form(s, "i", ThingForm), x="150", name="Pat")
        after = session.frame.after.robots[0]
        assert (after.name, after.x, after.y, after.angle) == ("Pat", 150, before.y, before.angle)
        assert (s.level.robots[0].x, s.level.robots[0].y) == (40, 60)
        shown = await form(s, "i", ThingForm)
        fill(shown, y="1e9")
        await s.press("f2", until=lambda: shown.query_one("#complaint").display)
        assert session.frame.after.robots[0] == after


async def test_a_new_level_is_an_empty_room_or_a_labyrinth_drawn_by_lot(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24), ready=True) as game:
        await game.press("H", until=lambda: game.shows("Create") and game.shows("Cancel"))
        new = game.app.screen
        await is_in(game, "kind")
        for field in ("title", "width", "height", "wall"):  # enter leads through the form
            await game.press("enter")
            await is_in(game, field)
        assert not new.query_one("#kind", Select).expanded
        fill(new, width="wide")
        await game.press("enter", sees="The width must be a number")
        fill(new, width="300")
        await game.press("enter", until=lambda: game.main.editing.is_on)
        assert game.session.level.width == 300
        assert game.session.source.name == "first-steps-starter"  # not the program before
        await game.press("H", sees="New level")
        new = game.app.screen
        await game.until(lambda: new.query("#kind"))
        fill(new, kind="labyrinth", columns="0")
        await game.press("f2", sees="A labyrinth needs at least 2 cells")
        fill(new, columns="3", rows="2", seed="7", title="Short cut")
        await game.press("f2", until=lambda: game.session.level.title == "Short cut")
        await game.until(lambda: game.main.editing.is_on)
        assert (game.session.level.width, game.session.level.height) == (220, 150)
        await game.sees("not saved")
        await game.press("s", sees="Save the level as")
        await game.press("enter", sees="Saved as short-cut")
        assert (data_dir / "levels" / "short-cut.toml").exists()
        await game.press("escape", until=lambda: not game.main.editing.is_on)
