"""The compile process: compiles programs, decomposes their rules, and reads calls."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from functools import partial

from logical_robots_tui.explain import decomposition
from logical_robots_tui.explain.calls import read_call
from logical_robots_tui.explain.diagnosis import checkup
from logical_robots_tui.explain.diagnosis.sites import Checkup, PrepareCheckup
from logical_robots_tui.explain.why.probing import CompileClauses, Decompose, Probing, ReadCall
from logical_robots_tui.mind.compilation import Task
from logical_robots_tui.mind.compiling import worker
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.tuning import tune_all


def main() -> None:
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
