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
    """Untie an aggregated expression from its select where one of its columns ties it, too.

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
            ties = [_tie_of(column) for column in columns]
            own_ties = [tie for tie in ties if tie is not None and _belongs_to(tie, select, zeros)]
            for tie in own_ties:
                tie.replace(tie.expressions[1])
            if len(own_ties) == len(columns) and len(sql.sources(select)) > 1:
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
        arg_calls = [call for call in calls if sql.call_name(call) in _NATIVE]
        extremes = {
            (_NATIVE.get(sql.call_name(call), call.name.upper()), call.expressions[-1])
            for call in calls
            if sql.call_name(call) in {*_NATIVE, "min", "max"} and call.expressions
        }
        if len(extremes) != 1 or any(len(call.expressions) != 2 for call in arg_calls):
            continue
        ((native, value),) = extremes
        parts = [value, *(call.expressions[0] for call in arg_calls)]
        calls = [call for part in parts for call in part.find_all(exp.Anonymous)]
        if any(part.find(exp.Select) for part in parts) or any(
            sql.call_name(call) in sql.AGGREGATES for call in calls
        ):
            continue
        for call in arg_calls:
            no_value, no_argument = f"{native}(value) IS NULL", "argument IS NULL"
            choice = (
                f"CASE WHEN {no_value} THEN NULL WHEN {no_argument} THEN JSON('') ELSE argument END"
            )
            call.replace(sql.expression(choice, value=value, argument=call.expressions[0]))


def _own_calls(node: exp.Expr) -> Iterator[exp.Anonymous]:
    if isinstance(node, exp.Select):
        return
    if isinstance(node, exp.Anonymous):
        yield node
    for child in node.iter_expressions():
        yield from _own_calls(child)


def _tie_of(column: exp.Column) -> exp.Expr | None:
    test = column.parent
    call = test.parent if isinstance(test, exp.EQ) and test.this is column else None
    if sql.call_name(call) != "iif" or not isinstance(call, exp.Anonymous):
        return None
    if len(call.expressions) != 3 or call.expressions[0] is not test:
        return None
    return call if isinstance(call.expressions[2], exp.Null) else None


def _belongs_to(tie: exp.Expr, select: exp.Select, zeros: set[str]) -> bool:
    columns = list(tie.expressions[1].find_all(exp.Column))
    if any(column.find_ancestor(exp.Select) is not select for column in columns):
        return False
    source_names = sql.sources(select).keys() - zeros
    return not columns or any(column.table in source_names for column in columns)


_NUMBERS = frozenset({"abs", "avg", "count", "sqrt", "sum", "total"})
_CHOICES = {"greatest": "MAX", "least": "MIN"}


def native_division(tree: exp.Expr) -> None:
    """Divide natively, checking for zero if necessary; SQLite computes a repeated sum once."""
    for call in reversed(list(tree.find_all(exp.Anonymous))):  # inner calls first
        if sql.call_name(call) != "divide" or not all(map(_is_number, call.expressions)):
            continue
        numerator, denominator = call.expressions
        parts = {"numerator": numerator, "denominator": denominator, "otherwise": call}
        quotient = "CAST(numerator AS REAL) / denominator"
        if isinstance(denominator, exp.Literal) and float(denominator.this):
            call.replace(sql.expression(f"({quotient})", **parts))
        elif _is_light(numerator) and _is_light(denominator):
            conditional = f"CASE WHEN denominator <> 0 THEN {quotient} ELSE otherwise END"
            call.replace(sql.expression(conditional, **parts))


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


_MAX_COLUMNS = 60
_WIDEST_CHOICE = 3  # records of a CASE, from which on a copy for each field costs too much


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
        if fields is None or len(columns) + len(fields) > _MAX_COLUMNS:
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
        return _fields_of_case(value)
    if sql.call_name(value) != "json_object":
        return None
    names, values = value.expressions[::2], value.expressions[1::2]
    if not all(isinstance(name, exp.Literal) and name.is_string for name in names):
        return None
    fields = {name.this: field for name, field in zip(names, values, strict=True)}
    return fields if len(fields) == len(names) and fields else None


def _fields_of_case(case: exp.Case) -> dict[str, exp.Expr] | None:
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


def _choice(branches: Sequence[exp.If], values: Sequence[exp.Expr]) -> exp.Expr | None:
    truths = [truth for truth in map(sql.truth_in, values) if truth is not None]
    if truths and len(truths) < len(values):
        return None
    *arms, default = map(sql.unwrap, values)
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
                    _use_columns(call, name, value)


def _arms(query: exp.Expr) -> Sequence[exp.Select]:
    while isinstance(query, exp.Select) and query.is_star:
        sources = list(sql.sources(query).values())
        if len(sources) != 1 or not isinstance(sources[0], exp.Subquery):
            return ()
        query = sources[0].this
    arms: list[exp.Select] = []
    pending: list[exp.Expr] = [query]
    while pending:
        node = pending.pop()
        if isinstance(node, exp.Union) and node.args.get("distinct") is False:
            pending += [node.expression, node.this]
        elif isinstance(node, exp.Select) and not node.args.get("distinct"):
            arms.append(node)
        else:
            return ()
    names = {tuple(item.alias for item in arm.expressions) for arm in arms}
    return arms if len(names) == 1 else ()


def _parts(arm: exp.Select, name: str) -> tuple[exp.Expr, exp.Expr] | None:
    pair = next(item.this for item in arm.expressions if item.alias == name)
    if sql.call_name(pair) != "json_object" or len(pair.expressions) != 4:
        return None
    first, argument, second, value = pair.expressions
    keys = [part.this for part in (first, second) if isinstance(part, exp.Literal)]
    if keys != ["arg", "value"] or sql.truth_in(argument) or sql.truth_in(value):
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
        source = sql.source(column) if column.name == name else None
        if column.name != name or (
            source is not None
            and not (isinstance(source[1], exp.Table) and source[1].name == query)
        ):
            continue
        call = column.find_ancestor(exp.Anonymous)
        while call is not None and sql.call_name(call) not in ("arg_min", "arg_max"):
            call = call.find_ancestor(exp.Anonymous)
        if call is None or not _reads_both_parts(call, column):
            return []
        calls[id(call)] = call
    return list(calls.values())


def _reads_both_parts(call: exp.Anonymous, column: exp.Column) -> bool:
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
    indexes = range(len(arms[0].expressions))
    shared_aliases = [
        arms[0].expressions[index].args["alias"]
        for index in indexes
        if all(
            arm.expressions[index].this == value
            for arm, (_, value) in zip(arms, pairs, strict=True)
        )
    ]
    values = shared_aliases[0] if shared_aliases else exp.to_identifier(f"t_0_{name}_value")
    for arm, (argument, value) in zip(arms, pairs, strict=True):
        items = [item for item in arm.expressions if item.alias != name]
        items.append(exp.alias_(argument, f"t_0_{name}_arg"))
        if not shared_aliases:
            items.append(exp.alias_(value, values.copy()))
        arm.set("expressions", items)
    return values


def _use_columns(call: exp.Anonymous, name: str, value: exp.Identifier) -> None:
    """Let ArgMin use columns; an infinite best fails, so that the plain query answers."""
    table = next(call.find_all(exp.Column)).table
    call_sql = f"{call.name}(argument, value)"
    overflow = f"{call.name[4:]}(value) IN (9e999, -9e999) OR {call_sql} IN (9e999, -9e999)"
    parts = {
        "argument": exp.column(f"t_0_{name}_arg", table),
        "value": exp.column(value.copy(), table),
    }
    call.replace(sql.expression(f"CASE WHEN {overflow} THEN JSON('') ELSE {call_sql} END", **parts))
