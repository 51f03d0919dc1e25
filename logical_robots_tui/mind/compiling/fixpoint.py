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
from logical_robots_tui.language.definitions import functor_names, names_used, rules_of
from logical_robots_tui.language.expansion import rename
from logical_robots_tui.mind.program import STEPS
from logical_robots_tui.mind.tuning import sql

_MOST_ALTERNATIVES = 50  # of one rule

DEPTH = 32  # as on DuckDB; the package's SQLite default is 8


@dataclass(frozen=True, slots=True)
class Fixpoint:
    """Predicates that are computed together by iterating.

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
    def asked(self) -> tuple[str, ...]:
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
    own: dict[str, list[tree.Rule]] = {}
    for rule in rules_of(program):
        own.setdefault(str(rule.name), []).append(rule)
    search = _Search(program, own)
    annotated = {each.subject for each in program if isinstance(each, tree.Annotation)}
    for name in sorted(own, key=lambda name: name not in annotated):  # those may have satellites
        search.extract(name)
    return search.statements, search.found


def _alternative_rules(rule: tree.Rule) -> list[tree.Rule]:
    """Return a rule for each alternative in a body, so that some can begin a recursion."""
    choices = tree.alternatives(tree.conjuncts(rule.body), _MOST_ALTERNATIVES)
    if len(choices) == 1:
        return [rule]
    return [replace(rule, body=tree.Conjunction(tuple(parts))) for parts, _ in choices]


class _Search:
    """Extracts recursions one after the other; `statements` is what is left of the program."""

    def __init__(self, program: Sequence[tree.Statement], own: dict[str, list[tree.Rule]]) -> None:
        self.statements = list(program)
        self.found: list[Fixpoint] = []
        self._own = own
        self._uses = {n: {str(c) for c in names_used(mine) if c in own} for n, mine in own.items()}
        self._annotations = [each for each in program if isinstance(each, tree.Annotation)]
        self._done: set[str] = set()
        made = functor_names(program)
        times = Counter((each.name, each.subject) for each in self._annotations)
        limited = {each.subject for each in self._annotations if each.name == "@Limit"}
        repeated = {subject for (_, subject), number in times.items() if number > 1}  # an error
        self._excluded = made | limited | repeated

    def extract(self, name: str) -> None:
        # The predicates mutually recursive with it, itself included.
        circle = {other for other in _below(name, self._uses) if name in _below(other, self._uses)}
        if not circle or circle & (self._done | self._excluded):
            return
        recursive = [
            each
            for each in self._annotations
            if each.name == "@Recursive" and each.subject in circle
        ]
        options = [argument for each in recursive for argument in each.arguments[1:]]
        stops = (o.value for o in options if o.field == "stop")
        stop = next((str(v.name) for v in stops if isinstance(v, tree.PredicateName)), "")
        beside = {
            str(each.name)
            for option in options
            if option.field == "satellites" and isinstance(option.value, tree.List)
            for each in option.value.elements
            if isinstance(each, tree.PredicateName) and each.name in self._own
        }
        # These are read from the step before, so that a stop can compare a step with it.
        beside |= {
            other
            for other in _below(stop, self._uses) - circle - {stop}
            if circle & _below(other, self._uses)
        }
        together = circle | beside
        for other in together:
            self._own[other] = [*chain.from_iterable(map(_alternative_rules, self._own[other]))]
        if not any(not together & _needs(rule) for each in together for rule in self._own[each]):
            return  # nothing to begin with
        names = (*self._cuts(circle), *sorted(beside - circle))
        given = (o.value for o in options if o.field == 1 and isinstance(o.value, tree.Number))
        depth = next((int(float(each.value)) for each in given), -1 if stop else DEPTH)
        depth = min(depth, MOST_STEPS) if depth >= 0 else MOST_STEPS  # -1: as many as it takes
        orders = tuple(
            (each.subject, ", ".join(filter(None, map(tree.text_of, each.values))))
            for each in self._annotations
            if each.name == "@OrderBy" and each.subject in names
        )
        fixpoint = Fixpoint(names, depth, stop, orders)
        self.statements = [
            each
            for each in self.statements
            if each not in recursive
            and (each.subject if isinstance(each, tree.Annotation) else each.name) not in names
        ]
        self.statements += self._step(fixpoint, circle)
        self.found.append(fixpoint)
        self._done |= together

    def _cuts(self, circle: Collection[str]) -> list[str]:
        """Return members without which there is no circle, as few as are easily found."""
        ordered = [name for name in self._own if name in circle]
        annotated = {each.subject for each in self._annotations if each.name == "@Recursive"}
        candidates = sorted(ordered, key=lambda name: name not in annotated)
        for name in candidates:
            if not self._left(ordered, [name]):
                return [name]
        cuts: list[str] = []
        while left := self._left(candidates, cuts):
            cuts.append(left[0])
        return cuts

    def _left(self, names: Sequence[str], cuts: Collection[str]) -> list[str]:
        """Return the names that still are in a circle."""
        return [n for n in names if n not in cuts and n in _below(n, self._uses, cuts)]

    def _step(self, fixpoint: Fixpoint, circle: set[str]) -> Iterator[tree.Rule]:
        copies = {name: f"{name}_For_{fixpoint.asked[0]}" for name in circle}
        calls = {**copies, **{name: _last(name) for name in fixpoint.names}}
        heads = {**copies, **dict(zip(fixpoint.names, fixpoint.asked, strict=False))}
        if fixpoint.stop:
            heads[fixpoint.stop] = fixpoint.asked[-1]
        for name, head in heads.items():
            for rule in self._own.get(name, ()):
                copied = rename(rule, calls)
                yield replace(copied, head=replace(copied.head, name=head))


def _below(name: str, uses: Mapping[str, set[str]], without: Collection[str] = ()) -> set[str]:
    seen: set[str] = set()
    waiting = [*uses.get(name, ())]
    while waiting:
        other = waiting.pop()
        if other not in seen and other not in without:
            seen.add(other)
            waiting += uses[other]
    return seen


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


def grows(fixpoint: Fixpoint, steps: Mapping[Fixpoint, Sequence[str]]) -> str:
    """Return a query for 1 if the last step of a recursion still changed something, else 0."""
    name = f"{STEPS}{fixpoint.names[0]}"
    last = f"step > {fixpoint.depth} AND {_found(fixpoint, name)} IS NOT before"
    query = f"SELECT EXISTS (SELECT 1 FROM {name} WHERE {last})"  # noqa: S608 - our own SQL
    return sql.render(_with_steps(sql.parse(query), steps), pretty=True)


def _with_steps(query: exp.Query, steps: Mapping[Fixpoint, Sequence[str]]) -> exp.Query:
    queries = [
        each
        for fixpoint, statements in steps.items()
        for each in _queries(fixpoint, [*map(sql.parse, statements)])
    ]
    both = [*queries, *sql.named_queries(query)]
    query.set("with_", exp.With(expressions=both, recursive=True))
    for fixpoint in steps:
        for name in fixpoint.names:
            _read_instead(query, name, f"t_0_{name}")
    return query


def _read_instead(query: exp.Query, name: str, other: str) -> bool:
    tables = [table for table in query.find_all(exp.Table) if table.name == name]
    for table in tables:
        table.replace(exp.alias_(exp.to_table(other), table.alias_or_name, table=True))
    return bool(tables)


def _found(fixpoint: Fixpoint, table: str) -> str:
    """Return all lists of a step as one value; two steps with the same one are equal."""
    return " || ".join(f"{table}.found{number}" for number, _ in enumerate(fixpoint.names))


def _queries(fixpoint: Fixpoint, asked: Sequence[exp.Query]) -> list[exp.CTE]:
    """Return the common table expressions for a recursion's steps and its final rows."""
    name = f"{STEPS}{fixpoint.names[0]}"
    columns = {each: _columns(query) for each, query in zip(fixpoint.names, asked, strict=False)}
    for query in asked:
        _read_last_step(query, name, columns)
    lists = ", ".join(
        f"{_as_list(query, columns[each])} AS found{number}"
        for number, (each, query) in enumerate(zip(fixpoint.names, asked, strict=False))
    )
    nothing = ", ".join(f"'[]' AS found{number}" for number, _ in enumerate(fixpoint.names))
    goes_on = f"{name}.step <= {fixpoint.depth} AND ({_found(fixpoint, name)}) IS NOT {name}.before"
    if fixpoint.stop:
        stopped = f"EXISTS (SELECT 1 FROM ({sql.render(asked[-1])}) AS stop)"  # noqa: S608 - our own SQL
        goes_on += f" AND ({name}.step = 0 OR NOT {stopped})"
    last = f"FROM {name} ORDER BY step DESC LIMIT 1"
    rows = ", ".join(
        f"t_0_{each} AS ({_rows(columns[each], f'(SELECT found{number} {last})')})"
        for number, each in enumerate(fixpoint.names)
    )
    text = f"""
    WITH {name} AS (
      SELECT 0 AS step, {nothing}, NULL AS before
      UNION ALL
      SELECT {name}.step + 1 AS step, {lists}, {_found(fixpoint, name)} AS before
      FROM {name} WHERE {goes_on}),
    {rows}
    SELECT 1"""  # noqa: S608 - the compiler's own SQL
    return sql.named_queries(sql.parse(text))


def _read_last_step(query: exp.Query, steps: str, columns: Mapping[str, list[str]]) -> None:
    """Let a query read the rows of the last step from its lists."""
    tables: list[exp.Expr] = []
    for number, (name, own) in enumerate(columns.items()):
        before = f"t_0_before_{name}"
        if _read_instead(query, _last(name), before):
            rows = exp.CTE(
                this=sql.parse(_rows(own, f"{steps}.found{number}")),
                alias=exp.TableAlias(this=exp.to_identifier(before)),
                materialized=True,  # or it would be evaluated again for each joined row
            )
            tables.append(rows)
    if tables:
        query.set("with_", exp.With(expressions=[*tables, *sql.named_queries(query)]))


def _as_list(query: exp.Query, columns: Sequence[str]) -> str:
    made = ", ".join(f"made.{column}" for column in columns)
    order = ", ".join(map(str, range(1, len(columns) + 1)))
    ordered = f"SELECT * FROM ({sql.render(query)}) AS step ORDER BY {order}"  # noqa: S608 - our own SQL
    return f"(SELECT json_group_array(json_array({made})) FROM ({ordered}) AS made)"  # noqa: S608 - our own SQL


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
