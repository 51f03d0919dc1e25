"""Files that levels are saved in, what can't be saved, and levels of the web platform."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.files import is_made_here, save_level
from logical_robots_tui.editing.level_text import write_native, write_web
from logical_robots_tui.editing.things import Ref, change
from logical_robots_tui.world import Beacon, LevelError, Robot, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.load import read_web
from logical_robots_tui.world.levels.native import read_native
from tests.editing.making import CONFORMANCE, SHIPPED, room


@pytest.mark.parametrize("ending", [".toml", ".json"])
def test_a_new_file_is_made_with_its_folders(ending: str, tmp_path: Path) -> None:
    path = tmp_path / "mine" / f"maze{ending}"
    saved = save_level(room(), path)
    assert (saved.name, saved.source) == ("maze", str(path))
    assert (load_level(path).walls == room().walls).all()
    assert [file.name for file in path.parent.iterdir()] == [path.name]
    path.write_text("walls = 3")  # a broken file is replaced
    save_level(room(), path)
    assert ending == ".json" or alike(load_level(path), room())  # that one has no title


def test_a_file_of_the_web_platform_that_says_the_same_is_not_touched(tmp_path: Path) -> None:
    path = tmp_path / "garden.json"
    text = CONFORMANCE[0].read_text()
    path.write_text(text)
    level = load_level(path)
    save_level(level, path)
    assert path.read_text() == text
    save_level(change(level, Ref("robots", 0), x=7.0), path)
    assert load_level(path).robots[0].x == 7


def test_a_file_is_made_here_if_this_game_would_write_it_like_that(tmp_path: Path) -> None:
    path = tmp_path / "garden.json"
    assert is_made_here(path)
    path.write_text(CONFORMANCE[0].read_text())
    assert not is_made_here(path)
    save_level(change(load_level(path), Ref("robots", 0), x=7.0), path)
    assert is_made_here(path)
    path.write_text("something else")
    assert not is_made_here(path)
    assert is_made_here(SHIPPED[0])


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("level.txt", {}, "no ending of a level format"),
        ("level.toml", {"robots": ()}, "The level has no robots."),
        ("level.toml", {"robots": (Robot("A", 1, 1),) * 2}, 'robots are called "A"'),
        ("level.json", {"beacons": (Beacon("n" * 61, 1, 1),)}, "longer than 60"),
    ],
)
def test_what_could_not_be_loaded_is_not_saved(
    name: str, changes: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    with pytest.raises(LevelError, match=message) as caught:
        save_level(replace(room(), **changes), path)
    assert caught.value.place == str(path)
    assert not path.exists()


def test_a_file_that_can_not_be_written_or_is_ours_says_so(tmp_path: Path) -> None:
    with pytest.raises(LevelError, match="can't be changed"):
        save_level(room(), SHIPPED[0])
    (tmp_path / "file").write_text("")
    with pytest.raises(LevelError, match="can't be written"):
        save_level(room(), tmp_path / "file" / "level.toml")


def test_in_a_folder_that_is_gone_nothing_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    here.rmdir()
    with pytest.raises(LevelError, match="can't be written"):
        save_level(room(), Path("level.toml"))


PLACED = {
    "name": st.text(st.sampled_from("abc"), min_size=1),
    "x": st.integers(0, 9),
    "y": st.integers(0, 9),
}
COLORED = {**PLACED, "color": st.just("red")}
FLAGS = st.booleans()
WEB_LEVELS = st.fixed_dictionaries(
    {
        "width": st.just(3),
        "height": st.just(2),
        "walls": st.text("01", min_size=6, max_size=6),
        "robots": st.lists(
            st.fixed_dictionaries(
                COLORED,
                optional={
                    "angle": st.floats(-9, 9),
                    "has_battery": FLAGS,
                    "can_charge": FLAGS,
                    "battery_capacity": st.integers(0, 9),
                    "battery_consumption_rate": st.floats(0, 9),
                },
            ),
            min_size=1,
            unique_by=lambda robot: robot["name"],
        ),
        "beacons": st.lists(st.fixed_dictionaries(PLACED, optional={"charging_station": FLAGS})),
        "areas": st.lists(
            st.fixed_dictionaries(
                {**COLORED, "radius": st.integers(0, 9), "victory_robots": st.just(["a"])},
                optional={
                    "on_beacon": st.sampled_from(["", "a"]),
                    "off_beacon": st.sampled_from(["", "a"]),
                    "sticky_switch": FLAGS,
                    "impenetrable": FLAGS,
                },
            )
        ),
    }
)


@settings(deadline=None)
@given(WEB_LEVELS)
def test_nothing_is_added_to_a_level_of_the_platform_on_its_way_there_and_back(
    written: dict[str, Any],
) -> None:
    level = read_web(json.dumps(written), "level", "")
    again = json.loads(write_web(read_native(write_native(level), "level", "")))
    assert again.keys() == written.keys()
    assert again["walls"] == written["walls"]
    for kind in ("robots", "beacons", "areas"):
        for one, other in zip(again[kind], written[kind], strict=True):
            assert one.items() <= other.items()
