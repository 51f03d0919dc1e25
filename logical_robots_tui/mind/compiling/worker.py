"""What the compile process does: reads a task per line, writes answers, each in a line.

It ends when its standard input is closed, even while compiling. Before the first program it
gives up the permissions to open or write files and to start processes.
"""

from __future__ import annotations

import gc
import os
import queue
import resource
import signal
import sqlite3
import sys
import threading
import traceback
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import replace
from functools import cache, partial, reduce
from operator import or_
from time import process_time
from typing import IO, TYPE_CHECKING, Any, TypeAlias

import msgspec

from logical_robots_tui.language.definitions import with_constants
from logical_robots_tui.language.diagnostics import (
    MOST_DIAGNOSTICS,
    Diagnostic,
    ProgramError,
    printable,
)
from logical_robots_tui.language.pitfalls import CALLED_AGGREGATE
from logical_robots_tui.mind.asking import in_plain_words
from logical_robots_tui.mind.compilation import (
    NO_MEMORY,
    CheckProgram,
    CompileProgram,
    CompileProgress,
    CompileQuestion,
    Failure,
    Refusal,
    SetConstants,
    Task,
    TaskResult,
)
from logical_robots_tui.mind.compiling import compiler
from logical_robots_tui.mind.compiling.questions import compile_question
from logical_robots_tui.mind.program import CompiledQuery, Program, Tuned
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.sqlite.layouts import COLUMNS_LAYOUT, WHOLE_RAY
from logical_robots_tui.mind.tuning import MemoryColumns, tune, tune_all
from logical_robots_tui.processes.helper import begin, collect_seldom, limit
from logical_robots_tui.schema import MAIN

if TYPE_CHECKING:
    from logical_robots_tui.mind.compilation import Report

_LONGEST_MESSAGE = 1_000
_MAX_SQL = 4_000_000  # characters of all statements of a program
_PREPARE_SECONDS = 1.0
_MIN_SECONDS = 0.001  # none would be without a limit

_SAMPLE = "Robot(robot_name: x, desire: Snesor(x));"
"""A program whose mistake loads what messages need; all else is loaded with this module."""


Job: TypeAlias = "Callable[[Any], object]"
"""Returns the result of a task; raises ProgramError."""


def serve(jobs: Mapping[type[Task], Job]) -> None:
    """Do tasks until standard input ends.

    The process's arguments are bytes of address space, and the processor seconds for one task.

    Args:
        jobs: What does them, by their types, `JOBS` among them.
    """
    arguments = begin(processor_seconds=None)  # each task has its own bound
    address_space, seconds = int(arguments[0]), float(arguments[1])
    collect_seldom()
    answers = os.fdopen(os.dup(1), "wb")
    # The package prints; its output must not reach the screen or the answers.
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    tasks: queue.Queue[bytes] = queue.Queue()
    threading.Thread(target=_read, args=(sys.stdin.buffer, tasks), daemon=True).start()
    read_task = msgspec.json.Decoder(reduce(or_, jobs)).decode
    warm_up()
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limit(resource.RLIMIT_AS, address_space)
    limit(resource.RLIMIT_NOFILE, 0)
    if hasattr(resource, "RLIMIT_NPROC"):
        limit(resource.RLIMIT_NPROC, 0)

    def report(compiled: int, total: int) -> None:
        _write(answers, CompileProgress(compiled, total))

    jobs = {**jobs, CompileProgram: partial(_compile, report=report)}
    while True:
        task = read_task(tasks.get())
        signal.setitimer(signal.ITIMER_PROF, max(seconds, _MIN_SECONDS))  # ends the process
        try:
            answer = do(task, jobs)
            signal.setitimer(signal.ITIMER_PROF, 0)
            _write(answers, answer)
        except MemoryError:  # what is left may not be enough to answer
            os._exit(NO_MEMORY)


def _write(answers: IO[bytes], answer: CompileProgress | TaskResult | Refusal | Failure) -> None:
    answers.write(msgspec.json.encode(answer) + b"\n")
    answers.flush()


@cache
def warm_up() -> None:
    """Load everything that compiling may need while files can still be opened."""
    sys.modules["numpy"] = None  # type: ignore[assignment]  # the package would load it for speed
    msgspec.json.encode(do(CompileProgram(_SAMPLE), JOBS))
    gc.freeze()


def _read(lines: IO[bytes], tasks: queue.Queue[bytes]) -> None:
    for line in lines:
        tasks.put(line)
    os._exit(0)


def do(task: Task, jobs: Mapping[type[Task], Job]) -> TaskResult | Refusal | Failure:
    """Return the result of a task, the diagnostics of its program, or the trace of a bug."""
    try:
        return TaskResult(msgspec.Raw(_encode(jobs[type(task)](task))))
    except ProgramError as error:
        return Refusal(tuple(map(_shortened, error.diagnostics[: MOST_DIAGNOSTICS + 1])))
    except MemoryError:
        raise
    except SystemError:  # without memory, CPython may lose the exception that says so
        raise MemoryError from None
    except RecursionError:
        nested = "The program is nested too deeply"
        return Refusal((Diagnostic(1, 1, nested, "Split it into named parts."),))
    except Exception:  # the package may raise anything, and the process must survive
        return Failure(traceback.format_exc())


def _plain_text(value: object) -> str:
    if not isinstance(value, str):
        raise NotImplementedError(type(value))
    return str(value)


_encode = msgspec.json.Encoder(enc_hook=_plain_text).encode


def _shortened(diagnostic: Diagnostic) -> Diagnostic:
    message, hint, excerpt = (
        printable(text[:_LONGEST_MESSAGE])
        for text in (diagnostic.message, diagnostic.hint, diagnostic.excerpt)
    )
    return replace(diagnostic, message=message, hint=hint, excerpt=excerpt)


def _compile(task: CompileProgram, report: Report | None = None) -> Program:
    program, trees = compiler.compile_text(task.text, report)
    _check_preparable(program)
    order = sorted(program.statements, key=lambda name: name not in program.needed)
    statements = {
        MAIN: program.statements[MAIN],
        **{f"{name} grows": sql for name, (_, sql) in program.recursions.items()},
        **{name: program.statements[name] for name in order},
    }
    return replace(program, tuned=keep_preparable(tune_all(statements, trees)))


def _compile_question(task: CompileQuestion) -> CompiledQuery:
    """Raises ProgramError if it has errors, or SQLite can't prepare it in reasonable time."""
    question = compile_question(task.text, task.query)
    with closing(Database()) as database:
        if failure := _failure_of(database, question.sql):
            message = f"The query can't be computed: {failure}"
            hint = "Check it, and the predicates that it uses."
            raise ProgramError((Diagnostic(1, 1, message, hint),))
    # For a table with the columns that there are already.
    tuned = tune(question.sql, MemoryColumns.from_columns(task.columns), for_all=True)
    preparable = {} if tuned is None else keep_preparable({"": tuned})
    return replace(question, tuned=preparable.get(""))


JOBS: Mapping[type[Task], Job] = {
    CheckProgram: lambda task: compiler.check_text(task.text)[0],
    CompileProgram: _compile,
    SetConstants: lambda task: with_constants(task.text, task.constants),
    CompileQuestion: _compile_question,
}


def _check_preparable(program: Program) -> None:
    """Refuse a program whose statements SQLite can't prepare in reasonable time.

    SQLite inlines named subqueries before it checks for interrupts, so this is done here, where
    the process can be killed.
    """
    if sum(map(len, program.statements.values())) > _MAX_SQL:
        raise _too_large()
    failures: dict[str, str] = {}
    with closing(Database()) as database:
        checks = [("", sql) for _, sql in program.recursions.values()]
        for name, sql in (*program.statements.items(), *checks):
            if failure := _failure_of(database, sql):
                failures[name] = failure
    # Errors in predicates that Robot does not use are reported when they are queried.
    culprit = next((name for name in program.needed if name in failures), None)
    for predicate in program.predicates if MAIN in failures else ():
        if predicate.name == culprit:
            if "aggregate" in failures[culprit]:
                misused = (w for w in program.warnings if w.message.endswith(CALLED_AGGREGATE))
                errors = tuple(replace(warning, severity="error") for warning in misused)
                if errors:
                    raise ProgramError(errors)
            message = f"{predicate.name} can't be computed: {failures[predicate.name]}"
            hint = "Check its rules and the annotations that name it."
            raise ProgramError((Diagnostic(predicate.line or 1, 1, message, hint),))


def keep_preparable(queries: dict[str, Tuned]) -> dict[str, Tuned]:
    """Return the tuned queries that SQLite can prepare in reasonable time."""
    preparable = {}
    with closing(Database(layout=COLUMNS_LAYOUT)) as database:
        database.register(WHOLE_RAY, lambda _: None)
        for name, tuned in queries.items():
            if is_prepared_soon(database, tuned.sql, tuned.bounds):
                pairs = (tuned.for_all(alike=alike) for alike in (False, True))
                is_joint = all(not sql or is_prepared_soon(database, sql, n) for sql, n in pairs)
                preparable[name] = (
                    tuned if is_joint else replace(tuned, together="", together_alike="")
                )
    return preparable


def is_prepared_soon(database: Database, sql: str, bounds: int = 0) -> bool:
    """Return whether SQLite can prepare a query with so many parameters in reasonable time."""
    try:
        return not _failure_of(database, sql, bounds)
    except ProgramError:
        return False


def _failure_of(database: Database, sql: str, bounds: int = 0) -> str:
    """Return why SQLite can't prepare a query, or ""; raise ProgramError if it takes too long."""
    failure, start = "", process_time()
    try:
        database.prepare(sql, (0,) * bounds)
    except (sqlite3.Error, sqlite3.Warning) as error:
        failure = in_plain_words(error)
    if process_time() - start > _PREPARE_SECONDS:
        raise _too_large()
    return failure


def _too_large() -> ProgramError:
    message = "The program becomes too large when its predicates are inlined"
    return ProgramError((Diagnostic(1, 1, message, "Mention long predicates less often."),))
