"""Sweeps: whatever is killed and however many work, the exported files are the same."""

import multiprocessing
import os
import re
import shutil
import signal
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from logical_robots_tui.lab import engines
from logical_robots_tui.lab.coordinating import Coordinator, Engine, RunTally
from logical_robots_tui.lab.engines import LocalEngine
from logical_robots_tui.lab.exporting import RunRecords, export_runs
from logical_robots_tui.lab.folder import Entry, Folder
from logical_robots_tui.lab.sweeping import plan_sweep
from logical_robots_tui.lab.tasks import WorkerAnswer
from tests.cli.running import Command, in_terminal
from tests.lab.laboratory import (
    Background,
    InlineEngine,
    deadly,
    exported,
    killed,
    recorded,
    rows,
    write_experiment,
)
from tests.lab.test_running import task
from tests.short import AHEAD, LEVEL
from tests.waiting import until

SHORT = f"Near() = 40;\n{AHEAD}"


def work(engine: Engine, folder: Folder, file: Path, show: object = None) -> RunTally:
    with folder.lock(), folder.ledger() as ledger:
        coordinator = Coordinator(folder, folder.write(*plan_sweep(file)), ledger)
        coordinator.work(engine, lambda: False, show if callable(show) else lambda: None)
        engine.close()
        return coordinator.tally()


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of an experiment with its results, to be copied by those who change it."""
    path = tmp_path_factory.mktemp("swept")
    folder = Folder(path / "out")
    assert work(InlineEngine(1), folder, write_experiment(path)).is_complete
    with folder.ledger() as ledger:
        export_runs(folder, RunRecords(folder.manifest(), ledger))
    return path


@pytest.fixture
def copied(swept: Path, tmp_path: Path) -> Path:
    shutil.copytree(swept, tmp_path, dirs_exist_ok=True)
    return tmp_path / "out"


@pytest.mark.parametrize(
    "kills", [pytest.param((2, 1), marks=pytest.mark.slow), (1,)], ids=["often", "once"]
)
def test_a_coordinator_killed_at_any_moment_loses_nothing(
    tmp_path: Path, command: Command, kills: tuple[int, ...]
) -> None:
    # Many small cells, so that there is a moment between any two results.
    file = write_experiment(tmp_path, values=[40], starts=1, ticks=60)
    file.write_text(file.read_text() + '[[vary]]\nlevel = "robots.*.heading"\nrange = [1, 24]\n')
    once, often = tmp_path / "once", tmp_path / "often"
    assert command("sweep", file, "-o", once).status == 0
    assert recorded(once) == 48
    counts = killed(often, ("sweep", file), workers=kills)
    assert sorted(set(counts)) == counts, "each time some more was recorded"
    assert counts[-1] < 48
    assert f"{48 - counts[-1]} runs are left" in command("lab", "status", often, status=1).out
    assert command("lab", "resume", often).status == 0
    assert exported(often) == exported(once)
    assert len(exported(once)["runs.csv"].splitlines()) == 49


def test_nothing_is_computed_again_and_differences_are_told(copied: Path, command: Command) -> None:
    before = (copied / "ledger.db").read_bytes()
    assert command("sweep", write_experiment(copied.parent), "-o", copied).status == 0
    assert (copied / "ledger.db").read_bytes() == before
    more = write_experiment(copied.parent, values=(20, 40, 60))
    assert command("sweep", more, "-o", copied).status == 0
    assert recorded(copied) == 6
    # Two results of a run that differ are said loudly.
    folder = Folder(copied)
    with folder.ledger() as ledger:
        (run, *_), manifest = RunRecords(folder.manifest(), ledger).finished, folder.manifest()
        result = '{"outcome":"won","ticks":1}'
        ledger.record([Entry(run.job, manifest.run(run.job), result, 0.1, "elsewhere/1")])
    told = command("lab", "status", copied, status=1)
    assert "DEFECT" in told.out
    assert manifest.run(run.job) in told.out


def test_a_worker_that_dies_is_told_of_and_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "execute", deadly)
    with closing(LocalEngine(1)) as engine:
        answers: list[tuple[object, WorkerAnswer]] = []
        for text in (SHORT + "# deadly from 0;\n", SHORT):
            engine.submit(text, task(text, ticks=3))
            while not engine.free:
                answers += engine.wait(1.0)
    (_, died), (_, lived) = answers
    assert (died.results, died.failure) == ((), "its worker process died")
    assert [begun for begun, _, _ in lived.results] == [0]


@pytest.mark.slow
def test_a_killed_worker_is_replaced(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=(20, 30, 40, 50), starts=7, ticks=400)
    running = Background("sweep", file, "-o", tmp_path / "out", "--workers", 2)
    until(lambda: recorded(tmp_path / "out") > 0)
    for worker in running.workers():
        os.kill(worker, signal.SIGKILL)
    status, said = running.finish()
    assert status == 0, said
    assert recorded(tmp_path / "out") == 32


@pytest.mark.parametrize("kind", [InlineEngine, pytest.param(LocalEngine, marks=pytest.mark.slow)])
def test_a_run_that_ends_every_worker_is_found_and_not_its_neighbours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: type[Engine]
) -> None:
    monkeypatch.setattr(engines, "execute", deadly)
    file = write_experiment(tmp_path, values=(20, 40), starts=3, ticks=20)
    program = tmp_path / "first.l"
    program.write_text(program.read_text() + "# deadly from 2;\n")
    folder = Folder(tmp_path / "out")
    tally = work(kind(1), folder, file)  # type: ignore[call-arg] # slots, which no protocol names
    assert (tally.done, tally.due, tally.failed) == (6, 0, 2)
    with folder.ledger() as ledger:
        assert list(ledger.failures().values()) == [["its worker process died"] * 3] * 2
        assert Coordinator(folder, folder.manifest(), ledger).tally() == tally
        export_runs(folder, RunRecords(folder.manifest(), ledger))
    table = (folder.path / "runs.csv").read_text("utf-8")
    assert (table.count(",infrastructure,"), table.count("its worker process died")) == (2, 2)


@pytest.mark.slow
def test_a_silent_worker_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "_GRACE", 0.0)
    file = write_experiment(tmp_path, values=(20, 40), starts=1, ticks=60)
    file.write_text(file.read_text() + "[limits]\nseconds = 2\n")
    folder = Folder(tmp_path / "out")
    stopped: list[int] = []
    said: list[str] = []
    finish = engines._Worker.finish

    def noted(worker: engines._Worker) -> tuple[object, WorkerAnswer]:
        key, answer = finish(worker)
        said.append(answer.failure)
        return key, answer

    monkeypatch.setattr(engines._Worker, "finish", noted)

    def stop_the_worker() -> None:
        if not stopped and recorded(folder.path) > 0:
            stopped.extend(child.pid or 0 for child in multiprocessing.active_children())
            for pid in stopped:
                os.kill(pid, signal.SIGSTOP)

    assert work(LocalEngine(1), folder, file, stop_the_worker).is_complete
    assert stopped
    assert "it took more than 2 seconds and could not be stopped" in said


def replayed(folder: Path, command: Command) -> list[str]:
    """Sweep a short level into a folder; return the arguments that play its last run again."""
    file = write_experiment(folder, values=(40,), starts=1, ticks=100)
    (folder / "short.toml").write_text(LEVEL)
    (folder / "first.l").write_text(SHORT)
    file.write_text(file.read_text().replace("01-first-steps", "short.toml"))
    assert command("sweep", file, "-o", folder / "out").status == 0
    *_, row = rows(folder / "out" / "runs.csv")
    assert (row["start"], row["outcome"]) == ("1", "won")
    _, play, *arguments = row["replay"].split()
    assert play == "play"
    arguments[:2] = [str(folder / "out" / name) for name in arguments[:2]]
    assert command("run", *arguments, "--json").data["ticks"] == int(row["ticks"])
    return [*arguments, row["ticks"]]


def test_the_command_of_a_row_replays_that_very_run(tmp_path: Path, command: Command) -> None:
    *arguments, ticks = replayed(tmp_path, command)
    options = ("--plain", "--data-dir", tmp_path / "data")
    assert f"Won after {ticks} ticks." in command("play", *arguments, *options, typed=["run"]).out


@pytest.mark.slow
def test_the_command_of_a_row_opens_the_game_at_its_start(tmp_path: Path, command: Command) -> None:
    *arguments, _ = replayed(tmp_path, command)
    with in_terminal("play", *arguments, "--data-dir", tmp_path / "data") as terminal:
        terminal.wait_for("start 1")
        terminal.send("q")
        terminal.finish()


def test_results_of_another_version_count_only_if_asked(copied: Path, command: Command) -> None:
    with closing(sqlite3.connect(copied / "ledger.db", isolation_level=None)) as ledger:
        ledger.execute("UPDATE results SET engine = 'another', run = 'of another ' || run")
    assert "--mixed" in command("lab", "resume", copied).refusal
    assert command("lab", "resume", copied, "--mixed").status == 0
    assert recorded(copied) == 4
    assert (copied / "runs.csv").read_text("utf-8").count(",another,") == 4


@pytest.mark.slow
def test_the_first_interrupt_stops_after_the_runs_at_hand(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=range(20, 60), starts=3, ticks=120)
    out = tmp_path / "out"
    running = Background("sweep", file, "-o", out, "--workers", 2)
    until(lambda: recorded(out) > 0)
    running.interrupt()
    status, said = running.finish()
    assert status == 1
    assert "Stopping after the runs at hand" in said
    assert f"logical-robots lab resume {out}" in said
    assert "Traceback" not in said
    left = re.search(r"(\d+) runs are left", said)
    assert left
    assert int(left[1]) == 160 - recorded(out)


@pytest.mark.slow
def test_the_second_interrupt_ends_at_once(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=(20,), starts=0, ticks=40_000)
    running = Background("sweep", file, "-o", tmp_path / "out", "--workers", 1)
    until(running.workers)
    workers = running.workers()
    running.interrupt()
    assert running.process.stdout
    assert "Stopping" in running.process.stdout.readline()
    running.interrupt()
    status, said = running.finish()
    assert status == 1
    assert "Traceback" not in said
    until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in workers))


def test_a_second_coordinator_is_refused(swept: Path, command: Command) -> None:
    out = swept / "out"
    with Folder(out).lock():
        assert "Another process is at work in this folder" in command("lab", "resume", out).refusal
        assert command("lab", "status", out).status == 0


@pytest.mark.slow
def test_a_terminal_shows_how_far_it_is(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=range(20, 40), ticks=300)
    with in_terminal("sweep", str(file), "-o", str(tmp_path / "out")) as terminal:
        assert terminal.finish() == 0
        assert "runs/s" in terminal.everything
        assert "40 runs done" in terminal.everything


def test_a_wrong_specification_is_exit_status_2(tmp_path: Path, command: Command) -> None:
    file = tmp_path / "e.toml"
    file.write_text("[experiment]\nlevel = 3\nstarts = true\n")
    told = command("sweep", file, "-o", tmp_path / "out").refusal
    lines = [line.split(": ")[0] for line in told.splitlines()]
    assert lines == [f"{file}:{number}" for number in (1, 2, 3)]
    assert not (tmp_path / "out").exists()
