"""The cluster: a real scheduler and real workers, which are killed, stopped and replaced."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab import coordinating
from logical_robots_tui.lab import engines as cluster
from logical_robots_tui.lab.coordinating import Coordinator, RunTally
from logical_robots_tui.lab.engines import ClusterEngine
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.lab.sweeping import plan_sweep
from tests.cli.running import Command
from tests.lab.laboratory import Background, deadly, exported, recorded, write_experiment
from tests.waiting import PATIENCE, until

pytestmark = pytest.mark.filterwarnings("ignore")  # Dask's own, at every turn


class Cluster:
    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self._port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self._port}"
        self._folder = folder
        self._processes: list[subprocess.Popen[bytes]] = []
        self.scheduler = self.start_scheduler()
        self.workers = [self.start_worker() for _ in range(2)]

    def _start(self, *arguments: object) -> subprocess.Popen[bytes]:
        with (self._folder / f"{len(self._processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *map(str, arguments), "--no-dashboard"],
                stdout=log,
                stderr=log,
                env={**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"},
            )
        self._processes.append(process)
        return process

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        return self._start("scheduler", "--host", "127.0.0.1", "--port", self._port)

    def start_worker(self) -> subprocess.Popen[bytes]:
        options = ("--nthreads", 1, "--no-nanny", "--local-directory", self._folder)
        return self._start("worker", self.address, *options)

    def end(self) -> None:
        for process in self._processes:
            process.kill()
            process.wait(PATIENCE)


@pytest.fixture
def machines(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    machines = Cluster(tmp_path_factory.mktemp("cluster"))
    yield machines
    machines.end()


def sweep(machines: Cluster, file: Path, out: Path) -> Background:
    running = Background("sweep", file, "-o", out, "--dask", machines.address)
    until(lambda: recorded(out) > 0 or running.process.poll() is not None)
    return running


@pytest.mark.slow
def test_a_killed_cluster_ends_alike(tmp_path: Path, machines: Cluster, command: Command) -> None:
    file = write_experiment(tmp_path, values=range(20, 44), starts=1, ticks=200)
    here, there = tmp_path / "here", tmp_path / "there"
    running = sweep(machines, file, there)
    machines.workers[0].kill()
    machines.start_worker()
    before = recorded(there)
    until(lambda: recorded(there) > before)
    machines.scheduler.kill()
    machines.scheduler.wait(PATIENCE)
    machines.start_scheduler()
    machines.start_worker()
    status, said = running.finish()
    assert status == 0, said
    assert "the Dask scheduler is lost" in said
    assert "connected to a Dask scheduler again" in said
    assert "Traceback" not in said
    assert command("sweep", file, "-o", here).status == 0
    assert exported(there) == exported(here)


@pytest.mark.slow
def test_a_worker_that_is_stopped_for_a_while_goes_on(tmp_path: Path, machines: Cluster) -> None:
    file = write_experiment(tmp_path, values=range(20, 40), starts=1, ticks=200)
    out = tmp_path / "out"
    running = sweep(machines, file, out)
    machines.workers[0].send_signal(signal.SIGSTOP)
    before = recorded(out)
    until(lambda: recorded(out) > before + 5)
    machines.workers[0].send_signal(signal.SIGCONT)
    status, said = running.finish()
    assert status == 0, said
    assert recorded(out) == 40


def worked(machines: Cluster, folder: Folder, file: Path) -> RunTally:
    with ExitStack() as stack:
        stack.enter_context(folder.lock())
        ledger = stack.enter_context(folder.ledger())
        engine = ClusterEngine(machines.address)
        stack.callback(engine.close)
        coordinator = Coordinator(folder, folder.write(*plan_sweep(file)), ledger)
        coordinator.work(engine, lambda: False, lambda: None)
        return coordinator.tally()


@pytest.mark.slow
def test_a_run_that_ends_every_worker_is_found(
    tmp_path: Path, machines: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "execute", deadly)
    file = write_experiment(tmp_path, values=(20,), starts=3, ticks=20)
    program = tmp_path / "first.l"
    program.write_text(program.read_text() + "# deadly from 2;\n")
    for _ in range(6):
        machines.start_worker()
    tally = worked(machines, Folder(tmp_path / "out"), file)
    assert (tally.done, tally.due, tally.failed) == (3, 0, 1)


@pytest.mark.slow
def test_workers_of_another_version_are_refused(
    tmp_path: Path, machines: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(coordinating, "fingerprint", lambda: "another")
    with pytest.raises(InputError, match="another version of Logical Robots"):
        worked(machines, Folder(tmp_path / "out"), write_experiment(tmp_path))


@pytest.mark.parametrize(
    ("is_installed", "said"),
    [
        (True, "The Dask scheduler can't be reached"),
        (False, "pip install 'logical-robots-tui[dask]'"),
    ],
)
def test_without_a_scheduler_or_the_extra_a_cluster_says_what_is_missing(
    tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch, said: str, is_installed: bool
) -> None:
    monkeypatch.setattr(cluster, "_CONNECT_SECONDS", 1.0)
    if not is_installed:
        monkeypatch.setitem(sys.modules, "distributed", None)
    words = (write_experiment(tmp_path), "-o", tmp_path / "out", "--dask", "tcp://127.0.0.1:9")
    assert said in command("sweep", *words).refusal
