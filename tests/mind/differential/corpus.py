"""Small programs, one construct or idiom each, whose answers DuckDB decides.

A line of ``corpus.txt`` is an expression over `sensor` and `memory`, with the rules that it
needs before ``@@``; lines that begin with ``##`` name the topic.
"""

import re
from pathlib import Path

from logical_robots_tui.language.definitions import built_in_names, prelude
from tests.mind.rows import cases

__all__ = ["BATCHES", "CASES", "DIFFERENCES", "Case", "in_one"]

Case = tuple[str, str, str]
"""Topic, rules and expression."""

_TEXT = Path(__file__).with_name("corpus.txt").read_text(encoding="utf-8")


def _cases() -> list[Case]:
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

_SUPPLIED = {*built_in_names(), *prelude().definitions, "Sensor", "Memory", "Str", "Bool", "Int"}
_WORD = re.compile(r""""[^"]*"|'[^']*'|@?\b[A-Z]\w*""")


def _apart(case: Case, number: int) -> tuple[str, str]:
    """Rules and expression of a case, whose predicates have names of their own."""
    own = {word for word in _WORD.findall(case[1]) if word[0].isalpha()} - _SUPPLIED
    rules, expression = (
        _WORD.sub(lambda word: f"{word[0]}{number}" if word[0] in own else word[0], text)
        for text in case[1:]
    )
    return rules, expression


def in_one(batch: list[Case]) -> tuple[str, dict[str, str]]:
    """The rules of all cases, and an expression for each by a name for a column or a field."""
    parts = [_apart(case, number) for number, case in enumerate(batch)]
    functions, calls = cases([expression for _, expression in parts])
    return "\n".join(rules for rules, _ in parts) + functions, calls


def _group(case: Case) -> str:
    """What kind of program a case can stand in together with others."""
    topic, rules, expression = case
    statements = {part.strip().partition("(")[0]: part for part in rules.split(";")}
    is_recursive = any(part.count(f"{head}(") > 1 for head, part in statements.items())
    stands_alone = (
        is_recursive  # and has the plain way only
        or topic.startswith("recursion")
        or "@DefineFlag" in rules
        or _SUPPLIED & {*statements}
    )
    return rules + expression if stands_alone else ""


def _batches(size: int) -> list[list[Case]]:
    groups: dict[str, list[Case]] = {}
    for case in CASES:
        groups.setdefault(_group(case), []).append(case)
    counts = {name: -(-len(group) // size) for name, group in groups.items()}
    return [groups[name][n::count] for name, count in counts.items() for n in range(count)]


BATCHES = _batches(16)
"""All cases, those in one list that can stand in one program."""

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
    ('Split("ab", null)', None, ["ab"]),
    ('ArrayToString(["a", "b"], null)', None, "a,b"),
    ('Join(["a", "b"], null)', None, "a,b"),
    ("Range(2.5)", [0, 1], "BinderException"),
    ('Substr("abc", 1.5, 1)', "a", "BinderException"),
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
