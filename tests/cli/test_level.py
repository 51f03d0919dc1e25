"""``logical-robots level``: create, check, convert and show levels."""

import re
from collections import Counter
from html import escape
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from logical_robots_tui import list_levels, load_level
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.labyrinth.drawing.lettering import names_once
from logical_robots_tui.world.level import alike
from tests.cli.running import Command, shown


def test_a_room_is_made_and_nothing_looks_wrong_with_it(command: Command, tmp_path: Path) -> None:
    path = tmp_path / "mine" / "room.toml"
    told = command("level", "new", path, "--room", "300x200", "--wall", "5", "--title", "Hall")
    assert (told.status, told.err) == (0, "")
    assert told.out == f"{path}: Hall, 300 x 200 units.\nPlay it: logical-robots play {path}\n"
    assert not load_level(path).walls[5:-5, 5:-5].any()
    assert command("level", "check", path).out == ""


def test_a_labyrinth_of_one_seed_is_always_the_same(command: Command, tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("a.toml", "b.toml", "c.toml", "d.json")]
    for path, seed in zip(paths, (7, 7, 8, 7), strict=True):
        assert command("level", "new", path, "--labyrinth", "9x6", "--seed", seed).status == 0
    assert paths[0].read_text() == paths[1].read_text() != paths[2].read_text()
    assert (load_level(paths[0]).walls == load_level(paths[3]).walls).all()
    assert command("level", "check", *paths).out == ""


def test_a_copy_keeps_its_comments_and_can_be_called_otherwise(
    command: Command, level: Path, tmp_path: Path
) -> None:
    level.write_text("# Mine.\n" + level.read_text())
    same, other = tmp_path / "same.toml", tmp_path / "other.toml"
    assert command("level", "new", same, "--copy", level).status == 0
    assert same.read_text() == level.read_text()
    assert command("level", "new", other, "--copy", level, "--title", "Mine").status == 0
    assert other.read_text() == level.read_text().replace("A short way", "Mine")
    shipped = tmp_path / "shipped.toml"
    assert command("level", "new", shipped, "--copy", "01-first-steps").status == 0
    assert shipped.read_text() == (shipped_folder("levels") / "01-first-steps.toml").read_text()
    web = tmp_path / "web.json"
    assert command("level", "new", web, "--copy", level).status == 0
    assert load_level(web).robots == load_level(level).robots


def test_a_file_that_is_there_is_kept_unless_forced(command: Command, level: Path) -> None:
    before = level.read_text()
    assert "already exists" in command("level", "new", level).refusal
    assert command("level", "new", level, "--labyrinth", "99x99", "--force").status == 2
    assert level.read_text() == before
    assert command("level", "new", level, "--copy", level, "--force").status == 0
    assert level.read_text() == before
    assert command("level", "new", level, "--force").status == 0
    assert load_level(level).title == "Room"


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("--room 9", "is not a size such as 8x6"),
        ("--room 50x5000", "The labyrinth would be 50 x 5000 units; at most 4000 x 4000 "),
        ("--room 30x30", "A robot does not fit"),
        ("--room 90x90 --wall 0", "A wall must be 1 to 4000 units thick, not 0."),
        ("--labyrinth 1x1", "at least 2 cells, not 1 x 1"),
        ("--labyrinth 80x8", "The labyrinth would be 5610 x 570 units; at most 4000 x 4000 "),
        ("--labyrinth 8x8 --loops 2", "The share of loops must be between 0 and 1, not 2."),
        ("--labyrinth 8x8 --loops nan", "The share of loops must be between 0 and 1"),
        ("--labyrinth 8x8 --corridor 9", "A corridor must be 20 to 4000 units wide"),
        ("--copy nothing", "There is no level called"),
        ("--title=", '"title" is empty.'),
    ],
)
def test_what_makes_no_level_is_refused(
    typed: str, message: str, command: Command, tmp_path: Path
) -> None:
    path = tmp_path / "new.toml"
    assert message in command("level", "new", path, *typed.split()).refusal
    assert not path.exists()
    assert "Use .toml" in command("level", "new", tmp_path / "new.txt").err


def test_what_looks_wrong_or_is_not_loaded_is_told_of(command: Command, level: Path) -> None:
    text = level.read_text()
    level.write_text(text.replace("#..........#", "#....#.....#"))
    said = command("level", "check", level).success
    assert said == f'{level}: at 42, 12: warning: Pip can\'t reach the goal "Door".\n'
    level.write_text(text.replace("#..........#", "#...X......#", 1))
    told = command("level", "check", level, "01-first-steps", "--json")
    assert told.status == 2
    assert told.data["ok"] is False
    broken, fine = told.data["levels"]
    (finding,) = broken["findings"]
    assert finding["forbids"]
    assert finding["text"].startswith('row 2 of walls (line 5): Character 5 is "X"')
    assert fine == {"file": "01-first-steps", "findings": []}
    words = command("level", "check", level).out
    assert words.startswith(f"{level}: error: row 2 of walls (line 5): ")
    told = command("level", "check", f"{level.parent}/\x1b[31m.toml")
    assert told.status == 2
    assert "\x1b" not in told.out + told.err, "names can't reach the terminal as codes"


def test_a_level_goes_to_the_web_and_back(command: Command, level: Path, tmp_path: Path) -> None:
    web, back = tmp_path / "short.json", tmp_path / "back.toml"
    left_out = "Left out because the web platform does not support it: title, visibility."
    assert command("level", "convert", level, web).success == f"{left_out}\nWrote {web}.\n"
    assert command("level", "convert", web, back).out == f"Wrote {back}.\n"
    assert alike(load_level(web), load_level(back))
    assert load_level(back).areas == load_level(level).areas
    # A file is only replaced when that is forced.
    other = tmp_path / "other.toml"
    other.write_text("# precious")
    assert command("level", "convert", level, other).status == 2
    assert other.read_text() == "# precious"
    assert command("level", "convert", level, other, "--force").status == 0
    assert alike(load_level(other), load_level(level))


def test_a_level_is_drawn_in_colours_in_a_terminal_and_with_plain_characters_in_a_pipe(
    command: Command,
) -> None:
    told = command("level", "show", "05-lighthouse").success
    assert told.isascii()
    assert "Otter" in told
    assert len({len(line) for line in told.splitlines()}) == 1
    seen = shown("level", "show", "05-lighthouse")
    assert len({cell.bg for row in seen.screen.buffer.values() for cell in row.values()}) > 3
    assert "Otter" in seen.text


@pytest.mark.sampled
@pytest.mark.parametrize("name", list_levels())
def test_a_picture_has_the_names_of_beacons_and_areas(
    name: str, command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    level, path = load_level(name), tmp_path / "level.svg"
    drawn = command("level", "show", name).out
    assert command("level", "show", name, "--svg", path).status == 0
    for wanted, times in Counter(filter(None, names_once(level))).items():
        assert drawn.count(wanted) >= times
        assert f">{escape(wanted)}<" in path.read_text("utf-8")


def test_a_drawing_has_everything(command: Command, level: Path, tmp_path: Path) -> None:
    level.write_text(level.read_text().replace('"Door"', '"<Tür & Tor>"'))
    path = tmp_path / "short.svg"
    assert command("level", "show", level, "--svg", path).out == f"Wrote {path}.\n"
    root = ET.fromstring(path.read_text())
    assert root.get("viewBox") == "0 0 60 25"
    texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == ["<Tür & Tor>", "Pip"]
    walls = next(root.iter("{http://www.w3.org/2000/svg}path")).get("d")
    assert walls is not None
    sizes = re.findall(r"h(\d+)v(\d+)", walls)
    assert sum(int(w) * int(h) for w, h in sizes) == load_level(level).walls.sum()
    nowhere = tmp_path / "nowhere" / "a.svg"
    assert "can't be written" in command("level", "show", level, "--svg", nowhere).refusal
