"""Compiled programs on disk: found again, never trusted, never in the way."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from logical_robots_tui.mind import (
    Diagnostic,
    Mind,
    Predicate,
    Program,
    ProgramError,
    cache,
    compilation,
)
from tests.mind.rows import ROBOT, row

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
    monkeypatch.setenv(cache.FOLDER_VARIABLE, str(place))
    return place


def entry(folder: Path) -> Path:
    (path,) = folder.iterdir()
    return path


def signed(body: bytes) -> bytes:
    return cache._digest(body) + b"\n" + body


def test_what_is_kept_is_found_again() -> None:
    assert cache.find(PROGRAM.text) is None
    cache.keep(PROGRAM)
    assert cache.find(PROGRAM.text) == PROGRAM
    assert cache.find(PROGRAM.text + " ") is None


def test_a_fresh_process_finds_it_without_compiling(folder: Path) -> None:
    text = ROBOT + "m = 4711;"
    program = Program.compile(text)
    assert len(list(folder.iterdir())) == 1
    script = (
        "import sys; from logical_robots_tui.mind import Program, compilation;"
        "p = Program.compile(sys.argv[1]); assert compilation._compiler._process is None;"
        "assert 'logica' not in sys.modules; print(p.statements['Robot'])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, text], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == program.statements["Robot"].strip()


def test_only_what_compiles_is_kept(folder: Path) -> None:
    with pytest.raises(ProgramError):
        Program.compile(ROBOT + "m = Wings(4711);")
    assert not folder.exists()


@pytest.mark.parametrize("length", [0, 1, 64, 65, 100, -1])
def test_a_truncated_entry_is_none_and_goes(folder: Path, length: int) -> None:
    cache.keep(PROGRAM)
    path = entry(folder)
    path.write_bytes(path.read_bytes()[:length])
    assert cache.find(PROGRAM.text) is None
    assert not path.exists()


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"null",
        b"[]",
        b"\xff\xfe garbage",
        b"[" * 100_000,
        b'{"text": "what was written"}',
        json.dumps({"text": "another", "predicates": [], "statements": {}}).encode(),
        json.dumps({"text": "what was written", "predicates": 1, "statements": {}}).encode(),
        json.dumps({"text": "what was written", "predicates": [], "statements": {"R": 1}}).encode(),
        json.dumps(
            {"text": "what was written", "predicates": [], "statements": {}, "memory": "none"}
        ).encode(),
        json.dumps(
            {"text": "what was written", "predicates": [], "statements": {}, "more": 1}
        ).encode(),
    ],
)
@pytest.mark.parametrize("sign", [True, False])
def test_garbage_is_none_and_goes(folder: Path, body: bytes, sign: bool) -> None:
    cache.keep(PROGRAM)
    path = entry(folder)
    path.write_bytes(signed(body) if sign else body)
    assert cache.find(PROGRAM.text) is None
    assert not path.exists()


def test_a_poisoned_entry_can_do_no_more_than_a_program(tmp_path: Path) -> None:
    poison = replace(
        PROGRAM, statements={"Robot": f"ATTACH '{tmp_path / 'touched'}' AS x"}, tuned={}
    )
    cache.keep(poison)
    mind = Mind(Program.compile(PROGRAM.text))
    (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
    mind.close()
    assert decision.memory == "kept"
    assert decision.notices[0].kind == "failed"
    assert not (tmp_path / "touched").exists()


def test_the_oldest_go_when_there_are_too_many(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "MAX_ENTRIES", 3)
    programs = [replace(PROGRAM, text=f"program {number}") for number in range(5)]
    for number, program in enumerate(programs[:3]):
        cache.keep(program)
        os.utime(folder / cache._name(program.text), (number, number))
    assert cache.find(programs[0].text)  # used just now, so it is not the oldest any more
    cache.keep(programs[3])
    cache.keep(programs[4])
    found = [cache.find(program.text) is not None for program in programs]
    assert found == [True, False, False, True, True]


def test_it_never_grows_beyond_its_size(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "MAX_BYTES", 5_000)
    for number in range(20):
        cache.keep(replace(PROGRAM, text=str(number) * 1_000))
        assert sum(path.stat().st_size for path in folder.iterdir()) <= 5_000
    assert cache.find(str(19) * 1_000)


def test_leftovers_of_killed_processes_go_too(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "MAX_ENTRIES", 1)
    folder.mkdir()
    leftover = folder / f"x{cache._UNFINISHED}"
    leftover.write_bytes(b"half")
    os.utime(leftover, (1, 1))
    cache.keep(PROGRAM)
    assert not leftover.exists()
    assert cache.find(PROGRAM.text)


@pytest.mark.parametrize("hindrance", ["a file", "a file above", "no cache"])
def test_without_a_folder_everything_works(
    hindrance: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if hindrance == "a file":
        folder.write_text("in the way", encoding="ascii")
    elif hindrance == "a file above":
        folder.write_text("in the way", encoding="ascii")
        monkeypatch.setenv(cache.FOLDER_VARIABLE, str(folder / "below"))
    else:
        monkeypatch.setenv(cache.FOLDER_VARIABLE, "")
    monkeypatch.setattr(compilation._compiler, "_kept", type(compilation._compiler._kept)())
    assert Program.compile(ROBOT + "m = 4712;").statements


def test_a_full_disk_is_no_hindrance(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    cache.keep(PROGRAM)
    assert cache.find(PROGRAM.text) is None
    assert list(folder.iterdir()) == []


def test_another_compiler_finds_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    cache.keep(PROGRAM)
    monkeypatch.setattr(cache, "_maker", lambda: b"of tomorrow")
    assert cache.find(PROGRAM.text) is None


def test_many_processes_share_it(folder: Path) -> None:
    script = (
        "from logical_robots_tui.mind import cache; from logical_robots_tui.mind import Program\n"
        "cache.MAX_ENTRIES = 4\n"
        "for n in range(200):\n"
        "    text = str(n % 8) * 1000\n"
        "    cache.keep(Program(text, (), {'Robot': text}))\n"
        "    found = cache.find(text)\n"
        "    assert found is None or found.statements['Robot'] == text\n"
    )
    with ThreadPoolExecutor(6) as pool:
        done = list(
            pool.map(
                lambda _: subprocess.run([sys.executable, "-c", script], capture_output=True),
                range(6),
            )
        )
    assert [(d.returncode, d.stderr) for d in done] == [(0, b"")] * 6
    assert not list(folder.glob(f"*{cache._UNFINISHED}"))
    assert 0 < len(list(folder.iterdir())) <= 4 + 6
