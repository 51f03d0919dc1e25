"""Asking the same of both engines."""

import math
from contextlib import closing
from pathlib import Path
from typing import Any

from logical_robots_tui.mind import Mind, Program
from tests.mind.differential.duckdb_reference import answer
from tests.mind.rows import ROBOT, nearly_same, row

SEEN = {
    3: (40, "robot", "Bo"),
    4: (33, "beacon", "A"),
    5: (50, "beacon", "B"),
    9: (12, "wall", "wall"),
}
ROWS = [row("Ada", clock=7, sees=SEEN)]
MEMORIES: dict[str, Any] = {
    "Ada": {
        "name": "Ada",
        "count": 4,
        "nothing": None,
        "plan": {"spot": "A", "done": True},
        "seen": [{"u": "A", "v": "B", "d": 3.5}, {"u": "B", "v": "C", "d": 1.25}],
    }
}


def program(rules: str = "", **expressions: str) -> str:
    """A program whose predicate `Answer` has one column per expression."""
    columns = ", ".join(f"{name}: ({text})" for name, text in expressions.items())
    return (
        f"{rules}\nAnswer({columns}) :- Sensor(robot_name:, sensor:), Memory(robot_name:, memory:);"
    )


def here(text: str, predicate: str = "Answer") -> list[Any]:
    """Rows of a predicate as this game computes them, the same whether it is tuned or not."""
    if "Robot(" not in text:
        text = f"{text}\n{ROBOT}m = 1;"
    program = Program.compile(text)
    minds = (Mind(program, plain=plain) for plain in (False, True))
    tuned, as_generated = (answers(mind, predicate) for mind in minds)
    assert nearly_same(tuned, as_generated)
    return tuned


def answers(mind: Mind, predicate: str) -> list[Any]:
    with closing(mind):
        return list(mind.query(predicate, ROWS, MEMORIES).rows)


def there(text: str, folder: Path, predicate: str = "Answer") -> list[Any]:
    return answer(text, predicate, ROWS, MEMORIES, folder)


def same(ours: Any, theirs: Any, tolerance: float = 1e-9) -> bool:
    """Equal, numbers within a tolerance; a number that is none (NaN) is null here."""
    if isinstance(theirs, float) and math.isnan(theirs):
        return ours is None
    if isinstance(theirs, bool) or isinstance(ours, bool):
        return bool(ours == theirs)
    if isinstance(theirs, int | float) and isinstance(ours, int | float):
        return ours == theirs or math.isclose(ours, theirs, rel_tol=tolerance, abs_tol=1e-9)
    if isinstance(theirs, dict) and isinstance(ours, dict):
        return ours.keys() == theirs.keys() and all(
            same(ours[k], theirs[k], tolerance) for k in ours
        )
    if isinstance(theirs, list | tuple) and isinstance(ours, list | tuple):
        return len(ours) == len(theirs) and all(
            same(one, other, tolerance) for one, other in zip(ours, theirs, strict=True)
        )
    return bool(ours == theirs)
