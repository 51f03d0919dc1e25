"""Going through a query: the type of each expression, and each one written as DuckDB means it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from sqlglot import exp

from logical_robots_tui.language.types import (
    MOST_DIGITS,
    SENSOR,
    Decimal,
    Kind,
    ListOf,
    Plain,
    Tables,
    common,
    digits,
    is_nested,
    is_number,
    is_whole,
    parse_spelling,
)
from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.mind.typed import changes
from logical_robots_tui.mind.typed.changes import conform

_GIVE: dict[Kind, tuple[str, ...]] = {
    Plain.TEXT: (
        *("char", "format", "formatted", "group_concat", "join_list", "lower_text", "ltrim"),
        *("pad_left", "pad_right", "regexp_extract", "repeat_text"),
        *("replace", "reverse", "rtrim", "string_agg", "substr", "substring", "to_text", "trim"),
        *("truth_to_text", "typeof", "upper_text", "lower", "upper", "decimal_to_text", "printf"),
    ),
    Plain.WHOLE: (
        *("count", "cume_dist", "dense_rank", "instr", "json_array_length", "length"),
        *("natural_hash", "ntile", "rank", "row_number", "sign", "to_whole", "unicode"),
        *("unicode_of", "unique_number"),
    ),
    Plain.REAL: (
        *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "avg", "cos", "cosh"),
        *("degrees", "divide", "exp", "ln", "log", "log10", "log2", "median", "percentile", "pi"),
        *("pow", "power", "radians", "sin", "sinh", "sqrt", "tan", "tanh", "total"),
    ),
    Plain.TRUTH: ("ends_with", "json_valid", "like", "list_has", "starts_with"),
}

_GIVES = {name: kind for kind, names in _GIVE.items() for name in names}

_FIRST = frozenset(
    {
        *("abs", "any_value", "arg_max", "arg_max_of_nested", "arg_min", "arg_min_of_nested"),
        *("first_value", "greatest_nested", "lag", "last_value", "lead", "least_nested"),
        *("likelihood", "likely", "nth_value", "nullif", "sort_list", "unique_list", "unlikely"),
    }
)

_ONE_OF_THEM = frozenset({"coalesce", "concat_some_lists", "greatest", "ifnull", "least"})

_SHORT_DIGITS = 18
"""Decimal numbers of no more digits are multiplied to one of no more, if that holds the scale."""

_ROUNDING = frozenset({"ceil", "ceiling", "floor", "trunc"})


def result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of what a function gives."""
    if name in _GIVES:
        return _GIVES[name]
    if name in _ONE_OF_THEM:
        return common(kinds)
    if not kinds:
        return Plain.ANY
    if name in _FIRST:
        return kinds[0]
    made = _MADE.get(name)
    return made(kinds) if made is not None else Plain.ANY


def sum_of(kinds: Sequence[Kind]) -> Kind:
    return common(kinds) if all(map(is_number, kinds)) else Plain.ANY


def product_of(left: Kind, right: Kind) -> Kind:
    found = sum_of((left, right))
    if not isinstance(found, Decimal):
        return found
    scale = sum(k.scale for k in (left, right) if isinstance(k, Decimal))
    most = digits(left) + digits(right)
    if max(digits(left), digits(right)) <= _SHORT_DIGITS < most:
        most = _SHORT_DIGITS
    return Decimal(scale, min(most, MOST_DIGITS) - scale)


def _total(kinds: Sequence[Kind]) -> Kind:
    kind = sum_of(kinds[:1])
    if isinstance(kind, Decimal):
        return Decimal(kind.scale, MOST_DIGITS - kind.scale)
    return Plain.LARGE if is_whole(kind) else kind


def _type_of_round(kinds: Sequence[Kind]) -> Kind:
    kind = kinds[0]
    return Decimal(0, digits(kind)) if isinstance(kind, Decimal) else sum_of(kinds[:1])


def _cut(kinds: Sequence[Kind]) -> Kind:
    """Return the type of a floor or ceiling; DuckDB's of a whole number is real."""
    return Plain.REAL if is_whole(kinds[0]) else _type_of_round(kinds)


def _type_of_array(kinds: Sequence[Kind]) -> Kind:
    return ListOf(kinds[1]) if len(kinds) > 1 else Plain.ANY


def _type_of_concat(kinds: Sequence[Kind]) -> Kind:
    if all(isinstance(kind, ListOf) for kind in kinds):
        return common(kinds)
    return Plain.TEXT if Plain.TEXT in kinds else Plain.ANY


_MADE: dict[str, Callable[[Sequence[Kind]], Kind]] = {
    **dict.fromkeys(_ROUNDING, _cut),
    "arg_max_k": lambda kinds: ListOf(kinds[0]),
    "arg_max_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "arg_min_k": lambda kinds: ListOf(kinds[0]),
    "arg_min_k_of_nested": lambda kinds: ListOf(kinds[0]),
    "array_by": _type_of_array,
    "concat_lists": lambda kinds: kinds[0],
    "concatenate": _type_of_concat,
    "if": lambda kinds: common(kinds[1:]),
    "iif": lambda kinds: common(kinds[1:]),
    "json_group_array": lambda kinds: ListOf(kinds[0]),
    "list_of_distinct": lambda kinds: ListOf(kinds[0]),
    "max": common,
    "min": common,
    "modulo": sum_of,
    "generate_array": lambda kinds: ListOf(common(kinds)),
    "number_range": lambda _: ListOf(Plain.WHOLE),
    "round": _type_of_round,
    "round_to": _type_of_round,
    "split_text": lambda _: ListOf(Plain.TEXT),
    "sum": _total,
}


Columns: TypeAlias = "dict[str, Kind]"

_INPUTS: Mapping[str, Columns] = {
    "sensor": {"robot_name": Plain.TEXT, "sensor": SENSOR},
    "memory": {"robot_name": Plain.TEXT, "memory": Plain.ANY},
}

_COMPARING = (exp.EQ, exp.NEQ, exp.LT, exp.LTE, exp.GT, exp.GTE)
_TRUTHS = (exp.And, exp.Or, exp.Not, exp.Is, exp.Exists, exp.Between, exp.Like)
_MOST_SMALL = 2**31 - 1
_MOST_DIGITS = 15  # of a decimal number that a real one holds exactly enough


class Reader:
    """One query. Methods that return an expression's type rewrite the expression in place."""

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self._named: dict[str, Columns] = {}
        self._scopes: list[dict[str, Columns]] = []

    def query(self, tree: exp.Expr) -> Columns:
        """Return a query's column types by name; changes the query in place."""
        if isinstance(tree, exp.Subquery):
            return self.query(tree.this)
        named = tree.args.get("with_")
        for query in named.expressions if named else ():
            self._named[query.alias] = self.query(query.this)
        if isinstance(tree, exp.Select):
            return self._select(tree)
        if isinstance(tree, exp.SetOperation):
            return self._union(tree)
        raise ValueError("not a query")

    def _union(self, tree: exp.SetOperation) -> Columns:
        arms = []
        waiting: list[exp.Expr] = [tree]
        while waiting:
            node = waiting.pop()
            if isinstance(node, exp.SetOperation):
                waiting += [node.expression, node.this]
            else:
                arms.append((node, list(self.query(node).items())))
        columns: Columns = {}
        for place, (name, _) in enumerate(arms[0][1]):
            kinds = [found[place][1] for _, found in arms]
            columns[name] = common(kinds)
            for (arm, _), kind in zip(arms, kinds, strict=True):
                if kind != columns[name] and isinstance(arm, exp.Select) and not arm.is_star:
                    item = arm.expressions[place]
                    conform(item.unalias(), kind, columns[name])
        return columns

    def _select(self, select: exp.Select) -> Columns:
        here: dict[str, Columns] = {}
        self._scopes.append(here)
        for alias, table in sql.sources(select).items():
            here[alias] = self._source(table)
        columns: Columns = {}
        for item in select.expressions:
            if isinstance(item, exp.Star):
                for given in here.values():
                    columns |= given
            else:
                columns[item.alias_or_name] = self.kind(
                    item.this if isinstance(item, exp.Alias) else item
                )
        for part in ("where", "having"):
            if (clause := select.args.get(part)) is not None:
                self.kind(clause.this)
        if (group := select.args.get("group")) is not None:
            for item in list(group.expressions):
                self.kind(item)
        self._scopes.pop()
        return columns

    def _source(self, table: exp.Expr) -> Columns:
        if isinstance(table, exp.Subquery):
            return self.query(table.this)
        if sql.call_name(table.this) == "json_each":
            (listed, *_) = table.this.expressions
            found = self.kind(listed)
            return {"value": found.element if isinstance(found, ListOf) else Plain.ANY}
        if table.name in self._named:
            return self._named[table.name]
        known = self._tables.get(table.name) or _INPUTS.get(table.name.lower(), {})
        return dict(known)

    # -- expressions ---------------------------------------------------------------------------

    def kind(self, node: exp.Expr) -> Kind:
        if isinstance(node, exp.Paren | exp.Alias):
            return self.kind(node.this)
        if isinstance(node, exp.Column):
            return self._column(node)
        if isinstance(node, exp.Literal):
            return _literal(node)
        if isinstance(node, exp.Null):
            return Plain.NULL
        if isinstance(node, exp.Boolean):
            return Plain.TRUTH
        if isinstance(node, exp.Anonymous):
            return self._call(node)
        if isinstance(node, exp.Case):
            return self._case(node)
        if isinstance(node, exp.Subquery):
            return common(self.query(node.this).values())
        if isinstance(node, exp.Add | exp.Sub | exp.Mul):
            return self._arithmetic(node)
        if isinstance(node, exp.Neg):
            return sum_of([self.kind(node.this)])
        if isinstance(node, _COMPARING):
            left, right = self.kind(node.this), self.kind(node.expression)
            changes.compare_nested(node, left, right)
            return Plain.TRUTH
        if isinstance(node, exp.In):
            return self._in(node)
        return self._other(node)

    def _other(self, node: exp.Expr) -> Kind:
        if isinstance(node, exp.Window):
            return self.kind(node.this)
        kinds = [
            common(self.query(child).values())
            if isinstance(child, exp.Select | exp.SetOperation)
            else self.kind(child)
            for child in list(node.iter_expressions())
        ]
        if isinstance(node, _TRUTHS):
            return Plain.TRUTH
        if isinstance(node, exp.DPipe):
            return Plain.TEXT
        return kinds[0] if isinstance(node, exp.Distinct) and kinds else Plain.ANY

    def _column(self, column: exp.Column) -> Kind:
        for scope in reversed(self._scopes):
            if column.table in scope:
                return scope[column.table].get(column.name, Plain.ANY)
            if not column.table:
                for columns in scope.values():
                    if column.name in columns:
                        return columns[column.name]
        return Plain.ANY

    def _case(self, case: exp.Case) -> Kind:
        kinds = []
        if case.this is not None:
            self.kind(case.this)
        for branch in case.args["ifs"]:
            self.kind(branch.this)
            kinds.append(self.kind(branch.args["true"]))
        default = case.args.get("default")
        kinds.append(Plain.NULL if default is None else self.kind(default))
        chosen = common(kinds)
        values = [branch.args["true"] for branch in case.args["ifs"]]
        for value, kind in zip([*values, case.args.get("default")], kinds, strict=True):
            if kind != chosen and value is not None:
                conform(value, kind, chosen)
        return chosen

    def _arithmetic(self, node: exp.Binary) -> Kind:
        left, right = self.kind(node.this), self.kind(node.expression)
        found = product_of(left, right) if isinstance(node, exp.Mul) else sum_of((left, right))
        if not isinstance(found, Decimal):
            return found
        if found.scale > _MOST_DIGITS:
            return Plain.REAL
        changes.round_decimal(node, found)
        return found

    def _in(self, node: exp.In) -> Kind:
        looked_for = self.kind(node.this)
        if (query := node.args.get("query")) is not None:
            listed = sql.sources(query.this)
            self.query(query.this)
            calls = [t.this for t in listed.values() if sql.call_name(t.this) == "json_each"]
            if is_nested(looked_for) and calls:
                changes.contain_nested(node, calls[0].expressions[0])
        for item in list(node.expressions):
            self.kind(item)
        return Plain.TRUTH

    def _call(self, call: exp.Anonymous) -> Kind:
        name = sql.call_name(call)
        if name == "cast":
            (cast,) = call.expressions
            self.kind(cast.this)
            return {"REAL": Plain.REAL, "INTEGER": Plain.WHOLE}.get(cast.alias, Plain.ANY)
        kinds = [self.kind(argument) for argument in call.expressions]
        arguments = call.expressions  # after they were rewritten
        if name in ("json_object", "json_array", "json_group_array", "json_group_object"):
            return changes.make_json(call, kinds)
        if name == "json_extract":
            return changes.extract(call, kinds)
        if name == "try_cast":
            wanted = parse_spelling(arguments[1].name)
            if wanted is Plain.WHOLE and isinstance(kinds[0], Decimal):
                arguments[0].replace(changes.call("ROUND", arguments[0].copy()))
            changes.spell_truth(arguments[0], kinds[0], wanted)
            return wanted
        found = result_of(name, kinds)
        return changes.change_call(call, name, kinds, found)


def _literal(node: exp.Literal) -> Kind:
    if node.is_string:
        return Plain.TEXT
    if node.this.isdigit():
        return Plain.SMALL if int(node.this) <= _MOST_SMALL else Plain.WHOLE
    if "e" in node.this.lower():
        return Plain.REAL
    whole, _, rest = node.this.partition(".")
    return Decimal(len(rest), len(whole))
