"""The compile process of the game: compiles programs, and decomposes them for explanations."""

from __future__ import annotations

from contextlib import closing
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from logical_robots_tui.explain.clauses.calls import read_call
from logical_robots_tui.explain.clauses.decomposition import decompose
from logical_robots_tui.explain.diagnosis.checkup import check_up
from logical_robots_tui.mind.compiling.worker import (
    is_prepared_soon,
    keep_preparable,
    serve,
)
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.tuning import tune_all


def main() -> None:
    """Serve requests until standard input ends."""
    serve(JOBS)


def _decompose(request: dict[str, Any]) -> dict[str, object]:
    """Decompose a predicate's rules, or return more of its queries."""
    found = decompose(*(request[field] for field in ("text", "predicate", "within", "kinds")))
    with closing(Database()) as database:
        queries = found.queries(database, request.get("queries", ()))
    if "queries" in request:
        return {"compiled": {"queries": queries}}
    return {"probing": asdict(replace(found.probing, queries=queries))}


def _check_up(request: dict[str, Any]) -> dict[str, object]:
    """Prepare a program to be watched, as far as SQLite can prepare it in time."""
    functions = frozenset(request["checkup"])
    with closing(Database()) as database:
        found = check_up(request["text"], functions, partial(is_prepared_soon, database))
    for_all = {probe.name for probe in found.probes if probe.closeness != "closer"}
    tuned = keep_preparable(tune_all(found.program.statements, for_all=for_all))
    return {"checkup": asdict(replace(found, program=replace(found.program, tuned=tuned)))}


def _read(request: dict[str, Any]) -> dict[str, object]:
    return {"called": asdict(read_call(request["called"]))}


JOBS = {"predicate": _decompose, "checkup": _check_up, "called": _read}
