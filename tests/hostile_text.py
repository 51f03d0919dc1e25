"""Families of texts that make careless readers work more than in proportion to their size."""

from collections.abc import Callable

__all__ = ["FILES", "PROGRAMS", "SIGNS"]

Family = Callable[[int], str]
"""From a size to a text of about so many characters."""


def repeated(piece: str, before: str = "", after: str = "") -> Family:
    return lambda size: before + piece * (size // len(piece)) + after


def nested(opening: str, closing: str) -> Family:
    return lambda size: opening * (size // 2) + closing * (size // 2)


def joined(piece: str, separator: str = "", before: str = "", after: str = "") -> Family:
    """Return a family of pieces; ``#`` in one is a number that differs from piece to piece."""

    def text(size: int) -> str:
        pieces = (piece.replace("#", str(n)) for n in range(size // len(piece + separator)))
        return before + separator.join(pieces) + after

    return text


PIECES = (
    *"([{)]};,:|~.@`'\"\\=+-!?$#_ \t\n\r\x01\u00a0Aa9",
    *('"\n', '" ', '"""', "x = '''", "\\'", "'\\q'", ");", "(;\n", "A(\n", "[]", "x[ "),
    *("{a = ", '{"a":', "{'a': ", "/*", "#\n", ":-", "->", "\r\n", " \n", "if ", "A ", "A("),
    *("a ", "a_", "a.", "a . ", "a/", "a: ", "a,", "*a"),
    *("e\u0301", "\uff08\uff09\uff1b", "\N{GRINNING FACE}", "a\u2028"),
    "\ufdfa",  # a ligature of 18 letters
    "\u0130",  # its small letter is two
)
SIGNS: dict[str, Family] = {
    **{f"many {piece!r}": repeated(piece) for piece in PIECES},
    "combining marks": repeated("\u0301\u0327\u0323", "e"),
    "nested parentheses": nested("(", ")"),
    "nested lists": nested("[", "]"),
    "parentheses": repeated("(", "", ")"),
    "blanks in a line": repeated(" ", "a", "b"),
    "tabs in a line": repeated("\t", "a", "b"),
    "empty lines": repeated("\n", "a", "b"),
    "words and underscores": repeated("a_", "", "!"),
    "a call at the end": repeated("A", "", "!("),
    "a list of numbers": repeated("1,", "[", "1]"),
    "a list of nothing": repeated(",", "[", "]"),
    "a list of backslashes": repeated("\\", "["),
    "a list of quotes": repeated("''", "[", "]"),
    "a record of fields": joined("'a#': 1", ", ", "{", "}"),
    "a record of one field": joined("'a': 1", ", ", "{", "}"),
    "an object of fields": joined('"a#": 1', ", ", "{", "}"),
    "objects in a list": repeated('{"a": 1},', "[", "{}]"),
}
PROGRAMS: dict[str, Family] = {
    "facts": joined("A(#);\n"),
    "the same rule": joined("A(x) :- B(x);\n"),
    "misspelt facts": joined("a(#);\n"),
    "unknown predicates": joined("A(x) :- Foo#(x);\n"),
    "copies": joined("A# := B#(C: D);\n"),
    "annotations": joined('@OrderBy(A, "x");\n'),
    "imports": joined("import a;\n"),
    "variables": joined("x# == 1", ", ", "A(x) :- ", ";"),
    "alternatives": joined("x == #", " | ", "A(x) :- ", ";"),
    "denials": joined("~B(x)", ", ", "A(x) :- ", ";"),
    "labels": joined('r.label == "x#"', ", ", "A(1) :- Sensor(sensor:), r in sensor.radar, ", ";"),
    "fields": joined("a#: 1", ", ", "A(x: {", "});"),
    "a sum": joined("#", " + ", "A() = ", ";"),
}
FILES: dict[str, Family] = {
    "a header of blanks": repeated(" ", "x = [\n[", "\n]]"),
    "a header without an end": repeated("a ", "x = [\n['", "'\n]]"),
    "headers of blanks": repeated("[" + " " * 98 + "\n"),
    "a list of blanks": repeated(" \n", "x = [", "]"),
    "a list of strings": repeated('"",', "x = [", "]"),
    "a list of lists": repeated("[]", "x = [", "]"),
    "backslashes in a title": repeated("\\", 'title = "'),
    "quotes in a title": repeated('\\"', 'title = "'),
    "digits": repeated("9", "x = "),
    "sections": repeated("[a]\n"),
    "different sections": joined("[a#]\n"),
    "sections in sections": joined("[a.b.c.d.e.f.g.h#]\n"),
    "items": repeated("[[a]]\n"),
    "items of items": repeated("[[a]]\n[[a.b]]\n"),
    "entries": repeated("a = 1\n"),
    "different entries": joined("a# = 1\n"),
    "entries of parts": joined("a.b.c.d.e.f.g.h# = 1\n"),
    "rows": joined("#,name #,submission #\n", "", "id,name,submission\n"),
    "columns": joined("c#,", "", "id,", "\n" + "a\n" * 1000),
    "columns and rows": lambda size: "id" + ",c" * (size // 4) + "\n" * (size // 4) + "a\n",
    # YAML
    "dashes": repeated("- "),
    "anchors": joined("a#: &a# [*a#, *a#]\n"),
    "documents": repeated("---\n"),
    "questions": repeated("? "),
    "tags": repeated("!a "),
    "folded lines": repeated("\n x", "a: >"),
    "students": joined("s#:\n  :submitters:\n  - :name: Ada #\n    :sid: '#'\n"),
}
