"""The coordinator: whatever fails and in whatever order answers come, the ledger ends the same."""

import random
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from logical_robots_tui.lab.coordinating import Coordinator
from logical_robots_tui.lab.exporting import RunRecords
from logical_robots_tui.lab.folder import Cell, Folder, Manifest, digest
from logical_robots_tui.lab.tasks import RunTask, WorkerAnswer
from tests.lab.laboratory import InlineEngine


class Whimsical(InlineEngine):
    """An engine whose workers die, are late, and give back what they like, but not for ever."""

    def __init__(self, seed: int) -> None:
        super().__init__(3)
        self._chance = random.Random(seed)
        self.failures: Counter[str] = Counter()
        self.executions: Counter[tuple[str, int]] = Counter()

    def submit(self, key: object, task: RunTask) -> None:
        assert self.free
        assert task.starts
        super().submit(key, task)

    def wait(self, seconds: float) -> Iterator[tuple[object, WorkerAnswer]]:
        self._chance.shuffle(self._tasks)
        key, task = self._tasks.pop()
        fails = self.failures[task.programs[""]] < 2 and self._chance.random() < 0.6
        some = task.starts[: self._chance.randint(not fails, len(task.starts))]
        done = []
        for start in some:
            self.executions[task.programs[""], start] += 1
            done.append((start, result(task.programs[""], start), 0.1))
            if start == 0 and task.given_first and '"won"' not in done[-1][1]:
                yield key, WorkerAnswer(tuple(done), "w")
                return
        if fails and len(done) < len(task.starts):
            self.failures[task.programs[""]] += 1
            dies = self._chance.random() < 0.5
            yield key, WorkerAnswer(() if dies else tuple(done), "" if dies else "w", "it failed")
            return
        yield key, WorkerAnswer(tuple(done), "w")


def result(program: str, start: int) -> str:
    """What comes of a run; the program says whether it wins from the given start."""
    if program.startswith("broken"):
        return '{"outcome":"does not compile"}'
    won = start != 4 and (start > 0 or not program.startswith("loses"))
    return '{"outcome":"won","ticks":7}' if won else '{"outcome":"out of ticks","ticks":9}'


TEXTS = ["wins a", "wins b", "loses", "broken", "broken  ", "wins c", "wins  c"]
RUN = {text: " ".join(text.split()) for text in TEXTS}
LEVEL = digest("level")
CELLS = tuple(
    Cell(LEVEL, digest(run), "level", text, 10, student=text, own=digest(text) * (run != text))
    for text, run in RUN.items()
)


@pytest.mark.parametrize("given_first", [True, False])
@pytest.mark.parametrize("seed", range(12))
def test_the_ledger_ends_the_same(tmp_path: Path, seed: int, *, given_first: bool) -> None:
    folder, engine = Folder(tmp_path), Whimsical(seed)
    with folder.lock(), folder.ledger() as ledger:
        plan = Manifest("sweep", "t", "", 6, given_first, ("won",), (), 1, 1.0, CELLS)
        manifest = folder.write(plan, {digest(text): text for text in [*TEXTS, "level"]})
        coordinator = Coordinator(folder, manifest, ledger)
        coordinator.work(engine, lambda: False, lambda: None)
        assert coordinator.tally().is_complete
        runs = RunRecords(manifest, ledger).finished
        found = Counter((done.cell.program_name, done.result.outcome) for done in runs)
        wins = {(name, "won"): 6 for name in ("wins a", "wins b", "wins c", "wins  c")}
        lost = {(name, "out of ticks"): 1 for name, _ in wins}
        loser = {("loses", "out of ticks"): 1 if given_first else 2}
        loser |= {} if given_first else {("loses", "won"): 5}
        broken = {(name, "does not compile"): 1 for name in ("broken", "broken  ")}
        assert found == Counter(wins | lost | loser | broken)
        assert ("wins  c", 0) not in engine.executions  # the same program runs once
        assert ("broken  ", 0) in engine.executions  # but its mistakes are its own
        assert Coordinator(folder, manifest, ledger).tally().is_complete
