"""The tables and functions that a program's SQL may use."""

from __future__ import annotations

import re

__all__ = ["BUILT_IN", "NAMED_QUERY", "TABLES"]

TABLES = frozenset({"sensor", "memory", "json_each"})
"""Tables that may be read, in lower case."""

NAMED_QUERY = re.compile(r"t_\d+_\w+|the_last_step|WhyGiven")
"""Names of the named queries of a statement."""

BUILT_IN = frozenset(
    [
        "abs",
        "acos",
        "acosh",
        "asin",
        "asinh",
        "atan",
        "atan2",
        "atanh",
        "avg",
        "ceil",
        "ceiling",
        "char",
        "coalesce",
        "concat",
        "concat_ws",
        "cos",
        "cosh",
        "count",
        "cume_dist",
        "degrees",
        "dense_rank",
        "exp",
        "first_value",
        "floor",
        "format",
        "group_concat",
        "if",
        "ifnull",
        "iif",
        "instr",
        "json",
        "json_array",
        "json_array_length",
        "json_each",
        "json_extract",
        "json_group_array",
        "json_group_object",
        "json_object",
        "json_quote",
        "json_type",
        "json_valid",
        "lag",
        "last_value",
        "lead",
        "length",
        "like",
        "likelihood",
        "likely",
        "ln",
        "log",
        "log10",
        "log2",
        "lower",
        "ltrim",
        "max",
        "median",
        "min",
        "mod",
        "nth_value",
        "ntile",
        "nullif",
        "percent_rank",
        "percentile",
        "pi",
        "pow",
        "power",
        "printf",
        "quote",
        "radians",
        "rank",
        "replace",
        "round",
        "row_number",
        "rtrim",
        "sign",
        "sin",
        "sinh",
        "sqrt",
        "string_agg",
        "substr",
        "substring",
        "sum",
        "tan",
        "tanh",
        "total",
        "trim",
        "trunc",
        "typeof",
        "unicode",
        "unlikely",
        "upper",
    ]
)
"""SQLite's own functions that may be called.

Excluded are functions that reach beyond the query (``load_extension``, ``readfile``), reveal the
machine (``random``, ``date``, ``sqlite_version``), or only create large values (``randomblob``,
``zeroblob``, ``hex``). Functions that can take very long in a single call are replaced by our
own.
"""
