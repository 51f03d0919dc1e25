"""SQL that no compiler of ours makes, forced upon the database to prove that it holds alone."""

from pathlib import Path

__all__ = ["REFUSED", "RUNAWAY"]

REFUSED = [*Path(__file__).with_name("refused.sql").read_text("utf-8").splitlines(), ""]
_NUMBERS = "WITH RECURSIVE t_0_N(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM t_0_N) "
_BIG = "printf('%1900000s', 'x')"
_TANGLE = ", ".join(
    ["t_0_A AS (SELECT 1 AS x)"]
    + [f"t_{i}_A AS (SELECT p.x FROM t_{i - 1}_A p, t_{i - 1}_A q)" for i in range(1, 14)]
)

RUNAWAY = {
    "counts for ever": _NUMBERS + "SELECT count(*) FROM t_0_N",
    "grows a table": "WITH RECURSIVE t_0_N(n, s) AS (SELECT 1, '' UNION SELECT n + 1, "
    "printf('%5000d', n) FROM t_0_N) SELECT count(*) FROM t_0_N",
    "sorts for ever": _NUMBERS
    + "SELECT n FROM (SELECT n, printf('%1000d', n) s FROM t_0_N) ORDER BY s",
    "groups for ever": _NUMBERS + "SELECT count(*) FROM t_0_N GROUP BY printf('%100d', n)",
    "collects for ever": _NUMBERS + "SELECT json_group_array(printf('%1000d', n)) FROM t_0_N",
    "collects in Python": _NUMBERS + "SELECT list_of_distinct(n) FROM t_0_N",
    "collects pairs": _NUMBERS + "SELECT array_by(n, printf('%1000d', n)) FROM t_0_N",
    "concatenates for ever": _NUMBERS + "SELECT group_concat(printf('%1000d', n)) FROM t_0_N",
    "concatenates in a window": _NUMBERS
    + "SELECT group_concat(n) OVER (ORDER BY n ROWS 100000 PRECEDING) FROM t_0_N LIMIT 1000000000",
    "gives rows for ever": _NUMBERS + "SELECT n FROM t_0_N",
    "gives large rows": _NUMBERS + f"SELECT {_BIG} FROM t_0_N",
    "gives a wide row": "SELECT " + ", ".join(["s"] * 95) + f" FROM (SELECT {_BIG} AS s)",
    "gives a wide row of blobs": "SELECT "
    + ", ".join(["s"] * 95)
    + f" FROM (SELECT CAST({_BIG} AS BLOB) AS s)",
    "is one slow row": "SELECT "
    + " + ".join(f"length(upper(s || {i}))" for i in range(900))
    + f" FROM (SELECT {_BIG} AS s)",
    "is one slow row of Python": "SELECT "
    + " + ".join(f"length(sort_list(s || substr('', {i})))" for i in range(900))
    + " FROM (SELECT number_range(19000) AS s)",
    "parses and parses": "SELECT "
    + " + ".join(f"json_array_length(json_array(s, {i}))" for i in range(900))
    + f" FROM (SELECT {_BIG} AS s)",
    "searches": _NUMBERS + f"SELECT sum(instr({_BIG} || 'a', {_BIG} || n)) FROM t_0_N",
    "replaces": _NUMBERS + f"SELECT sum(length(replace({_BIG}, ' ', n))) FROM t_0_N",
    "trims": _NUMBERS + f"SELECT sum(length(trim({_BIG}, ' x' || n))) FROM t_0_N",
    "likes": _NUMBERS + f"SELECT sum({_BIG} || n LIKE '%_ _ _ _ _%_ _ _x_%b') FROM t_0_N",
    "likes a long pattern": f"SELECT 'a' LIKE {_BIG}",
    "is tangled": f"WITH {_TANGLE} SELECT count(*) FROM t_13_A p CROSS JOIN t_13_A q",
    "joins": "WITH t_1_N(v) AS (SELECT value FROM json_each(number_range(99999))) "
    "SELECT count(*) FROM t_1_N a, t_1_N b, t_1_N c WHERE a.v + b.v + c.v = -1",
    "makes a text of texts": "SELECT json_array("
    + ", ".join(["s"] * 120)
    + f") FROM (SELECT {_BIG} AS s)",
    "doubles a blob": "WITH RECURSIVE t_0_N(s) AS (SELECT CAST('x' AS BLOB) UNION ALL "
    "SELECT s || s FROM t_0_N) SELECT max(length(s)) FROM t_0_N",
    "nests JSON": "WITH RECURSIVE t_0_N(s) AS (SELECT '[]' UNION ALL "
    "SELECT json_array(json(s)) FROM t_0_N LIMIT 1500) SELECT max(s) FROM t_0_N",
    "nests expressions": "SELECT " + "(" * 5_000 + "1" + ")" * 5_000,
    "adds and adds": "SELECT " + "+".join(["1"] * 100_000),
    "unites and unites": " UNION ALL ".join(["SELECT 1"] * 5_000),
    "has many columns": "SELECT " + ", ".join(["1"] * 5_000),
    "has many arguments": "SELECT max(" + ", ".join(["1"] * 5_000) + ")",
    "is long": "SELECT '" + "x" * 3_000_000 + "'",
    "has half a character": "SELECT '\ud800'",
    "has a zero byte": "SELECT '\0'",
    "makes half a character": "SELECT char(55296) || char(0) || char(1114111)",
    "makes bad UTF-8": "SELECT CAST(char(255, 254) AS BLOB), CAST(CAST(char(255) AS BLOB) AS TEXT)",
    "overflows": "SELECT abs(-9223372036854775808)",
    "divides by zero": "SELECT 1 / 0, divide(1, 0), modulo(1, 0), 9e999, -9e999",
}
"""They may end by themselves or by a limit, but they end."""
