"""Sweeps: whatever is killed and however many work, the exported files are the same."""

from __future__ import annotations

import csv
import multiprocessing
import os
import re
import signal
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.lab import engines
from logical_robots_tui.lab.coordinating import Coordinator
from logical_robots_tui.lab.engines import LocalEngine
from logical_robots_tui.lab.exporting import done_runs, export_runs
from logical_robots_tui.lab.folder import Entry, Folder
from logical_robots_tui.lab.sweeping import plan_sweep
from tests.cli.running import Command, in_terminal
from tests.lab.laboratory import deadly, exported, recorded, start, write_experiment
from tests.short import AHEAD, LEVEL
from tests.waiting import until

if TYPE_CHECKING:
    from logical_robots_tui.lab.running import Answer


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def test_a_coordinator_killed_at_any_moment_loses_nothing(tmp_path: Path, command: Command) -> None:
    # Many small cells, so that there is a moment between any two results.
    file = write_experiment(tmp_path, values=range(20, 44), starts=1, ticks=60)
    once, often = tmp_path / "once", tmp_path / "often"
    assert command("sweep", file, "-o", once, "--workers", 1).status == 0
    assert recorded(once) == 48
    arguments: tuple[object, ...] = ("sweep", file, "-o", often)
    counts = []
    for workers in (2, 1):
        before = recorded(often)
        running = start(*arguments, "--workers", workers)
        until(lambda before=before: recorded(often) > before)  # type: ignore[misc] # bound at once
        running.kill()
        counts.append(recorded(often))
        arguments = ("lab", "resume", often)
    assert sorted(set(counts)) == counts, "each time some more was recorded"
    assert counts[-1] < 48
    told = command("lab", "status", often)
    assert told.status == 1
    assert f"{48 - counts[-1]} runs are left" in told.out
    assert command("lab", "resume", often, "--workers", 2).status == 0
    assert exported(often) == exported(once)
    assert len(exported(once)["runs.csv"].splitlines()) == 49


def test_what_was_computed_is_not_computed_again(tmp_path: Path, command: Command) -> None:
    out = tmp_path / "out"
    assert command("sweep", write_experiment(tmp_path), "-o", out, "--workers", 1).status == 0
    ledger = (out / "ledger.db").read_bytes()
    assert command("sweep", write_experiment(tmp_path), "-o", out, "--workers", 1).status == 0
    assert (out / "ledger.db").read_bytes() == ledger
    more = write_experiment(tmp_path, values=(20, 40, 60))
    assert command("sweep", more, "-o", out, "--workers", 1).status == 0
    assert recorded(out) == 6


@pytest.mark.slow
def test_a_killed_worker_is_replaced(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=(20, 30, 40, 50), starts=7, ticks=400)
    running = start("sweep", file, "-o", tmp_path / "out", "--workers", 2)
    until(lambda: recorded(tmp_path / "out") > 0)
    for worker in running.workers():
        os.kill(worker, signal.SIGKILL)
    status, said = running.finish()
    assert status == 0, said
    assert recorded(tmp_path / "out") == 32


@pytest.mark.slow
def test_a_run_that_ends_every_worker_is_found_and_not_its_neighbours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engines, "execute", deadly)
    file = write_experiment(tmp_path, values=(20, 40), starts=3, ticks=20)
    program = tmp_path / "first.l"
    program.write_text(program.read_text() + "# deadly from 2;\n")
    manifest, inputs = plan_sweep(file)
    folder = Folder(tmp_path / "out")
    engine = LocalEngine(1)
    with folder.locked(), folder.ledger() as ledger:
        manifest = folder.write(manifest, inputs)
        coordinator = Coordinator(folder, manifest, ledger)
        coordinator.work(engine, lambda: False, lambda: None)
        engine.close()
        tally = coordinator.tally()
        assert (tally.done, tally.due, tally.failed) == (6, 0, 2)
        assert list(ledger.failures().values()) == [["its worker process died"] * 3] * 2
        again = Coordinator(folder, manifest, ledger)
        assert again.tally() == tally
        export_runs(folder, manifest, ledger)
    table = (folder.path / "runs.csv").read_text("utf-8")
    assert table.count(",infrastructure,") == 2
    assert table.count("its worker process died") == 2


@pytest.mark.slow
def test_a_worker_that_says_nothing_is_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engines, "_GRACE", 0.0)
    file = write_experiment(tmp_path, values=(20, 40), starts=1, ticks=60)
    file.write_text(file.read_text() + "[limits]\nseconds = 2\n")
    folder = Folder(tmp_path / "out")
    stopped: list[int] = []
    said: list[str] = []
    finish = engines._Worker.finish

    def noted(worker: engines._Worker) -> tuple[object, Answer]:
        key, answer = finish(worker)
        said.append(answer.failure)
        return key, answer

    monkeypatch.setattr(engines._Worker, "finish", noted)

    def stop_the_worker() -> None:
        if not stopped and recorded(folder.path) > 0:
            stopped.extend(each.pid or 0 for each in multiprocessing.active_children())
            for pid in stopped:
                os.kill(pid, signal.SIGSTOP)

    engine = LocalEngine(1)
    with folder.locked(), folder.ledger() as ledger:
        coordinator = Coordinator(folder, folder.write(*plan_sweep(file)), ledger)
        coordinator.work(engine, lambda: False, stop_the_worker)
        assert stopped
        assert coordinator.tally().is_complete
    assert "it took more than 2 seconds and could not be stopped" in said
    engine.close()


def test_the_command_of_a_row_replays_that_very_run(tmp_path: Path, command: Command) -> None:
    out = tmp_path / "out"
    file = write_experiment(tmp_path, values=(40,), starts=1, ticks=100)
    (tmp_path / "short.toml").write_text(LEVEL)
    (tmp_path / "first.l").write_text(f"Near() = 40;\n{AHEAD}")
    file.write_text(file.read_text().replace("01-first-steps", "short.toml"))
    assert command("sweep", file, "-o", out, "--workers", 1).status == 0
    *_, row = csv.DictReader((out / "runs.csv").read_text("utf-8").splitlines())
    assert (row["start"], row["outcome"]) == ("1", "won")
    _, play, *arguments = row["replay"].split()
    assert play == "play"
    arguments[:2] = [str(out / name) for name in arguments[:2]]
    data = command("run", *arguments, "--json").data
    assert data["ticks"] == int(row["ticks"])
    with in_terminal("play", *arguments) as terminal:
        terminal.wait_for("start 1")
        terminal.send("q")
        terminal.finish()


def test_results_of_another_version_count_only_if_asked(tmp_path: Path, command: Command) -> None:
    out = tmp_path / "out"
    file = write_experiment(tmp_path)
    assert command("sweep", file, "-o", out, "--workers", 1).status == 0
    with closing(sqlite3.connect(out / "ledger.db", isolation_level=None)) as ledger:
        ledger.execute("UPDATE results SET engine = 'another', run = 'of another ' || run")
    told = command("lab", "resume", out)
    assert told.status == 2
    assert "--mixed" in told.err
    assert command("lab", "resume", out, "--mixed").status == 0
    assert recorded(out) == 4
    assert (out / "runs.csv").read_text("utf-8").count(",another,") == 4


def test_two_results_of_a_run_that_differ_are_said_loudly(tmp_path: Path, command: Command) -> None:
    folder = Folder(tmp_path / "out")
    file = write_experiment(tmp_path)
    assert command("sweep", file, "-o", folder.path, "--workers", 1).status == 0
    with folder.ledger() as ledger:
        (run, *_), manifest = done_runs(folder.manifest(), ledger), folder.manifest()
        result = '{"outcome":"won","ticks":1}'
        ledger.record([Entry(run.job, manifest.run(run.job), result, 0.1, "elsewhere/1")])
    told = command("lab", "status", folder.path)
    assert told.status == 1
    assert "DEFECT" in told.out
    assert manifest.run(run.job) in told.out


@pytest.mark.slow
def test_the_first_interrupt_stops_after_the_runs_at_hand(tmp_path: Path) -> None:
    file = write_experiment(tmp_path, values=range(20, 60), starts=3, ticks=120)
    out = tmp_path / "out"
    running = start("sweep", file, "-o", out, "--workers", 2)
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
    running = start("sweep", file, "-o", tmp_path / "out", "--workers", 1)
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


def test_a_second_coordinator_is_refused(tmp_path: Path, command: Command) -> None:
    out = tmp_path / "out"
    running = start("sweep", write_experiment(tmp_path, ticks=40_000), "-o", out, "--workers", 1)
    try:
        until(running.workers)
        told = command("lab", "resume", out)
        assert told.status == 2
        assert "Another process is at work in this folder" in told.err
        assert command("lab", "status", out).status == 1
    finally:
        running.kill()


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
    told = command("sweep", file, "-o", tmp_path / "out")
    assert told.status == 2
    assert [line.split(": ")[0] for line in told.err.splitlines()] == [
        f"{file}:1",
        f"{file}:2",
        f"{file}:3",
    ]
    assert not (tmp_path / "out").exists()
