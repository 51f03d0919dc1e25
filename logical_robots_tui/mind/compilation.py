"""Compiling in a process of its own, which can be killed; results are kept by content."""

from __future__ import annotations

import hashlib
import json
import os
import select
import subprocess
import sys
import threading
from collections import OrderedDict
from pathlib import Path
from time import monotonic
from typing import Any

from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError, Stopped
from logical_robots_tui.mind.program import Predicate, Program

__all__ = ["MAX_PROGRAM_CHARACTERS", "compile_program", "stop_compiling"]

MAX_PROGRAM_CHARACTERS = 200_000
COMPILE_SECONDS = 30.0
_KEPT = 64
_LOOK_SECONDS = 0.05


def compile_program(text: str, *, stop: threading.Event | None = None) -> Program:
    """Compile a program, or return the one compiled from the same text before.

    Args:
        text: Logica text.
        stop: Set it from another thread to give up.

    Raises:
        ProgramError: The program is wrong, too large, or takes too long to compile.
        Stopped: `stop` was set.
    """
    if len(text) > MAX_PROGRAM_CHARACTERS:
        raise _refusal(
            f"the program has {len(text):,} characters, more than the "
            f"{MAX_PROGRAM_CHARACTERS:,} that a program may have",
            "A robot's program is a short text; is this the right file?",
        )
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise _refusal("this is not text", "Is this the right file?", line)
    return _compiler.compile(text, stop)


def stop_compiling() -> None:
    """End the compile process, if there is one."""
    _compiler.close()


class _Compiler:
    """One warm compile process and the programs that it has compiled."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._turn = threading.Lock()
        self._kept: OrderedDict[bytes, Program] = OrderedDict()

    def compile(self, text: str, stop: threading.Event | None) -> Program:
        key = hashlib.sha256(text.encode("utf-8", "surrogatepass")).digest()
        with self._turn:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
            if stop is not None and stop.is_set():
                raise Stopped("The compilation was stopped.")
            program = _program(self._ask(text, stop))
            self._kept[key] = program
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
            return program

    def close(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()

    def _ask(self, text: str, stop: threading.Event | None) -> dict[str, Any]:
        process = self._started()
        assert process.stdin is not None
        try:
            process.stdin.write(json.dumps(text).encode() + b"\n")
            process.stdin.flush()
            answer = self._read_line(process, stop)
        except BrokenPipeError:
            answer = b""
        if not answer:
            self.close()
            raise _refusal("the compiler gave up on this program", "Try a simpler one.")
        answered: dict[str, Any] = json.loads(answer)
        return answered

    def _read_line(self, process: subprocess.Popen[bytes], stop: threading.Event | None) -> bytes:
        assert process.stdout is not None
        deadline = monotonic() + COMPILE_SECONDS
        pieces: list[bytes] = []
        while not (pieces and pieces[-1].endswith(b"\n")):
            if stop is not None and stop.is_set():
                self.close()
                raise Stopped("The compilation was stopped.")
            if monotonic() > deadline:
                self.close()
                raise _refusal(
                    f"compiling took longer than {COMPILE_SECONDS:g} seconds",
                    "Simplify the program; deep recursion and many mentions of a long "
                    "expression are what takes time.",
                )
            if select.select([process.stdout], [], [], _LOOK_SECONDS)[0]:
                piece = os.read(process.stdout.fileno(), 1 << 20)
                if not piece:
                    return b""
                pieces.append(piece)
        return b"".join(pieces)

    def _started(self) -> subprocess.Popen[bytes]:
        if self._process is not None and self._process.poll() is None:
            return self._process
        self.close()
        home = Path(__file__).resolve().parents[2]
        path = os.pathsep.join(filter(None, [str(home), os.environ.get("PYTHONPATH")]))
        self._process = subprocess.Popen(
            [sys.executable, "-m", "logical_robots_tui.mind.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": path},
            start_new_session=True,  # an interrupt from the keyboard is for the game alone
        )
        return self._process


def _program(answer: dict[str, Any]) -> Program:
    if "diagnostics" in answer:
        raise ProgramError(tuple(Diagnostic(**d) for d in answer["diagnostics"]))
    fields = answer["program"]
    fields["predicates"] = tuple(Predicate(**p) for p in fields["predicates"])
    return Program(**fields)


def _refusal(message: str, hint: str, line: int = 1) -> ProgramError:
    return ProgramError((Diagnostic(line, 1, message, hint),))


_compiler = _Compiler()
