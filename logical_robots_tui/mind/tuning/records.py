"""Records as columns, so that numbers are not written as text and parsed again.

These are a result's records, and the pairs that ArgMin and ArgMax collect from several
rules, ``JSON_OBJECT('arg', a, 'value', v) AS best``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sqlglot import exp

from logical_robots_tui.mind.program import TRUTH_MARK
from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.tuning.columns import guarded_field

_NATIVE = {"arg_min": "MIN", "arg_max": "MAX"}
_ZERO = "JSON_EACH(JSON_ARRAY(0))"


def untie_aggregates(tree: exp.Expr) -> None:
    """Remove what ties an aggregated expression to its select, where one of its columns does.

    An aggregate belongs to the select that its columns come from. The compiler writes
    ``IIF(x.value = 0, expression, NULL)`` over a table of a single 0 to make sure of that.
    """
    for select in list(tree.find_all(exp.Select)):
        zeros = {
            name
            for name, table in sql.sources(select).items()
            if isinstance(table, exp.Table) and sql.render(table.this) == _ZERO
        }
        for name in zeros:
            columns = [c for c in select.find_all(exp.Column) if c.table == name]
            tied = [_tied(column) for column in columns]
            loose = [node for node in tied if node is not None and _is_of(node, select, zeros)]
            for node in loose:
                node.replace(node.expressions[1])
            if len(loose) == len(columns) and len(sql.sources(select)) > 1:
                sql.drop_source(select, name)


def native_arg_min(tree: exp.Expr) -> None:
    """ArgMin and ArgMax by SQLite's MIN and MAX, beside which a bare column is of the best row.

    It is of the first of several. Beside a second MIN or MAX it is not said of which row. A best
    row whose argument is null does not count, and fails, so that the plain query answers.
    """
    for select in list(tree.find_all(exp.Select)):
        if select.args.get("having") or select.args.get("order"):
            continue
        calls = [call for item in select.expressions for call in _own_calls(item)]
        best = [call for call in calls if sql.call_name(call) in _NATIVE]
        extremes = {
            (_NATIVE.get(sql.call_name(call), call.name.upper()), call.expressions[-1])
            for call in calls
            if sql.call_name(call) in {*_NATIVE, "min", "max"} and call.expressions
        }
        if len(extremes) != 1 or any(len(call.expressions) != 2 for call in best):
            continue
        ((native, value),) = extremes
        parts = [value, *(call.expressions[0] for call in best)]
        calls = [call for part in parts for call in part.find_all(exp.Anonymous)]
        if any(part.find(exp.Select) for part in parts) or any(
            sql.call_name(call) in sql.AGGREGATES for call in calls
        ):
            continue
        for call in best:
            none, bad = f"{native}(value) IS NULL", "argument IS NULL"
            chosen = f"CASE WHEN {none} THEN NULL WHEN {bad} THEN JSON('') ELSE argument END"
            call.replace(sql.expression(chosen, value=value, argument=call.expressions[0]))


def _own_calls(node: exp.Expr) -> Iterator[exp.Anonymous]:
    if isinstance(node, exp.Select):
        return
    if isinstance(node, exp.Anonymous):
        yield node
    for child in node.iter_expressions():
        yield from _own_calls(child)


def _tied(column: exp.Column) -> exp.Expr | None:
    test = column.parent
    call = test.parent if isinstance(test, exp.EQ) and test.this is column else None
    if sql.call_name(call) != "iif" or not isinstance(call, exp.Anonymous):
        return None
    if len(call.expressions) != 3 or call.expressions[0] is not test:
        return None
    return call if isinstance(call.expressions[2], exp.Null) else None


def _is_of(tied: exp.Expr, select: exp.Select, zeros: set[str]) -> bool:
    columns = list(tied.expressions[1].find_all(exp.Column))
    if any(column.find_ancestor(exp.Select) is not select for column in columns):
        return False
    own = sql.sources(select).keys() - zeros
    return not columns or any(column.table in own for column in columns)


_NUMBERS = frozenset({"abs", "avg", "count", "sqrt", "sum", "total"})
_CHOICES = {"greatest": "MAX", "least": "MIN"}


def native_division(tree: exp.Expr) -> None:
    """Divide natively, checking for zero if necessary; SQLite computes a repeated sum once."""
    for call in reversed(list(tree.find_all(exp.Anonymous))):  # what stands in another, first
        if sql.call_name(call) != "divide" or not all(map(_is_number, call.expressions)):
            continue
        above, below = call.expressions
        parts = {"above": above, "below": below, "otherwise": call}
        quotient = "CAST(above AS REAL) / below"
        if isinstance(below, exp.Literal) and float(below.this):
            call.replace(sql.expression(f"({quotient})", **parts))
        elif _is_light(above) and _is_light(below):
            checked = f"CASE WHEN below <> 0 THEN {quotient} ELSE otherwise END"
            call.replace(sql.expression(checked, **parts))


def native_choice(tree: exp.Expr) -> None:
    """Use native MAX and MIN of a value and a literal; ignore null, prefer the first equal."""
    for call in reversed(list(tree.find_all(exp.Anonymous))):
        native = _CHOICES.get(sql.call_name(call))
        if native is None or len(call.expressions) != 2:
            continue
        if not all(map(sql.is_plain, call.expressions)):
            continue
        literals = [value for value in call.expressions if isinstance(value, exp.Literal)]
        if not literals:
            continue
        first, second = call.expressions[::-1] if native == "MIN" else call.expressions
        text = f"COALESCE({native}(first, second), literal)"
        call.replace(sql.expression(text, first=first, second=second, literal=literals[0]))


def _is_number(node: exp.Expr) -> bool:
    if isinstance(node, exp.Paren | exp.Alias):
        return _is_number(node.this)
    if isinstance(node, exp.Subquery) and isinstance(node.this, exp.Select):
        return all(map(_is_number, node.this.expressions))
    if isinstance(node, exp.Literal):
        return not node.is_string
    if isinstance(node, exp.Anonymous):
        return sql.call_name(node) in _NUMBERS
    return isinstance(node, exp.Add | exp.Sub | exp.Mul | exp.Div | exp.Neg)


def _is_light(node: exp.Expr) -> bool:
    calls = node.find_all(exp.Anonymous)
    return node.find(exp.Select, exp.Case) is None and all(
        sql.call_name(call) in _NUMBERS for call in calls
    )


_MOST_COLUMNS = 60
_WIDEST_CHOICE = 3  # records that a CASE chooses from, before writing it out for each field is dear


def records_as_columns(tree: exp.Query) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Split a result's records into columns; return former columns with fields, truths marked.

    Unchanged columns have (); the result is () if all are.
    """
    if not isinstance(tree, exp.Select):
        return ()
    result: list[tuple[str, tuple[str, ...]]] = []
    columns: list[exp.Expr] = []
    for item in tree.expressions:
        fields = _fields(item.this) if isinstance(item, exp.Alias) else None
        if fields is None or len(columns) + len(fields) > _MOST_COLUMNS:
            result.append((item.alias, ()))
            columns.append(item)
        else:
            marks = (TRUTH_MARK * (sql.truth_in(value) is not None) for value in fields.values())
            result.append((item.alias, tuple(map(str.__add__, fields, marks))))
            columns += [
                exp.alias_(sql.unwrap(value), f"{item.alias}_{number}")
                for number, value in enumerate(fields.values())
            ]
    if not all(name for name, _ in result) or not any(fields for _, fields in result):
        return ()
    tree.set("expressions", columns)
    return tuple(result)


def _fields(value: exp.Expr) -> dict[str, exp.Expr] | None:
    if isinstance(value, exp.Paren):
        return _fields(value.this)
    if isinstance(value, exp.Case):
        return _chosen_fields(value)
    if sql.call_name(value) != "json_object":
        return None
    names, values = value.expressions[::2], value.expressions[1::2]
    if not all(isinstance(name, exp.Literal) and name.is_string for name in names):
        return None
    fields = {name.this: field for name, field in zip(names, values, strict=True)}
    return fields if len(fields) == len(names) and fields else None


def _chosen_fields(case: exp.Case) -> dict[str, exp.Expr] | None:
    branches = case.args["ifs"]
    if case.this or not case.args.get("default") or len(branches) >= _WIDEST_CHOICE:
        return None
    records = [record for value in sql.arms(case) if (record := _fields(value))]
    if len(records) <= len(branches) or len({tuple(record) for record in records}) > 1:
        return None
    fields: dict[str, exp.Expr] = {}
    for field in records[0]:
        choice = _choice(branches, [record[field] for record in records])
        if choice is None:
            return None
        fields[field] = choice
    return fields


def _choice(branches: Sequence[exp.If], given: Sequence[exp.Expr]) -> exp.Expr | None:
    truths = [truth for truth in map(sql.truth_in, given) if truth is not None]
    if truths and len(truths) < len(given):
        return None
    *arms, default = map(sql.unwrap, given)
    ifs = [
        exp.If(this=branch.this.copy(), true=arm)
        for branch, arm in zip(branches, arms, strict=True)
    ]
    case = exp.Case(ifs=ifs, default=default)
    return sql.truth(case) if truths else case


def pairs_as_columns(tree: exp.Expr) -> None:
    """Carry the parts of a pair in two columns, if only ArgMin reads the pair."""
    for query in list(tree.find_all(exp.CTE)):
        arms = _arms(query.this)
        for name in [item.alias for item in arms[0].expressions] if arms else []:
            pairs = [_parts(arm, name) for arm in arms]
            calls = _calls(tree, query.alias, name) if all(pairs) else []
            if calls:
                value = _split(arms, name, [pair for pair in pairs if pair])
                for call in calls:
                    _ask(call, name, value)


def _arms(query: exp.Expr) -> Sequence[exp.Select]:
    while isinstance(query, exp.Select) and query.is_star:
        sources = list(sql.sources(query).values())
        if len(sources) != 1 or not isinstance(sources[0], exp.Subquery):
            return ()
        query = sources[0].this
    found: list[exp.Select] = []
    waiting: list[exp.Expr] = [query]
    while waiting:
        node = waiting.pop()
        if isinstance(node, exp.Union) and node.args.get("distinct") is False:
            waiting += [node.expression, node.this]
        elif isinstance(node, exp.Select) and not node.args.get("distinct"):
            found.append(node)
        else:
            return ()
    names = {tuple(item.alias for item in arm.expressions) for arm in found}
    return found if len(names) == 1 else ()


def _parts(arm: exp.Select, name: str) -> tuple[exp.Expr, exp.Expr] | None:
    made = next(item.this for item in arm.expressions if item.alias == name)
    if sql.call_name(made) != "json_object" or len(made.expressions) != 4:
        return None
    first, argument, second, value = made.expressions
    written_out = [part.this for part in (first, second) if isinstance(part, exp.Literal)]
    if written_out != ["arg", "value"] or sql.truth_in(argument) or sql.truth_in(value):
        return None
    return sql.unwrap(argument), sql.unwrap(value)


def _calls(tree: exp.Expr, query: str, name: str) -> list[exp.Anonymous]:
    """Return the calls of ArgMin that split a column of a named query; [] if it has other uses."""
    for table in tree.find_all(exp.Table):
        select = table.find_ancestor(exp.Select)
        if table.name == query and (select is None or select.is_star):
            return []
    calls: dict[int, exp.Anonymous] = {}
    for column in tree.find_all(exp.Column):
        found = sql.source(column) if column.name == name else None
        if column.name != name or (
            found is not None and not (isinstance(found[1], exp.Table) and found[1].name == query)
        ):
            continue
        call = column.find_ancestor(exp.Anonymous)
        while call is not None and sql.call_name(call) not in ("arg_min", "arg_max"):
            call = call.find_ancestor(exp.Anonymous)
        if call is None or not _takes_apart(call, column):
            return []
        calls[id(call)] = call
    return list(calls.values())


def _takes_apart(call: exp.Anonymous, column: exp.Column) -> bool:
    if len(call.expressions) != 2:
        return False
    for argument, part in zip(call.expressions, ("arg", "value"), strict=True):
        mentions = list(argument.find_all(exp.Column))
        fields = [guarded_field(mention) for mention in mentions]
        if mentions != [column, column] or (argument, part) not in fields:
            return False
    return True


def _split(
    arms: Sequence[exp.Select], name: str, pairs: Sequence[tuple[exp.Expr, exp.Expr]]
) -> exp.Identifier:
    places = range(len(arms[0].expressions))
    same = [
        arms[0].expressions[place].args["alias"]
        for place in places
        if all(
            arm.expressions[place].this == value
            for arm, (_, value) in zip(arms, pairs, strict=True)
        )
    ]
    values = same[0] if same else exp.to_identifier(f"t_0_{name}_value")
    for arm, (argument, value) in zip(arms, pairs, strict=True):
        kept = [item for item in arm.expressions if item.alias != name]
        kept.append(exp.alias_(argument, f"t_0_{name}_arg"))
        if not same:
            kept.append(exp.alias_(value, values.copy()))
        arm.set("expressions", kept)
    return values


def _ask(call: exp.Anonymous, name: str, value: exp.Identifier) -> None:
    """Let ArgMin use columns; an infinite best fails, so that the plain query answers."""
    table = next(call.find_all(exp.Column)).table
    best = f"{call.name}(argument, value)"
    endless = f"{call.name[4:]}(value) IN (9e999, -9e999) OR {best} IN (9e999, -9e999)"
    parts = {
        "argument": exp.column(f"t_0_{name}_arg", table),
        "value": exp.column(value.copy(), table),
    }
    call.replace(sql.expression(f"CASE WHEN {endless} THEN JSON('') ELSE {best} END", **parts))
