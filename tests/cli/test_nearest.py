"""``logical-robots nearest``: which one change would have given a rule a row."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.cli.running import in_terminal

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command

CLOSE = """\
Near(robot_name:) :-
  Sensor(robot_name:, sensor:), sensor.clock > 5;
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "") :-
  Sensor(robot_name:), ~Near(robot_name:);
"""


@pytest.fixture
def close(tmp_path: Path) -> Path:
    path = tmp_path / "close.l"
    path.write_text(CLOSE)
    return path


def test_the_threshold_is_named_with_what_would_have_met_it(
    command: Command, level: Path, close: Path
) -> None:
    asked = ("--tick", 3, "--robot", "Pip", "--predicate", "Near")
    told = command("nearest", level, close, *asked)
    assert told.status == 0
    (only,) = told.data
    assert (only["rule"], only["line"], only["text"]) == (1, 2, "5")
    assert only["said"] == "`sensor.clock > 5` is missed: sensor.clock is 2 too little."
    with in_terminal("nearest", level, close, *asked) as terminal:
        assert terminal.finish() == 0
        assert "For the rule in line 1 to have a row, one of:" in terminal.text
        assert "line 2, 5: write 2.997" in terminal.text


def test_a_rule_that_has_a_row_misses_nothing(command: Command, level: Path, close: Path) -> None:
    told = command("nearest", level, close, "--tick", 3, "--robot", "Pip")
    assert told.status == 1
    assert told.data == []
    with in_terminal("nearest", level, close, "--tick", 3, "--robot", "Pip") as terminal:
        assert terminal.finish() == 1
        assert "No single change" in terminal.text


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--robot", "Pop"], "there is no robot Pop. There is Pip."),
        (["--robot", "Pip", "--predicate", "Robbot"], "there is no predicate Robbot."),
    ],
)
def test_what_is_not_there_is_named(
    command: Command, level: Path, close: Path, more: list[str], message: str
) -> None:
    told = command("nearest", level, close, "--tick", 2, *more)
    assert told.status == 2
    assert message in told.err
