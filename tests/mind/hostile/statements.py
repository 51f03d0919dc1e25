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
    **{
        name: sql.replace("NUMBERS ", _NUMBERS).replace("BIG", _BIG)
        for line in Path(__file__).with_name("runaway.sql").read_text("utf-8").splitlines()
        for name, _, sql in [line.partition(": ")]
    },
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
    "is tangled": f"WITH {_TANGLE} SELECT count(*) FROM t_13_A p CROSS JOIN t_13_A q",
    "makes a text of texts": "SELECT json_array("
    + ", ".join(["s"] * 120)
    + f") FROM (SELECT {_BIG} AS s)",
    "nests expressions": "SELECT " + "(" * 5_000 + "1" + ")" * 5_000,
    "adds and adds": "SELECT " + "+".join(["1"] * 100_000),
    "unites and unites": " UNION ALL ".join(["SELECT 1"] * 5_000),
    "has many columns": "SELECT " + ", ".join(["1"] * 5_000),
    "has many arguments": "SELECT max(" + ", ".join(["1"] * 5_000) + ")",
    "is long": "SELECT '" + "x" * 3_000_000 + "'",
    "has half a character": "SELECT '\ud800'",
    "has a zero byte": "SELECT '\0'",
}
"""They may end by themselves or by a limit, but they end."""
