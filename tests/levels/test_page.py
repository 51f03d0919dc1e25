"""The page about levels and its examples: true, complete, and the examples run."""

import re
from pathlib import Path

import pytest

from logical_robots_tui.editing.checks import check
from logical_robots_tui.world import LevelError, Score, Team, load_level
from tests.levels.playing import ticks_to_win

PAGE = Path(__file__).parents[2] / "docs" / "levels.md"


def examples() -> list[str]:
    return re.findall(r"^```toml\n(.*?)^```$", PAGE.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def example() -> str:
    return examples()[0]


def arena() -> str:
    """The example of a level with teams, which leaves out what the first one has."""
    head, _, _ = example().partition("[[robots]]")
    return head + examples()[1]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "gate.toml"
    path.write_text(example(), "utf-8")
    return path


def test_the_example_is_a_level_without_likely_mistakes_that_can_be_played(file: Path) -> None:
    level = load_level(file)
    assert (level.name, level.title) == ("gate", "Two at the gate")
    assert (level.width, level.height) == (300, 90)
    assert [robot.name for robot in level.robots] == ["Ann", "Bob"]
    assert check(level) == []
    text = """
    Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") :-
      Sensor(robot_name:);
    """
    assert ticks_to_win(level, text, 20) is None


def test_the_example_with_teams_is_a_level(file: Path) -> None:
    file.write_text(arena(), "utf-8")
    level = load_level(file)
    assert level.teams == (Team("red", "obstacle-avoider"), Team("blue"))
    assert [robot.team for robot in level.robots] == ["red", "blue"]
    assert level.scores == (Score("hold", "garden", 2), Score("charged", points=100))
    assert (level.match_ticks, level.divided_charge) == (1000, True)
    assert (level.solid_robots, level.all_goals) == (True, False)
    assert level.shuffled_names == ("R*",)


EVERY_TABLE = [
    # text of the example, which is followed by a key that means nothing
    *("cell = 10\n", "visibility = {", "questions = [\n  {", "battery = {"),
    *(f"[[{table}]]\n" for table in ("robots", "beacons", "areas", "teams", "scores")),
]
TABLES = {"robots", "beacons", "areas", "teams", "scores"}


@pytest.mark.parametrize("place", EVERY_TABLE)
def test_example_and_page_name_every_key_that_a_level_knows(file: Path, place: str) -> None:
    text = example() if place in example() else arena()
    unknown = "zzz = 1\n" if place.endswith("\n") else "zzz = 1, "
    file.write_text(text.replace(place, place + unknown, 1), "utf-8")
    with pytest.raises(LevelError) as caught:
        load_level(file)
    known = caught.value.hint.removeprefix("Known keys: ").removesuffix(".").split(", ")
    assert len(known) > 1
    explained = PAGE.read_text("utf-8")
    for text in examples():
        explained = explained.replace(text, "")
    for key in set(known) - TABLES:
        assert f"`{key}`" in explained
        assert re.search(rf"\b{key} = ", "".join(examples()))
    for key in TABLES:
        assert f"`[[{key}]]`" in explained
