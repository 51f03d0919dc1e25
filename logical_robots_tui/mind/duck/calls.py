"""The functions that DuckDB computes as SQLite does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.duck.terms import (
    NUMBERS,
    Term,
    UnlikeError,
    as_kind,
    common,
    condition,
    number,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = ["AGGREGATES", "aggregate", "arithmetic", "cast", "choice", "computed", "real", "refuse"]

_ABOUT_TEXTS = frozenset(
    {
        *("char", "concat", "concatenate", "concat_ws", "ends_with", "format", "group_concat"),
        *("instr", "join_list", "length", "like", "lower", "lower_text", "ltrim", "natural_hash"),
        *("printf", "quote", "replace", "reverse", "rtrim", "split_text", "starts_with", "substr"),
        *("substring", "to_text", "trim", "truth_to_text", "unicode", "unicode_of", "upper"),
        "upper_text",
    }
)

_ABOUT_RECORDS = frozenset(
    {
        *("arg_max_k", "arg_min_k", "array_by", "assemble_record", "concat_lists"),
        *("concat_two_lists", "disassemble_record", "list_of_distinct", "number_range"),
        *("record_as_json", "sort_list", "try_cast", "unique_list"),
    }
)


def refuse(function: str) -> UnlikeError:
    """What to raise for a function that is not among the known ones."""
    if function in _ABOUT_TEXTS:
        return UnlikeError("makes texts or takes them apart")
    if function in _ABOUT_RECORDS or function.startswith("json"):
        return UnlikeError("makes records or lists, or takes them apart")
    return UnlikeError(f"calls {function.upper()}")


def real(sql: str) -> Term:
    """A real number out of an expression; SQLite gives null where there is none."""
    return Term(f"nullif({sql}, CAST('nan' AS DOUBLE))", "real")


def arithmetic(operator: str, left: Term, right: Term) -> Term:
    """Sum, difference or product."""
    left, right = number(left), number(right)
    sql = f"({left.sql} {operator} {right.sql})"
    kinds = {left.kind, right.kind}
    if kinds == {"whole"}:
        return Term(sql, "whole")  # DuckDB fails where it grows too large, SQLite goes on
    return Term(real(sql).sql, "real" if "real" in kinds else "number")


def choice(conditions: Sequence[Term], values: Sequence[Term]) -> Term:
    """A CASE; there is one more value than conditions if it has an ELSE."""
    kind = common(value.kind for value in values)
    texts = [as_kind(value, kind).sql for value in values]
    branches = [
        f"WHEN {condition(test)} THEN {text}" for test, text in zip(conditions, texts, strict=False)
    ]
    otherwise = f" ELSE {texts[-1]}" if len(texts) > len(conditions) else ""
    return Term(f"(CASE {' '.join(branches)}{otherwise} END)", kind)


def cast(value: Term, to: str) -> Term:
    """CAST of a number.

    Args:
        value: The number.
        to: SQLite's name of the type.
    """
    value = number(value)
    if to == "REAL":
        return as_kind(value, "real")
    if to != "INTEGER":
        raise UnlikeError("makes texts or takes them apart")
    if value.kind == "whole":
        return value
    return Term(f"CAST(trunc({value.sql}) AS BIGINT)", "whole")


def computed(function: str, arguments: Sequence[Term]) -> Term:
    """A call of a function that is no aggregate.

    Raises:
        UnlikeError: It is not among those that mean the same.
    """
    known = _FUNCTIONS.get((function, len(arguments))) or _FUNCTIONS.get((function, -1))
    if known is None:
        raise refuse(function)
    return known(*arguments)


def _real(template: str) -> Callable[..., Term]:
    return lambda *values: real(template.format(*(as_kind(number(v), "real").sql for v in values)))


def _same_kind(template: str) -> Callable[[Term], Term]:
    def of(value: Term) -> Term:
        value = number(value)
        return Term(template.format(value.sql), value.kind)

    return of


def _whole_part(function: str) -> Callable[[Term], Term]:
    def of(value: Term) -> Term:
        value = number(value)
        return value if value.kind == "whole" else Term(f"{function}({value.sql})", value.kind)

    return of


def _one_of(function: str) -> Callable[..., Term]:
    def of(*values: Term) -> Term:
        kind = common("whole" if v.kind == "truth" else v.kind for v in values)
        texts = ", ".join(as_kind(v, kind).sql for v in values)
        return Term(f"{function}({texts})", kind)

    return of


def _null_if(value: Term, other: Term) -> Term:
    kind = common([value.kind, other.kind])
    if kind == "nothing" or value.kind == "nothing":
        raise UnlikeError("computes with null")
    left = Term(f"nullif({as_kind(value, kind).sql}, {as_kind(other, kind).sql})", kind)
    return left if value.kind == kind else Term(as_kind(left, value.kind).sql, value.kind)


def _modulo(left: Term, right: Term) -> Term:
    left, right = number(left), number(right)
    if {left.kind, right.kind} != {"whole"}:
        raise UnlikeError("computes the remainder of numbers that are not whole")
    return Term(f"({left.sql} % nullif({right.sql}, 0))", "whole")


_FUNCTIONS: dict[tuple[str, int], Callable[..., Term]] = {
    ("abs", 1): _same_kind("abs({})"),
    ("atan", 1): _real("atan({})"),
    ("atan2", 2): _real("atan2({}, {})"),
    ("ceil", 1): _whole_part("ceil"),
    ("ceiling", 1): _whole_part("ceil"),
    ("coalesce", -1): _one_of("coalesce"),
    ("cos", 1): _real("cos({})"),
    ("degrees", 1): _real("degrees({})"),
    ("divide", 2): _real("({} / {})"),
    ("exp", 1): _real("exp({})"),
    ("floor", 1): _whole_part("floor"),
    ("greatest", -1): _one_of("greatest"),
    ("if", 3): lambda test, yes, no: choice([test], [yes, no]),
    ("ifnull", 2): _one_of("coalesce"),
    ("iif", 3): lambda test, yes, no: choice([test], [yes, no]),
    ("least", -1): _one_of("least"),
    ("modulo", 2): _modulo,
    ("nullif", 2): _null_if,
    ("pi", 0): lambda: Term("pi()", "real"),
    ("pow", 2): _real("pow({}, {})"),
    ("power", 2): _real("pow({}, {})"),
    ("radians", 1): _real("radians({})"),
    ("round", 1): _real("round({})"),
    ("sin", 1): _real("sin({})"),
    # Of 0 DuckDB's are infinite; greatest() passes over null.
    ("ln", 1): _real("ln(nullif(greatest({}, 0), 0))"),
    ("log", 1): _real("log10(nullif(greatest({}, 0), 0))"),
    ("log10", 1): _real("log10(nullif(greatest({}, 0), 0))"),
    ("log2", 1): _real("log2(nullif(greatest({}, 0), 0))"),
    ("sqrt", 1): _real("sqrt({})"),
    ("tan", 1): _real("tan({})"),
}
"""By SQLite's name and number of arguments, -1 for any."""

AGGREGATES = frozenset({"arg_max", "arg_min", "avg", "count", "max", "min", "sum"})
"""Aggregates that are translated."""


def aggregate(function: str, value: Term, *, distinct: bool = False) -> Term:
    """A call of an aggregate of one argument."""
    once = "DISTINCT " if distinct else ""
    if function == "count":
        return Term(f"count({once}{value.sql})", "whole")
    if distinct:
        raise UnlikeError(f"calls {function.upper()} with DISTINCT")
    if function in ("min", "max"):
        value = number(value) if value.kind == "truth" else value
        return Term(f"{function}({value.sql})", value.kind)
    value = number(value)
    if function == "avg":
        return real(f"avg({as_kind(value, 'real').sql})")
    if value.kind == "whole":
        return Term(f"CAST(sum({value.sql}) AS BIGINT)", "whole")
    assert value.kind in NUMBERS
    return Term(real(f"sum({value.sql})").sql, value.kind)
