"""Programs made by lot, to ask why of: everything that a rule can be made of, in small."""

from random import Random

from tests.explain.asking import REST

__all__ = ["program"]
_FUNCTIONS = """
F(a) = a + 1;
G(a) = (if a > 2 then F(a) else if a == 1 then 0 else a * 2);
H(a, b) = Coalesce(b, a);
Big(a) :- a > 1;
Split(a, b) :- b == a - 1;
Two(a) = b :- A(x: a, y: b);
"""
_RECURSIONS = (
    "R(x:, y:) distinct :- A(x:, y:);\nR(x:, y:) distinct :- A(x:, y: z), R(x: z, y:);",
    "R(x:, y:) distinct :- A(x:, y:);\nR(x:, y:) distinct :- R(x:, y: z), A(x: z, y:), z < 4;",
    "R(x: 0, y? Min= 0) distinct;\n"
    "R(x: y, y? Min= e + 1) distinct :- R(x:, y: e), A(x:, y:), e < 6;",
)


def program(seed: int) -> str:
    lot = Random(seed)
    number, one = lot.randint, lot.choice

    def facts(name: str) -> str:
        pairs = {(number(0, 4), one(["0", "1", "2", "3", "4", "null"])) for _ in range(4)}
        return " ".join(f"{name}(x: {x}, y: {y});" for x, y in sorted(pairs))

    known = ["A", "B"]

    def expression(names: list[str]) -> str:
        v, w = one(names), one(names)
        return one(
            [v, v, f"{v} + {w}", f"F({v})", f"G({v})", f"H({v}, {w})", f"Two({v})",
             f"(if {v} > {w} then {v} else F({w}))", f"Coalesce({v}, 7)",
             f"Greatest({v}, {w})", f"{{a: {v}, b: {w}}}.a", "3"]
        )  # fmt: skip

    def aggregate(names: list[str]) -> str:
        v, p = one(names), one(known)
        return one(
            [f"Sum{{q :- {p}(x: {v}, y: q)}}", f"Max{{q + {v} :- {p}(x: q, y: r), r < {v}}}",
             f"Count{{q :- {p}(x: q, y: {v})}}", f"Min{{q :- {p}(x: q), q > {v}}}",
             f"ArgMin{{q -> r :- {p}(x: q, y: r), q != {v}}}", f"List{{q :- q in [{v}, 2]}}[0]",
             f"Sum{{F(q) :- q in [1, {v}]}}"]
        ).replace("[0]", "")  # fmt: skip

    def condition(names: list[str], local: str) -> str:
        v, w, p = one(names), one(names), one(known)
        return one(
            [f"{v} < {w}", f"{v} != {w}", f"Big({v})", f"~{p}(x: {v})", f"{p}(x: {v}, y: {w})",
             f"~({p}(x: {v}, y: {local}), {local} > {w})", f"({v} == 1 | {w} > 2)",
             f"({p}(x: {v}) | {v} < 2, ~Big({w}))", f"({p}(x: {v}, y: {local}) => {local} > 0)",
             f"F({v}) > {w}", f"{v} is not null", f"{v} in [0, 1, 3]"]
        )  # fmt: skip

    def rule(name: str, head: str) -> str:
        names: list[str] = []
        parts = []
        for place in range(number(1, 3)):
            v, w, p = f"v{place}", f"w{place}", one(known)
            kind = number(0, 7)
            if kind <= 2 or not names:
                parts.append(f"{p}(x: {v}, y: {w})")
                names += [v, w]
            elif kind == 3:
                parts.append(f"{p}(x: {v}, y: {one(names)})")
                names.append(v)
            elif kind == 4:
                parts.append(f"{v} in [{one(names)}, 2, {one(names)}]")
                names.append(v)
            elif kind == 5:
                parts.append(f"{v} == {expression(names)}")
                names.append(v)
            elif kind == 6:
                parts.append(f"{v} == {aggregate(names)}")
            else:
                parts.append(f"Split({one(names)}, {v})")
                names.append(v)
        parts += [condition(names, f"l{place}") for place in range(number(0, 2))]
        first, second = expression(names), expression(names)
        if number(0, 3) == 0:
            parts = parts[::-1]
        body = ", ".join(parts)
        return f"{name}(x: {first}, {head.format(second)} :- {body};"

    text = [facts("A"), facts("B"), _FUNCTIONS]
    for place in range(number(1, 3)):
        name = f"P{place}"
        operator = one(["Min", "Max", "+", "List", "Set", "Count"])
        head = one(["y: {})", "y: {})", "y: {}) distinct", f"y? {operator}= {{}}) distinct"])
        text += [rule(name, head) for _ in range(number(1, 2))]
        known.append(name)
    if number(0, 2) == 0:
        text.append(one(_RECURSIONS))
        known.append("R")
        text.append(rule("P8", "y: {})"))
    first = "\n".join(each for each in text if each.startswith("P1("))
    if "A(x:" in first and number(0, 1) == 0:
        text.append("P9 := P1(A: B);")
    return "\n".join([*text, REST])
