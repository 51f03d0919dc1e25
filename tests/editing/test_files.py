"""Saving levels: nothing is lost, what didn't change keeps its bytes, and what can't be saved."""

import difflib
import json
import math
import re
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.editing.entities import Ref, add, change, remove, resize, set_words
from logical_robots_tui.editing.files import is_made_here, rewrite_text, save_level
from logical_robots_tui.editing.level_text import lost_in_web, record_of, write_native, write_web
from logical_robots_tui.editing.strokes import paint, paint_rectangle
from logical_robots_tui.world import Area, Beacon, Level, LevelError, Robot, Visibility, load_level
from logical_robots_tui.world.level import Cycle, Sensors, alike
from logical_robots_tui.world.levels.load import read_web
from logical_robots_tui.world.levels.native import read_native
from tests.editing.making import CONFORMANCE, EDITS, SHIPPED, Edit, room
from tests.world.making import levels

BY_HAND = """\
# A level made by hand.
title   =   'Mixed'          # in many ways
"cell" = 10
lenient = false

walls = '''
########
#.. ...#
#  ....#
2* 1# 6. 1#
########'''      # five rows

hints = ["one",
  # the second one is better
  "two"]

# Ann is the first.
[[robots]]
x = 1_5.50 # in the corner
y = 15
name = "Ann"
heading = 0

  # Everybody goes home.
  [[areas]]
  name = "home" # sweet home
  x = 60
  y = 20
  radius = 7.0
  sticky = false
  goal_for = [ "Ann", 'Bob' ]

[[robots]]
# Bob has a battery.
name = "Bob"
x = 3e1
y = 30
[robots.battery]
# He is the only one.
capacity = 100 # units

[[beacons]]
name = "lamp"
x = 50
y = 30"""
INLINE = """\
title = "Inline" # on one line
cell = 10
walls = "####\\n#..#\\n####"
robots = [{name = "Ann", x = 15, y = 15}]
areas = [{name = "home", x = 25, y = 15, radius = 5}] # only one
"""
NEAR = (1.15 + i / 2**52 for i in range(10_000))
IN_NO_DEGREES = next(angle for angle in NEAR if "angle" in record_of(Robot("Ann", 0, 0, angle)))


def read(text: str) -> Level:
    return read_native(text.replace("\r\n", "\n"), "level", "level.toml")


def changed_lines(before: str, after: str) -> list[str]:
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm="")
    return [line for line in lines if not line.startswith(("---", "+++", "@@"))]


def after(text: str, level: Level) -> str:
    new = rewrite_text(text, level)
    assert alike(read(new.removeprefix("\ufeff")), level)
    return new


@settings(deadline=None)
@given(
    st.lists(st.one_of(EDITS, st.sampled_from(["undo", "redo", "save"])), max_size=15),
    st.sampled_from([BY_HAND, INLINE, SHIPPED[0].read_text()]),
)
def test_any_sequence_of_edits_and_saves_loads_back(steps: Sequence[Edit | str], text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "level.toml"
        path.write_text(text, encoding="utf-8")
        edits = Edits(load_level(path))
        for step in [*steps, "save"]:
            if isinstance(step, Edit):
                edits.do(step.what, step(edits.level))
            elif step == "save":
                save_level(edits.level, path)
                edits.mark_saved()
                assert alike(load_level(path), edits.level)
                assert not edits.is_changed
            else:
                getattr(edits, step)()


def says_no_more(level: Level, original: dict[str, Any]) -> dict[str, Any]:
    """What a file of the platform says of a level; it adds nothing to the original."""
    again: dict[str, Any] = json.loads(write_web(level))
    assert again.keys() == original.keys()
    assert again["walls"] == original["walls"].replace("2", "0")
    for kind in ("robots", "beacons", "areas"):
        for record, before in zip(again[kind], original[kind], strict=True):
            assert record.items() <= before.items()
    return again


@settings(deadline=None)
@given(levels())
def test_a_level_of_the_web_platform_becomes_one_of_this_game_and_comes_back(level: Level) -> None:
    web = read_web(write_web(level), "level", "")
    native = read_native(write_native(web), "level", "")
    assert alike(native, web)
    assert alike(read_web(write_web(native), "level", ""), web)
    assert web.walls.tobytes() == level.walls.tobytes()
    assert (web.robots, web.beacons, web.areas) == (level.robots, level.beacons, level.areas)


@pytest.mark.sampled
@pytest.mark.parametrize("path", CONFORMANCE, ids=lambda path: path.stem)
def test_levels_of_the_platform_pass_through_both_formats(path: Path) -> None:
    level = load_level(path)
    native = read_native(write_native(level), path.stem, "")
    assert alike(native, level)
    original = json.loads(path.read_text())
    again = says_no_more(native, original)
    assert [robot["x"] for robot in again["robots"]] == [r["x"] for r in original["robots"]]


@pytest.mark.sampled
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_our_own_levels_are_written_anew_without_loss(path: Path) -> None:
    level = load_level(path)
    text = write_native(level)
    assert alike(read(text), level)
    after_walls = [file.split("walls = '''")[1] for file in (text, path.read_text())]
    assert len({rest.partition("'''")[0] for rest in after_walls}) == 1
    assert write_native(read(text)) == text


@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_a_save_without_a_change_changes_no_byte(mark: str, tmp_path: Path) -> None:
    path = tmp_path / "level.toml"
    for text in (BY_HAND, INLINE, *(file.read_text() for file in SHIPPED)):
        for ends in ("\n", "\r\n"):
            content = (mark + text.replace("\n", ends)).encode()
            path.write_bytes(content)
            before = path.stat()
            save_level(load_level(path), path)
            assert path.read_bytes() == content
            assert path.stat().st_ino == before.st_ino


HAND = read(BY_HAND)
ANN, BOB, HOME, LAMP = (Ref("robots", 0), Ref("robots", 1), Ref("areas", 0), Ref("beacons", 0))
BOB_ALONE = '-  radius = 7.0|+  radius = 9|-  goal_for = [ "Ann", \'Bob\' ]|+  goal_for = ["Bob"]'
OTHER = (
    "-title   =   'Mixed'          # in many ways|+title   =   \"Other\"          # in many ways"
)
DIFFERENCES = [
    (change(HAND, ANN, x=20.5), "-x = 1_5.50 # in the corner|+x = 20.5 # in the corner"),
    (change(HAND, HOME, radius=9.0, victory_robots=("Bob",)), BOB_ALONE),
    (change(HAND, HOME, sticky_switch=True), "-  sticky = false|+  sticky = true"),
    (change(HAND, BOB, battery_capacity=90), "-capacity = 100 # units|+capacity = 90 # units"),
    (change(HAND, ANN, angle=math.radians(-30)), "-heading = 0|+heading = -30"),
    (change(HAND, ANN, angle=IN_NO_DEGREES), f"-heading = 0|+angle = {IN_NO_DEGREES!r}"),
    (add(HAND, Beacon("bell", 5, 6))[0], '+|+[[beacons]]|+name = "bell"|+x = 5|+y = 6'),
    (add(HAND, Robot("Cid", 5, 6))[0], '+[[robots]]|+name = "Cid"|+x = 5|+y = 6|+'),
    (remove(HAND, LAMP), '-[[beacons]]|-name = "lamp"|-x = 50|-y = 30'),
    (set_words(HAND, title="Other"), OTHER),
    (set_words(HAND, idea="New."), '+idea = "New."'),
    (set_words(HAND, hints=("one", "2")), '-  "two"]|+  "2"]'),  # comments in it stay
    (paint(HAND, [(35, 15)], width=1, grid=10), "-#.. ...#|+#..#...#"),
    (paint(HAND, [(35, 35)], width=1, grid=10), "-2* 1# 6. 1#|+1# 2. 1# 3. 1#|+1# 6. 1#"),
]


def test_a_small_change_is_a_small_difference() -> None:
    for level, difference in DIFFERENCES:
        assert changed_lines(BY_HAND, after(BY_HAND, level)) == difference.split("|")


def test_line_ends_and_a_mark_of_another_system_and_every_comment_stay() -> None:
    text = "\ufeff" + BY_HAND.replace("\n", "\r\n")
    new = after(text, paint(change(HAND, ANN, x=20.0), [(35, 15)], grid=10))
    assert new.startswith("\ufeff")
    assert new.count("\r\n") == new.count("\n") == text.count("\n")
    level = HAND
    for ref in (ANN, BOB, HOME, LAMP):
        level = change(level, ref, name=f"new {ref.kind} {ref.index}", x=33.25, y=21.0)
    level = set_words(level, title="Other", visibility=Visibility("all", "all"), briefing="Go.")
    many = after(BY_HAND, add(resize(level, 90, 50), Area("far", 80, 20, 5))[0])
    finer = after(BY_HAND, paint(HAND, [(35.5, 15.5)]))
    assert '"cell" = 1\n' in finer
    comments = re.findall(r"# [A-Za-z].*$", BY_HAND, re.MULTILINE)
    assert len(comments) > 8
    assert [comment for comment in comments if comment not in many or comment not in finer] == []
    assert "lenient = true" in after(BY_HAND, change(HAND, HOME, on_beacon="nothing"))


def test_neither_a_row_that_ends_the_drawing_nor_words_like_our_own_mark_confuse() -> None:
    worded = BY_HAND.replace("'Mixed'", '"the drawing, the drawing itself"')
    ended = BY_HAND.replace("'''      # five rows\n\nhints", "'''\n# Ann.\nhints")
    assert "####'''\n# Ann.\nhints" in ended
    for text in (worded, ended):
        new = after(text, paint(read(text), [(15, 15)], grid=10))
        assert changed_lines(text, new) == ["-#.. ...#", "+##. ...#"]
    new = after(ended, change(read(ended), BOB, y=16.0))
    assert changed_lines(ended, new) == ["-y = 30", "+y = 16"]


def test_what_is_written_on_one_line_is_changed_there() -> None:
    level = change(read(INLINE), HOME, radius=6.0)
    assert changed_lines(INLINE, after(INLINE, level)) == [
        '-areas = [{name = "home", x = 25, y = 15, radius = 5}] # only one',
        '+areas = [{name = "home", x = 25, y = 15, radius = 6}] # only one',
    ]
    assert "# only one" in after(INLINE, paint(level, [(15, 15)], grid=5))


def test_a_file_laid_out_very_differently_is_written_anew() -> None:
    for kind in ("robots", "areas"):
        text = BY_HAND.replace(f"[[{kind}]]", f'[["{kind}"]]')
        after(text, change(read(text), ANN, x=20.0))


@pytest.mark.parametrize("size", [1000, pytest.param(4000, marks=pytest.mark.slow)])
def test_a_web_level_with_fine_walls_is_stored_compactly(size: int) -> None:
    level = resize(room(), size, size)
    level = paint_rectangle(level, (0, 0), (size - 1, size - 1), border=1)
    for x in range(0, size, 97):
        level = paint(level, [(x, 0), (x, 0.75 * size)])
    text = write_native(level)
    assert len(text) < 2_000
    assert alike(read(text), level)


def test_what_the_web_platform_can_not_say_is_named() -> None:
    assert lost_in_web(load_level(CONFORMANCE[0])) == []
    words = "title idea briefing hints lesson further story questions starter solution"
    lost = [*words.split(), "second_goals", "visibility", "sensors"]
    level = load_level("01-first-steps")
    assert lost_in_web(level) == lost[:-1]
    assert lost_in_web(replace(level, sensors=Sensors(rays=7))) == lost
    timed = replace(level, areas=(Area("Hill", 50, 50, 9, cycle=Cycle(4, 1, 2)),))
    assert lost_in_web(timed) == [*lost[:-1], "cycle"]
    assert "cycle" not in write_web(timed)


def test_a_new_file_is_made_with_its_folders(tmp_path: Path) -> None:
    for ending in (".toml", ".json"):
        path = tmp_path / ending / f"maze{ending}"
        saved = save_level(room(), path)
        assert (saved.name, saved.source) == ("maze", str(path))
        assert (load_level(path).walls == room().walls).all()
        assert [file.name for file in path.parent.iterdir()] == [path.name]
        path.write_text("walls = 3")  # a broken file is replaced
        save_level(room(), path)
        assert ending == ".json" or alike(load_level(path), room())  # that one has no title


def test_a_file_of_the_web_platform_that_says_the_same_is_not_touched(tmp_path: Path) -> None:
    path, text = tmp_path / "garden.json", CONFORMANCE[0].read_text()
    assert is_made_here(path)
    path.write_text(text)
    assert not is_made_here(path)
    level = load_level(path)
    save_level(level, path)
    assert path.read_text() == text
    save_level(change(level, ANN, x=7.0), path)
    assert load_level(path).robots[0].x == 7
    assert is_made_here(path)
    path.write_text("something else")
    assert not is_made_here(path)
    assert is_made_here(SHIPPED[0])


def test_what_could_not_be_loaded_is_not_saved(tmp_path: Path) -> None:
    twins = (Robot("A", 1, 1),) * 2
    changes: Any
    for name, changes, message in (
        ("level.txt", {}, "no ending of a level format"),
        ("level.toml", {"robots": ()}, "The level has no robots."),
        ("level.toml", {"robots": twins}, 'robots are called "A"'),
        ("level.json", {"beacons": (Beacon("n" * 61, 1, 1),)}, "longer than 60"),
    ):
        path = tmp_path / name
        with pytest.raises(LevelError, match=message) as caught:
            save_level(replace(room(), **changes), path)
        assert caught.value.place == str(path)
        assert not path.exists()


def test_an_unwritable_file_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "here").rmdir()
    files = [tmp_path / "file" / "level.toml", Path("level.toml")]
    for path, message in [(SHIPPED[0], "changed"), *((path, "written") for path in files)]:
        with pytest.raises(LevelError, match=f"can't be {message}"):
            save_level(room(), path)
