"""The compile process: compiles programs, decomposes their rules, and reads calls.

A host of games has a warm one, which forks those of all games: it reads two numbers from a game,
and gives it pipes to a process that has given up everything else before it reads a program. The
warm one ends with the last game after the host.
"""

from __future__ import annotations

import os
import socket
import sys
from contextlib import closing, suppress
from dataclasses import replace
from functools import partial
from selectors import EVENT_READ, DefaultSelector

from logical_robots_tui.explain import decomposition
from logical_robots_tui.explain.calls import read_call
from logical_robots_tui.explain.diagnosis import checkup
from logical_robots_tui.explain.diagnosis.sites import Checkup, PrepareCheckup
from logical_robots_tui.explain.why.probing import CompileClauses, Decompose, Probing, ReadCall
from logical_robots_tui.mind.compilation import Task
from logical_robots_tui.mind.compiling import worker
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.tuning import tune_all
from logical_robots_tui.processes.hosted import Fork

_LARGEST = 100  # bytes of a request


def main() -> None:
    """Do tasks, or with the words host and DESCRIPTOR fork processes that do, until the end."""
    if sys.argv[1] == "host":
        _serve_games(socket.socket(fileno=int(sys.argv[2])))
    else:
        worker.serve(JOBS)


def _decompose(task: Decompose) -> Probing:
    clauses = decomposition.decompose(task.text, task.predicate, task.within, task.kinds)
    with closing(Database()) as database:
        return replace(clauses.probing, queries=clauses.queries(database, ()))


def _compile_clauses(task: CompileClauses) -> dict[str, str]:
    clauses = decomposition.decompose(task.text, task.predicate, task.within, task.kinds)
    with closing(Database()) as database:
        return clauses.queries(database, task.queries)


def _check_up(task: PrepareCheckup) -> Checkup:
    with closing(Database()) as database:
        is_prepared_soon = partial(worker.is_prepared_soon, database)
        plan = checkup.check_up(task.text, frozenset(task.functions), is_prepared_soon)
    for_all = {probe.name for probe in plan.probes if probe.closeness != "closer"}
    tuned = worker.keep_preparable(tune_all(plan.program.statements, for_all=for_all))
    return replace(plan, program=replace(plan.program, tuned=tuned))


JOBS: dict[type[Task], worker.Job] = {
    **worker.JOBS,
    Decompose: _decompose,
    CompileClauses: _compile_clauses,
    PrepareCheckup: _check_up,
    ReadCall: lambda task: read_call(task.text),
}


def _serve_games(host: socket.socket) -> None:
    """Fork compile processes until there are no games, and no host to tell of others."""
    worker.warm_up()
    selector = DefaultSelector()
    selector.register(host, EVENT_READ)
    working: set[socket.socket] = set()
    while selector.get_map():
        for key, _ in selector.select():
            if isinstance(key.data, Fork):
                working.discard(key.data.client)
                key.data.tell_end(selector, key.fd)
                continue
            connection = key.fileobj
            assert isinstance(connection, socket.socket)
            content = b""
            with suppress(OSError, ValueError):  # no game at the host's end
                if connection is host:
                    _, [game], *_ = socket.recv_fds(host, _LARGEST, 1)
                    selector.register(socket.socket(fileno=game), EVENT_READ)
                    continue
                content = connection.recv(_LARGEST)  # without descriptors
            if (arguments := _arguments(content)) is None or connection in working:
                selector.unregister(connection)
                connection.close()
            else:
                working.add(connection)
                _fork(connection, arguments).watch(selector)


def _arguments(content: bytes) -> list[str] | None:
    """Return a compile process's arguments from a request, or None if it is not one."""
    try:
        size, seconds = content.split()
        return [str(int(size)), str(float(seconds))]
    except ValueError:
        return None


def _fork(game: socket.socket, arguments: list[str]) -> Fork:
    """Fork a compile process for a game, and give the game the other ends of its pipes."""
    (stdin, to_stdin), (from_stdout, stdout), (lifeline, our_end) = (os.pipe() for _ in range(3))
    pid = os.fork()
    if pid == 0:
        os.setsid()
        os.dup2(stdin, 0)
        os.dup2(stdout, 1)
        lifeline = os.dup2(lifeline, 3)
        os.closerange(4, os.sysconf("SC_OPEN_MAX"))
        sys.argv[1:] = [str(lifeline), *arguments]
        worker.serve(JOBS)
    with suppress(OSError):
        socket.send_fds(game, [str(pid).encode()], [to_stdin, from_stdout, our_end])
    for descriptor in (stdin, to_stdin, from_stdout, stdout, lifeline, our_end):
        os.close(descriptor)
    return Fork(pid, game)
