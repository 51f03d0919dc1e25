"""Recursion by iterating to a fixed point.

The package unrolls a recursion; a step that mentions its predicate twice doubles the SQL
each time. Here the step is compiled once; one recursive query passes its rows as a list::

    WITH RECURSIVE
    t_0_steps_of_T AS (
      SELECT 0 AS step, '[]' AS found, NULL AS before
      UNION ALL
      SELECT step + 1, (SELECT json_group_array(json_array(col0, col1)) FROM (...)), found
      FROM t_0_steps_of_T WHERE step < 32 AND found IS NOT before),
    t_0_T AS (SELECT json_extract(value, '$[0]') AS col0, ... FROM json_each(...))
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from sqlglot import exp

from logical_robots_tui.language.definitions import functor_names, names_used
from logical_robots_tui.language.functors import rename
from logical_robots_tui.language.tree import Annotation, Number, Rule
from logical_robots_tui.mind.program import STEPS
from logical_robots_tui.mind.tuning import sql

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.language.tree import Statement

_DEPTH = 32  # as on DuckDB; the package's SQLite default is 8
_MOST_STEPS = 1_000
_ABOUT_THE_WHOLE = frozenset({"@Limit", "@OrderBy"})


@dataclass(frozen=True, slots=True)
class Fixpoint:
    """A predicate that is computed by iterating."""

    name: str
    depth: int

    @property
    def before(self) -> str:
        return f"{self.name}_LastStep"

    @property
    def step(self) -> str:
        return f"{self.name}_NextStep"


def fixpoints(program: Sequence[Statement]) -> tuple[list[Statement], list[Fixpoint]]:
    """Extract the recursions from a program; the package unrolls those that can't be extracted.

    Returns:
        The program, with rules for one step in place of each recursion; and the recursions.
    """
    statements = list(program)
    own: dict[str, list[Rule]] = {}
    for each in statements:
        if isinstance(each, Rule):
            own.setdefault(str(each.name), []).append(each)
    uses = {name: {str(c) for c in names_used(mine) if c in own} for name, mine in own.items()}
    made = functor_names(statements)
    annotations = [each for each in statements if isinstance(each, Annotation)]
    ordered = {each.subject for each in annotations if each.name in _ABOUT_THE_WHOLE}
    times = Counter((each.name, each.subject) for each in annotations)
    ordered |= {subject for (_, subject), number in times.items() if number > 1}  # an error
    found: list[Fixpoint] = []
    for name in own:
        circle = _circle(name, uses)
        if (
            name in circle
            and not circle & (made | ordered)
            and not any(circle & _circle(fixpoint.name, uses) for fixpoint in found)
            and not any(other in _circle(other, uses, without=name) for other in circle - {name})
            and _begins(name, own, circle)
        ):
            fixpoint = Fixpoint(name, min(_depth(name, annotations), _MOST_STEPS))
            statements = [
                each
                for each in statements
                if (each.subject if isinstance(each, Annotation) else each.name) != name
            ]
            statements += _step(fixpoint, circle, own)
            found.append(fixpoint)
    return statements, found


def _depth(name: str, annotations: Sequence[Annotation]) -> int:
    """Return the steps that ``@Recursive`` allows."""
    for each in reversed(annotations):
        if each.name == "@Recursive" and each.subject == name and each.values:
            (steps, *_) = each.values
            if isinstance(steps, Number) and (depth := int(float(steps.value))) >= 0:
                return depth
    return _DEPTH


def _circle(name: str, uses: Mapping[str, set[str]], without: str = "") -> set[str]:
    """Return the predicates mutually recursive with one, itself included, or none."""
    below = _below(name, uses, without)
    return {other for other in below if name in _below(other, uses, without)}


def _below(name: str, uses: Mapping[str, set[str]], without: str) -> set[str]:
    seen: set[str] = set()
    waiting = [*uses[name]]
    while waiting:
        other = waiting.pop()
        if other not in seen and other != without:
            seen.add(other)
            waiting += uses[other]
    return seen


def _begins(start: str, own: Mapping[str, list[Rule]], circle: set[str]) -> bool:
    """Return whether a recursion has a base case."""
    begun: set[str] = set()
    while True:
        waiting = circle - begun
        found = {
            name for name in waiting if any(not waiting & {*names_used(rule)} for rule in own[name])
        }
        if not found:
            return start in begun
        begun |= found


def _step(fixpoint: Fixpoint, circle: set[str], own: Mapping[str, list[Rule]]) -> Iterator[Rule]:
    copies = {name: f"{name}_For_{fixpoint.step}" for name in circle}
    heads = {**copies, fixpoint.name: fixpoint.step}
    calls = {**copies, fixpoint.name: fixpoint.before}
    for name in circle:
        for rule in own[name]:
            copied = rename(rule, calls)
            yield replace(copied, head=replace(copied.head, name=heads[name]))


def with_fixpoints(statement: str, steps: Mapping[Fixpoint, str]) -> str:
    """Add the named queries of iterated predicates; `steps` are in order of dependency."""
    if not any(fixpoint.name in statement for fixpoint in steps):
        return statement
    tree = sql.parse(statement)
    mentioned = {table.name for table in tree.find_all(exp.Table)}
    if not any(fixpoint.name in mentioned for fixpoint in steps):
        return statement
    return f"{sql.render(_with_steps(tree, steps), pretty=True)};"


def grows(fixpoint: Fixpoint, steps: Mapping[Fixpoint, str]) -> str:
    """Return a query for 1 if the last step of a recursion still changed something, else 0."""
    last = f"step > {fixpoint.depth} AND found IS NOT before"
    query = f"SELECT EXISTS (SELECT 1 FROM {STEPS}{fixpoint.name} WHERE {last})"  # noqa: S608 - our own SQL
    return sql.render(_with_steps(sql.parse(query), steps), pretty=True)


def _with_steps(tree: exp.Query, steps: Mapping[Fixpoint, str]) -> exp.Query:
    queries: list[exp.Expr] = []
    for fixpoint, statement in steps.items():
        queries += _queries(fixpoint, sql.parse(statement))
    named = tree.args.get("with_")
    queries += named.expressions if named else []
    tree.set("with_", exp.With(expressions=queries, recursive=True))
    for fixpoint in steps:
        _read_instead(tree, fixpoint.name, f"t_0_{fixpoint.name}")
    return tree


def _read_instead(tree: exp.Query, name: str, other: str) -> None:
    for table in list(tree.find_all(exp.Table)):
        if table.name == name:
            table.replace(exp.alias_(exp.to_table(other), table.alias_or_name, table=True))


def _queries(fixpoint: Fixpoint, step: exp.Query) -> list[exp.Expr]:
    """Return the common table expressions for a recursion's steps and its final rows."""
    columns = _columns(step)
    name, before = f"{STEPS}{fixpoint.name}", f"t_0_before_{fixpoint.name}"
    _read_instead(step, fixpoint.before, before)
    rows = exp.CTE(
        this=sql.parse(_rows(columns, f"{name}.found")),
        alias=exp.TableAlias(this=exp.to_identifier(before)),
        materialized=True,  # or it would be evaluated again for each joined row
    )
    named = step.args.get("with_")
    step.set("with_", exp.With(expressions=[rows, *(named.expressions if named else [])]))
    made = ", ".join(f"made.{column}" for column in columns)
    order = ", ".join(map(str, range(1, len(columns) + 1)))
    last = f"(SELECT found FROM {name} ORDER BY step DESC LIMIT 1)"  # noqa: S608 - our own SQL
    text = f"""
    WITH {name} AS (
      SELECT 0 AS step, '[]' AS found, NULL AS before
      UNION ALL
      SELECT {name}.step + 1 AS step,
        (SELECT json_group_array(json_array({made}))
         FROM (SELECT * FROM ({sql.render(step)}) AS step ORDER BY {order}) AS made) AS found,
        {name}.found AS before
      FROM {name} WHERE ({name}.step <= {fixpoint.depth}) AND ({name}.found IS NOT {name}.before)),
    t_0_{fixpoint.name} AS ({_rows(columns, last)})
    SELECT 1"""  # noqa: S608 - the compiler's own SQL
    return list(sql.parse(text).args["with_"].expressions)


def _rows(columns: list[str], listed: str) -> str:
    values = (f"json_extract(listed.value, '$[{n}]') AS {c}" for n, c in enumerate(columns))
    return f"SELECT {', '.join(values)} FROM json_each({listed}) AS listed"  # noqa: S608 - our own SQL


def _columns(query: Any) -> list[str]:
    while isinstance(query, exp.Subquery | exp.SetOperation) or query.is_star:
        query = query.args["from_"].this if isinstance(query, exp.Select) else query.this
    return [sql.render(item.args["alias"]) for item in query.expressions]


_PIECE = re.compile(r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|[()]|\bSELECT\b")


def growth_check(statement: str, predicate: str, steps: int) -> str:
    """Return a query for whether the last unrolled step changed anything, or "" if unknown."""
    if not statement.startswith("WITH "):
        return ""
    before = rf"\b(t_\d+_{re.escape(predicate)}_f?r{steps - 1}) AS \("
    step, last = re.search(before, statement), _last_query(statement)
    if step is None or last is None:
        return ""
    named, query = statement[:last].rstrip(), statement[last:].strip().rstrip(";")
    changed = f"SELECT * FROM the_last_step EXCEPT SELECT * FROM {step.group(1)}"  # noqa: S608 - the compiler's own SQL
    return f"{named},\nthe_last_step AS ({query})\nSELECT EXISTS ({changed})"


def _last_query(statement: str) -> int | None:
    """Return the offset of the final SELECT, after all named queries."""
    depth = 0
    for found in _PIECE.finditer(statement):
        piece = found.group()
        depth += (piece == "(") - (piece == ")")
        if piece == "SELECT" and depth == 0:
            return found.start()
    return None
