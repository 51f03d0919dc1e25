"""Rewriting expressions so that SQLite computes what DuckDB would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sqlglot import exp

from logical_robots_tui.language import types
from logical_robots_tui.language.types import Decimal, Kind, ListOf, Plain, RecordOf, common
from logical_robots_tui.mind.tuning import sql


def call(name: str, *arguments: exp.Expr) -> exp.Anonymous:
    return exp.Anonymous(this=name, expressions=list(arguments))


def conform(value: exp.Expr, kind: Kind, target: Kind) -> None:
    """Coerce an expression in place to the common type, also inside written records and lists."""
    if isinstance(value, exp.Paren | exp.Alias):
        conform(value.this, kind, target)
    elif types.is_whole(kind) and (target is Plain.REAL or isinstance(target, Decimal)):
        is_written = isinstance(value, exp.Literal)
        value.replace(exp.Literal.number(f"{value.name}.0") if is_written else cast(value, "REAL"))
    elif isinstance(value, exp.Case):
        for arm in sql.arms(value):
            conform(arm, kind, target)
    elif isinstance(kind, Decimal) and isinstance(target, Decimal):
        if kind.scale > target.scale:
            value.replace(call("ROUND", value.copy(), exp.Literal.number(target.scale)))
    elif sql.call_name(value) == "json_object" and isinstance(target, RecordOf):
        _conform_fields(value, kind, target)
    elif sql.call_name(value) == "json_array":
        if isinstance(kind, ListOf) and isinstance(target, ListOf):
            for element in list(value.expressions):
                conform(element, kind.element, target.element)
    elif (
        types.is_nested(kind)
        and kind != target
        and types.is_nested(target)
        and types.is_known(target)
    ):
        is_real = _as_cast(target, in_order=False) == target  # as all numbers of `try_cast`
        if is_real:
            value.replace(call("try_cast", value.copy(), exp.Literal.string(types.spell(target))))


def _conform_fields(record: exp.Expr, kind: Kind, target: RecordOf) -> None:
    if not isinstance(kind, RecordOf):
        return
    for name, value in zip(record.expressions[::2], record.expressions[1::2], strict=True):
        conform(value, kind.field(name.name), target.field(name.name))
    values = {n.name: (n, v) for n, v in zip(*[iter(record.expressions)] * 2, strict=True)}
    nulls = ((exp.Literal.string(name), exp.Null()) for name, _ in target.fields)
    pairs = [values.get(n.name, (n, default)) for n, default in nulls]
    if len(pairs) >= len(values) and pairs != [*values.values()]:
        record.set("expressions", [part for pair in pairs for part in pair])


def cast(value: exp.Expr, to: str) -> exp.Expr:
    return call("CAST", exp.Alias(this=value.copy(), alias=exp.to_identifier(to)))


_JSON_MAKERS = frozenset({"json", "json_array", "json_extract", "json_group_array", "json_object"})
"""Functions whose results SQLite treats as JSON, not as texts, inside JSON."""

_TRANSPARENT_FUNCTIONS = frozenset({"coalesce", "ifnull", "iif", "if", "nullif"})

_EXACT_DIGITS = 15
"""The digits of a number in JSON text; DuckDB reads a decimal with no more as a real number."""


def extract(node: exp.Anonymous, kinds: Sequence[Kind]) -> Kind:
    """Return the type of the value at a path in JSON; negative indexes give null."""
    container, path = kinds[0], node.expressions[1]
    if isinstance(path, exp.Literal):
        name = path.name.removeprefix("$.").strip('"')
        return container.field(name) if isinstance(container, RecordOf) else Plain.ANY
    cast_index = next(path.find_all(exp.Alias), None)
    if cast_index is not None and not isinstance(cast_index.this.unnest(), exp.Literal):
        index = cast_index.parent
        assert index is not None
        minus_one = exp.Literal.number(-1)
        checked_index = call("NULLIF", call("greatest", index.copy(), minus_one), minus_one.copy())
        index.replace(checked_index)
    return container.element if isinstance(container, ListOf) else Plain.ANY


def round_index(cast: exp.Expr, kind: Kind) -> None:
    """Round an index into a list, halves of real numbers as DuckDB does."""
    if types.is_whole(kind) or isinstance(cast.this.unnest(), exp.Boolean):
        return
    successor = exp.Add(this=exp.Paren(this=cast.this.copy()), expression=exp.Literal.number(1))
    name = "ROUND" if isinstance(kind, Decimal) else "to_whole"
    cast.set("this", exp.Sub(this=call(name, successor), expression=exp.Literal.number(1)))


def skip_nulls(node: exp.In, listed: exp.Select) -> None:
    """Make a membership test null only for a null value; nulls in the list do not count."""
    value = sql.expression("value")
    sql.restrict(listed, exp.Not(this=exp.Is(this=value, expression=exp.Null())))
    is_null = exp.Is(this=node.this.copy(), expression=exp.Null())
    node.replace(call("IIF", is_null, exp.Null(), node.copy()))


def make_json(node: exp.Anonymous, kinds: Sequence[Kind]) -> Kind:
    """Return the type of a record or list made of values, which are written as JSON."""
    name = sql.call_name(node)
    values = list(node.expressions)
    if name in ("json_object", "json_group_object"):
        names = [item.name.strip('"') for item in values[::2]]
        if name == "json_object":
            for key, field_name in zip(values[::2], names, strict=True):
                key.replace(exp.Literal.string(field_name))
        for value, kind in zip(values[1::2], kinds[1::2], strict=True):
            _as_json(value, kind)
        if name == "json_group_object":
            return Plain.ANY
        return RecordOf(tuple(zip(names, kinds[1::2], strict=True)))
    parent, element = sql.call_name(node.parent), common(kinds)
    is_row = parent == "json_group_array"  # of a recursion
    is_tie = parent == "json_each" and [item.name for item in values] == ["0"]  # of a subquery
    if name != "json_array" or not (is_row or is_tie):
        element = _as_cast(element) if name == "json_array" else element
        for value, kind in zip(values, kinds, strict=True):
            conform(value, kind, element)
        kinds = [element] * len(kinds)
    for value, kind in zip(list(node.expressions), kinds, strict=True):
        _as_json(value, kind)
    return ListOf(element)


def _as_json(value: exp.Expr, kind: Kind) -> None:
    if kind is Plain.TRUTH:
        if isinstance(literal := value.unnest(), exp.Boolean):
            text = exp.Literal.string("true" if literal.this else "false")
            value.replace(call("JSON", text))
        else:
            value.replace(sql.truth(value.copy()))
    elif kind is Plain.REAL and not _is_short(value):
        value.replace(call("JSON", call("real_as_json", value.copy())))
    elif isinstance(kind, Decimal) and not kind.scale and kind.whole > _EXACT_DIGITS:
        value.replace(cast(value, "INTEGER"))
    elif types.is_nested(kind) and not _is_json(value):
        value.replace(call("JSON", value.copy()))
    elif kind is Plain.ANY:
        value.replace(call("JSON", call("value_as_json", value.copy())))


def _is_short(value: exp.Expr) -> bool:
    value = value.unnest()
    if isinstance(value, exp.Neg):
        return _is_short(value.this)
    return isinstance(value, exp.Literal) and len(value.name) <= _EXACT_DIGITS


def _is_json(value: exp.Expr) -> bool:
    value = value.unnest()
    if isinstance(value, exp.Case):
        return all(map(_is_json, sql.arms(value)))
    name = sql.call_name(value)
    if name in _TRANSPARENT_FUNCTIONS:
        values = value.expressions[1:] if name in ("iif", "if") else value.expressions
        return all(map(_is_json, values[:1] if name == "nullif" else values))
    return name in _JSON_MAKERS or isinstance(value, exp.Null)


def _rename(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    """Call the corresponding function for records, lists or texts."""
    name, nested = node.name.lower(), [*map(types.is_nested, kinds)]
    if name == "any_value":
        node.set("this", "MIN")
    elif name in ("max", "min") and nested == [True]:
        node.set("this", "least_nested" if name == "min" else "greatest_nested")
    elif name.startswith("arg_") and nested[1:2] == [True]:
        node.set("this", f"{name}_of_nested")
    elif name == "json_array_length" and kinds[0] is Plain.TEXT:
        node.set("this", "length")
    return result_kind


def _choice(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    if node.name.lower() == "concatenate" and not isinstance(result_kind, ListOf):
        return result_kind
    values = list(zip(node.expressions, kinds, strict=True))
    for value, kind in values[1:] if node.name.lower() in ("iif", "if") else values:
        if kind != result_kind:
            conform(value, kind, result_kind)
    return result_kind


def _text(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    (kind,) = kinds
    if kind is Plain.TRUTH:
        node.set("this", "truth_to_text")
    elif isinstance(kind, Decimal):
        node.set("this", "decimal_to_text")
        node.append("expressions", exp.Literal.number(kind.scale))
    return result_kind


def _to_whole(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    """Round halves away from zero; `to_whole` rounds those of real numbers to even."""
    if kinds[0] is not Plain.REAL:
        node.replace(cast(call("ROUND", node.expressions[0].copy()), "INTEGER"))
    return result_kind


def _round(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    digits = node.expressions[1].unnest() if len(kinds) > 1 else exp.Literal.number(0)
    if not isinstance(digits, exp.Literal):
        node.set("this", "round_to")
        if not isinstance(digits, exp.Neg):
            return Plain.REAL if isinstance(kinds[0], Decimal) else result_kind
    elif isinstance(kinds[0], Decimal):
        return replace(kinds[0], scale=min(kinds[0].scale, int(digits.name)))
    if types.is_whole(result_kind):
        node.replace(cast(node, "INTEGER"))
    return result_kind


def _round_or_cast(node: exp.Anonymous, kinds: Sequence[Kind], result_kind: Kind) -> Kind:
    if result_kind is Plain.REAL and types.is_whole(kinds[0]):
        node.replace(cast(node, "REAL"))
        return result_kind
    return _round(node, kinds, result_kind)


def _total(node: exp.Anonymous, _: Sequence[Kind], result_kind: Kind) -> Kind:
    if isinstance(result_kind, Decimal):
        node.replace(call("ROUND", node.copy(), exp.Literal.number(result_kind.scale)))
    return result_kind


def _cast_as_example(node: exp.Anonymous, kinds: Sequence[Kind], _: Kind) -> Kind:
    """Replace an example by its type if that is known; otherwise SQLite examines the value."""
    target = _as_cast(kinds[1])
    spell_truth(node.expressions[0], kinds[0], target)
    if types.is_known(target):
        node.set("this", "try_cast")
        node.set("expressions", [node.expressions[0], exp.Literal.string(types.spell(target))])
    return target


def spell_truth(value: exp.Expr, kind: Kind, target: Kind) -> None:
    """Convert a Boolean to the text ``true`` or ``false`` where it becomes a text."""
    if kind is Plain.TRUTH and target is Plain.TEXT:
        value.replace(call("truth_to_text", value.copy()))


def _as_cast(kind: Kind, *, in_order: bool = True) -> Kind:
    """Return the type as written in a cast, as of list literals: numbers real, fields sorted."""
    if isinstance(kind, ListOf):
        return ListOf(_as_cast(kind.element, in_order=in_order))
    if isinstance(kind, RecordOf):
        fields = [(name, _as_cast(k, in_order=in_order)) for name, k in kind.fields]
        by_name = sorted(fields, key=lambda field: field[0])
        return RecordOf(tuple(by_name if in_order else fields))
    return Plain.REAL if types.is_number(kind) else kind


CHANGES = {
    **dict.fromkeys(("arg_max", "arg_max_k", "arg_min", "arg_min_k", "max", "min"), _rename),
    **dict.fromkeys(("any_value", "json_array_length"), _rename),
    **dict.fromkeys(("ceil", "ceiling", "floor"), _round_or_cast),
    **dict.fromkeys(("coalesce", "concat_some_lists", "concatenate", "greatest", "least"), _choice),
    **dict.fromkeys(("if", "ifnull", "iif"), _choice),
    "round": _round,
    "sum": _total,
    "to_text": _text,
    "to_whole": _to_whole,
    "try_cast_like": _cast_as_example,
}
"""By function, what rewrites a call as DuckDB evaluates it, and returns its type."""
