"""Fields of sensors, rays and memories as columns, where the compiler takes them out of JSON text.

Every table gets the rows of all robots of a tick, rays and the records of lists in tables of their
own; which of them a robot may see is two bounds on their numbers, so that one load serves the
thoughts of all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field

from sqlglot import exp

from logical_robots_tui.mind.sqlite import layouts
from logical_robots_tui.mind.tuning import sql
from logical_robots_tui.schema import RAY, SELF, SENSOR

SENSOR_FIELDS = {
    **{f"$.{name}": name for name in SENSOR.scalars},
    **{f"$.self.{name}": name for name in SELF.scalars},
}
"""Columns of ``Sensor`` by the place in the record that they hold."""

RAY_FIELDS = RAY.names
"""Columns of ``Ray`` and the tables of some rays, beside ``value``, the whole ray as JSON text."""

_BOUNDS = {"sensor": ("?1", "?2"), "memory": ("?3", "?4")}


def merge_self_joins(tree: exp.Expr) -> None:
    """Read an input once where a select joins it with itself on the robot's name.

    A robot has one row in each, so it is the same row.
    """
    for select in list(tree.find_all(exp.Select)):
        sources = sql.sources(select)
        groups: list[set[str]] = []
        for condition in sql.conjuncts(select):
            if pair := _same_robot(condition):
                overlapping_groups = [names for names in groups if names & pair]
                groups = [names for names in groups if not names & pair]
                groups.append(pair.union(*overlapping_groups))
        for names in groups:
            first_names: dict[str, str] = {}
            for name in [name for name in sources if name in names]:
                table = sql.table_name(sources[name])
                if table in _BOUNDS and first_names.setdefault(table, name) != name:
                    for column in list(sql.columns_of(select, name)):
                        column.set("table", exp.to_identifier(first_names[table]))
                    sql.drop_source(select, name)
        for condition in sql.conjuncts(select):
            # robot_name of an input is never null.
            if _same_robot(condition) and condition.this == condition.expression:
                sql.drop_condition(select, condition)


def rays_as_rows(tree: exp.Expr) -> None:
    for select in list(tree.find_all(exp.Select)):
        sources = sql.sources(select)
        followers = {}
        for name, table in sources.items():
            sensor = _radar_of(table)
            if sensor is None:
                continue
            columns = list(sql.columns_of(select, name))
            if any(column.name != "value" for column in columns):
                continue
            for column in columns:
                field = sql.extract_path(column.parent)
                if column.parent and field[:2] == "$." and field[2:] in RAY_FIELDS:
                    column.parent.replace(exp.column(field[2:], name))
            rays = exp.to_table(_table_of_kind(select, name) or "Ray")
            table.replace(exp.alias_(rays, name, table=True))
            first_ray = f"sensor * {layouts.RAYS}"
            ray_range = f"ray BETWEEN {first_ray} AND {first_ray} + {layouts.RAYS - 1}"
            numbers = {"ray": exp.column("id", name), "sensor": exp.column("id", sensor)}
            sql.restrict(select, sql.expression(ray_range, **numbers))
            if sensor in sources:
                followers[name] = sensor
        # SQLite would otherwise scan the rays of all robots first.
        if followers:
            sql.read_after(select, followers)


def sensor_fields_as_columns(tree: exp.Expr) -> None:
    for column in list(tree.find_all(exp.Column)):
        if column.name.lower() != "sensor" or not _is_table(column, "sensor"):
            continue
        node: exp.Expr = column
        path = "$"
        while (call := node.parent) is not None and sql.extract_path(call).startswith("$."):
            node, path = call, path + sql.extract_path(call)[1:]
            if path in SENSOR_FIELDS:
                node.replace(exp.column(SENSOR_FIELDS[path], column.table))
                break


def bind_viewers(tree: exp.Expr) -> None:
    """Restrict every mention of an input to the rows between the bounds of a viewer."""
    for table in list(tree.find_all(exp.Table)):
        bounds = _BOUNDS.get(sql.table_name(table))
        select = table.find_ancestor(exp.Select)
        if bounds and select is not None:
            low, high = (exp.Var(this=name) for name in bounds)
            sql.restrict(
                select, exp.Between(this=exp.column("id", table.alias_or_name), low=low, high=high)
            )


def columns_read(trees: Iterable[exp.Expr]) -> dict[str, tuple[str, ...]]:
    columns_by_table: dict[str, set[str]] = {}
    for tree in trees:
        for table in tree.find_all(exp.Table):
            name = sql.TABLES.get(sql.table_name(table))
            if name is not None:
                columns_by_table.setdefault(name, set())
        for column in tree.find_all(exp.Column):
            source = sql.source(column)
            name = sql.TABLES.get(sql.table_name(source[1])) if source is not None else None
            if name is not None and column.name.lower() != "id":
                columns_by_table[name].add(column.name.lower())
    return {name: tuple(sorted(columns)) for name, columns in columns_by_table.items()}


def _same_robot(condition: exp.Expr) -> set[str]:
    sides = (condition.this, condition.expression) if isinstance(condition, exp.EQ) else ()
    if not sides or not all(isinstance(side, exp.Column) for side in sides):
        return set()
    if any(side.name.lower() != "robot_name" for side in sides):
        return set()
    return {side.table for side in sides}


def _radar_of(table: exp.Expr) -> str | None:
    if not isinstance(table, exp.Table) or sql.call_name(table.this) != "json_each":
        return None
    arguments = table.this.expressions
    if len(arguments) != 1 or sql.extract_path(arguments[0]) != "$.radar":
        return None
    column = arguments[0].expressions[0]
    is_sensor = isinstance(column, exp.Column) and column.name == "sensor"
    return column.table if is_sensor and _is_table(column, "sensor") else None


def _table_of_kind(select: exp.Select, ray: str) -> str:
    """Return the table of the one kind of rays selected, or ""; drops the redundant condition."""
    for test in sql.conjuncts(select):
        if not isinstance(test, exp.EQ):
            continue
        for column, kind in ((test.this, test.expression), (test.expression, test.this)):
            if not isinstance(column, exp.Column) or (column.table, column.name) != (ray, "object"):
                continue
            for table, object_kind in layouts.KINDS.items():
                if isinstance(kind, exp.Literal) and kind.is_string and kind.this == object_kind:
                    sql.drop_condition(select, test)
                    return table
    return ""


def _is_table(column: exp.Column, name: str) -> bool:
    source = sql.source(column)
    return source is not None and sql.table_name(source[1]) == name


def is_input(table: exp.Expr) -> bool:
    return sql.table_name(table) in _BOUNDS


_TABLES = frozenset({"ray", *(table.lower() for table in layouts.KINDS)})


def fetch_whole_rays(tree: exp.Expr) -> None:
    """Fetch whole rays once for each group, where they stand beside an aggregate.

    A ray that is read as a whole, as in ``ArgMin{ray -> ray.distance}``, is one of 31. Beside MIN
    a column of a group comes from the row that has the least value, so SQLite can ask for that ray
    alone.
    """
    for column in list(tree.find_all(exp.Column)):
        source = sql.source(column) if column.name.lower() == "value" else None
        if source is None or sql.table_name(source[1]) not in _TABLES:
            continue
        if _is_beside_aggregate(column, source[0]):
            number = exp.column("id", column.table)
            column.replace(exp.Anonymous(this=layouts.WHOLE_RAY, expressions=[number]))


def _is_beside_aggregate(column: exp.Column, select: exp.Select) -> bool:
    node: exp.Expr = column
    while node.parent is not select:
        parent = node.parent
        if (
            parent is None
            or isinstance(parent, exp.Select)
            or sql.call_name(parent) in sql.AGGREGATES
        ):
            return False
        node = parent
    return node.arg_key == "expressions" and any(map(sql.own_aggregates, select.expressions))


@dataclass(frozen=True, slots=True)
class MemoryColumns:
    """The columns of memory fields and of list records' fields, for all queries of a program."""

    fields: dict[str, str] = field(default_factory=dict)
    items: dict[str, str] = field(default_factory=dict)

    @classmethod
    def from_columns(cls, names_by_table: Mapping[str, Sequence[str]]) -> MemoryColumns:
        """Return the columns that are read already; they take no further fields."""
        pairs = (name.split("=") for name in names_by_table.get("Memory", ()) if "=" in name)
        fields = {content: column for column, content in pairs}
        pairs = (name.split("=") for name in names_by_table.get("Item", ()))
        items = {content.rpartition(".")[2]: column for column, content in pairs}
        # No field has a number for its name.
        fields |= {
            str(n): c for n, c in enumerate(layouts.MEMORY_FIELDS) if c not in fields.values()
        }
        items |= {str(n): c for n, c in enumerate(layouts.ITEM_FIELDS) if c not in items.values()}
        return cls(fields, items)


def memory_fields_as_columns(tree: exp.Expr, field_columns: MutableMapping[str, str]) -> None:
    for column in list(tree.find_all(exp.Column)):
        is_memory = column.name.lower() == "memory" and _is_table(column, "memory")
        extraction = guarded_field(column) if is_memory else None
        if extraction is None:
            continue
        case, field = extraction
        if field not in field_columns:
            if len(field_columns) == len(layouts.MEMORY_FIELDS):
                continue
            field_columns[field] = layouts.MEMORY_FIELDS[len(field_columns)]
        replacement = exp.column(field_columns[field], column.table)
        case.replace(sql.restore_mark(replacement, case, is_result=True))


def guarded_field(column: exp.Column) -> tuple[exp.Case, str] | None:
    """Return the Case that extracts a field of a column, and the field, or None.

    ``CASE WHEN JSON_VALID(column) THEN JSON_EXTRACT(column, '$.field') END``, given the second
    mention.
    """
    call = column.parent
    branch = call.parent if sql.call_name(call) == "json_extract" and call else None
    case = branch.parent if isinstance(branch, exp.If) else None
    if not isinstance(case, exp.Case) or branch is None or call is None:
        return None
    test = branch.this
    path = call.expressions[1] if len(call.expressions) == 2 else None
    if (
        case.this is not None
        or case.args.get("default") is not None
        or len(case.args["ifs"]) != 1
        or branch.args.get("true") is not call
        or sql.call_name(test) != "json_valid"
        or test.expressions != [column]
        or not isinstance(path, exp.Literal)
        or not path.is_string
    ):
        return None
    name = path.this.removeprefix("$.")
    return (case, name) if path.this == f"$.{name}" and name.isidentifier() else None


def items_as_rows(
    tree: exp.Expr, fields: Mapping[str, str], item_columns: MutableMapping[str, str]
) -> tuple[str, ...]:
    """Read records in lists of memories from ``Item``; return its columns, as in `insertions`."""
    by_column = {column: name for name, column in fields.items()}
    column_names: set[str] = set()
    for table in list(tree.find_all(exp.Table)):
        select, items = table.find_ancestor(exp.Select), _list_of(table)
        if select is None or items is None:
            continue
        names, alias = list(sql.sources(select)), table.alias_or_name
        if items.table in names and names.index(items.table) > names.index(alias):
            continue
        uses = list(sql.columns_of(select, alias))
        keys = {sql.extract_path(use.parent).removeprefix("$.") for use in uses}
        new_keys = sorted(key for key in keys if key not in item_columns)
        if not all(map(str.isidentifier, keys)) or len(item_columns) + len(new_keys) > len(
            layouts.ITEM_FIELDS
        ):
            continue
        if not keys or any(use.name != "value" for use in uses):
            continue
        item_columns.update(zip(new_keys, layouts.ITEM_FIELDS[len(item_columns) :], strict=False))
        for use in uses:
            call = use.parent
            assert call is not None
            column = item_columns[sql.extract_path(call).removeprefix("$.")]
            replacement = exp.column(column, alias)
            call.replace(sql.restore_mark(replacement, call, is_result=True))
        list_number = layouts.MEMORY_FIELDS.index(items.name)
        column_names |= {
            layouts.item_column_name(item_columns[key], list_number, by_column[items.name], key)
            for key in keys
        }
        _read_items(select, table, items.table, list_number)
    return tuple(sorted(column_names))


def _list_of(table: exp.Table) -> exp.Column | None:
    arguments = table.this.expressions if sql.call_name(table.this) == "json_each" else []
    column = arguments[0] if len(arguments) == 1 else None
    if not isinstance(column, exp.Column) or column.name not in layouts.MEMORY_FIELDS:
        return None
    return column if _is_table(column, "memory") else None


def _read_items(select: exp.Select, table: exp.Table, memory: str, list_number: int) -> None:
    alias = table.alias_or_name
    join = table.parent
    if isinstance(join, exp.Join):
        join.set("kind", "CROSS")
    table.replace(exp.alias_(exp.to_table("Item"), alias, table=True))
    first_item = f"(memory * {len(layouts.MEMORY_FIELDS)} + {list_number}) * {layouts.ITEMS}"
    item_range = f"item BETWEEN {first_item} AND {first_item} + {layouts.ITEMS - 1}"
    numbers = {"item": exp.column("id", alias), "memory": exp.column("id", memory)}
    sql.restrict(select, sql.expression(item_range, **numbers))
