"""DuckDB's static types, made explicit in a query that both evaluations start from."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from sqlglot import exp
from sqlglot.errors import SqlglotError

from logical_robots_tui.language import types
from logical_robots_tui.language.types import SENSOR, Decimal, Kind, ListOf, Plain, Tables, common
from logical_robots_tui.mind.compiling import duckdb_changes as changes
from logical_robots_tui.mind.compiling.duckdb_changes import conform
from logical_robots_tui.mind.tuning import sql

_NAMES_BY_RESULT: dict[Kind, tuple[str, ...]] = {
    Plain.TEXT: (
        *("character", "format", "formatted", "group_concat", "join_list", "lower_text", "ltrim"),
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

_RESULTS = {name: kind for kind, names in _NAMES_BY_RESULT.items() for name in names}

_LIKE_FIRST_ARGUMENT = frozenset(
    {
        *("abs", "any_value", "arg_max", "arg_max_of_nested", "arg_min", "arg_min_of_nested"),
        *("first_value", "greatest_nested", "lag", "last_value", "lead", "least_nested"),
        *("likelihood", "likely", "nth_value", "nullif", "sort_list", "unique_list", "unlikely"),
    }
)

_LIKE_ALL_ARGUMENTS = frozenset({"coalesce", "concat_some_lists", "greatest", "ifnull", "least"})

_SHORT_DIGITS = 18
"""The product of decimals of at most so many digits has no more, if that holds the scale."""

_LIST_FUNCTIONS = (
    *("arg_max_k", "arg_max_k_of_nested", "arg_min_k", "arg_min_k_of_nested"),
    *("json_group_array", "list_of_distinct"),
)


def _result_of(name: str, kinds: Sequence[Kind]) -> Kind:
    """Return the type of a function's result."""
    if name in _RESULTS:
        return _RESULTS[name]
    if name in _LIKE_ALL_ARGUMENTS:
        return common(kinds)
    if not kinds:
        return Plain.ANY
    if name in _LIKE_FIRST_ARGUMENT:
        return kinds[0]
    infer = _INFERENCE.get(name)
    return infer(kinds) if infer is not None else Plain.ANY


def _sum(kinds: Sequence[Kind]) -> Kind:
    return common(kinds) if all(map(types.is_number, kinds)) else Plain.ANY


def _product(left: Kind, right: Kind) -> Kind:
    kind = _sum((left, right))
    if not isinstance(kind, Decimal):
        return kind
    scale = sum(k.scale for k in (left, right) if isinstance(k, Decimal))
    max_digits = types.digits(left) + types.digits(right)
    if max(types.digits(left), types.digits(right)) <= _SHORT_DIGITS < max_digits:
        max_digits = _SHORT_DIGITS
    return Decimal(scale, min(max_digits, types.MOST_DIGITS) - scale)


def _total(kinds: Sequence[Kind]) -> Kind:
    kind = _sum(kinds[:1])
    if isinstance(kind, Decimal):
        return Decimal(kind.scale, types.MOST_DIGITS - kind.scale)
    return Plain.LARGE if types.is_whole(kind) else kind


def _round(kinds: Sequence[Kind]) -> Kind:
    kind = kinds[0]
    return Decimal(0, types.digits(kind)) if isinstance(kind, Decimal) else _sum(kinds[:1])


def _concat(kinds: Sequence[Kind]) -> Kind:
    if all(isinstance(kind, ListOf) for kind in kinds):
        return common(kinds)
    return Plain.TEXT if Plain.TEXT in kinds else Plain.ANY


_INFERENCE: dict[str, Callable[[Sequence[Kind]], Kind]] = {
    # DuckDB's floor or ceiling of a whole number is real.
    **dict.fromkeys(
        ("ceil", "ceiling", "floor", "trunc"),
        lambda kinds: Plain.REAL if types.is_whole(kinds[0]) else _round(kinds),
    ),
    **dict.fromkeys(_LIST_FUNCTIONS, lambda kinds: ListOf(kinds[0])),
    "array_by": lambda kinds: ListOf(kinds[1]) if len(kinds) > 1 else Plain.ANY,
    "concat_lists": lambda kinds: kinds[0],
    "concatenate": _concat,
    "if": lambda kinds: common(kinds[1:]),
    "iif": lambda kinds: common(kinds[1:]),
    "max": common,
    "min": common,
    "modulo": _sum,
    "generate_array": lambda kinds: ListOf(common(kinds)),
    "number_range": lambda _: ListOf(Plain.WHOLE),
    "round": _round,
    "round_to": _round,
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


def as_on_duckdb(
    statement: str, tables: Tables | None = None
) -> tuple[str, exp.Query | None, Mapping[str, Kind]]:
    """Make SQLite compute what DuckDB's types imply; `tables` are those besides the inputs.

    Returns:
        The statement, its tree, or None if it can't be read, and the types of its columns.
    """
    try:
        tree = sql.parse(statement)
        original = tree.copy()
        columns = _TypeInference(tables or {}).query(tree)
        sql.drop_parentheses(tree)
    except (SqlglotError, ValueError, RecursionError):
        return statement, None, {}
    return statement if tree == original else f"{sql.render(tree, pretty=True)};", tree, columns


class _TypeInference:
    """The types in one query. Methods that return an expression's type rewrite it in place."""

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self._named: dict[str, Columns] = {}
        self._scopes: list[dict[str, Columns]] = []

    def query(self, tree: exp.Expr) -> Columns:
        """Return a query's column types by name; changes the query in place."""
        if isinstance(tree, exp.Subquery):
            return self.query(tree.this)
        for query in sql.named_queries(tree):
            self._named[query.alias] = self.query(query.this)
        if isinstance(tree, exp.Select):
            return self._select(tree)
        if isinstance(tree, exp.SetOperation):
            return self._union(tree)
        raise ValueError("not a query")

    def _union(self, tree: exp.SetOperation) -> Columns:
        arms = []
        pending: list[exp.Expr] = [tree]
        while pending:
            node = pending.pop()
            if isinstance(node, exp.SetOperation):
                pending += [node.expression, node.this]
            else:
                arms.append((node, list(self.query(node).items())))
        columns: Columns = {}
        for index, (name, _) in enumerate(arms[0][1]):
            kinds = [arm_columns[index][1] for _, arm_columns in arms]
            columns[name] = common(kinds)
            for (arm, _), kind in zip(arms, kinds, strict=True):
                if kind != columns[name] and isinstance(arm, exp.Select) and not arm.is_star:
                    item = arm.expressions[index]
                    conform(item.unalias(), kind, columns[name])
        return columns

    def _select(self, select: exp.Select) -> Columns:
        source_columns: dict[str, Columns] = {}
        self._scopes.append(source_columns)
        for alias, table in sql.sources(select).items():
            source_columns[alias] = self._source(table)
        columns: Columns = {}
        for item in select.expressions:
            if isinstance(item, exp.Star):
                for table_columns in source_columns.values():
                    columns |= table_columns
            else:
                columns[item.alias_or_name] = self.kind(
                    item.this if isinstance(item, exp.Alias) else item
                )
        for ordered in select.find_all(exp.Ordered):
            ordered.set("nulls_first", False)
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
            (list_expression, *_) = table.this.expressions
            list_kind = self.kind(list_expression)
            return {"value": list_kind.element if isinstance(list_kind, ListOf) else Plain.ANY}
        if table.name in self._named:
            return self._named[table.name]
        columns = self._tables.get(table.name) or _INPUTS.get(table.name.lower(), {})
        return dict(columns)

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
            return _sum([self.kind(node.this)])
        if isinstance(node, _COMPARING):
            if any(
                [types.is_nested(self.kind(node.this)), types.is_nested(self.kind(node.expression))]
            ):
                # Field by field and element by element.
                order = changes.call("compare_values", node.this.copy(), node.expression.copy())
                node.set("this", order)
                node.set("expression", exp.Literal.number(0))
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
        for test in (case.this, *(branch.this for branch in case.args["ifs"])):
            if test is not None:
                self.kind(test)
        kinds = [self.kind(value) for value in sql.arms(case)]
        result_kind = common(kinds)  # null, as without ELSE, has any type
        for value, kind in zip(sql.arms(case), kinds, strict=True):
            if kind != result_kind:
                conform(value, kind, result_kind)
        return result_kind

    def _arithmetic(self, node: exp.Binary) -> Kind:
        left, right = self.kind(node.this), self.kind(node.expression)
        result_kind = _product(left, right) if isinstance(node, exp.Mul) else _sum((left, right))
        if not isinstance(result_kind, Decimal):
            return result_kind
        if result_kind.scale > _MOST_DIGITS:
            return Plain.REAL
        # Rounded, so that it has only the digits of the decimal.
        for side in (node.this.unnest(), node.expression.unnest()):
            if sql.call_name(side) == "round":
                side.replace(side.expressions[0])
        node.replace(changes.call("ROUND", node.copy(), exp.Literal.number(result_kind.scale)))
        return result_kind

    def _in(self, node: exp.In) -> Kind:
        element_kind = self.kind(node.this)
        if (query := node.args.get("query")) is not None:
            tables = sql.sources(query.this)
            self.query(query.this)
            calls = [t.this for t in tables.values() if sql.call_name(t.this) == "json_each"]
            if types.is_nested(element_kind) and calls:
                list_expression = calls[0].expressions[0].copy()
                node.replace(changes.call("list_has", list_expression, node.this.copy()))
            elif calls and not sql.is_condition(node):
                changes.skip_nulls(node, query.this)
        for item in list(node.expressions):
            self.kind(item)
        return Plain.TRUTH

    def _call(self, call: exp.Anonymous) -> Kind:
        name = sql.call_name(call)
        if name == "cast":
            (cast,) = call.expressions
            if (kind := self.kind(cast.this)) is not Plain.TEXT and cast.alias == "INTEGER":
                changes.round_index(cast, kind)
            return {"REAL": Plain.REAL, "INTEGER": Plain.WHOLE}.get(cast.alias, Plain.ANY)
        kinds = [self.kind(argument) for argument in call.expressions]
        arguments = call.expressions  # after they were rewritten
        if name in ("json_object", "json_array", "json_group_array", "json_group_object"):
            return changes.make_json(call, kinds)
        if name == "json_extract":
            return changes.extract(call, kinds)
        if name == "try_cast":
            target = types.parse_spelling(arguments[1].name)
            if target is Plain.WHOLE and isinstance(kinds[0], Decimal):
                arguments[0].replace(changes.call("ROUND", arguments[0].copy()))
            changes.spell_truth(arguments[0], kinds[0], target)
            return target
        result_kind, change = _result_of(name, kinds), changes.CHANGES.get(name)
        return result_kind if change is None else change(call, kinds, result_kind)


def _literal(node: exp.Literal) -> Kind:
    if node.is_string:
        return Plain.TEXT
    if node.this.isdigit():
        return Plain.SMALL if int(node.this) <= _MOST_SMALL else Plain.WHOLE
    if "e" in node.this.lower():
        return Plain.REAL
    whole, _, fraction = node.this.partition(".")
    return Decimal(len(fraction), len(whole))
