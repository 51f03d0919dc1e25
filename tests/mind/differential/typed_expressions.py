"""Random expressions whose types are known: casts, texts, records, lists and recursions.

A kind is ``"Num"``, ``"Str"``, ``"Bool"``, a record of kinds or a list of one.
"""

import json
from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

Text = st.SearchStrategy[str]

SAID = ["a", "", "it's", "a, b", "NULL", "null", "1", "-2.5", "true", " x ", "Zoë", "no"]
SPELLED = [
    *("1e3", "3.50", "[]", "{'a': 1}", "{'a': {'b': 2}}"),
    *("{'a': x, 'b': 'it\\'s'}", "[a, 'b c', NULL]"),
]
NUMBERS = [
    *("0", "1", "7", "2.5", "0.25", "-3", "1000000", "(sensor.clock + 0)", "(sensor.clock / 4)")
]

FIELDS = ("a", "b", "c")
LETTERS = st.sampled_from(['"a"', '"b"', '","', '" "', '"\'"'])

plain_kinds = st.sampled_from(["Num", "Str", "Bool"])
kinds = st.recursive(
    plain_kinds,
    lambda of: (
        st.dictionaries(st.sampled_from(FIELDS), of, min_size=1, max_size=3)
        | plain_kinds.map(lambda kind: [kind])
        | st.dictionaries(st.sampled_from(FIELDS), of, min_size=1, max_size=2).map(lambda r: [r])
    ),
    max_leaves=4,
)


def example(kind: Any) -> str:
    if isinstance(kind, list):
        return f"[{example(kind[0])}]"
    if isinstance(kind, dict):
        return "{" + ", ".join(f"{name}: {example(of)}" for name, of in kind.items()) + "}"
    return {"Num": "0", "Str": '""', "Bool": "true"}[kind]


def call(name: str, *arguments: Text) -> Text:
    return st.tuples(*arguments).map(lambda found: f"{name}({', '.join(found)})")


def infix(operator: str, left: Text, right: Text) -> Text:
    return st.tuples(left, right).map(lambda found: f"({found[0]} {operator} {found[1]})")


def choice(condition: Text, one: Text, other: Text) -> Text:
    parts = st.tuples(condition, one, other)
    return parts.map(lambda found: "(if {} then {} else {})".format(*found))


def values(kind: Any, depth: int) -> Text:
    written = _written(kind, depth)
    if depth <= 0:
        return written
    inner = values(kind, depth - 1)
    other_kind = kinds.flatmap(lambda other: values(other, depth - 2))
    general = [
        *(
            call("TryCast", of, st.just(example(kind)))
            for of in (other_kind, _spelled(kind, depth - 1))
        ),
        call("Coalesce", inner, inner),
        choice(values("Bool", depth - 2), inner, inner),
        inner.map(lambda value: f"{{f: {value}, g: 1}}.f"),
    ]
    if not isinstance(kind, list):
        general.append(call("Element", values([kind], depth - 1), st.integers(-1, 3).map(str)))
    family = "list" if isinstance(kind, list) else "record" if isinstance(kind, dict) else kind
    return st.one_of(written, *general, *_OWN[family](kind, depth - 1))


def _written(kind: Any, depth: int) -> Text:
    if isinstance(kind, list):
        elements = st.lists(values(kind[0], depth - 1), min_size=1, max_size=3)
        return elements.map(lambda found: f"[{', '.join(found)}]")
    if isinstance(kind, dict):
        parts = st.tuples(*(values(of, depth - 1) for of in kind.values()))
        return parts.map(lambda found: "{" + ", ".join(map("{}: {}".format, kind, found)) + "}")
    if kind == "Num":
        return st.sampled_from(NUMBERS)
    if kind == "Bool":
        return st.sampled_from(["true", "false", "(sensor.clock > 5)"])
    return st.sampled_from(SAID).map(lambda text: json.dumps(text, ensure_ascii=False))


def _spelled(kind: Any, depth: int) -> Text:
    return st.one_of(
        call("ToString", values(kind, depth)),
        st.sampled_from([*SAID, *SPELLED]).map(lambda text: json.dumps(text, ensure_ascii=False)),
        values("Str", depth),
    )


def _numbers(_: Any, depth: int) -> list[Text]:
    number, text = values("Num", depth), values("Str", depth)
    return [
        *(infix(operator, number, st.integers(1, 9).map(str)) for operator in "+-*/"),
        *(call(name, number) for name in ("Abs", "Floor", "Round", "Sign")),
        call("Greatest", number, number),
        call("Length", text),
        call("Strpos", text, LETTERS),
        call("Size", plain_kinds.flatmap(lambda kind: values([kind], depth))),
        values(["Num"], depth).map(lambda found: f"Sum{{x{depth} :- x{depth} in {found}}}"),
        values(["Num"], depth).map(lambda found: f"Max{{y{depth} :- y{depth} in {found}}}"),
    ]


def _texts(_: Any, depth: int) -> list[Text]:
    text, small = values("Str", depth), st.integers(-2, 5).map(str)
    return [
        call("ToString", kinds.flatmap(lambda kind: values(kind, depth))),
        infix("++", text, text),
        infix("++", st.just('"j"'), call("RecordAsJson", records(depth))),
        *(call(name, text) for name in ("Upper", "Lower", "Reverse", "Trim")),
        call("Substr", text, small, small),
        call("Replace", text, LETTERS, text),
        call("Lpad", text, small, LETTERS),
        call("Rpad", text, small, LETTERS),
        call("Repeat", text, small),
        call("RegexpExtract", text, st.sampled_from(['"[a-z]+"', '"[0-9.]+"', '"(a|b),?"'])),
        call("Join", values(["Str"], depth), LETTERS),
        call("Join", call("Split", text, LETTERS), st.just('"|"')),
    ]


def _truths(_: Any, depth: int) -> list[Text]:
    truth, text, number = values("Bool", depth), values("Str", depth), values("Num", depth)
    same_kind = kinds.flatmap(
        lambda kind: infix("==", values(kind, depth - 1), values(kind, depth - 1))
    )
    return [
        infix("&&", truth, truth),
        infix("||", truth, truth),
        truth.map(lambda found: f"(!{found})"),
        infix("<", number, number),
        infix("<", text, text),
        # In a list that is null is nothing here, as docs/dialect.md says.
        infix("in", text, call("Coalesce", values(["Str"], depth), st.just('["-"]'))),
        infix("in", number, call("Coalesce", values(["Num"], depth), st.just("[0.5]"))),
        same_kind,
        call("StartsWith", text, text),
        kinds.flatmap(lambda kind: values(kind, depth)).map(lambda found: f"({found} is null)"),
    ]


def _lists(kind: Any, depth: int) -> list[Text]:
    inner = values(kind, depth)
    found = [
        infix("++", inner, inner),
        inner.map(lambda listed: f"List{{z{depth} :- z{depth} in {listed}}}"),
        inner.map(
            lambda listed: (
                f"Array{{ToString(w{depth}) -> w{depth} :- "
                f"w{depth} in {listed}, w{depth} is not null}}"
            )
        ),
    ]
    if kind == ["Str"]:
        found.append(call("Split", values("Str", depth), LETTERS))
    if kind == ["Num"]:
        found.append(st.integers(0, 4).map(lambda count: f"Range({count})"))
    return found


def _records(_: Any, depth: int) -> list[Text]:
    return []


def records(depth: int) -> Text:
    fields = st.dictionaries(st.sampled_from(FIELDS), plain_kinds, min_size=1, max_size=3)
    return fields.flatmap(lambda kind: values(kind, depth))


_OWN: dict[str, Callable[[Any, int], list[Text]]] = {
    "Num": _numbers,
    "Str": _texts,
    "Bool": _truths,
    "list": _lists,
    "record": _records,
}

expressions = kinds.flatmap(lambda kind: values(kind, 3))

_GRAPH = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=1, max_size=8)
_RECURSIONS = [
    "T{n}(x, y) distinct :- E{n}(x, y); T{n}(x, z) distinct :- T{n}(x, y), E{n}(y, z);"
    " V{n}() = Sum{{x * 10 + y :- T{n}(x, y)}};",
    "@Recursive(T{n}, {depth}); T{n}(x) Min= d :- x = 0, d = 0;"
    " T{n}(y) Min= T{n}(x) + x + 1.5 :- E{n}(x, y);"
    " V{n}() = List{{{{x:, d: T{n}(x)}} :- x in Range(6)}};",
    "@Recursive(A{n}, {depth}); A{n}(x) distinct :- x in [0];"
    " A{n}(y) distinct :- B{n}(x), E{n}(x, y);"
    " B{n}(x) distinct :- A{n}(x); B{n}(y) distinct :- A{n}(x), E{n}(y, x);"
    " V{n}() = {{a: Sum{{x :- A{n}(x)}}, b: Sum{{x :- B{n}(x)}}}};",
    "@Recursive(T{n}, {depth}); T{n}(k:, w:) distinct :- k = 0, w = \"0\";"
    " T{n}(k: y, w: w ++ ToString(y)) distinct :- T{n}(k: x, w:), E{n}(x, y), Length(w) < 4;"
    " V{n}() = Array{{w -> w :- T{n}(w:)}};",
]  # fmt: skip


@st.composite
def recursions(draw: Any, number: int) -> tuple[str, str]:
    """Rules of a recursion over a small graph, and an expression of what it gives."""
    facts = "".join(f"E{number}({x}, {y}); " for x, y in sorted(set(draw(_GRAPH))))
    rules = draw(st.sampled_from(_RECURSIONS)).format(n=number, depth=draw(st.integers(12, 16)))
    return facts + rules, f"V{number}()"
