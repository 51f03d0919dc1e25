"""``why``, ``origin`` and ``diagnose``: rules that gave a row or stopped, values, whole runs."""

from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import load_program
from tests.cli.running import Ask, Command, shown
from tests.installed import CHECKOUT
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


# A program that notes the clock once, and keeps it.
KEEPER = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {at:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  at = (if sensor.clock == 3 then sensor.clock else memory.at);
"""
HALF = """\
Half(robot_name:, x:) :- Sensor(robot_name:, sensor:), x == sensor.clock / 2;
Robot(robot_name:, desire: {left_engine: x + 1, right_engine: 0}) :-
  Half(robot_name:, x:);
"""


@pytest.fixture
def asked(level: Path, ahead: Path) -> tuple[object, ...]:
    ahead.write_text(KEEPER)
    return ("origin", level, ahead, "--tick", 8, "--robot", "Pip")


def test_tick_line_and_what_was_read_are_told(command: Command, asked: tuple[object, ...]) -> None:
    (link,) = command(*asked, "--value", "memory.at", status=0).data["links"]
    assert (link["value"], link["tick"], link["until"], link["rule_line"]) == (3, 3, 8, 1)
    assert [(read["name"], read["value"]) for read in link["from"]] == [("sensor.clock", 3)]
    seen = shown(*asked, "--value", "memory.at")
    assert "1. Pip's memory.at = 3" in seen.text
    assert "the same since tick 3, set then by the rule in line 1" in seen.text
    assert "read from Pip's sensor.clock = 3" in seen.text


def test_a_value_of_a_predicate_is_traced(
    command: Command, asked: tuple[object, ...], ahead: Path
) -> None:
    ahead.write_text(HALF)
    engine, x = command(*asked, "--value", "desire.left_engine").data["links"]
    told = (engine["name"], engine["value"], engine["text"])
    assert told == ("Pip's desire.left_engine", 5, "x + 1")
    assert (x["name"], x["text"], x["from"][0]["value"]) == ("x", "sensor.clock / 2", 8)
    (half,) = command(*asked, "--predicate", "Half").data["links"]
    assert (half["name"], half["value"]) == ("Pip's Half.x", 4)


def test_a_part_that_is_not_there_is_named(command: Command, asked: tuple[object, ...]) -> None:
    assert "'at[x]' is not a part" in command(*asked, "--value", "at[x]").refusal
    assert "This value has no part of" in command(*asked, "--value", "memory.of").refusal


BROKEN = """\
Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.forward_distance < 0;
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-
  Sensor(robot_name:), ~Near(robot_name:);
"""


def test_findings_are_told_with_line_and_tick(command: Command, level: Path, ahead: Path) -> None:
    ahead.write_text(BROKEN)
    told = command("diagnose", level, ahead, "--ticks", 5, status=0)
    data = told.data
    assert (data["first"], data["last"], data["won_at"]) == (1, 5, None)
    finding = data["findings"][0]
    assert (finding["severity"], finding["kind"], finding["line"]) == ("note", "no rows", 1)
    assert finding["tick"] == 1
    assert "The rule of Near in line 1 never had a row" in finding["message"]
    assert finding["hint"]
    seen = shown("diagnose", level, ahead, "--ticks", "5")
    assert "Ticks 1 to 5, not won." in seen.text
    assert "note, line 1, tick 1: The rule of Near" in seen.text
    told = command("diagnose", level, ahead, status=0)
    assert told.data["won_at"]
    severities = {finding["severity"] for finding in told.data["findings"]}
    assert severities == {"note"}, "of a robot that wins there are only notes"


def test_it_says_where_nothing_stands_out(short: Ask, level: Path, ahead: Path) -> None:
    told = short("diagnose")
    assert told.status == 0
    assert told.data["won_at"]
    assert told.data["findings"] == []
    assert "Nothing stands out." in shown("diagnose", level, ahead).text


@pytest.mark.slow
def test_the_page_shows_what_the_command_says(tmp_path: Path) -> None:
    example = (CHECKOUT / "docs" / "diagnose.md").read_text().split("```")[3].strip("\n")
    assert example.startswith("Ticks 1 to")
    program = tmp_path / "harbor.l"
    lines = load_program("lighthouse").text.split("\n")
    assert '"Harbour"' in lines[18]
    lines[18] = lines[18].replace('"Harbour"', '"Harbor"')
    program.write_text("\n".join(lines))
    told = shown("diagnose", "05-lighthouse", program, size=(80, 40), status=1)
    for line in example.splitlines():
        assert line in told.lines
