"""Editing without a screen, also while robots run, and what becomes of it."""

import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.checks import load_errors
from logical_robots_tui.editing.editor import GRIDS, WIDTHS, LevelEditor, Tool
from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.editing.files import save_level
from logical_robots_tui.game.victory import is_by_the_book
from logical_robots_tui.world import Beacon, Level, World, load_level
from logical_robots_tui.world.dynamics import WorldState
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.world import change_state
from tests.editing.making import room
from tests.short import AHEAD
from tests.tui.conftest import ROOM
from tests.tui.level_editor.conftest import bench, said, say
from tests.virtual_time import Hold

POINTS = st.tuples(st.integers(-5, 125).map(float), st.integers(-5, 85).map(float))
SETTINGS = {
    "tool": st.sampled_from(Tool),
    "width": st.sampled_from(WIDTHS),
    "grid": st.sampled_from(GRIDS),
    "is_wall": st.booleans(),
    "is_filled": st.booleans(),
}
PLAIN = ["undo", "redo", "duplicate", "delete", "cancel", "save"]
DEEDS = st.one_of(
    st.tuples(st.just("stroke"), st.lists(POINTS, min_size=1, max_size=4)),
    st.tuples(st.just("set"), st.fixed_dictionaries({}, optional=SETTINGS)),
    st.tuples(st.sampled_from(PLAIN), st.just(())),
    st.tuples(st.sampled_from(["turn", "select_next"]), st.tuples(st.sampled_from([-1, 1]))),
)


def editor_of(level: Level, state: WorldState, warn: Callable[[str], None]) -> LevelEditor:
    return LevelEditor(Edits(level), lambda: state, lambda: None, warn)


@settings(deadline=None)
@given(st.lists(DEEDS, max_size=20))
def test_any_strokes_undos_and_saves_load_back_as_the_level(done: list[tuple[str, Any]]) -> None:
    editor = editor_of(room(), World(room()).save(), lambda _: None)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mine.toml"
        for what, more in done:
            if what == "stroke":
                editor.press(more[0][0], more[0][1], 1.0)
                for point in more[1:]:
                    editor.drag(*point)
                editor.release()
            elif what == "set":
                editor.settings = replace(editor.settings, **more)
            elif what == "save":
                save_level(editor.level, file)
                editor.edits.mark_saved()
                assert alike(load_level(file), editor.level)
                before = file.read_bytes()
                save_level(editor.level, file)
                assert file.read_bytes() == before
            else:
                getattr(editor, what)(*more)
            assert not [*load_errors(editor.level)]
            assert (editor.entity is None) == (editor.selected is None)
        last = editor.level
        save_level(last, file)
        assert alike(load_level(file), last)
        undone = 0
        while editor.undo():
            undone += 1
        assert alike(editor.level, room())
        for _ in range(undone):
            editor.redo()
        assert alike(editor.level, last)


def test_a_level_that_grows_on_all_sides_takes_robots_under_way_along() -> None:
    level, world = room(), World(room())
    world.act({})
    state = world.save()
    state = replace(state, robots=tuple(replace(r, x=60.0, angle=1.0) for r in state.robots))
    editor = editor_of(level, state, lambda _: None)
    moved = tuple(replace(robot, x=robot.x + 10) for robot in level.robots)
    editor.change_level("level", replace(level, robots=moved))
    poses = editor.poses.between(level, editor.level)
    assert poses == {"Ann": (70.0, state.robots[0].y, 1.0)}
    assert change_state(state, level, editor.level, poses).robots[0].x == 70.0


def test_several_turns_are_one_step_and_a_beacon_is_not_turned() -> None:
    complaints: list[str] = []
    level = replace(room(), beacons=(Beacon("Lamp", 50, 50),))
    editor = editor_of(level, World(level).save(), complaints.append)
    editor.select_next(1)
    editor.turn(1)
    editor.turn(1)
    assert editor.level.robots[0].angle == pytest.approx(math.pi / 6)
    assert (editor.undo(), editor.level.robots) == ("turn Ann", level.robots)
    editor.select_next(1)
    editor.turn(1)
    assert complaints == ["Select a robot first."]


def slow_saving(monkeypatch: pytest.MonkeyPatch) -> Hold:
    hold = Hold()

    def save(level: Level, path: Path) -> Level:
        hold.here()
        return save_level(level, path)

    monkeypatch.setattr("logical_robots_tui.editing.files.save_level", save)
    return hold


async def test_a_robot_under_way_meets_walls_and_is_taken(data_dir: Path, room_file: Path) -> None:
    async with bench(data_dir, room_file) as b:
        session = b.session
        await b.run_to(10)
        before = session.frame
        b.command("brush")
        await b.stroke((85, 20), (85, 80))
        assert session.level.walls[50, 85]
        assert session.game is not None
        assert session.game.history.marks.marks_at(10)[0].kind == "edit"
        session.run()
        await b.until(lambda: session.frame.after.robots[0].blocked)
        b.command("hand")
        body = session.frame.after.robots[0]
        await b.stroke((body.x, body.y), (150, 50))
        await b.until(lambda: session.frame.after.robots[0].x > 140)
        session.pause()
        await b.until(lambda: not session.busy)
        last = session.frame
        session.go_to(9)
        assert session.frame.after.robots == before.before.robots
        assert not session.level.walls[50, 85]
        assert not b.level.walls[50, 85]
        assert b.editor.edits.can_undo == "go to tick 9"
        session.go_to(last.tick)
        assert session.frame == last
        assert session.history is not None
        assert not is_by_the_book(session.history, session.opened, session.frame.tick)
        b.command("undo", "undo", "undo")
        b.ui.answers = ["away"]
        b.command("stop_editing")
        await b.says("What should happen to your changes")
        await b.until(lambda: not b.controller.is_on)
        assert np.array_equal(session.level.walls, b.controller.levels.saved.walls)


async def test_a_save_changes_little_and_an_idle_one_none(data_dir: Path, room_file: Path) -> None:
    async with bench(data_dir, room_file) as b:
        await b.save("It is already saved")
        assert said(room_file) == ROOM
        await b.stroke((200, 30), (180, 30))
        await b.save("Saved as room")
        assert said(room_file) == ROOM.replace("x = 200", f"x = {b.level.beacons[0].x:g}")
        assert b.controller.levels.is_saved
        say(room_file, ROOM.replace("A room", "Another room", 1))
        b.command("brush")
        await b.stroke((100, 50))
        await b.save("was changed by another program")
        await b.settled()
        assert "Another room" in said(room_file)


async def test_a_save_is_finished_whatever_is_asked_for_meanwhile(
    data_dir: Path, room_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saving = slow_saving(monkeypatch)
    async with bench(data_dir, room_file) as b:
        await b.until(lambda: b.controller.findings == [])
        b.editor.press(200, 30, 1.0)
        b.editor.drag(180, 30)
        b.editor.release()
        b.command("save_level")
        await b.until(lambda: saving.has_begun)
        b.command("findings", "save_level")
        b.controller.toggle()
        await b.settled()
        assert b.controller.is_on
        saving.release()
        await b.until(lambda: not b.controller.is_on)
        assert "What should happen to your changes to the level?" not in b.ui.said
        assert b.controller.levels.is_saved
        assert load_level(room_file).beacons == b.level.beacons


async def test_a_save_under_way_when_the_level_is_left_keeps_what_was_done_since(
    data_dir: Path, room_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    saving = slow_saving(monkeypatch)
    async with bench(data_dir, room_file) as b:
        await b.stroke((200, 30), (180, 30))
        b.command("save_level")
        await b.until(lambda: saving.has_begun)
        await b.stroke((180, 30), (120, 30))
        newest = b.level.beacons
        sources = {"": b.session.source}
        b.session.open_level(load_level("02-open-space"), sources, AHEAD)
        assert not b.controller.is_on
        saving.release()
        await b.says("Saved as room")
        assert b.session.opened.name != "room"
        b.session.open_level(load_level(room_file), sources, AHEAD)
        b.controller.toggle()
        await b.says("unsaved changes to the level have been restored")
        assert b.level.beacons == newest


async def test_a_file_of_the_platform_is_replaced_if_wished(data_dir: Path, web_file: Path) -> None:
    async with bench(data_dir, web_file) as b:
        before = said(web_file)
        await b.stroke((200, 30), (180, 30))
        await b.save("was not made by this game")
        await b.settled()
        assert said(web_file) == before
        b.ui.answers = ["same"]
        for points in ([(180, 30)], [(180, 30), (120, 30)]):  # at last it was made here
            await b.stroke(*points)
            await b.save("Saved as garden.json")
            assert load_level(web_file).beacons[0].x == b.level.beacons[0].x
            assert b.controller.levels.is_saved
