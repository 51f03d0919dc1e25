"""The compile process: alone, bounded, stopped at once, gone with its parent."""

import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import msgspec
import pytest

from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.mind import Limits, Program, ProgramError, Stopped, compilation
from logical_robots_tui.mind.compilation import CompileProgram
from logical_robots_tui.mind.compiling import compiler, worker
from logical_robots_tui.processes import helper
from logical_robots_tui.processes.helper import Helper
from tests.mind.rows import ROBOT, python, slow
from tests.processes import is_running, run_command
from tests.waiting import PATIENCE, until

HEAVY = (
    "A0(x) = x + 1;"
    + "".join(f"A{i}(x) = A{i - 1}(x) + A{i - 1}(x);" for i in range(1, 40))
    + ROBOT
    + "m = A39(1);"
)
"""Its SQL would have a million million characters."""

ONLY_LINUX = pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs /proc")


@pytest.fixture(autouse=True)
def _nothing_is_compiled_yet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(FOLDER_VARIABLE, "")


def process() -> Helper:
    with suppress(ProgramError):
        Program.compile("Robot(")
    running = compilation._compiler._process
    assert isinstance(running, Helper)
    return running


def refusal(text: str, limits: Limits) -> str:
    with pytest.raises(ProgramError) as caught:
        Program.compile(text, limits=limits)
    return caught.value.diagnostics[0].message


def test_compiling_can_be_stopped_and_the_next_program_compiles() -> None:
    working = process()
    stop = threading.Event()
    with pytest.raises(Stopped):
        Program.compile(HEAVY, stop=stop, report=lambda *_: stop.set())
    assert working.poll() is not None
    assert Program.compile(ROBOT + "m = 12345;").statements


def test_waiting_for_another_compilation_can_be_stopped() -> None:
    first, second = threading.Event(), threading.Event()

    def compile_heavy() -> None:
        with pytest.raises(Stopped):
            Program.compile(HEAVY + " # first", stop=first)

    thread = threading.Thread(target=compile_heavy)
    thread.start()
    until(compilation._compiler._lock.locked)
    second.set()
    with pytest.raises(Stopped):
        Program.compile(HEAVY + " # second", stop=second)
    first.set()
    thread.join(PATIENCE)


def test_a_program_that_compiles_too_long_or_is_too_long_is_refused() -> None:
    assert "longer than 0.05 seconds" in refusal(HEAVY, Limits(compile_seconds=0.05))
    assert "longer than 0 seconds" in refusal(ROBOT + "m = 54321;", Limits(compile_seconds=0.0))
    assert "more than the 10 " in refusal(ROBOT + "m = 1;", Limits(program_characters=10))


@pytest.mark.slow
def test_a_program_that_needs_too_much_memory_to_compile_is_refused() -> None:
    limits = Limits(compile_bytes=100 * 1024**2, compile_seconds=60)
    columns = ", ".join(f"c{number}: {number}" for number in range(100))
    facts = "".join(f"P{number}({columns});" for number in range(150))
    assert "memory" in refusal(f"{facts} {ROBOT} m = 1;", limits)
    assert Program.compile(ROBOT + "m = 12346;").statements


ENDS = {
    -signal.SIGSEGV: "too much memory",
    -signal.SIGKILL: "too much memory",
    compilation.NO_MEMORY: "too much memory",
    -signal.SIGPROF: "took longer than 30 seconds",
    -signal.SIGTERM: "gave up",
}


def test_the_end_of_a_compile_process_is_told_by_its_cause() -> None:
    for status, message in ENDS.items():
        assert message in str(compilation._exit_error(status, Limits())), status


@pytest.mark.parametrize("ended_by", [signal.SIGTERM, slow(signal.SIGSEGV), slow(signal.SIGKILL)])
def test_a_compile_process_that_ends_while_compiling_is_told_by_its_cause(
    ended_by: signal.Signals,
) -> None:
    working = process()
    with pytest.raises(ProgramError, match=ENDS[-ended_by]):
        Program.compile(HEAVY, report=lambda *_: working.send_signal(ended_by))
    assert Program.compile(ROBOT + "m = 779;").statements


def test_there_is_one_compile_process_however_many_compile() -> None:
    with ThreadPoolExecutor(5) as pool:
        compiled = pool.map(Program.compile, [f"{ROBOT} m = {n};" for n in range(5_000, 5_005)])
        assert all(program.statements for program in compiled)
    assert len(children(os.getpid())) <= 1


def children(parent: int) -> list[int]:
    listed = run_command(["ps", "-ww", "-o", "pid=,args=", "--ppid", str(parent)]).stdout
    return [int(line.split()[0]) for line in listed.splitlines() if "compile_process" in line]


@ONLY_LINUX
def test_the_compile_process_can_open_no_file_and_start_no_process() -> None:
    limits = Path(f"/proc/{process().pid}/limits").read_text(encoding="ascii")
    most = {line[:26].strip(): line[26:].split()[:2] for line in limits.splitlines()[1:]}
    for what in ("open files", "file size", "processes", "core file size"):
        assert most[f"Max {what}"] == ["0", "0"], what
    assert most["Max address space"] == [str(Limits().compile_bytes)] * 2


@ONLY_LINUX
def test_a_compile_process_that_dies_is_replaced_by_one_that_knows_no_secrets(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("SOME_SECRET", "swordfish")
    running = process()
    running.kill()
    running.wait(PATIENCE)
    assert Program.compile(ROBOT + "m = 778;").statements
    pid = process().pid
    assert pid != running.pid
    environment = Path(f"/proc/{pid}/environ").read_text(encoding="utf-8")
    names = {pair.split("=", 1)[0] for pair in environment.split("\0") if pair}
    assert "SOME_SECRET" not in names
    assert names <= {
        "HOME", "LC_CTYPE", "LOGICAL_ROBOTS_CACHE_DIR", "OPENBLAS_NUM_THREADS", "PYTHONNOUSERSITE",
        *helper._INHERITED_VARIABLES,
    }  # fmt: skip
    assert os.getsid(pid) == pid
    assert str(Path(f"/proc/{pid}/cwd").readlink()) == "/"


@ONLY_LINUX
def test_the_compile_process_ends_with_a_parent_that_is_killed_while_it_compiles(
    tmp_path: Path,
) -> None:
    text = tmp_path / "heavy.l"
    text.write_text(HEAVY + " # orphan", encoding="utf-8")
    script = (
        "import sys, pathlib; from logical_robots_tui.mind import Program;"
        "Program.compile(pathlib.Path(sys.argv[1]).read_text())"
    )
    parent = subprocess.Popen([sys.executable, "-c", script, str(text)])
    until(lambda: any(busy(pid) for pid in children(parent.pid)))
    (child,) = children(parent.pid)
    os.kill(parent.pid, signal.SIGKILL)
    parent.wait(PATIENCE)
    until(lambda: not is_running(child))


def busy(pid: int) -> bool:
    """Whether a compile process has its limits, which it sets before its first program."""
    try:
        limits = Path(f"/proc/{pid}/limits").read_text(encoding="ascii")
    except OSError:
        return False
    return any(line.split()[:4] == ["Max", "open", "files", "0"] for line in limits.splitlines())


def test_a_mistake_of_ours_while_compiling_is_told_plainly_and_logged(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def stumble(_text: str, _report: object) -> Program:
        raise ZeroDivisionError("ours")

    monkeypatch.setattr(compiler, "compile_text", stumble)
    answer = msgspec.json.encode(worker.do(CompileProgram("A(1);"), worker.JOBS))
    monkeypatch.setattr(compilation._Compiler, "_exchange", lambda *_: iter([answer]))
    with pytest.raises(ProgramError, match="gave up on this program"):
        Program.compile(ROBOT + "m = 4242;")
    assert "ZeroDivisionError: ours" in caplog.text


@pytest.mark.parametrize("error", [MemoryError, SystemError])
def test_a_compile_process_does_not_survive_a_program_for_which_there_is_no_memory(
    error: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stumble(_text: str, _report: object) -> Program:
        raise error  # CPython may lose the exception that says so

    monkeypatch.setattr(compiler, "compile_text", stumble)
    with pytest.raises(MemoryError):
        worker.do(CompileProgram("A(1);"), worker.JOBS)


def test_compiling_tells_how_far_it_is() -> None:
    told: list[tuple[int, int]] = []
    text = "A(1);\nB(x) :- A(x);\n" + ROBOT + "B(m), m < 98765;"
    Program.compile(text, report=lambda done, of_all: told.append((done, of_all)))
    assert told == [(0, 3), (1, 3), (2, 3)]


SCRIPT = """
import sys
from logical_robots_tui.compile_process import JOBS
from logical_robots_tui.explain.diagnosis.sites import PrepareCheckup
from logical_robots_tui.explain.why.probing import Decompose, ReadCall
from logical_robots_tui.mind.compilation import CompileProgram, CompileQuestion, SetConstants
from logical_robots_tui.mind.compiling import worker

worker.warm_up()
before = set(sys.modules)
program, *wrong = sys.argv[1:]
kinds = '{"Robot": {}}'
for task in (
    *(CompileProgram(text) for text in (program, *wrong)),
    *(CompileQuestion(program, query, {}) for query in ("1 + 1", "Robot(", "x > ")),
    SetConstants(program, {"Near": "2"}),
    PrepareCheckup(program, ()),
    Decompose(program, "Robot", "", kinds),
    ReadCall('Robot(memory: "a")'),
):
    worker.do(task, JOBS)
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
