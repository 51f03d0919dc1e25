"""``logical-robots why``: which rule gave a decision, and what stopped the others."""

from pathlib import Path
from typing import Any

import pytest

from tests.cli.running import Ask, Command, shown
from tests.lab.laboratory import write_files

TWO_RULES = """\
Speed(d) = 1 :- d > 20;
Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: "far") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d > 20;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "near") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d <= 20;
"""


@pytest.fixture
def two(tmp_path: Path) -> Path:
    return write_files(tmp_path, {"two.l": TWO_RULES}) / "two.l"


@pytest.fixture
def why(command: Command, level: Path, two: Path) -> Ask:
    return lambda *words: command("why", level, two, "--tick", 3, "--robot", "Pip", *words)


def test_each_rule_says_what_it_gave_or_what_stopped_it(why: Ask, level: Path, two: Path) -> None:
    told = why()
    assert (told.status, told.data["rows"], told.data["row"]["memory"]) == (0, 1, "far")
    far, near = told.data["rules"]
    assert (far["line"], far["rows"], far["gives_row"], far["stopped_by"]) == (2, 1, True, None)
    assert (near["line"], near["rows"], near["stopped_by"]) == (4, 0, "d <= 20")
    assert near["stopped_at_line"] == 5
    in_terminal = shown("why", level, two, "--tick", 3, "--robot", "Pip")
    for words in ("Robot for Pip at tick 3", "(gives this row)", "- d <= 20  (no match)"):
        assert words in in_terminal.text
    assert "--predicate 'Speed(" in in_terminal.text


def test_one_step_deeper_and_with_values_of_ones_own(why: Ask) -> None:
    asked = [node["asked"] for node in _walk(*why().data["tree"]) if "asked" in node]
    assert asked[0]["predicate"] == "Speed"
    given = [f"--given={column}={value}" for column, value in asked[0]["given"].items()]
    assert why("--predicate", "Speed", *given).data["rules"][0]["rows"] == 1
    told = why("--predicate", "Speed", "--given", "col0=9")
    assert (told.status, told.data["rules"][0]["stopped_by"]) == (1, "d > 20")
    there, low = why("--predicate", "Speed(30)"), why("--predicate", "Speed(5)")
    assert (there.status, there.data["row"]["d"]) == (0, 30)
    assert (low.status, low.data["rules"][0]["stopped_by"]) == (1, "d > 20")


def test_a_tree_goes_down_to_what_was_sensed(why: Ask) -> None:
    kinds = [node["kind"] for node in _walk(*why("--tree").data["tree"])]
    assert kinds.count("rule") == 2
    assert "read" in kinds
    shallow = why("--tree", "--depth", 1).data["tree"]
    assert [node["kind"] for node in _walk(*shallow)].count("rule") == 1


def _walk(*nodes: dict[str, Any]) -> list[dict[str, Any]]:
    return [each for node in nodes for each in (node, *_walk(*node.get("children", ())))]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--robot", "Pop"], "There is no robot Pop. There is Pip."),
        (["--predicate", "Robbot"], "There is no predicate Robbot."),
        (["--predicate", "Speed"], "Speed is a function of d"),
        (["--given", "nonsense"], "'nonsense' is not COLUMN=VALUE"),
        (["--predicate", "Speed(x + 1)"], "This is not a value"),
        (["--predicate", "Speed(1"], "This '(' is never closed"),
        (["--predicate", "Robot(pace: 1)"], "Robot has no column pace"),
        (["--predicate", "Speed(d: 7, col0: 5)"], ""),
        (["--tick", "0"], "'0' is not an integer of at least 1"),
    ],
)
def test_what_is_not_there_is_named(why: Ask, more: list[str], message: str) -> None:
    assert message in why(*more).refusal


def test_a_line_that_is_too_long_shows_that_it_is_cut(level: Path, ahead: Path) -> None:
    ahead.write_text(ahead.read_text().replace("name:);", "name:, sensor:), all = sensor.radar;"))
    told = shown("why", level, ahead, "--tick", 3, "--robot", "Pip")
    (line,) = (line for line in told.lines if " all = sensor.radar = [" in line)
    assert line.endswith("...")


def test_what_would_have_to_differ_is_told_of_a_rule(why: Ask, level: Path, two: Path) -> None:
    two.write_text(
        "Near(robot_name:) :-\n"
        "  Sensor(robot_name:, sensor:), sensor.clock > 5;\n"
        'Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-\n'
        "  Sensor(robot_name:), ~Near(robot_name:);\n"
    )
    (only,) = why("--predicate", "Near").data["nearest"]
    assert (only["rule"], only["line"], only["text"]) == (1, 2, "5")
    sentence = "Change `5` to `2` in line 2: `sensor.clock` is 3, 2 too little."
    assert only["said"] == sentence
    seen = shown("why", level, two, "--tick", 3, "--robot", "Pip", "--predicate", "Near", status=1)
    assert "This change would give the rule in line 1 a row:" in seen.text
    assert f"  {sentence}" in seen.text
    assert why().data["nearest"] == []
