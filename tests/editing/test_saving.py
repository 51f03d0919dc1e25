"""Files that levels are saved in, and what can't be saved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.editing.files import is_made_here, save_level
from logical_robots_tui.editing.things import Ref, change
from logical_robots_tui.world import (
    Beacon,
    LevelError,
    Robot,
    load_level,
)
from logical_robots_tui.world.level import alike
from tests.editing.making import CONFORMANCE, SHIPPED, room


@pytest.mark.parametrize("ending", [".toml", ".json"])
def test_a_new_file_is_made_with_its_folders(ending: str, tmp_path: Path) -> None:
    path = tmp_path / "mine" / f"maze{ending}"
    saved = save_level(room(), path)
    assert (saved.name, saved.source) == ("maze", str(path))
    assert (load_level(path).walls == room().walls).all()
    assert [file.name for file in path.parent.iterdir()] == [path.name]


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


def test_a_broken_file_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "level.toml"
    path.write_text("walls = 3")
    save_level(room(), path)
    assert alike(load_level(path), room())


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


def test_our_own_levels_are_not_overwritten() -> None:
    with pytest.raises(LevelError, match="can't be changed"):
        save_level(room(), SHIPPED[0])


def test_a_file_that_can_not_be_written_says_so(tmp_path: Path) -> None:
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
