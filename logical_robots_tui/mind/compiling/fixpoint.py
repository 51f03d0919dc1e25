"""Recursion by iterating to a fixed point.

The package unrolls a recursion; a step that mentions its predicate twice doubles the SQL
each time. Here a step is compiled once; one recursive query passes its rows as a list::

    WITH RECURSIVE
    t_0_steps_of_T AS (
      SELECT 0 AS step, '[]' AS found0, NULL AS before
      UNION ALL
      SELECT step + 1, (SELECT json_group_array(json_array(col0, col1)) FROM (...)), found0
      FROM t_0_steps_of_T WHERE step < 32 AND found0 IS NOT before),
    t_0_T AS (SELECT json_extract(value, '$[0]') AS col0, ... FROM json_each(...))

Of predicates that mention each other, those whose rows are passed cut every circle; the others
are computed from them within a step.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from sqlglot import exp

from logical_robots_tui.language import tree
from logical_robots_tui.language.checks import MOST_STEPS
from logical_robots_tui.language.definitions import Model, names_used
from logical_robots_tui.language.expansion import rename
from logical_robots_tui.mind.program import STEPS
from logical_robots_tui.mind.tuning import sql

_MOST_ALTERNATIVES = 50  # of one rule

DEPTH = 32  # as on DuckDB; the package's SQLite default is 8


@dataclass(frozen=True, slots=True)
class Fixpoint:
    """Predicates that are iterated together.

    Attributes:
        names: The predicates whose rows are passed from step to step.
        depth: The most steps after the first one.
        stop: The predicate that ends the iteration when it has a row, or "".
        orders: The columns by which some of them are ordered, as in SQL, with their directions.
    """

    names: tuple[str, ...]
    depth: int
    stop: str = ""
    orders: tuple[tuple[str, str], ...] = ()

    @property
    def step_predicates(self) -> tuple[str, ...]:
        """The predicates whose queries a step needs: one per name, and one for the stop."""
        return (*map(_next, self.names), *([_next(self.stop)] if self.stop else []))

    def all_rows(self, name: str) -> str:
        """Return the query for the final rows of a predicate."""
        order = dict(self.orders).get(name, "")
        order = order.replace(", DESC", " DESC").replace(", ASC", " ASC")
        return f"SELECT * FROM {name}" + (f" ORDER BY {order}" if order else "")  # noqa: S608 - names


def _next(name: str) -> str:
    return f"{name}_NextStep"


def _last(name: str) -> str:
    return f"{name}_LastStep"


def fixpoints(program: Sequence[tree.Statement]) -> tuple[list[tree.Statement], list[Fixpoint]]:
    """Extract the recursions from a program; the package unrolls those that can't be extracted.

    Returns:
        The program, with rules for one step in place of each recursion; and the recursions.
    """
    model = Model(program)
    rules: dict[str, list[tree.Rule]] = {}
    for rule in model.rules:
        rules.setdefault(str(rule.name), []).append(rule)
    extractor = _RecursionExtractor(model, rules)
    annotated = {annotation.subject for annotation in model.annotations}
    for name in sorted(rules, key=lambda name: name not in annotated):  # these may have satellites
        extractor.extract(name)
    return extractor.statements, extractor.fixpoints


def _alternative_rules(rule: tree.Rule) -> list[tree.Rule]:
    """Return a rule for each alternative in a body, so that some can begin a recursion."""
    choices = tree.alternatives(tree.conjuncts(rule.body), _MOST_ALTERNATIVES)
    if len(choices) == 1:
        return [rule]
    return [replace(rule, body=tree.Conjunction(tuple(parts))) for parts, _ in choices]


class _RecursionExtractor:
    """Extracts recursions in turn; `statements` holds the rest of the program."""

    def __init__(self, model: Model, rules_by_name: dict[str, list[tree.Rule]]) -> None:
        self.statements = list(model.statements)
        self.fixpoints: list[Fixpoint] = []
        self._rules = rules_by_name
        self._uses = {
            n: {str(c) for c in names_used(rules) if c in rules_by_name}
            for n, rules in rules_by_name.items()
        }
        self._annotations = model.annotations
        self._extracted: set[str] = set()
        functors = model.substituted | {*names_used(model.functors)}
        counts = Counter((a.name, a.subject) for a in self._annotations)
        limited_names = {a.subject for a in self._annotations if a.name == "@Limit"}
        repeated_names = {subject for (_, subject), n in counts.items() if n > 1}  # an error
        self._excluded = functors | limited_names | repeated_names

    def extract(self, name: str) -> None:
        # The predicates mutually recursive with it, itself included.
        circle = {n for n in _reachable(name, self._uses) if name in _reachable(n, self._uses)}
        if not circle or circle & (self._extracted | self._excluded):
            return
        recursive = [a for a in self._annotations if a.name == "@Recursive" and a.subject in circle]
        options = [argument for annotation in recursive for argument in annotation.arguments[1:]]
        stops = (o.value for o in options if o.field == "stop")
        stop = next((str(v.name) for v in stops if isinstance(v, tree.PredicateName)), "")
        satellites = {
            str(element.name)
            for option in options
            if option.field == "satellites" and isinstance(option.value, tree.List)
            for element in option.value.elements
            if isinstance(element, tree.PredicateName) and element.name in self._rules
        }
        # These are read from the previous step, so that a stop can compare steps.
        satellites |= {
            callee
            for callee in _reachable(stop, self._uses) - circle - {stop}
            if circle & _reachable(callee, self._uses)
        }
        iterated = circle | satellites
        for member in iterated:
            self._rules[member] = [
                *chain.from_iterable(map(_alternative_rules, self._rules[member]))
            ]
        rules = [rule for member in iterated for rule in self._rules[member]]
        if all(iterated & _needs(rule) for rule in rules):
            return  # nothing to begin with
        names = (*self._cuts(circle), *sorted(satellites - circle))
        depths = (o.value for o in options if o.field == 1 and isinstance(o.value, tree.Number))
        depth = next((int(float(number.value)) for number in depths), -1 if stop else DEPTH)
        depth = min(depth, MOST_STEPS) if depth >= 0 else MOST_STEPS  # -1: no limit of its own
        orders = tuple(
            (annotation.subject, ", ".join(filter(None, map(tree.text_of, annotation.values))))
            for annotation in self._annotations
            if annotation.name == "@OrderBy" and annotation.subject in names
        )
        fixpoint = Fixpoint(names, depth, stop, orders)
        self.statements = [
            statement
            for statement in self.statements
            if statement not in recursive
            and (statement.subject if isinstance(statement, tree.Annotation) else statement.name)
            not in names
        ]
        self.statements += self._step(fixpoint, circle)
        self.fixpoints.append(fixpoint)
        self._extracted |= iterated

    def _cuts(self, circle: Collection[str]) -> list[str]:
        """Return members whose removal breaks every circle, few of them, by a greedy search."""
        ordered = [name for name in self._rules if name in circle]
        annotated = {a.subject for a in self._annotations if a.name == "@Recursive"}
        candidates = sorted(ordered, key=lambda name: name not in annotated)
        for name in candidates:
            if not self._in_circle(ordered, [name]):
                return [name]
        cuts: list[str] = []
        while remaining := self._in_circle(candidates, cuts):
            cuts.append(remaining[0])
        return cuts

    def _in_circle(self, names: Sequence[str], cuts: Collection[str]) -> list[str]:
        """Return the names that still are in a circle."""
        return [n for n in names if n not in cuts and n in _reachable(n, self._uses, cuts)]

    def _step(self, fixpoint: Fixpoint, circle: set[str]) -> Iterator[tree.Rule]:
        copies = {name: f"{name}_For_{fixpoint.step_predicates[0]}" for name in circle}
        calls = {**copies, **{name: _last(name) for name in fixpoint.names}}
        heads = {**copies, **dict(zip(fixpoint.names, fixpoint.step_predicates, strict=False))}
        if fixpoint.stop:
            heads[fixpoint.stop] = fixpoint.step_predicates[-1]
        for name, head in heads.items():
            for rule in self._rules.get(name, ()):
                copy = rename(rule, calls)
                yield replace(copy, head=replace(copy.head, name=head))


def _reachable(name: str, uses: Mapping[str, set[str]], excluded: Collection[str] = ()) -> set[str]:
    visited: set[str] = set()
    pending = [*uses.get(name, ())]
    while pending:
        callee = pending.pop()
        if callee not in visited and callee not in excluded:
            visited.add(callee)
            pending += uses[callee]
    return visited


def _needs(rule: tree.Rule) -> set[str]:
    """Return the predicates that a rule calls outside aggregates, which may be of nothing."""
    return {*names_used(rule)} - {
        name
        for node in tree.walk(rule)
        if isinstance(node, tree.Aggregate)
        for name in names_used(node)
    }


def with_fixpoints(statement: str, steps: Mapping[Fixpoint, Sequence[str]]) -> str:
    """Add the named queries of iterated predicates to a query that reads some."""
    names = {name for fixpoint in steps for name in fixpoint.names}
    if not any(name in statement for name in names):
        return statement
    query = sql.parse(statement)
    if not names & {table.name for table in query.find_all(exp.Table)}:
        return statement
    return f"{sql.render(_with_steps(query, steps), pretty=True)};"


def growth_query(fixpoint: Fixpoint, steps: Mapping[Fixpoint, Sequence[str]]) -> str:
    """Return a query for 1 if the last step of a recursion still changed something, else 0."""
    name = f"{STEPS}{fixpoint.names[0]}"
    last = f"step > {fixpoint.depth} AND {_step_state(fixpoint, name)} IS NOT before"
    query = f"SELECT EXISTS (SELECT 1 FROM {name} WHERE {last})"  # noqa: S608 - our own SQL
    return sql.render(_with_steps(sql.parse(query), steps), pretty=True)


def _with_steps(query: exp.Query, steps: Mapping[Fixpoint, Sequence[str]]) -> exp.Query:
    queries = [
        named_query
        for fixpoint, statements in steps.items()
        for named_query in _queries(fixpoint, [*map(sql.parse, statements)])
    ]
    named_queries = [*queries, *sql.named_queries(query)]
    query.set("with_", exp.With(expressions=named_queries, recursive=True))
    for fixpoint in steps:
        for name in fixpoint.names:
            _replace_table(query, name, f"t_0_{name}")
    return query


def _replace_table(query: exp.Query, name: str, replacement: str) -> bool:
    tables = [table for table in query.find_all(exp.Table) if table.name == name]
    for table in tables:
        table.replace(exp.alias_(exp.to_table(replacement), table.alias_or_name, table=True))
    return bool(tables)


def _step_state(fixpoint: Fixpoint, table: str) -> str:
    """Return all lists of a step as one value; two steps with the same one are equal."""
    return " || ".join(f"{table}.found{number}" for number, _ in enumerate(fixpoint.names))


def _queries(fixpoint: Fixpoint, queries: Sequence[exp.Query]) -> list[exp.CTE]:
    """Return the common table expressions for a recursion's steps and its final rows."""
    name = f"{STEPS}{fixpoint.names[0]}"
    columns = {
        predicate: _columns(query)
        for predicate, query in zip(fixpoint.names, queries, strict=False)
    }
    for query in queries:
        _read_last_step(query, name, columns)
    lists = ", ".join(
        f"{_as_list(query, columns[predicate])} AS found{number}"
        for number, (predicate, query) in enumerate(zip(fixpoint.names, queries, strict=False))
    )
    initial_lists = ", ".join(f"'[]' AS found{number}" for number, _ in enumerate(fixpoint.names))
    condition = (
        f"{name}.step <= {fixpoint.depth} AND ({_step_state(fixpoint, name)}) IS NOT {name}.before"
    )
    if fixpoint.stop:
        stop_test = f"EXISTS (SELECT 1 FROM ({sql.render(queries[-1])}) AS stop)"  # noqa: S608 - our own SQL
        condition += f" AND ({name}.step = 0 OR NOT {stop_test})"
    last_step = f"FROM {name} ORDER BY step DESC LIMIT 1"
    rows = ", ".join(
        f"t_0_{predicate} AS ({_rows(columns[predicate], f'(SELECT found{number} {last_step})')})"
        for number, predicate in enumerate(fixpoint.names)
    )
    text = f"""
    WITH {name} AS (
      SELECT 0 AS step, {initial_lists}, NULL AS before
      UNION ALL
      SELECT {name}.step + 1 AS step, {lists}, {_step_state(fixpoint, name)} AS before
      FROM {name} WHERE {condition}),
    {rows}
    SELECT 1"""  # noqa: S608 - the compiler's own SQL
    return sql.named_queries(sql.parse(text))


def _read_last_step(query: exp.Query, steps: str, columns: Mapping[str, list[str]]) -> None:
    """Let a query read the rows of the last step from its lists."""
    tables: list[exp.Expr] = []
    for number, (name, column_names) in enumerate(columns.items()):
        previous_table = f"t_0_before_{name}"
        if _replace_table(query, _last(name), previous_table):
            rows = exp.CTE(
                this=sql.parse(_rows(column_names, f"{steps}.found{number}")),
                alias=exp.TableAlias(this=exp.to_identifier(previous_table)),
                materialized=True,  # or it would be evaluated again for each joined row
            )
            tables.append(rows)
    if tables:
        query.set("with_", exp.With(expressions=[*tables, *sql.named_queries(query)]))


def _as_list(query: exp.Query, columns: Sequence[str]) -> str:
    values = ", ".join(f"made.{column}" for column in columns)
    order = ", ".join(map(str, range(1, len(columns) + 1)))
    ordered = f"SELECT * FROM ({sql.render(query)}) AS step ORDER BY {order}"  # noqa: S608 - our own SQL
    return f"(SELECT json_group_array(json_array({values})) FROM ({ordered}) AS made)"  # noqa: S608 - our own SQL


def _rows(columns: list[str], rows_list: str) -> str:
    values = (f"json_extract(listed.value, '$[{n}]') AS {c}" for n, c in enumerate(columns))
    return f"SELECT {', '.join(values)} FROM json_each({rows_list}) AS listed"  # noqa: S608 - our own SQL


def _columns(query: Any) -> list[str]:
    while isinstance(query, exp.Subquery | exp.SetOperation) or query.is_star:
        query = query.args["from_"].this if isinstance(query, exp.Select) else query.this
    return [sql.render(item.args["alias"]) for item in query.expressions]


_PIECE = re.compile(r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|[()]|\bSELECT\b")


def growth_check(statement: str, predicate: str, steps: int) -> str:
    """Return a query for whether the last unrolled step changed anything, or "" if unknown."""
    if not statement.startswith("WITH "):
        return ""
    step_pattern = rf"\b(t_\d+_{re.escape(predicate)}_f?r{steps - 1}) AS \("
    step, last = re.search(step_pattern, statement), _last_query(statement)
    if step is None or last is None:
        return ""
    queries, query = statement[:last].rstrip(), statement[last:].strip().rstrip(";")
    difference = f"SELECT * FROM the_last_step EXCEPT SELECT * FROM {step.group(1)}"  # noqa: S608 - the compiler's own SQL
    return f"{queries},\nthe_last_step AS ({query})\nSELECT EXISTS ({difference})"


def _last_query(statement: str) -> int | None:
    """Return the offset of the final SELECT, after all named queries."""
    depth = 0
    for match in _PIECE.finditer(statement):
        piece = match.group()
        depth += (piece == "(") - (piece == ")")
        if piece == "SELECT" and depth == 0:
            return match.start()
    return None
