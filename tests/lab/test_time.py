"""Time: counted in steps and processor seconds; what takes too much of it holds nobody up."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from logical_robots_tui.lab import engines
from logical_robots_tui.lab.coordinating import Coordinator
from logical_robots_tui.lab.folder import ATTEMPTS, Cell, Folder, Manifest, Student, digest
from logical_robots_tui.lab.running import execute
from logical_robots_tui.lab.tasks import RunTask, WorkerAnswer
from tests.cli.running import Command
from tests.lab.laboratory import (
    FIRST_STEPS,
    SENSOR,
    STILL,
    InlineEngine,
    endless,
    lane,
    rows,
    write_files,
)
from tests.lab.test_running import only, task
from tests.waiting import PATIENCE

HEAVY = "N(x) :- x in Range(100);\n" + STILL.format(
    "Sum{x * y :- N(x), N(y)} + sensor.clock", '""', SENSOR
)
ASSIGNMENT = Path(__file__).with_name("time.toml").read_text("utf-8")


def test_a_program_that_thinks_too_much_is_too_slow_at_a_tick_that_is_always_the_same() -> None:
    first = only(execute(task(HEAVY, run_steps=3_000_000)))
    assert first.outcome == "too slow"
    assert 10 < first.ticks < 300
    execute(task(FIRST_STEPS))
    assert only(execute(task(HEAVY, run_steps=3_000_000, seconds=30.0))) == first
    assert only(execute(task(HEAVY, run_steps=4_000_000))).ticks > first.ticks
    assert only(execute(task(HEAVY, ticks=first.ticks))).outcome == "out of ticks"


class Recorder(InlineEngine):
    def __init__(self) -> None:
        super().__init__(1)
        self.order: list[str] = []
        self.during: Callable[[], None] = lambda: None  # called while a task is at work

    def submit(self, key: object, task: RunTask) -> None:
        super().submit(key, task)
        self.order.append(task.programs[""])

    def wait(self, seconds: float) -> Iterator[tuple[object, WorkerAnswer]]:
        self.during()
        key, task = self._tasks.pop()
        if "stuck" in task.programs[""]:
            yield key, WorkerAnswer((), "w", "it took more than 1 seconds", is_final=True)
            return
        took = 9.0 if "slow" in task.programs[""] else 0.1
        won = '{"outcome":"won","ticks":7}'
        yield key, WorkerAnswer(tuple((start, won, took) for start in task.starts[:1]), "w")


def test_students_whose_programs_take_long_come_last(tmp_path: Path) -> None:
    texts = ["ada slow 1", "ada 2", "ben stuck 1", "ben 2", "cem 1", "cem 2"]
    level = digest("level")
    cells = tuple(Cell(level, digest(t), "level", t, 10, student=t.split()[0]) for t in texts)
    students = tuple(Student(name) for name in ("ada", "ben", "cem"))
    plan = Manifest("grade", "t", "", 1, True, (), (), 1, 1.0, cells, students)
    folder, engine = Folder(tmp_path), Recorder()
    with folder.lock(), folder.ledger() as ledger:
        manifest = folder.write(plan, {digest(text): text for text in [*texts, "level"]})
        coordinator = Coordinator(folder, manifest, ledger)
        named: set[str] = set()

        def note() -> None:
            seconds, cell = coordinator.longest() or (-1.0, cells[0])
            assert 0 <= seconds < PATIENCE
            named.add(manifest.label_of(cell))

        engine.during = note
        coordinator.work(engine, lambda: False, lambda: None)
        assert coordinator.longest() is None
        assert named == {f"{text.split()[0]}: {text} in level" for text in texts}
        tally = coordinator.tally()
        assert [len(reasons) for reasons in ledger.failures().values()] == [ATTEMPTS]
    assert engine.order.count("ben stuck 1") == 1  # another attempt would take as long
    assert (tally.done, tally.failed) == (10, 1)
    last = max(place for place, text in enumerate(engine.order) if text.startswith("cem"))
    assert set(engine.order[last + 1 :]) == {"ada slow 1", "ada 2", "ben 2"}


@pytest.fixture
def graded(tmp_path: Path) -> Path:
    names = [
        f"all/{name}/{level}.l"
        for name in ("ada", "ben")
        for level in ("first-steps", "open-space")
    ]
    files = {
        "a.toml": ASSIGNMENT + "[limits]\nseconds = 3\n",
        "01-first-steps.toml": lane("First steps"),
        "roster.csv": "id,name,submission\n1,Ada,ada\n2,Ben,ben\n",
        **dict.fromkeys(names, FIRST_STEPS),
        names[2]: FIRST_STEPS.replace("= 40", "= 50") + "# endless\n# deadly from 0;\n",
    }
    return write_files(tmp_path, files)


def test_grading_ends_with_a_gradebook_of_what_there_is(graded: Path, command: Command) -> None:
    out = graded / "out"
    told = command("grade", graded / "a.toml", graded / "all", "-o", out, "--workers", 1, status=1)
    assert "1 run could not be done (infrastructure).\nUngraded:\n" in told.out
    assert "\n  Ben (2): 01-first-steps: its worker" in told.out
    ada, ben = rows(out / "gradebook.csv")
    assert (ada["points"], ada["ungraded"]) == ("10.0", "0")
    assert (ben["points"], ben["ungraded"], ben["01-first-steps"]) == ("", "1", "")
    assert ben["02-open-space"] == "0.0"
    scope = json.loads((out / "gradescope/2.json").read_text())
    assert "score" not in scope
    assert not any("score" in test for test in scope["tests"])  # they would be added up
    said = "0 of 20 points so far, 1 level not graded yet"
    assert scope["output"] == f"Ben: {said}"
    feedback = (out / "feedback/2.md").read_text()
    assert said in feedback
    assert "- Not graded yet, because a run could not be finished: its worker" in feedback
    assert "not run yet" not in feedback
    assert '<error message="its worker' in (out / "junit.xml").read_text()
    assert f"Ben (2): {said}" in command("lab", "report", out).out
    page = (out / "report.html").read_text("utf-8")
    assert page.count(said) == 1
    assert ">Ben (2)</td>" in page


@pytest.mark.slow
@pytest.mark.usefixtures("workers")
def test_a_worker_that_computes_for_ever_is_killed_and_only_its_program_blamed(
    graded: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engines, "execute", endless)
    monkeypatch.setattr(engines, "_GRACE", 0.0)
    out = graded / "out"
    told = command("grade", graded / "a.toml", graded / "all", "-o", out, "--workers", 1, status=1)
    assert "  Ben (2): 01-first-steps: it took more than 3 seconds and could" in told.out
    assert "1 run could not be done" in told.out
    with Folder(out).ledger() as ledger:
        assert [len(reasons) for reasons in ledger.failures().values()] == [ATTEMPTS]
        assert len(ledger.results()) == 2  # of three programs two are the same
