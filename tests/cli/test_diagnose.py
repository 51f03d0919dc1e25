"""``logical-robots diagnose``: what stands out in a run, for people and for scripts."""

from pathlib import Path

import pytest

from logical_robots_tui.game import load_program
from tests.cli.running import Ask, Command, shown
from tests.installed import CHECKOUT

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
