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


def conform(value: exp.Expr, kind: Kind, wanted: Kind) -> None:
    """Coerce an expression in place to the common type, also inside written records and lists."""
    if isinstance(value, exp.Paren | exp.Alias):
        conform(value.this, kind, wanted)
    elif types.is_whole(kind) and (wanted is Plain.REAL or isinstance(wanted, Decimal)):
        is_written = isinstance(value, exp.Literal)
        value.replace(exp.Literal.number(f"{value.name}.0") if is_written else cast(value, "REAL"))
    elif isinstance(value, exp.Case):
        for arm in sql.arms(value):
            conform(arm, kind, wanted)
    elif isinstance(kind, Decimal) and isinstance(wanted, Decimal):
        if kind.scale > wanted.scale:
            value.replace(call("ROUND", value.copy(), exp.Literal.number(wanted.scale)))
    elif sql.call_name(value) == "json_object" and isinstance(wanted, RecordOf):
        _conform_fields(value, kind, wanted)
    elif sql.call_name(value) == "json_array":
        if isinstance(kind, ListOf) and isinstance(wanted, ListOf):
            for element in list(value.expressions):
                conform(element, kind.element, wanted.element)
    elif (
        types.is_nested(kind)
        and kind != wanted
        and types.is_nested(wanted)
        and types.is_known(wanted)
    ):
        is_real = _as_cast(wanted, in_order=False) == wanted  # as all numbers of `try_cast`
        if is_real:
            value.replace(call("try_cast", value.copy(), exp.Literal.string(types.spell(wanted))))


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


def cast(value: exp.Expr, to: str) -> exp.Expr:
    return call("CAST", exp.Alias(this=value.copy(), alias=exp.to_identifier(to)))


_MAKERS = frozenset({"json", "json_array", "json_extract", "json_group_array", "json_object"})
"""Functions whose result SQLite takes for JSON, and not for a text, where it is put into JSON."""

_PASSING_ON = frozenset({"coalesce", "ifnull", "iif", "if", "nullif"})

_EXACT_DIGITS = 15
"""That SQLite writes of a number in JSON; DuckDB takes a decimal of no more for a real number."""


def extract(made: exp.Anonymous, kinds: Sequence[Kind]) -> Kind:
    """Return the type of the value at a path in JSON; negative places are null."""
    whole, path = kinds[0], made.expressions[1]
    if isinstance(path, exp.Literal):
        name = path.name.removeprefix("$.").strip('"')
        return whole.field(name) if isinstance(whole, RecordOf) else Plain.ANY
    place = next(path.find_all(exp.Alias), None)
    if place is not None and not isinstance(place.this.unnest(), exp.Literal):
        index = place.parent
        assert index is not None
        nowhere = exp.Literal.number(-1)
        at = call("NULLIF", call("greatest", index.copy(), nowhere), nowhere.copy())
        index.replace(at)
    return whole.element if isinstance(whole, ListOf) else Plain.ANY


def round_place(cast: exp.Expr, kind: Kind) -> None:
    """Round a place in a list to the nearest one, halves of real numbers as DuckDB does."""
    if types.is_whole(kind) or isinstance(cast.this.unnest(), exp.Boolean):
        return
    after = exp.Add(this=exp.Paren(this=cast.this.copy()), expression=exp.Literal.number(1))
    name = "ROUND" if isinstance(kind, Decimal) else "to_whole"
    cast.set("this", exp.Sub(this=call(name, after), expression=exp.Literal.number(1)))


def skip_nulls(node: exp.In, listed: exp.Select) -> None:
    """Let a value be null in no list but for being null: other nulls in the list do not count."""
    value = sql.expression("value")
    sql.restrict(listed, exp.Not(this=exp.Is(this=value, expression=exp.Null())))
    is_null = exp.Is(this=node.this.copy(), expression=exp.Null())
    node.replace(call("IIF", is_null, exp.Null(), node.copy()))


def make_json(made: exp.Anonymous, kinds: Sequence[Kind]) -> Kind:
    """Return the type of a record or list made of values, which are written as JSON."""
    name = sql.call_name(made)
    values = list(made.expressions)
    if name in ("json_object", "json_group_object"):
        names = [each.name.strip('"') for each in values[::2]]
        if name == "json_object":
            for written, plain in zip(values[::2], names, strict=True):
                written.replace(exp.Literal.string(plain))
        for value, kind in zip(values[1::2], kinds[1::2], strict=True):
            _as_json(value, kind)
        if name == "json_group_object":
            return Plain.ANY
        return RecordOf(tuple(zip(names, kinds[1::2], strict=True)))
    parent, element = sql.call_name(made.parent), common(kinds)
    is_row = parent == "json_group_array"  # of a recursion
    is_tie = parent == "json_each" and [each.name for each in values] == ["0"]  # of a subquery
    if name != "json_array" or not (is_row or is_tie):
        element = _as_cast(element) if name == "json_array" else element
        for value, kind in zip(values, kinds, strict=True):
            conform(value, kind, element)
        kinds = [element] * len(kinds)
    for value, kind in zip(list(made.expressions), kinds, strict=True):
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
    if name in _PASSING_ON:
        values = value.expressions[1:] if name in ("iif", "if") else value.expressions
        return all(map(_is_json, values[:1] if name == "nullif" else values))
    return name in _MAKERS or isinstance(value, exp.Null)


def _rename(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    """Call the function that does the same with records, lists or texts."""
    name, nested = made.name.lower(), [*map(types.is_nested, kinds)]
    if name == "any_value":
        made.set("this", "MIN")
    elif name in ("max", "min") and nested == [True]:
        made.set("this", "least_nested" if name == "min" else "greatest_nested")
    elif name.startswith("arg_") and nested[1:2] == [True]:
        made.set("this", f"{name}_of_nested")
    elif name == "json_array_length" and kinds[0] is Plain.TEXT:
        made.set("this", "length")
    return found


def _choice(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    if made.name.lower() == "concatenate" and not isinstance(found, ListOf):
        return found
    values = list(zip(made.expressions, kinds, strict=True))
    for value, kind in values[1:] if made.name.lower() in ("iif", "if") else values:
        if kind != found:
            conform(value, kind, found)
    return found


def _text(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    (kind,) = kinds
    if kind is Plain.TRUTH:
        made.set("this", "truth_to_text")
    elif isinstance(kind, Decimal):
        made.set("this", "decimal_to_text")
        made.append("expressions", exp.Literal.number(kind.scale))
    return found


def _to_whole(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    """Round halves away from zero; `to_whole` rounds those of real numbers to even."""
    if kinds[0] is not Plain.REAL:
        made.replace(cast(call("ROUND", made.expressions[0].copy()), "INTEGER"))
    return found


def _round(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    digits = made.expressions[1].unnest() if len(kinds) > 1 else exp.Literal.number(0)
    if not isinstance(digits, exp.Literal):
        made.set("this", "round_to")
        if not isinstance(digits, exp.Neg):
            return Plain.REAL if isinstance(kinds[0], Decimal) else found
    elif isinstance(kinds[0], Decimal):
        return replace(kinds[0], scale=min(kinds[0].scale, int(digits.name)))
    if types.is_whole(found):
        made.replace(cast(made, "INTEGER"))
    return found


def _cut(made: exp.Anonymous, kinds: Sequence[Kind], found: Kind) -> Kind:
    if found is Plain.REAL and types.is_whole(kinds[0]):
        made.replace(cast(made, "REAL"))
        return found
    return _round(made, kinds, found)


def _total(made: exp.Anonymous, _: Sequence[Kind], found: Kind) -> Kind:
    if isinstance(found, Decimal):
        made.replace(call("ROUND", made.copy(), exp.Literal.number(found.scale)))
    return found


def _cast_as_example(made: exp.Anonymous, kinds: Sequence[Kind], _: Kind) -> Kind:
    """Replace an example by its type if that is known; otherwise SQLite examines the value."""
    wanted = _as_cast(kinds[1])
    spell_truth(made.expressions[0], kinds[0], wanted)
    if types.is_known(wanted):
        made.set("this", "try_cast")
        made.set("expressions", [made.expressions[0], exp.Literal.string(types.spell(wanted))])
    return wanted


def spell_truth(value: exp.Expr, kind: Kind, wanted: Kind) -> None:
    """Let a Boolean that becomes a text be ``true`` or ``false``."""
    if kind is Plain.TRUTH and wanted is Plain.TEXT:
        value.replace(call("truth_to_text", value.copy()))


def _as_cast(kind: Kind, *, in_order: bool = True) -> Kind:
    """Return the type as written in a cast, as of list literals: numbers real, fields sorted."""
    if isinstance(kind, ListOf):
        return ListOf(_as_cast(kind.element, in_order=in_order))
    if isinstance(kind, RecordOf):
        fields = [(name, _as_cast(of, in_order=in_order)) for name, of in kind.fields]
        by_name = sorted(fields, key=lambda field: field[0])
        return RecordOf(tuple(by_name if in_order else fields))
    return Plain.REAL if types.is_number(kind) else kind


CHANGES = {
    **dict.fromkeys(("arg_max", "arg_max_k", "arg_min", "arg_min_k", "max", "min"), _rename),
    **dict.fromkeys(("any_value", "json_array_length"), _rename),
    **dict.fromkeys(("ceil", "ceiling", "floor"), _cut),
    **dict.fromkeys(("coalesce", "concat_some_lists", "concatenate", "greatest", "least"), _choice),
    **dict.fromkeys(("if", "ifnull", "iif"), _choice),
    "round": _round,
    "sum": _total,
    "to_text": _text,
    "to_whole": _to_whole,
    "try_cast_like": _cast_as_example,
}
"""By function what writes a call as DuckDB means it, and returns the type of what it gives."""
