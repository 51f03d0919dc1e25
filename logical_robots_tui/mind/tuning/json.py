"""Values in JSON: unwrapped where no JSON is needed, written without calling Python, marked.

A value in a record is written with all of its digits, and a truth as a word (`typed/changes.py`).
SQLite marks a text that it made as a record or a list. A value that passes through a query of its
own loses that mark; put into a record, it would be an escaped text there. So it is marked as JSON
once more, where that makes a difference.
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.sqlite.layouts import ITEM_FIELDS, MEMORY_FIELDS
from logical_robots_tui.mind.tuning import sql

_CHEAP = frozenset({"abs", "atan2", "cos", "sin", "sqrt"})
_WRITTEN = frozenset({"real_as_json", "value_as_json"})
_MAKES_JSON = frozenset({"json_array", "json_object", "json_quote"})
_COLLECTS_JSON = frozenset({"json_group_array", "json_group_object"})
_UNPLAIN = frozenset({"memory", "sensor", "value", *MEMORY_FIELDS, *ITEM_FIELDS})
_PASSES_ON = frozenset({"coalesce", "iif", "if", "ifnull", "nullif", "min", "max", "any_value"})


def unwrap(value: exp.Expr) -> exp.Expr:
    """Return what was written as JSON, as it was before; a truth is a number then."""
    truth = truth_in(value)
    if truth is not None:
        return truth
    if sql.call_name(value) != "json" or len(value.expressions) != 1:
        return value
    inner: exp.Expr = value.expressions[0]
    return inner.expressions[0] if sql.call_name(inner) in _WRITTEN else inner


def truth_in(value: exp.Expr) -> exp.Expr | None:
    """Return the truth that is written as JSON, if that is what it is."""
    inner = value.expressions[0] if sql.call_name(value) == "json" else None
    if isinstance(inner, exp.Literal) and inner.is_string and inner.name in ("true", "false"):
        return exp.Literal.number(int(inner.name == "true"))
    if not isinstance(inner, exp.Case) or inner.this is None or len(inner.args["ifs"]) != 2:
        return None
    names = [branch.args["true"].name for branch in inner.args["ifs"]]
    return inner.this if names == ["true", "false"] else None


def truth(value: exp.Expr) -> exp.Expr:
    """Return a truth, which is a number for SQLite, as JSON."""
    ifs = [
        exp.If(this=exp.Literal.number(number), true=exp.Literal.string(word))
        for number, word in ((1, "true"), (0, "false"))
    ]
    return exp.Anonymous(this="JSON", expressions=[exp.Case(this=value, ifs=ifs)])


def native_numbers(tree: exp.Expr) -> None:
    """Let SQLite write the digits of real numbers itself, unless they are expensive to compute.

    SQLite can't write infinity as JSON: then the query fails, and the plain way answers.
    """
    for call in list(tree.find_all(exp.Anonymous)):
        name = sql.call_name(call)
        if name == "real_as_json":
            number = call.expressions[0]
            if _is_cheap(number):
                call.replace(_digits_or_null(number))
        elif name == "value_as_json" and isinstance(call.expressions[0], exp.Column):
            outer = call.parent
            assert outer is not None
            outer.replace(_as_it_is(call.expressions[0]))


def _is_cheap(number: exp.Expr) -> bool:
    """Return whether SQLite computes a number twice in less time than a call of Python takes."""
    calls = number.find_all(exp.Anonymous)
    return not number.find(exp.Query) and all(sql.call_name(call) in _CHEAP for call in calls)


def _digits(number: exp.Expr) -> exp.Expr:
    template = exp.Literal.string("%!.17g")
    return exp.Anonymous(this="PRINTF", expressions=[template, number.copy()])


def _digits_or_null(number: exp.Expr) -> exp.Expr:
    there = exp.Is(this=number.copy(), expression=exp.Not(this=exp.Null()))
    return exp.Case(ifs=[exp.If(this=there, true=_digits(number))])


def _as_it_is(value: exp.Column) -> exp.Expr:
    """Return a value for JSON, of which only SQLite knows whether it is a number or a text."""
    kind = exp.Anonymous(this="TYPEOF", expressions=[value.copy()])
    is_real = exp.EQ(this=kind, expression=exp.Literal.string("real"))
    # Texts come after all numbers; to compare is quicker than to ask for the type.
    is_text = exp.GTE(this=value.copy(), expression=exp.Literal.string(""))
    real = exp.Anonymous(this="JSON", expressions=[_digits(value)])
    ifs = [
        exp.If(this=is_text, true=mark(value.copy(), value.copy())),
        exp.If(this=is_real, true=real),
    ]
    return exp.Case(ifs=ifs, default=value.copy())


def is_plain(node: exp.Expr) -> bool:
    """Return whether a value is certainly no record and no list."""
    if isinstance(node, exp.Paren):
        return is_plain(node.this)
    if isinstance(node, exp.Subquery) and isinstance(node.this, exp.Select):
        only = node.this.expressions
        return len(only) == 1 and is_plain(only[0])
    if isinstance(node, exp.Alias):
        return is_plain(node.this)
    if isinstance(node, exp.Case):
        arms = [branch.args["true"] for branch in node.args["ifs"]]
        default = node.args.get("default")
        return all(map(is_plain, [*arms, *([default] if default is not None else [])]))
    if isinstance(node, exp.Column):
        found = sql.source(node)
        return found is not None and _is_plain_column(node, found[1])
    if isinstance(node, exp.Anonymous):
        name = sql.call_name(node)
        if name in _PASSES_ON:
            return all(map(is_plain, node.expressions))
        return name in {"sum", "avg", "count", "total", "divide", "modulo", "abs", "sqrt"}
    return isinstance(node, exp.Binary | exp.Not | exp.Neg | exp.Literal | exp.Null)


def _is_plain_column(column: exp.Column, table: exp.Expr) -> bool:
    """Return whether a column holds numbers and plain text only."""
    if isinstance(table, exp.Subquery) and isinstance(table.this, exp.Select):
        for made in table.this.expressions:
            if made.alias_or_name.lower() == column.name.lower():
                return is_plain(made)
    return is_stored(table) and column.name.lower() not in _UNPLAIN


def _is_noticed(node: exp.Expr, is_result: bool) -> bool:
    """Return whether it makes a difference that a value is marked as a record or a list."""
    while True:
        parent = node.parent
        if isinstance(parent, exp.Anonymous):
            name = sql.call_name(parent)
            if name in _MAKES_JSON or name in _COLLECTS_JSON:
                return True
            if name not in _PASSES_ON:
                return False
        elif isinstance(parent, exp.If):
            if parent.this is node:
                return False
        elif isinstance(parent, exp.Select):
            if isinstance(parent.parent, exp.Subquery) and not isinstance(
                parent.parent.parent, exp.From | exp.Join
            ):
                node = parent
                parent = parent.parent
            else:
                return not is_result
        elif not isinstance(parent, exp.Case | exp.Paren | exp.Alias | exp.Subquery):
            return False
        node = parent


def remark(value: exp.Column, place: exp.Expr, *, is_result: bool) -> exp.Expr:
    """Return a value marked again as a record or list, where that matters."""
    return mark(value, value) if _is_noticed(place, is_result) else value


def mark(value: exp.Column, otherwise: exp.Expr) -> exp.Expr:
    """Return a value as JSON if it is the text of a record or list, else another expression."""
    begins = exp.Anonymous(
        this="SUBSTR", expressions=[value.copy(), exp.Literal.number(1), exp.Literal.number(1)]
    )
    brackets = [exp.Literal.string("{"), exp.Literal.string("[")]
    valid = exp.Anonymous(this="JSON_VALID", expressions=[value.copy()])
    as_json = exp.Anonymous(this="JSON", expressions=[value.copy()])
    test = exp.And(this=exp.In(this=begins, expressions=brackets), expression=valid)
    return exp.Case(ifs=[exp.If(this=test, true=as_json)], default=otherwise)


def is_stored(table: exp.Expr) -> bool:
    """Return whether a source is a table, in which no value has the note anyway."""
    return sql.table_name(table) in sql.TABLES
