"""The compile process loads all that it needs before it gives up opening files."""

from tests.mind.rows import python

SCRIPT = """
import sys
from logical_robots_tui.explain.worker import JOBS
from logical_robots_tui.mind.compiling import worker

worker.warm_up()
jobs = {**worker._JOBS, **JOBS}
before = set(sys.modules)
program, *wrong = sys.argv[1:]
kinds = '{"Robot": {}}'
for request in (
    *({"text": text} for text in (program, *wrong)),
    *({"text": program, "query": query, "columns": {}} for query in ("1 + 1", "Robot(", "x > ")),
    {"text": program, "constants": {"Near": "2"}},
    {"text": program, "checkup": []},
    {"text": program, "predicate": "Robot", "within": "", "kinds": kinds},
    {"called": 'Robot(memory: "a")'},
):
    worker.answer(request, jobs)
print(*sorted(set(sys.modules) - before))
"""

PROGRAM = """
Near() = 3;
Far(x) distinct :- x in [1, 2], x > Near();
Robot(robot_name:, desire: {left_engine: Sum{x :- Far(x)}, right_engine: 0}, memory: "") :-
  Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "wal";
"""
WRONG = (
    "Robot(",
    "Robot(robot_name: x) :- Snesor(robot_name: x);",
    "P(x) :- Q(x;",
    "A(x:) :- A(x:);",
)


def test_no_request_loads_a_module() -> None:
    assert python(SCRIPT, PROGRAM, *WRONG).strip() == ""
