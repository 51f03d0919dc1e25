"""Compiled programs on disk: found again, never trusted, never in the way."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from logical_robots_tui import caching
from logical_robots_tui.mind import Diagnostic, Mind, Predicate, Program, ProgramError, compilation
from logical_robots_tui.mind.compilation import CompileProgram
from tests.mind.rows import ROBOT, decision_of, python

PROGRAM = Program(
    text="what was written",
    predicates=(Predicate("Robot", "program", 1, has_rows=True),),
    statements={"Robot": "SELECT 'Ada' AS robot_name, 7 AS memory"},
    memory="seen",
    warnings=(Diagnostic(1, 2, "perhaps", severity="warning"),),
    recursions={"N": (32, "SELECT 0")},
)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "compiled"
    monkeypatch.setenv(caching.FOLDER_VARIABLE, str(place))
    return place


def entry(folder: Path) -> Path:
    (path,) = folder.iterdir()
    return path


def keep(program: Program) -> None:
    compilation.keep_result(CompileProgram(program.text), program)


def find(text: str) -> Program | None:
    return compilation.find_result(CompileProgram(text), Program)


def written(made: object, text: str = PROGRAM.text) -> bytes:
    return msgspec.json.encode([CompileProgram(text), made])


def signed(body: bytes) -> bytes:
    return compilation._digest(body) + b"\n" + body


def test_what_is_kept_is_found_again_but_not_by_another_compiler(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert find(PROGRAM.text) is None
    keep(PROGRAM)
    assert find(PROGRAM.text) == PROGRAM
    assert find(PROGRAM.text + " ") is None
    monkeypatch.setattr(compilation, "_digest_of_parts", lambda _: b"of tomorrow")
    assert find(PROGRAM.text) is None


def test_a_fresh_process_finds_it_without_compiling(folder: Path) -> None:
    text = ROBOT + "m = 4711;"
    program = Program.compile(text)
    assert len(list(folder.iterdir())) == 1
    script = (
        "import sys; from logical_robots_tui.mind import Program, compilation;"
        "p = Program.compile(sys.argv[1]); assert compilation._compiler._process is None;"
        "assert 'logica' not in sys.modules; print(p.statements['Robot'])"
    )
    assert python(script, text).strip() == program.statements["Robot"].strip()


def test_a_fresh_process_needs_no_compiler_for_what_was_asked_before() -> None:
    script = (
        "import sys; from logical_robots_tui.mind import Program, compilation;"
        "from logical_robots_tui.explain.why.probing import decompose;"
        "p = Program.compile(sys.argv[1]); q = p.question('Robot(memory: 4713)');"
        "t = decompose(p, 'Robot'); print(q.sql, len(t.rules));"
        "print(compilation._compiler._process is None)"
    )
    first, second = (python(script, ROBOT + "m = 4712;").splitlines() for _ in range(2))
    assert first[:-1] == second[:-1]
    assert (first[-1], second[-1]) == ("False", "True")


def test_only_what_compiles_is_kept(folder: Path) -> None:
    with pytest.raises(ProgramError):
        Program.compile(ROBOT + "m = Wings(4711);")
    assert not folder.exists()


GARBAGE = [
    b"",
    b"null",
    b"[]",
    b"\xff\xfe garbage",
    b"[" * 100_000,
    b"[1, 2, 3]",
    written({"text": PROGRAM.text}),
    written({"text": PROGRAM.text, "predicates": [], "statements": {}}, "another"),
    written(None),
    written({"text": PROGRAM.text, "predicates": 1, "statements": {}}),
    written({"text": PROGRAM.text, "predicates": [], "statements": {"R": 1}}),
    written({"text": PROGRAM.text, "predicates": [], "statements": {}, "memory": "none"}),
]


def test_a_truncated_entry_and_garbage_are_none_and_go(folder: Path) -> None:
    keep(PROGRAM)
    path = entry(folder)
    whole = path.read_bytes()
    pieces = [whole[:length] for length in (0, 1, 64, 65, 100, -1)]
    for content in (*pieces, *GARBAGE, *map(signed, GARBAGE)):
        path.write_bytes(content)
        assert find(PROGRAM.text) is None, content[:200]
        assert not path.exists(), content[:200]


def test_a_poisoned_entry_can_do_no_more_than_a_program(tmp_path: Path) -> None:
    keep(replace(PROGRAM, statements={"Robot": f"ATTACH '{tmp_path / 'touched'}' AS x"}, tuned={}))
    decision = decision_of(Mind(Program.compile(PROGRAM.text)))
    assert (decision.memory, decision.notices[0].kind) == ("kept", "failed")
    assert not (tmp_path / "touched").exists()


def test_the_oldest_go_when_there_are_many(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compilation, "MAX_ENTRIES", 3)
    programs = [replace(PROGRAM, text=f"program {number}") for number in range(5)]
    for number, program in enumerate(programs[:3]):
        keep(program)
        os.utime(
            folder / f"{compilation._name(CompileProgram(program.text))}.program", (number, number)
        )
    assert find(programs[0].text)  # used just now, so it is not the oldest any more
    keep(programs[3])
    keep(programs[4])
    found = [find(program.text) is not None for program in programs]
    assert found == [True, False, False, True, True]


def test_it_never_grows_beyond_its_size(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compilation, "MAX_BYTES", 5_000)
    for number in range(20):
        keep(replace(PROGRAM, text=str(number) * 1_000))
        assert sum(path.stat().st_size for path in folder.iterdir()) <= 5_000
    assert find(str(19) * 1_000)


def test_leftovers_of_killed_processes_go(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compilation, "MAX_ENTRIES", 1)
    folder.mkdir()
    leftover = folder / f"x{caching._UNFINISHED}"
    leftover.write_bytes(b"half")
    os.utime(leftover, (1, 1))
    keep(PROGRAM)
    assert not leftover.exists()
    assert find(PROGRAM.text)


@pytest.mark.parametrize("hindrance", ["a file", "a file above", "no cache"])
def test_without_a_folder_everything_works(
    hindrance: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if hindrance != "no cache":
        folder.write_text("in the way", encoding="ascii")
    if hindrance != "a file":
        below = str(folder / "below") if hindrance == "a file above" else ""
        monkeypatch.setenv(caching.FOLDER_VARIABLE, below)
    monkeypatch.setattr(compilation._compiler, "_cache", type(compilation._compiler._cache)())
    assert Program.compile(ROBOT + "m = 4712;").statements


def test_a_full_disk_is_no_hindrance(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    keep(PROGRAM)
    assert find(PROGRAM.text) is None
    assert list(folder.iterdir()) == []


@pytest.mark.slow
def test_many_processes_share_it(folder: Path) -> None:
    script = (
        "from logical_robots_tui.mind import Program, compilation\n"
        "compilation.MAX_ENTRIES = 4\n"
        "for n in range(200):\n"
        "    text = str(n % 8) * 1000\n"
        "    task = compilation.CompileProgram(text)\n"
        "    compilation.keep_result(task, Program(text, (), {'Robot': text}))\n"
        "    found = compilation.find_result(task, Program)\n"
        "    assert found is None or found.statements['Robot'] == text\n"
    )
    with ThreadPoolExecutor(6) as pool:
        assert list(pool.map(python, [script] * 6)) == [""] * 6
    assert not list(folder.glob(f"*{caching._UNFINISHED}"))
    assert 0 < len(list(folder.iterdir())) <= 4 + 6
