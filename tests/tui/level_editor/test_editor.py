"""The editor without its widgets: whatever is done, undone and saved loads back the same."""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.checks import refusals
from logical_robots_tui.editing.editor import GRIDS, WIDTHS, LevelEditor, Tool
from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.editing.files import save_level
from logical_robots_tui.world import Beacon, Level, World, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.world import change_state
from tests.editing.making import room

points = st.tuples(st.integers(-5, 125).map(float), st.integers(-5, 85).map(float))
deeds = st.one_of(
    st.tuples(st.just("stroke"), st.lists(points, min_size=1, max_size=4)),
    st.tuples(st.just("tool"), st.sampled_from(Tool)),
    st.tuples(
        st.just("set"),
        st.fixed_dictionaries(
            {},
            optional={
                "width": st.sampled_from(WIDTHS),
                "grid": st.sampled_from(GRIDS),
                "is_wall": st.booleans(),
                "is_filled": st.booleans(),
            },
        ),
    ),
    st.tuples(
        st.sampled_from(["undo", "redo", "duplicate", "delete", "cancel", "save"]), st.none()
    ),
    st.tuples(st.sampled_from(["turn", "select_next"]), st.sampled_from([-1, 1])),
)


def editor_of(level: Level) -> LevelEditor:
    state = World(level).save()
    return LevelEditor(Edits(level), lambda: state, lambda: None, lambda _: None)


@settings(deadline=None)
@given(st.lists(deeds, max_size=20))
def test_any_sequence_of_strokes_undos_and_saves_loads_back_to_the_same_level(
    done: list[tuple[str, Any]],
) -> None:
    editor = editor_of(room())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mine.toml"
        for what, more in done:
            if what == "stroke":
                editor.press(more[0][0], more[0][1], 1.0)
                for point in more[1:]:
                    editor.drag(*point)
                editor.release()
            elif what == "tool":
                editor.settings = replace(editor.settings, tool=more)
            elif what == "set":
                editor.settings = replace(editor.settings, **more)
            elif what == "save":
                save_level(editor.level, file)
                editor.edits.saved()
                assert alike(load_level(file), editor.level)
                before = file.read_bytes()
                save_level(editor.level, file)
                assert file.read_bytes() == before
            else:
                getattr(editor, what)(*([more] if more else []))
            assert not refusals(editor.level)
            thing = editor.thing
            assert (thing is None) == (editor.selected is None)
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
    level = room()
    world = World(level)
    world.act({})
    state = replace(
        world.save(), robots=tuple(replace(r, x=60.0, angle=1.0) for r in world.save().robots)
    )
    editor = LevelEditor(Edits(level), lambda: state, lambda: None, lambda _: None)
    moved = tuple(replace(robot, x=robot.x + 10) for robot in level.robots)
    editor.change_level("level", replace(level, robots=moved))
    poses = editor.poses.between(level, editor.level)
    assert poses == {"Ann": (70.0, state.robots[0].y, 1.0)}
    after = change_state(state, level, editor.level, poses)
    assert after.robots[0].x == 70.0


def test_several_turns_are_one_step_and_a_beacon_is_not_turned() -> None:
    complaints: list[str] = []
    level = replace(room(), beacons=(Beacon("Lamp", 50, 50),))
    state = World(level).save()
    editor = LevelEditor(Edits(level), lambda: state, lambda: None, complaints.append)
    editor.select_next(1)
    editor.turn(1)
    editor.turn(1)
    assert editor.level.robots[0].angle == pytest.approx(math.pi / 6)
    assert editor.undo() == "turn Ann"
    assert editor.level.robots == level.robots
    editor.select_next(1)
    editor.turn(1)
    assert complaints == ["Select a robot first."]
