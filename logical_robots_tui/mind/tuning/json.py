"""Values in JSON: taken out again where no JSON is needed, and written without a call of Python.

A value in a record is written with all of its digits, and a truth as a word (`typed/changes.py`).
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.sqlite.stored import to_json
from logical_robots_tui.mind.tuning import notes, sql

__all__ = ["native_numbers", "records_at_once", "taken_out", "truth", "truth_in"]

_WRITTEN = frozenset({"real_as_json", "value_as_json"})


def taken_out(value: exp.Expr) -> exp.Expr:
    """What was written as JSON, as it was before; a truth is a number then."""
    truth = truth_in(value)
    if truth is not None:
        return truth
    if sql.call_name(value) != "json" or len(value.expressions) != 1:
        return value
    inner: exp.Expr = value.expressions[0]
    return inner.expressions[0] if sql.call_name(inner) in _WRITTEN else inner


def truth_in(value: exp.Expr) -> exp.Expr | None:
    """The truth that is written as JSON, if that is what it is."""
    inner = value.expressions[0] if sql.call_name(value) == "json" else None
    if isinstance(inner, exp.Literal) and inner.is_string and inner.name in ("true", "false"):
        return exp.Literal.number(int(inner.name == "true"))
    if not isinstance(inner, exp.Case) or inner.this is None or len(inner.args["ifs"]) != 2:
        return None
    names = [branch.args["true"].name for branch in inner.args["ifs"]]
    return inner.this if names == ["true", "false"] else None


def truth(value: exp.Expr) -> exp.Expr:
    """A truth, which is a number for SQLite, as JSON."""
    ifs = [
        exp.If(this=exp.Literal.number(number), true=exp.Literal.string(word))
        for number, word in ((1, "true"), (0, "false"))
    ]
    return exp.Anonymous(this="JSON", expressions=[exp.Case(this=value, ifs=ifs)])


def records_at_once(tree: exp.Expr) -> None:
    """Let records that become a list be written together, and not number by number."""
    for call in list(tree.find_all(exp.Anonymous)):
        if sql.call_name(call) != "json_group_array" or len(call.expressions) != 1:
            continue
        (record,) = call.expressions
        names, values = record.expressions[::2], record.expressions[1::2]
        if sql.call_name(record) != "json_object" or any(map(truth_in, values)):
            continue
        if not all(isinstance(name, exp.Literal) for name in names):
            continue
        spelled = exp.Literal.string(to_json([name.name for name in names]))
        made = exp.Anonymous(this="json_records", expressions=[spelled, *map(taken_out, values)])
        if notes.is_noticed(call, is_result=True):
            made = exp.Anonymous(this="JSON", expressions=[made])
        call.replace(made)


def native_numbers(tree: exp.Expr) -> None:
    """Let SQLite write the digits of real numbers itself.

    Of a number without end it makes no JSON: then the query fails, and the plain way is asked.
    """
    for call in list(tree.find_all(exp.Anonymous)):
        if sql.call_name(call) == "real_as_json":
            digits = exp.Literal.string("%!.17g")
            call.replace(exp.Anonymous(this="PRINTF", expressions=[digits, *call.expressions]))
