"""Compiling in a process of its own, which can be killed; results are kept by content."""

from __future__ import annotations

import hashlib
import json
import logging
import math
import os
import select
import subprocess
import sys
import threading
from collections import OrderedDict
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from logical_robots_tui.mind import cache
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError, QueryError, Stopped
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.program import Program, Question
from logical_robots_tui.mind.records import record

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from _typeshed import DataclassInstance

    from logical_robots_tui.mind.diagnosis.sites import Checkup
    from logical_robots_tui.mind.program import Report
    from logical_robots_tui.mind.why.probing import Probing

__all__ = ["check_up", "compile_program", "compile_question", "stop_compiling", "take_apart"]

T = TypeVar("T", bound="DataclassInstance")

_log = logging.getLogger(__name__)

_KEPT = 64
_LOOK_SECONDS = 0.02
_LARGEST_ANSWER = 32_000_000  # bytes
_PASSED_ON = ("DYLD_LIBRARY_PATH", "LD_LIBRARY_PATH", "PYTHONHOME")
"""The parts of the environment without which Python itself may not start."""


def compile_program(
    text: str,
    *,
    stop: threading.Event | None = None,
    limits: Limits | None = None,
    report: Report | None = None,
) -> Program:
    """Compile a program, or return the one compiled from the same text before.

    Args:
        text: Logica text.
        stop: Set it from another thread to give up.
        limits: Bounds on the length of the text and on time and memory for compiling.
        report: Called meanwhile with the number of predicates compiled and of all.

    Raises:
        ProgramError: The program is wrong, too large, or takes too long to compile.
        Stopped: `stop` was set.
    """
    limits = limits or Limits()
    _check_text(text, limits)
    return _compiler.answer({"text": text}, "program", Program, limits, stop, report)


def compile_question(
    program: Program,
    query: str,
    *,
    stop: threading.Event | None = None,
    limits: Limits | None = None,
) -> Question:
    """As `Program.question`; what was compiled before is at hand."""
    limits = limits or Limits()
    _check_text(query, limits)
    columns = {
        table: sorted({n for t in program.tuned.values() for n in t.columns.get(table, ())})
        for table in ("Memory", "Item")
    }
    request = {"text": program.text, "query": query, "columns": columns}
    return _compiler.answer(request, "question", Question, limits, stop)


def take_apart(
    program: Program,
    predicate: str,
    within: str = "",
    *,
    stop: threading.Event | None = None,
    limits: Limits | None = None,
) -> Probing:
    """As `Program.take_apart`; what was taken apart before is at hand."""
    from logical_robots_tui.mind.why.probing import Probing

    known = program.predicate(predicate)
    if known is None or known.kind != "program":
        raise QueryError(f"The program has no rules for {predicate}.")
    request = {
        "text": program.text,
        "predicate": predicate,
        "within": within,
        "with_rows": [p.name for p in program.predicates if p.kind == "program" and p.has_rows],
    }
    if not (known.has_rows or known.is_function or within):
        raise QueryError(known.reason)
    try:
        return _compiler.answer(request, "probing", Probing, limits or Limits(), stop)
    except ProgramError as error:
        raise QueryError(f"{predicate} can't be taken apart: {error}") from None


def check_up(
    program: Program, *, stop: threading.Event | None = None, limits: Limits | None = None
) -> Checkup:
    """Make a program ready to be watched; what was made ready before is at hand. Blocks.

    Args:
        program: The program.
        stop: Set it from another thread to give up.
        limits: Bounds on compiling.

    Raises:
        QueryError: It is too entangled for that.
        Stopped: `stop` was set.
    """
    from logical_robots_tui.mind.diagnosis.sites import Checkup

    functions = [p.name for p in program.predicates if p.is_function]
    request = {"text": program.text, "checkup": functions}
    try:
        found = _compiler.answer(request, "checkup", Checkup, limits or Limits(), stop)
    except ProgramError as error:
        raise QueryError(f"The program can't be watched: {error}") from None
    asked = replace(found.program, memory=program.memory, sensor=program.sensor)
    return replace(found, program=asked)


def stop_compiling() -> None:
    """End the compile process, if there is one."""
    _compiler.close()


class _Compiler:
    """One warm compile process and the programs that it has compiled."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._bounds = ("", "")
        self._turn = threading.Lock()
        self._kept: OrderedDict[bytes, Any] = OrderedDict()

    def answer(
        self,
        request: Mapping[str, Any],
        name: str,
        kind: type[T],
        limits: Limits,
        stop: threading.Event | None,
        report: Report | None = None,
    ) -> T:
        """What the process makes of a request, or made of it before.

        Args:
            request: What to compile.
            name: What the answer is called.
            kind: The dataclass that it is.
            limits: Bounds on time and memory.
            stop: Set it from another thread to give up.
            report: Told of progress.
        """
        line = json.dumps(request).encode()
        key = hashlib.sha256(line).digest()
        deadline = monotonic() + limits.compile_seconds
        while not self._turn.acquire(timeout=_LOOK_SECONDS):
            _check(stop)
        try:
            if key in self._kept:
                self._kept.move_to_end(key)
            else:
                _check(stop)
                made = cache.find(line, kind)
                if made is None:
                    made = self._ask(line, name, kind, limits, deadline, stop, report)
                    cache.keep(line, made)
                self._kept[key] = made
                while len(self._kept) > _KEPT:
                    self._kept.popitem(last=False)
            kept: T = self._kept[key]
            return kept
        finally:
            self._turn.release()

    def close(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()

    def _ask(
        self,
        line: bytes,
        name: str,
        kind: type[T],
        limits: Limits,
        deadline: float,
        stop: threading.Event | None,
        report: Report | None,
    ) -> T:
        """Have it compiled. A process that was not heard to the end is ended."""
        try:
            found: dict[str, Any] = {}
            for answer in self._exchange(line + b"\n", limits, deadline, stop):
                found = json.loads(answer)
                if "done" not in found:
                    break
                if report is not None:
                    report(found["done"], found["all"])
            if "trace" in found:
                _log.error("The compiler stumbled over a program.\n%s", found["trace"])
            if "diagnostics" in found:
                raise ProgramError(tuple(record(Diagnostic, d) for d in found["diagnostics"]))
            return record(kind, found[name])
        except ProgramError:
            raise
        except (OSError, ValueError):
            self.close()
            raise _refusal("the compiler gave up on this program", "Try a simpler one.") from None
        except BaseException:
            self.close()
            raise

    def _exchange(
        self, request: bytes, limits: Limits, deadline: float, stop: threading.Event | None
    ) -> Iterator[bytes]:
        """The lines that the process says about a request."""
        process = self._started(limits)
        assert process.stdin is not None
        assert process.stdout is not None
        into, out_of = process.stdin.fileno(), process.stdout.fileno()
        answer = bytearray()
        while True:
            *lines, answer = answer.split(b"\n")
            yield from map(bytes, lines)
            _check(stop)
            if monotonic() > deadline:
                self.close()
                raise _refusal(
                    f"compiling took longer than {limits.compile_seconds:g} seconds",
                    "Simplify the program; deep recursion and many mentions of a long "
                    "expression are what takes time.",
                )
            readable, writable, _ = select.select(
                [out_of], [into] if request else [], [], _LOOK_SECONDS
            )
            if writable:
                request = request[os.write(into, request[: select.PIPE_BUF]) :]
            if readable:
                piece = os.read(out_of, 1 << 20)
                if not piece or len(answer) > _LARGEST_ANSWER:
                    raise OSError("the compile process ended or would not stop talking")
                answer += piece

    def _started(self, limits: Limits) -> subprocess.Popen[bytes]:
        bounds = (str(limits.compile_bytes), str(math.ceil(limits.compile_seconds) + 1))
        running = self._process is not None and self._process.poll() is None
        if self._process is not None and running and bounds == self._bounds:
            return self._process
        self.close()
        self._bounds = bounds
        self._process = subprocess.Popen(  # noqa: S603 - our own interpreter, and two numbers
            [sys.executable, "-P", "-S", "-m", "logical_robots_tui.mind.compiling.worker", *bounds],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            cwd="/",
            env=_environment(),
            start_new_session=True,  # an interrupt from the keyboard is for the game alone
        )
        return self._process


def _check_text(text: str, limits: Limits) -> None:
    """Refuse what is too long, or no text at all.

    Raises:
        ProgramError: It is.
    """
    if len(text) > limits.program_characters:
        raise _refusal(
            f"the program has {len(text):,} characters, more than the "
            f"{limits.program_characters:,} that a program may have",
            "A robot's program is a short text; is this the right file?",
        )
    if (at := _not_text(text)) is not None:
        line = text.count("\n", 0, at) + 1
        raise _refusal("this is not text", "Is this the right file?", line)


def _environment() -> dict[str, str]:
    """Where Python finds what it needs, and nothing else of this process's environment."""
    home = str(Path(__file__).resolve().parents[2])
    paths = [home, *(str(Path(p).resolve()) for p in sys.path if p)]
    return {
        "PYTHONPATH": os.pathsep.join(dict.fromkeys(paths)),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONUTF8": "1",
        **{name: os.environ[name] for name in _PASSED_ON if name in os.environ},
    }


def _check(stop: threading.Event | None) -> None:
    if stop is not None and stop.is_set():
        raise Stopped("The compilation was stopped.")


def _not_text(text: str) -> int | None:
    """Offset of a character that no text has, or None."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        return error.start
    return text.index("\0") if "\0" in text else None


def _refusal(message: str, hint: str, line: int = 1) -> ProgramError:
    return ProgramError((Diagnostic(line, 1, message, hint),))


_compiler = _Compiler()
