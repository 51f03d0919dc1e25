"""Compiling in a separate process that can be killed; results are cached, also on disk."""

from __future__ import annotations

import hashlib
import logging
import os
import select
import signal
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from time import monotonic
from typing import Any, ClassVar, TypeAlias, TypeVar

import msgspec

from logical_robots_tui import schema
from logical_robots_tui.caching import CacheFolder, cache_place, digest_of_code
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError, Stopped
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.processes.helper import COMPILE_PROCESS, Helper
from logical_robots_tui.processes.hosted import HostedHelper, forked_compile_process

Report: TypeAlias = "Callable[[int, int], None]"
"""Called with the number of compiled predicates and of all."""

T = TypeVar("T")

_log = logging.getLogger(__name__)

_CACHED_RESULTS = 64
_POLL_SECONDS = 0.02
_PATIENCE = 20  # seconds to wait for each processor second, on a busy computer
_IDLE_SECONDS = 60.0
_MAX_ANSWER = 32_000_000  # bytes
MAX_ENTRIES = 5_000
MAX_BYTES = 50_000_000
_MAX_ENTRY = 5_000_000  # bytes of one entry

NO_MEMORY = 3
"""The exit status of a compile process that ran out of memory."""

_LACKS_MEMORY = {NO_MEMORY, -signal.SIGSEGV, -signal.SIGBUS, -signal.SIGABRT, -signal.SIGKILL}
"""Exit statuses: a stack that can't grow, a failed allocation, or a kill by the system."""


class Task(msgspec.Struct, frozen=True, tag=True):
    """What the compile process is to do; sent as JSON that names the class."""

    parts: ClassVar[tuple[str, ...]] = ()
    """Parts of the package on whose code the result depends, besides language and mind."""
    is_stored: ClassVar[bool] = True
    """Whether to keep the result on disk: not if it is found in less time than it takes to read."""


class CompileProgram(Task, frozen=True):
    """Gives a `Program`."""

    text: str


class CheckProgram(Task, frozen=True):
    """Gives a `Program` without statements: its text was checked, but not compiled."""

    is_stored: ClassVar = False
    text: str


class CompileQuestion(Task, frozen=True):
    """Gives a `CompiledQuery` about a program, for a memory table with these columns."""

    text: str
    query: str
    columns: dict[str, list[str]]


class SetConstants(Task, frozen=True):
    """Gives the program's text with other values of its constants."""

    text: str
    constants: dict[str, str]


class CompileProgress(msgspec.Struct, tag=True):
    """An answer before the last one: how many predicates are compiled, and of how many."""

    compiled: int
    total: int


class TaskResult(msgspec.Struct, tag=True):
    content: msgspec.Raw


class Refusal(msgspec.Struct, tag=True):
    diagnostics: tuple[Diagnostic, ...]


class Failure(msgspec.Struct, tag=True):
    trace: str


_read_answer = msgspec.json.Decoder(CompileProgress | TaskResult | Refusal | Failure).decode


def check_text(text: str, limits: Limits | None) -> None:
    """Raise ProgramError for text that is too long to compile, or that is not text."""
    limit = (limits or Limits()).program_characters
    if len(text) > limit:
        raise _refusal(
            f"The program has {len(text):,} characters, more than the {limit:,} that a program may "
            "have",
            "A robot's program is a short text; is this the right file?",
        )
    try:
        text.encode()
        offset = text.find("\0")
    except UnicodeEncodeError as error:  # a lone surrogate
        offset = error.start
    if offset >= 0:
        line = text.count("\n", 0, offset) + 1
        raise _refusal("This is not text", "Is this the right file?", line)


class _Compiler:
    def __init__(self) -> None:
        self._process: Helper | HostedHelper | None = None
        self._bounds = ("", "")
        self._lock = threading.Lock()
        self._used_at = 0.0
        self._cache: OrderedDict[bytes, Any] = OrderedDict()

    def result(
        self,
        task: Task,
        kind: type[T],
        *,
        stop: threading.Event | None = None,
        limits: Limits | None = None,
        report: Report | None = None,
    ) -> T:
        """Return the compile process's result of a task, cached if possible. Blocks.

        Raises:
            ProgramError: The program has errors, is too large, or takes too long to compile.
            Stopped: `stop` was set.
        """
        limits = limits or Limits()
        deadline = monotonic() + _PATIENCE * limits.compile_seconds
        request = msgspec.json.encode(task)
        key = hashlib.sha256(request).digest()
        while not self._lock.acquire(timeout=_POLL_SECONDS):
            _raise_if_stopped(stop)
        try:
            if key in self._cache:
                self._cache.move_to_end(key)
            else:
                _raise_if_stopped(stop)
                result = find_result(task, kind) if task.is_stored else None
                if result is None:
                    result = self._compute(request, kind, limits, deadline, stop, report)
                    if task.is_stored:
                        keep_result(task, result)
                self._cache[key] = result
                while len(self._cache) > _CACHED_RESULTS:
                    self._cache.popitem(last=False)
            cached: T = self._cache[key]
            return cached
        finally:
            self._lock.release()

    def close(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.end()

    def close_idle(self, seconds: float = _IDLE_SECONDS) -> None:
        """End the process if it has had no task for a while; the next one starts another."""
        if self._lock.acquire(blocking=False):
            try:
                if monotonic() - self._used_at > seconds:
                    self.close()
            finally:
                self._lock.release()

    def _compute(
        self,
        request: bytes,
        kind: type[T],
        limits: Limits,
        deadline: float,
        stop: threading.Event | None,
        report: Report | None,
    ) -> T:
        """Return the result of a request; end the process if its answer is incomplete."""
        try:
            for line in self._exchange(request + b"\n", limits, deadline, stop):
                match _read_answer(line):
                    case CompileProgress(compiled=compiled, total=total):
                        if report is not None:
                            report(compiled, total)
                    case TaskResult(content=content):
                        return msgspec.json.decode(content, type=kind)
                    case Refusal(diagnostics=diagnostics):
                        raise ProgramError(diagnostics)
                    case Failure(trace=trace):
                        _log.error("The compiler failed on a program.\n%s", trace)
                        raise _compiler_failure(is_unfinished=False)
            raise OSError("the compile process sent no result")
        except ProgramError:
            raise
        except (OSError, ValueError, msgspec.DecodeError) as error:
            self.close()
            _log.warning("The compile process failed: %r", error)
            raise _compiler_failure() from None
        except BaseException:
            self.close()
            raise

    def _exchange(
        self, request: bytes, limits: Limits, deadline: float, stop: threading.Event | None
    ) -> Iterator[bytes]:
        process = self._running_process(limits)
        self._used_at = monotonic()
        assert process.stdin is not None
        assert process.stdout is not None
        stdin, stdout = process.stdin.fileno(), process.stdout.fileno()
        answer = bytearray()
        while True:
            *lines, answer = answer.split(b"\n")
            yield from map(bytes, lines)
            _raise_if_stopped(stop)
            if monotonic() > deadline:
                self.close()
                raise _timeout_error(limits)
            readable, writable, _ = select.select(
                [stdout], [stdin] if request else [], [], _POLL_SECONDS
            )
            if writable:
                try:
                    request = request[os.write(stdin, request[: select.PIPE_BUF]) :]
                except BrokenPipeError:
                    request = b""  # it has ended; its status is reported below
            if readable:
                chunk = os.read(stdout, 1 << 20)
                if not chunk:
                    self.close()
                    raise _exit_error(process.returncode, limits)
                answer += chunk
                if len(answer) > _MAX_ANSWER:
                    raise OSError("the compile process sent too much")

    def _running_process(self, limits: Limits) -> Helper | HostedHelper:
        bounds = str(limits.compile_bytes), str(limits.compile_seconds)
        is_running = self._process is not None and self._process.poll() is None
        if self._process is not None and is_running and bounds == self._bounds:
            return self._process
        self.close()
        self._bounds = bounds
        self._process = forked_compile_process(*bounds) or Helper(COMPILE_PROCESS, *bounds)
        return self._process


def _raise_if_stopped(stop: threading.Event | None) -> None:
    if stop is not None and stop.is_set():
        raise Stopped("The compilation was stopped.")


def _timeout_error(limits: Limits) -> ProgramError:
    return _refusal(
        f"Compiling took longer than {limits.compile_seconds:g} seconds",
        "Simplify the program: deep recursion and repeated long expressions take the most time.",
        is_unfinished=True,
    )


def _exit_error(status: int | None, limits: Limits) -> ProgramError:
    """Return why the compile process ended with an exit status."""
    if status == -signal.SIGPROF:
        return _timeout_error(limits)
    if status not in _LACKS_MEMORY:
        _log.warning("The compile process ended with status %d.", status)
        return _compiler_failure()
    return _refusal(
        "The program needs too much memory to compile",
        "Shorten it, or let a recursion take fewer steps: @Recursive(P, 8);",
        is_unfinished=status != NO_MEMORY,
    )


def _compiler_failure(*, is_unfinished: bool = True) -> ProgramError:
    message = "The compiler gave up on this program"
    return _refusal(message, "Try a simpler one.", is_unfinished=is_unfinished)


def _refusal(
    message: str, hint: str, line: int = 1, *, is_unfinished: bool = False
) -> ProgramError:
    return ProgramError((Diagnostic(line, 1, message, hint),), is_unfinished=is_unfinished)


_compiler = _Compiler()
compile_task, stop_compiling = _compiler.result, _compiler.close
stop_idle_compiling = _compiler.close_idle


# -- on disk -------------------------------------------------------------------------------------


def find_result(task: Task, kind: type[T]) -> T | None:
    entries, name = compiled_programs(), _name(task)
    content = entries.read(name, _MAX_ENTRY)
    if content is None:
        return None
    digest, _, body = content.partition(b"\n")
    try:
        if digest != _digest(body):
            raise ValueError("not an entry")
        written_for, result = msgspec.json.decode(body, type=tuple[msgspec.Raw, kind])  # type: ignore[valid-type]  # a type by its value
        if bytes(written_for) != msgspec.json.encode(task):
            raise ValueError("the entry of another task")
        return result
    except (ValueError, msgspec.DecodeError, RecursionError):
        entries.drop(name)
        return None


def keep_result(task: Task, result: object) -> None:
    entries = compiled_programs()
    if entries.place is None:
        return
    body = msgspec.json.encode((task, result))
    content = _digest(body) + b"\n" + body
    if len(content) <= min(_MAX_ENTRY, MAX_BYTES):
        entries.keep(_name(task), [content])


def compiled_programs() -> CacheFolder:
    """Return the folder on disk; its place is None if there is no cache."""
    return CacheFolder(cache_place("compiled"), ".program", MAX_ENTRIES, MAX_BYTES)


def _name(task: Task) -> str:
    return hashlib.sha256(_digest_of_parts(task.parts) + msgspec.json.encode(task)).hexdigest()


def _digest(body: bytes) -> bytes:
    return hashlib.sha256(body).hexdigest().encode()


@cache
def _digest_of_parts(parts: tuple[str, ...]) -> bytes:
    package = Path(schema.__file__).parent
    places = [package / part for part in ("language", "mind", *parts, "schema.py")]
    return digest_of_code(places, ("logica", "sqlglot"))
