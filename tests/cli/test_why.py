"""``logical-robots why``: which rule gave a decision, and what stopped the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from tests.cli.running import shown

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command

TWO_RULES = """\
Speed(d) = 1 :- d > 20;
Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: "far") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d > 20;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "near") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d <= 20;
"""


@pytest.fixture
def two(tmp_path: Path) -> Path:
    path = tmp_path / "two.l"
    path.write_text(TWO_RULES)
    return path


def test_each_rule_says_whether_it_gave_a_row_and_what_stopped_it(
    command: Command, level: Path, two: Path
) -> None:
    told = command("why", level, two, "--tick", 3, "--robot", "Pip")
    assert told.status == 0
    assert told.data["rows"] == 1
    assert told.data["row"]["memory"] == "far"
    far, near = told.data["rules"]
    assert (far["line"], far["rows"], far["gives_row"], far["stopped_by"]) == (2, 1, True, None)
    assert (near["line"], near["rows"], near["stopped_by"]) == (4, 0, "d <= 20")
    assert near["stopped_at_line"] == 5


def test_one_step_deeper(command: Command, level: Path, two: Path) -> None:
    asked = _asked(command("why", level, two, "--tick", 3, "--robot", "Pip").data["tree"])
    assert asked[0]["predicate"] == "Speed"
    question = ("why", level, two, "--tick", 3, "--robot", "Pip", "--predicate", "Speed")
    given = [f"--given={column}={value}" for column, value in asked[0]["given"].items()]
    assert command(*question, *given).data["rules"][0]["rows"] == 1
    told = command(*question, "--given", "col0=9")
    assert told.status == 1
    assert told.data["rules"][0]["stopped_by"] == "d > 20"


def test_a_tree_goes_down_to_what_was_sensed(command: Command, level: Path, two: Path) -> None:
    question = ("why", level, two, "--tick", 3, "--robot", "Pip", "--tree")
    (root,) = command(*question).data["tree"]
    kinds = [node["kind"] for node in _walk(root)]
    assert kinds.count("rule") == 2
    assert "read" in kinds
    (shallow,) = command(*question, "--depth", 1).data["tree"]
    assert [node["kind"] for node in _walk(shallow)].count("rule") == 1


def _walk(node: dict[str, Any]) -> list[dict[str, Any]]:
    return [node, *(each for child in node.get("children", ()) for each in _walk(child))]


def _asked(nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [each["asked"] for node in nodes for each in _walk(node) if "asked" in each]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--robot", "Pop"], "There is no robot Pop. There is Pip."),
        (["--robot", "Pip", "--predicate", "Robbot"], "There is no predicate Robbot."),
        (["--robot", "Pip", "--predicate", "Speed"], "Speed is a function of d"),
        (["--robot", "Pip", "--given", "nonsense"], "'nonsense' is not COLUMN=VALUE"),
        (["--robot", "Pip", "--predicate", "Speed(x + 1)"], "This is not a value"),
        (["--robot", "Pip", "--predicate", "Speed(1"], "This '(' is never closed"),
        (["--robot", "Pip", "--predicate", "Robot(pace: 1)"], "Robot has no column pace"),
        (["--robot", "Pip", "--tick", "0"], "'0' is not an integer of at least 1"),
    ],
)
def test_what_is_not_there_is_named(
    command: Command, level: Path, two: Path, more: list[str], message: str
) -> None:
    told = command("why", level, two, "--tick", 2, *more)
    assert told.status == 2
    assert message in told.err


def test_values_of_ones_own_show_where_a_rule_stops_then(
    command: Command, level: Path, two: Path
) -> None:
    asked = ("why", level, two, "--tick", 2, "--robot", "Pip", "--predicate")
    there, low = command(*asked, "Speed(30)"), command(*asked, "Speed(d: 7, col0: 5)")
    assert (there.status, there.data["row"]["d"]) == (0, 30)
    assert low.status == 2
    low = command(*asked, "Speed(5)")
    assert (low.status, low.data["rules"][0]["stopped_by"]) == (1, "d > 20")


def test_in_a_terminal_it_is_told_line_by_line(level: Path, two: Path) -> None:
    told = shown("why", level, two, "--tick", 3, "--robot", "Pip")
    assert told.status == 0
    assert "Robot for Pip at tick 3" in told.text
    assert "(gives this row)" in told.text
    assert "- d <= 20  (no match)" in told.text
    assert "--predicate 'Speed(" in told.text


def test_a_line_that_is_too_long_shows_that_it_is_cut(level: Path, tmp_path: Path) -> None:
    program = tmp_path / "long.l"
    program.write_text(
        'Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") :-\n'
        "  Sensor(robot_name:, sensor:), all = sensor.radar;\n"
    )
    told = shown("why", level, program, "--tick", 3, "--robot", "Pip")
    assert told.status == 0
    (line,) = (line for line in told.lines if " all = sensor.radar = [" in line)
    assert line.endswith("...")


def test_what_would_have_to_differ_is_told_of_a_rule_without_a_row(
    command: Command, level: Path, tmp_path: Path
) -> None:
    program = tmp_path / "close.l"
    program.write_text(
        "Near(robot_name:) :-\n"
        "  Sensor(robot_name:, sensor:), sensor.clock > 5;\n"
        'Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-\n'
        "  Sensor(robot_name:), ~Near(robot_name:);\n"
    )
    asked = ("why", level, program, "--tick", 3, "--robot", "Pip", "--predicate", "Near")
    (only,) = command(*asked).data["nearest"]
    assert (only["rule"], only["line"], only["text"]) == (1, 2, "5")
    sentence = "Change `5` to `2` in line 2: `sensor.clock` is 3, 2 too little."
    assert only["said"] == sentence
    seen = shown(*asked)
    assert seen.status == 1
    assert "This change would give the rule in line 1 a row:" in seen.text
    assert f"  {sentence}" in seen.text
    told = command("why", level, program, "--tick", 3, "--robot", "Pip")
    assert told.data["nearest"] == []
