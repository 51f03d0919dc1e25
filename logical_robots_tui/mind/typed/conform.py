"""Converting values to a common type, such as the branches of a choice."""

from __future__ import annotations

from sqlglot import exp

from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.typed.kinds import Decimal, Kind, ListOf, Plain, RecordOf, is_whole

__all__ = ["call", "cast", "conform"]


def call(name: str, *arguments: exp.Expr) -> exp.Anonymous:
    """Return a call of a function."""
    return exp.Anonymous(this=name, expressions=list(arguments))


def conform(value: exp.Expr, kind: Kind, wanted: Kind) -> None:
    """Let a value, in its place, be one of another type that it is to have in common with others.

    Whole numbers have to be made real ones, and decimal numbers may have to lose digits; where a
    record or a list is written out, in it.
    """
    if isinstance(value, exp.Paren | exp.Alias):
        conform(value.this, kind, wanted)
    elif is_whole(kind) and (wanted is Plain.REAL or isinstance(wanted, Decimal)):
        value.replace(_real(value))
    elif isinstance(value, exp.Case):
        for branch in value.args["ifs"]:
            conform(branch.args["true"], kind, wanted)
        if (default := value.args.get("default")) is not None:
            conform(default, kind, wanted)
    elif isinstance(kind, Decimal) and isinstance(wanted, Decimal):
        if kind.scale > wanted.scale:
            value.replace(call("ROUND", value.copy(), exp.Literal.number(wanted.scale)))
    elif sql.call_name(value) == "json_object" and isinstance(wanted, RecordOf):
        _conform_fields(value, kind, wanted)
    elif sql.call_name(value) == "json_array":
        _conform_elements(value, kind, wanted)


def _conform_elements(made: exp.Expr, kind: Kind, wanted: Kind) -> None:
    if isinstance(kind, ListOf) and isinstance(wanted, ListOf):
        for element in list(made.expressions):
            conform(element, kind.element, wanted.element)


def _conform_fields(record: exp.Expr, kind: Kind, wanted: RecordOf) -> None:
    if not isinstance(kind, RecordOf):
        return
    for name, value in zip(record.expressions[::2], record.expressions[1::2], strict=True):
        conform(value, kind.field(name.name), wanted.field(name.name))
    values = {n.name: (n, v) for n, v in zip(*[iter(record.expressions)] * 2, strict=True)}
    missing = ((exp.Literal.string(name), exp.Null()) for name, _ in wanted.fields)
    pairs = [values.get(n.name, (n, null)) for n, null in missing]
    if len(pairs) >= len(values) and pairs != [*values.values()]:
        record.set("expressions", [part for pair in pairs for part in pair])


def _real(value: exp.Expr) -> exp.Expr:
    if isinstance(value, exp.Literal):
        return exp.Literal.number(f"{value.name}.0")
    return cast(value, "REAL")


def cast(value: exp.Expr, to: str) -> exp.Expr:
    """Return a value cast to one of SQLite's types."""
    return call("CAST", exp.Alias(this=value.copy(), alias=exp.to_identifier(to)))
