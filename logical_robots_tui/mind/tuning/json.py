"""Values in JSON: taken out again where no JSON is needed, and written without a call of Python.

A value in a record is written with all of its digits, and a truth as a word (`typed/changes.py`).
"""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.tuning import notes, sql

__all__ = ["native_numbers", "taken_out", "truth", "truth_in"]

_CHEAP = frozenset({"abs", "atan2", "cos", "sin", "sqrt"})

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


def native_numbers(tree: exp.Expr) -> None:
    """Let SQLite write the digits of real numbers itself, where they are not computed at length.

    Of a number without end it makes no JSON: then the query fails, and the plain way is asked.
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
    """Whether SQLite computes a number twice in less time than a call of Python takes."""
    calls = number.find_all(exp.Anonymous)
    return not number.find(exp.Query) and all(sql.call_name(call) in _CHEAP for call in calls)


def _digits(number: exp.Expr) -> exp.Expr:
    template = exp.Literal.string("%!.17g")
    return exp.Anonymous(this="PRINTF", expressions=[template, number.copy()])


def _digits_or_null(number: exp.Expr) -> exp.Expr:
    there = exp.Is(this=number.copy(), expression=exp.Not(this=exp.Null()))
    return exp.Case(ifs=[exp.If(this=there, true=_digits(number))])


def _as_it_is(value: exp.Column) -> exp.Expr:
    """A value for JSON, of which only SQLite knows whether it is a number or a text."""
    kind = exp.Anonymous(this="TYPEOF", expressions=[value.copy()])
    is_real = exp.EQ(this=kind, expression=exp.Literal.string("real"))
    # Texts come after all numbers; to compare is quicker than to ask for the type.
    is_text = exp.GTE(this=value.copy(), expression=exp.Literal.string(""))
    real = exp.Anonymous(this="JSON", expressions=[_digits(value)])
    ifs = [
        exp.If(this=is_text, true=notes.marked(value.copy(), value.copy())),
        exp.If(this=is_real, true=real),
    ]
    return exp.Case(ifs=ifs, default=value.copy())
