"""Families of texts that make careless readers work more than in proportion to their size."""

from collections.abc import Callable

__all__ = ["TEXTS", "repeated"]


def repeated(piece: str, before: str = "", after: str = "") -> Callable[[int], str]:
    return lambda size: before + piece * (size // len(piece)) + after


def nested(opening: str, closing: str) -> Callable[[int], str]:
    return lambda size: opening * (size // 2) + closing * (size // 2)


def rules(rule: str) -> Callable[[int], str]:
    """Return a family of programs; ``#`` in the rule is a number that differs from rule to rule."""
    return lambda size: "".join(rule.replace("#", str(n)) for n in range(size // len(rule)))


def joined(piece: str, separator: str, before: str, after: str) -> Callable[[int], str]:
    def text(size: int) -> str:
        pieces = (piece.replace("#", str(n)) for n in range(size // len(piece + separator)))
        return before + separator.join(pieces) + after

    return text


SIGNS = {
    **{f"many {sign!r}": repeated(sign) for sign in "([{)]};,:|~.@`'\"\\=+-!?$ \t\n\r\x01\u00a0"},
    **{f"many {piece!r}": repeated(piece) for piece in ('"\n', ");", "(;\n", "[]", "{'a': ")},
    **{f"many {piece!r}": repeated(piece) for piece in ("/*", "#\n", '"""', ":-", "->", "\r\n")},
    **{f"many {piece!r}": repeated(piece) for piece in ("if ", "A ", "A(", "a.", "\\'", "'\\q'")},
    "one long name": repeated("A"),
    "combining marks": repeated("\u0301", "e"),
    "marked letters": repeated("e\u0301"),
    "look-alikes": repeated("\uff08\uff09\uff1b"),
    "emoji": repeated("\N{GRINNING FACE}"),
    "nested parentheses": nested("(", ")"),
    "nested lists": nested("[", "]"),
    "a list of numbers": repeated("1,", "[", "1]"),
    "a list of nothing": repeated(",", "[", "]"),
    "a list of backslashes": repeated("\\", "["),
    "a list of quotes": repeated("''", "[", "]"),
    "a record of fields": joined("'a#': 1", ", ", "{", "}"),
    "a record of one field": joined("'a': 1", ", ", "{", "}"),
}
PROGRAMS = {
    "facts": rules("A(#);\n"),
    "the same rule": rules("A(x) :- B(x);\n"),
    "misspelt facts": rules("a(#);\n"),
    "unknown predicates": rules("A(x) :- Foo#(x);\n"),
    "copies": rules("A# := B#(C: D);\n"),
    "annotations": rules('@OrderBy(A, "x");\n'),
    "imports": rules("import a;\n"),
    "variables": joined("x# == 1", ", ", "A(x) :- ", ";"),
    "alternatives": joined("x == #", " | ", "A(x) :- ", ";"),
    "denials": joined("~B(x)", ", ", "A(x) :- ", ";"),
    "labels": joined('r.label == "x#"', ", ", "A(1) :- Sensor(sensor:), r in sensor.radar, ", ";"),
    "fields": joined("a#: 1", ", ", "A(x: {", "});"),
    "a sum": joined("#", " + ", "A() = ", ";"),
}
TEXTS = SIGNS | PROGRAMS
