"""The compile process: reads a program per line, writes its compiled form per line.

It ends when its standard input is closed, even while compiling. Before the first program it
gives up the permissions to open or write files and to start processes.
"""

from __future__ import annotations

import gc
import json
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
from dataclasses import asdict, replace
from functools import partial
from time import process_time
from typing import IO, TYPE_CHECKING, Any

from logical_robots_tui.language.definitions import with_constants
from logical_robots_tui.language.diagnostics import (
    MOST_DIAGNOSTICS,
    Diagnostic,
    ProgramError,
    printable,
)
from logical_robots_tui.language.pitfalls import CALLED_AGGREGATE
from logical_robots_tui.mind.asking import in_plain_words
from logical_robots_tui.mind.compilation import NO_MEMORY
from logical_robots_tui.mind.compiling import compiler
from logical_robots_tui.mind.compiling.questions import compile_question
from logical_robots_tui.mind.program import Program, Tuned
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.sqlite.layouts import COLUMNS_LAYOUT, WHOLE_RAY
from logical_robots_tui.mind.tuning import MemoryColumns, tune, tune_all
from logical_robots_tui.processes.helper import begin, collect_seldom, limit
from logical_robots_tui.schema import MAIN

if TYPE_CHECKING:
    from logical_robots_tui.mind.compilation import Report

_LONGEST_MESSAGE = 1_000
_MOST_SQL = 4_000_000  # characters of all statements of a program
_PREPARE_SECONDS = 1.0
_LEAST_SECONDS = 0.001  # none would be without a limit

_SAMPLE = "Robot(robot_name: x, desire: Snesor(x));"
"""A program whose mistake loads what messages need; all else is loaded with this module."""


Job = Callable[[dict[str, Any]], dict[str, object]]
"""Answers a request."""


def serve(jobs: Mapping[str, Job]) -> None:
    """Serve requests until standard input ends.

    The process's arguments are bytes of address space, and the processor seconds for one program.

    Args:
        jobs: Answers to further requests, by the field that tells them apart.
    """
    jobs = {**_JOBS, **jobs}
    arguments = begin(processor_seconds=None)  # each program has its own bound
    address_space, seconds = int(arguments[0]), float(arguments[1])
    collect_seldom()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    # The package prints; its output must not reach the screen or the answers.
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    requests: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_read, args=(sys.stdin, requests), daemon=True).start()
    warm_up()
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limit(resource.RLIMIT_AS, address_space)
    limit(resource.RLIMIT_NOFILE, 0)
    if hasattr(resource, "RLIMIT_NPROC"):
        limit(resource.RLIMIT_NPROC, 0)
    while True:
        request = json.loads(requests.get())
        signal.setitimer(signal.ITIMER_PROF, max(seconds, _LEAST_SECONDS))  # ends the process
        try:
            found = answer(request, jobs, partial(_report, answers))
            signal.setitimer(signal.ITIMER_PROF, 0)
            _say(answers, found)
        except MemoryError:  # what is left may not be enough to answer
            os._exit(NO_MEMORY)


def _say(answers: IO[str], what: dict[str, object]) -> None:
    answers.write(json.dumps(what) + "\n")
    answers.flush()


def _report(answers: IO[str], done: int, of_all: int) -> None:
    _say(answers, {"done": done, "all": of_all})


def warm_up() -> None:
    """Load everything that compiling may need while files can still be opened."""
    sys.modules["numpy"] = None  # type: ignore[assignment]  # the package would load it for speed
    answer({"text": _SAMPLE}, {})
    gc.freeze()


def _read(lines: IO[str], requests: queue.Queue[str]) -> None:
    for line in lines:
        requests.put(line)
    os._exit(0)


def answer(
    request: dict[str, Any], jobs: Mapping[str, Job], report: Report | None = None
) -> dict[str, object]:
    """Return the answer to a request: what was asked for, diagnostics, or the trace of a bug."""
    try:
        job = next((job for field, job in jobs.items() if field in request), None)
        if job is not None:
            return job(request)
        program, trees = compiler.compile_text(request["text"], report)
        _try_out(program)
        order = sorted(program.statements, key=lambda name: name not in program.needed)
        statements = {
            MAIN: program.statements[MAIN],
            **{f"{name} grows": sql for name, (_, sql) in program.recursions.items()},
            **{name: program.statements[name] for name in order},
        }
        tuned = keep_preparable(tune_all(statements, trees))
        return {"program": asdict(replace(program, tuned=tuned))}
    except ProgramError as error:
        shown = [asdict(each) for each in error.diagnostics[: MOST_DIAGNOSTICS + 1]]
        for each in shown:
            for part in ("message", "hint", "excerpt"):
                each[part] = printable(each[part][:_LONGEST_MESSAGE])
        return {"diagnostics": shown}
    except MemoryError:
        raise
    except SystemError:  # without memory, CPython may lose the exception that says so
        raise MemoryError from None
    except RecursionError:
        nested = "The program is nested too deeply"
        deep = Diagnostic(1, 1, nested, "Split it into named parts.")
        return {"diagnostics": [asdict(deep)]}
    except Exception:  # the package may raise anything, and the process must survive
        return {"trace": traceback.format_exc()}


def _ask(request: dict[str, Any]) -> dict[str, object]:
    """Compile a question about a program.

    Raises:
        ProgramError: It has errors, or SQLite can't prepare it in reasonable time.
    """
    question = compile_question(request["text"], request["query"])
    with closing(Database()) as database:
        if trouble := _trouble(database, question.sql):
            message = f"The query can't be computed: {trouble}"
            hint = "Check it, and the predicates that it uses."
            raise ProgramError((Diagnostic(1, 1, message, hint),))
    # For a table with the columns that there are already.
    tuned = tune(question.sql, MemoryColumns.closed(request["columns"]), for_all=True)
    found = {} if tuned is None else keep_preparable({"": tuned})
    return {"question": asdict(replace(question, tuned=found.get("")))}


_JOBS: Mapping[str, Job] = {
    "constants": lambda asked: {
        "settled": {"text": with_constants(asked["text"], asked["constants"])}
    },
    "query": _ask,
}


def _try_out(program: Program) -> None:
    """Refuse a program whose statements SQLite can't prepare in reasonable time.

    SQLite inlines named subqueries before it checks for interrupts, so this is done here, where
    the process can be killed.
    """
    if sum(map(len, program.statements.values())) > _MOST_SQL:
        raise _too_large()
    failed: dict[str, str] = {}
    with closing(Database()) as database:
        checks = [("", sql) for _, sql in program.recursions.values()]
        for name, sql in (*program.statements.items(), *checks):
            if trouble := _trouble(database, sql):
                failed[name] = trouble
    # Errors in predicates that Robot does not use are reported when they are queried.
    culprit = next((name for name in program.needed if name in failed), None)
    for predicate in program.predicates if MAIN in failed else ():
        if predicate.name == culprit:
            if "aggregate" in failed[culprit]:
                called = (w for w in program.warnings if w.message.endswith(CALLED_AGGREGATE))
                wrong = tuple(replace(each, severity="error") for each in called)
                if wrong:
                    raise ProgramError(wrong)
            message = f"{predicate.name} can't be computed: {failed[predicate.name]}"
            hint = "Check its rules and the annotations that name it."
            raise ProgramError((Diagnostic(predicate.line or 1, 1, message, hint),))


def keep_preparable(every: dict[str, Tuned]) -> dict[str, Tuned]:
    """Return the tuned queries that SQLite can prepare in reasonable time."""
    kept = {}
    with closing(Database(layout=COLUMNS_LAYOUT)) as database:
        database.offer(WHOLE_RAY, lambda _: None)
        for name, tuned in every.items():
            if is_prepared_soon(database, tuned.sql, tuned.bounds):
                jointly = (tuned.for_all(alike=alike) for alike in (False, True))
                good = all(not sql or is_prepared_soon(database, sql, n) for sql, n in jointly)
                kept[name] = tuned if good else replace(tuned, together="", together_alike="")
    return kept


def is_prepared_soon(database: Database, sql: str, bounds: int = 0) -> bool:
    """Return whether SQLite can prepare a query with so many parameters in reasonable time."""
    try:
        return not _trouble(database, sql, bounds)
    except ProgramError:
        return False


def _trouble(database: Database, sql: str, bounds: int = 0) -> str:
    """Return why SQLite can't prepare a query, or ""; raise ProgramError if it takes too long."""
    trouble, began = "", process_time()
    try:
        database.prepare(sql, (0,) * bounds)
    except (sqlite3.Error, sqlite3.Warning) as error:
        trouble = in_plain_words(error)
    if process_time() - began > _PREPARE_SECONDS:
        raise _too_large()
    return trouble


def _too_large() -> ProgramError:
    message = "The program becomes too large when its predicates are inlined"
    return ProgramError((Diagnostic(1, 1, message, "Mention long predicates less often."),))
