"""Small programs, one construct or idiom each, whose answers DuckDB decides.

A line of ``corpus.txt`` is an expression over `sensor` and `memory`, with the rules that it
needs before ``@@``; lines that begin with ``##`` name the topic.
"""

from __future__ import annotations

from pathlib import Path

__all__ = ["CASES", "DIFFERENCES"]

_TEXT = Path(__file__).with_name("corpus.txt").read_text(encoding="utf-8")


def _cases() -> list[tuple[str, str, str]]:
    """Topic, rules and expression of every case."""
    topic = ""
    cases = []
    for line in _TEXT.strip().splitlines():
        if line.startswith("## "):
            topic = line[3:]
        else:
            rules, _, expression = line.rpartition(" @@ ")
            cases.append((topic, rules, expression))
    return cases


CASES = _cases()

DIFFERENCES: list[tuple[str, object, object]] = [
    # expression, its value here, its value on DuckDB; each is explained in docs/dialect.md
    ("0 / 0", None, float("nan")),
    ("Sqrt(-1)", None, float("nan")),
    ("1 in memory.nothing", False, None),
    ("ToString([1, 2])", [1, 2], "[1.0, 2.0]"),
    ('RecordAsJson({a: 1, b: "x"})', {"a": 1, "b": "x"}, '{"a":1,"b":"x"}'),
    ("'x' ++ RecordAsJson({a: Coalesce(sensor.clock, 0.125)})", 'x{"a":7.0}', 'x{"a":7.000}'),
    ("ToString(memory.plan.done)", "1", "true"),
    ("ToString(if true then memory.count else 0.5)", "4", "4.0"),
    ('Element(["a", "b"], -2)', None, "b"),
    ('Split("a", null)', None, ["a"]),
    ('ArrayToString(["a"], null)', None, "a"),
    ("List{ToString(x) :- x in [0]}", ["0"], ["0.0"]),
    ('Format("%s", 1.5)', "1.5", "InvalidInputException"),
    ('Lpad("a", 3)', "  a", "BinderException"),
    ('Repeat("ab", 1.5)', "ab", "BinderException"),
    ('TryCast(ToString(["1e3"]), [""])', ["1000.0"], ["1e3"]),
    ("Sort([3, 1, 2])", [1, 2, 3], "CatalogException"),
    ("Size([])", 0, "RuleCompileException"),
    ("100000000000 * 100000000000", 1e22, "OutOfRangeException"),
    ('ToInt64("x")', 0, "ConversionException"),
]
