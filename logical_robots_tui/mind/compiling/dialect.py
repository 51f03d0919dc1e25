"""The SQL dialect for Logica: the package's SQLite dialect with DuckDB's semantics."""

from __future__ import annotations

import re
from typing import Any

from logica.compiler import dialects

from logical_robots_tui.language.adapter import tie_pair

_COLUMN = re.compile(r"\w+\.\w+")
_ALWAYS_JSON = (".sensor", ".value")


class RobotDialect(dialects.SqLiteDialect):  # type: ignore[misc]  # the package has no types
    """SQLite with DuckDB's division, no errors on null, and only our own functions."""

    def BuiltInFunctions(self) -> dict[str, str | None]:
        """Return functions by Logica name, as SQL templates."""
        functions: dict[str, str | None] = dict(super().BuiltInFunctions())
        functions.update(
            {
                # An expression that the optimizer can't move out of its subquery.
                "MagicalEntangle": "IIF({1} = 0, {0}, NULL)",
                "Set": "list_of_distinct({0})",
                "Join": "join_list({0}, {1})",
                "Sort": "sort_list({0})",
                "Agg++": "concat_lists(%s)",
                "Concat": "concat_two_lists({0}, {1})",
                "Split": "split_text(%s)",
                "If": "IIF(%s)",
                # MIN, but also for records; it need not be the least of them.
                "1": "any_value(%s)",
                "AnyValue": "any_value(%s)",
                "Format": "formatted(%s)",
                "Log": "LN(%s)",
                "Element": "json_extract({0}, '$[' || CAST({1} AS INTEGER) || ']')",
                "ToInt64": "CAST(round(%s) AS INTEGER)",
                "ToFloat64": "CAST(%s AS REAL)",
                "Range": "number_range({0})",
                "Unique": "unique_list({0})",
                # Like DuckDB, return null instead of an empty list.
                "List": "NULLIF(json_group_array({0}), '[]')",
                "Least": "least(%s)",
                "Greatest": "greatest(%s)",
                "Mod": "modulo(%s)",
                "Upper": "upper_text(%s)",
                "Lower": "lower_text(%s)",
                "ToString": "to_text(%s)",
            }
        )
        return functions

    def InfixOperators(self) -> dict[str, str]:
        """Return operators by Logica name, as SQL templates."""
        return {
            **super().InfixOperators(),
            "/": "divide(%s, %s)",
            "%": "modulo(%s, %s)",
            "++": "concatenate(%s, %s)",
            "in": "%s IN (SELECT value FROM json_each(%s))",
        }

    def Subscript(self, record: str, subscript: str, record_is_table: bool) -> str:
        """Return the SQL of `record.subscript`; null for a column that may hold plain text."""
        if record_is_table:
            return f"{record}.{subscript}"
        field = subscript.replace("'", "''")
        sql = f"json_extract({record}, '$.{field}')"
        if _COLUMN.fullmatch(record) and not record.endswith(_ALWAYS_JSON):
            return f"CASE WHEN json_valid({record}) THEN {sql} END"
        return sql

    def LibraryProgram(self) -> str:
        """Return nothing: the prelude is added to the program's rules instead."""
        return ""

    def DecorateCombineRule(self, rule: dict[str, Any], var: str) -> dict[str, Any]:
        """Tie an aggregated expression to its own subquery, as the package does.

        The pair `argument -> value` is tied in parts, so that it need never be built.
        """
        tied = tie_pair(rule, var)
        decorated: dict[str, Any] = tied or super().DecorateCombineRule(rule, var)
        return decorated
