"""Finding levels, by path and by name."""

import os
from pathlib import Path

import pytest

from logical_robots_tui import paths
from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import did_you_mean, shipped_folder, shipped_names
from logical_robots_tui.world import LevelError, list_levels, load_level
from logical_robots_tui.world.levels import load
from tests.lab.laboratory import write_files

from .records import LEVELS
from .test_native import SMALL

WEB = LEVELS[0].read_text("utf-8")


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "place" / "package"
    folder.mkdir(parents=True)
    monkeypatch.setattr(paths, "__file__", str(folder / "paths.py"))
    return folder


@pytest.fixture
def levels(package: Path) -> Path:
    names = {"02-maze.toml": SMALL, "01-start.toml": SMALL, "03-web.json": WEB}
    return write_files(package / "levels", {**names, "notes.md": "No level."})


def refusal(path_or_name: str | Path) -> LevelError:
    with pytest.raises(LevelError) as caught:
        load_level(path_or_name)
    return caught.value


def test_what_ships_is_beside_the_package_in_a_checkout_and_inside_an_installed_copy(
    package: Path,
) -> None:
    (package.parent / "levels").mkdir()
    assert shipped_folder("levels") == package.parent / "levels"
    assert shipped_folder("programs") == package.parent / "programs"
    (package / "levels").mkdir()
    assert shipped_folder("levels") == package / "levels"


def test_levels_of_both_formats_are_listed_and_found_by_the_names_of_their_files(
    levels: Path,
) -> None:
    assert shipped_names("levels", ".toml") == ["01-start", "02-maze"]
    assert shipped_names("programs", ".l") == []
    assert list_levels() == ["01-start", "02-maze", "03-web"]
    assert len(list(levels.iterdir())) == 4
    level = load_level("02-maze")
    assert (level.name, level.source) == ("02-maze", str(levels / "02-maze.toml"))
    assert load_level("03-web").name == "03-web"


@pytest.mark.usefixtures("levels")
@pytest.mark.parametrize("name", ["maze", "11-maze"])
def test_a_shipped_level_is_found_without_its_number_and_by_an_earlier_one(name: str) -> None:
    assert load_level(name).name == "02-maze"


@pytest.mark.usefixtures("levels")
def test_a_wrong_name_asks_for_the_one_that_was_meant_or_a_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    error = refusal("02-mase")
    assert error.message == 'There is no level called "02-mase".'
    assert error.hint == 'Did you mean "02-maze"?'
    for name in ("", "zzzzzz", "*"):
        assert refusal(name).hint == "A path needs its ending, such as maze.toml."
    monkeypatch.chdir(tmp_path)
    for path in ("./02-maze", Path("02-maze"), tmp_path / "none" / "maze.toml"):
        assert refusal(path).message == "There is no such file."


def test_a_missing_file_shows_its_place_and_asks_which_one_was_meant(tmp_path: Path) -> None:
    (tmp_path / "maze.toml").write_text(SMALL)
    error = refusal(tmp_path / "mase.toml")
    assert isinstance(error, InputError)
    assert (error.place, error.message) == (str(tmp_path / "mase.toml"), "There is no such file.")
    assert error.hint == 'Did you mean "maze.toml"?'
    assert str(error) == f"{error.place}: {error.message} {error.hint}"


def test_what_is_no_ordinary_file_is_refused_without_waiting_for_it(tmp_path: Path) -> None:
    for folder in (".", "..", "/"):
        error = refusal(folder)
        assert (error.place, error.message) == (folder, "This is a folder, not a level.")
    os.mkfifo(tmp_path / "pipe.toml")
    assert refusal(tmp_path / "pipe.toml").message == "This is not a regular file."
    for path in ("maze\0.toml", "n" * 5000 + ".toml"):  # no system allows these
        assert refusal(path).message


def test_a_file_that_is_not_text_is_refused_at_its_line(tmp_path: Path) -> None:
    path = tmp_path / "maze.toml"
    path.write_bytes(b"title = 'A'\ncell = \xff\x00\x01\n")
    error = refusal(path)
    assert (error.place, error.message) == (f"{path}, line 2", "This file is not UTF-8 text.")
    assert error.hint.startswith("A level is a .toml file")


def test_a_huge_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(load, "MOST_BYTES", 2**20)
    path = tmp_path / "maze.toml"
    path.write_bytes(b"#" * (2**20 + 1))
    assert refusal(path).message == "The file is larger than 1 MB."
    path.write_bytes(b"#" * 2**20)
    assert "larger" not in refusal(path).message


def test_an_ending_decides_the_format_or_else_the_first_character(tmp_path: Path) -> None:
    files = {"a.JSON": SMALL, "b.toml": WEB, "native.txt": SMALL, "web": "\n  " + WEB}
    write_files(tmp_path, files)
    assert "JSON" in refusal(tmp_path / "a.JSON").message
    assert "TOML" in refusal(tmp_path / "b.toml").message
    assert load_level(str(tmp_path / "native.txt")).title == "Small"
    assert load_level(tmp_path / "web").name == "web"


def test_a_question_names_what_is_nearest_or_nothing_at_all() -> None:
    assert did_you_mean("ALPA", ["Alpha", "Beta"]) == 'Did you mean "Alpha"?'
    assert did_you_mean("xyz", ["Alpha", "Beta"]) == ""
    assert did_you_mean("", []) == ""


def test_the_number_of_a_shipped_level_is_a_name_of_it() -> None:
    assert load_level("5").name == load_level("05").name == "05-lighthouse"
    with pytest.raises(LevelError, match='no level called "99"'):
        load_level("99")
