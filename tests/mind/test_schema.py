"""What is known of a field is written once, and arrives wherever it is needed."""

import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

import logical_robots_tui
from logical_robots_tui import World, load_level
from logical_robots_tui.game.run import simulation_digest
from logical_robots_tui.mind.compilation import _digest_of_parts
from logical_robots_tui.schema import DESIRE, SENSOR, FieldType, ListOf, Type
from logical_robots_tui.values import Desire
from tests.processes import run_command

CLASSES = {Type.TRUTH: bool, Type.WHOLE: int, Type.REAL: (int, float), Type.TEXT: str}


def check(value: Any, field: FieldType) -> None:
    """Assert that a value of the world is as the schema says, with the fields in that order."""
    if isinstance(field, Type):
        assert isinstance(value, CLASSES[field]), value  # type: ignore[arg-type]  # of a mapping
    elif isinstance(field, ListOf):
        for each in value:
            check(each, field.element)
    else:
        assert tuple(value) == field.names
        for each in field.fields:
            check(value[each.name], each.type)


@pytest.mark.parametrize("level", ["04-everybody-home", "07-station-management", "13-swarm"])
def test_what_robots_sense_is_as_the_schema_says(level: str) -> None:
    for row in World(load_level(level)).sense():
        check(row["sensor"], SENSOR)


def test_a_desire_is_as_the_schema_says() -> None:
    assert tuple(Desire.__dataclass_fields__) == DESIRE.names


USES = """if True:
    import sys
    from docs.reference import language, page
    from logical_robots_tui import Mind, Program, ProgramError, World, load_level
    from logical_robots_tui.game.run import simulation_digest
    from logical_robots_tui.mind.compilation import _digest_of_parts
    from logical_robots_tui.language.services.completion import words_for

    program = '''
    Robot(robot_name:, desire: {left_engine: sensor.self.y, right_engine: 0}, memory: s) :-
      Sensor(robot_name:, sensor:), s = sensor.self;
    '''
    rows = World(load_level("01-first-steps")).sense()
    (row,) = rows
    assert row["sensor"]["self"]["y"] > 1
    (decision,) = Mind(Program.compile(program)).think(rows, {})
    assert decision.desire.left_engine == decision.memory["y"] == row["sensor"]["self"]["y"]
    tuned = Program.compile(program.replace("memory: s", "memory: 0")).tuned["Robot"]
    assert "y" in tuned.columns["Sensor"], tuned.columns

    try:
        Program.compile(program.replace("self.y", "self.yy"))
    except ProgramError as error:
        (diagnostic,) = error.diagnostics
        assert "self has no field yy" in diagnostic.message, diagnostic

    (word,) = words_for("Robot(a: sensor.self.y", (0, 22))
    assert word.meaning == "how far down the robot is: 0 or more map units"
    told = "`sensor.self.y` | number | 0 or more map units | how far down the robot is |"
    assert told in page()
    assert told in language()

    assert sys.argv[1] != _digest_of_parts(()).hex(), "what was compiled for other fields is used"
    assert sys.argv[2] != simulation_digest().hex(), "what was computed for other fields is used"
"""


@pytest.mark.slow
def test_a_field_that_is_added_to_the_schema_arrives_everywhere(tmp_path: Path) -> None:
    package = Path(logical_robots_tui.__file__).parent
    without = shutil.ignore_patterns("__pycache__")
    for folder in (package, package.parent / "docs"):
        shutil.copytree(folder, tmp_path / folder.name, ignore=without)
    for name in ("levels", "programs"):
        (tmp_path / name).symlink_to(package.parent / name)
    schema = tmp_path / package.name / "schema.py"
    text = schema.read_text("utf-8")
    last = 'Field("battery_capacity"'
    assert text.count(last) == 1
    added = 'Field("y", Type.REAL, "how far down the robot is", "0 or more", "map units"),\n'
    schema.write_text(text.replace(last, f"{added}        {last}"), "utf-8")
    done = run_command(
        [sys.executable, "-c", USES, _digest_of_parts(()).hex(), simulation_digest().hex()],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "LOGICAL_ROBOTS_CACHE_DIR": ""},
    )
    assert done.returncode == 0, done.stderr
