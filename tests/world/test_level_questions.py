"""The questions that a level file asks beside its lesson."""

from pathlib import Path

import pytest

from logical_robots_tui.world import Level, LevelError, load_level
from logical_robots_tui.world.level import LevelQuestion
from tests.short import LEVEL


def level(folder: Path, questions: str) -> Level:
    path = folder / "level.toml"
    path.write_text(f"questions = [{questions}]\n{LEVEL}", "utf-8")
    return load_level(path)


def test_questions_are_read(tmp_path: Path) -> None:
    asked = """
      {ask = "Who sees a lamp?", answer = '''
    Lit(robot_name:)
    ''', ticks = [120, 480]},
      {ask = "Where?", answer = "Here", ticks = [0], program = "wander"},
    """
    assert level(tmp_path, asked).questions == (
        LevelQuestion("Who sees a lamp?", "Lit(robot_name:)", (120, 480)),
        LevelQuestion("Where?", "Here", (0,), "wander"),
    )


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        ('answer = "A"', ".ticks", '"ticks" must be ascending numbers up to 10000.'),
        ('answer = "A", ticks = [480, 120]', ".ticks", '"ticks" must be ascending numbers'),
        ('answer = "A", ticks = [1, 10001]', ".ticks", '"ticks" must be ascending numbers'),
        ('answer = "A", ticks = 120', ".ticks", '"ticks" must be a list, not a number.'),
        ('answer = "A", ticks = [1, "2"]', ".ticks[1]", '"ticks[1]" must be a number, not text.'),
        ('answer = "A", ticks = [-1]', ".ticks[0]", '"ticks[0]" must be 0 or more, not -1.'),
        ('answer = " ", ticks = [1]', ".answer", '"answer" is empty.'),
        ("ticks = [1]", ".answer", '"answer" is missing.'),
        ('answer = "A", ticks = [1], tick = 3', ".tick", '"tick" is not a known key.'),
    ],
)
def test_a_mistake_in_a_question_is_told(tmp_path: Path, text: str, key: str, said: str) -> None:
    with pytest.raises(LevelError) as caught:
        level(tmp_path, f'{{ask = "Who?", {text}}}')
    assert caught.value.place.endswith(f"level.toml: questions[0]{key}")
    assert caught.value.message.startswith(said)


def test_the_number_of_a_shipped_level_is_a_name_of_it() -> None:
    assert load_level("5").name == load_level("05").name == "05-lighthouse"
    with pytest.raises(LevelError, match='no level called "99"'):
        load_level("99")
