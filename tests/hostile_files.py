"""Families of texts that keep readers of files busy: openers, quotes, names, again and again."""

from collections.abc import Callable

from tests.hostile_text import repeated


def _numbered(piece: str, begin: str = "", end: str = "") -> Callable[[int], str]:
    """A family of lines or items that differ in a number, which `piece` has as ``{n}``."""
    length = len(piece.format(n=10_000))
    return lambda size: begin + "".join(piece.format(n=n) for n in range(size // length)) + end


FAMILIES: dict[str, Callable[[int], str]] = {
    # brackets
    "lists that are open": repeated("["),
    "a header of blanks": repeated(" ", "x = [\n[", "\n]]"),
    "a header without an end": repeated("a ", "x = [\n['", "'\n]]"),
    "a list of blanks": repeated(" \n", "x = [", "]"),
    "a list of strings": repeated('"",', "x = [", "]"),
    "headers of blanks": repeated("[" + " " * 98 + "\n"),
    "lists that are closed": repeated("[]", "x = [", "]"),
    "closers": repeated("]"),
    "tables that are open": repeated("{a = "),
    "objects that are open": repeated('{"a":'),
    "parentheses": repeated("(", "", ")"),
    # quotes, escapes and blanks
    "quotes": repeated('"'),
    "apostrophes": repeated("'"),
    "long strings": repeated("x = '''"),
    "quotes and blanks": repeated('" '),
    "backslashes": repeated("\\", 'title = "'),
    "escaped quotes": repeated('\\"', 'title = "'),
    "blanks": repeated(" ", "a", "b"),
    "tabs": repeated("\t", "a", "b"),
    "empty lines": repeated("\n", "a", "b"),
    "carriage returns": repeated("\r"),
    "blank lines": repeated(" \n", "a = 1"),
    # names, keys and numbers
    "a name": repeated("a"),
    "a capital name": repeated("A"),
    "words": repeated("a "),
    "underscores": repeated("_", "a", "!"),
    "words and underscores": repeated("a_", "", "!"),
    "digits": repeated("9", "x = "),
    "hyphens": repeated("-"),
    "dots": repeated("a."),
    "dots and blanks": repeated("a . "),
    "slashes": repeated("a/"),
    "colons": repeated("a: "),
    "commas": repeated("a,"),
    "stars": repeated("*a"),
    "hashes": repeated("#"),
    "hashes in lines": repeated("#\n"),
    "equal signs": repeated("="),
    # characters
    "combining marks": repeated("\u0301\u0327\u0323", "e"),
    "ligatures": repeated("\ufdfa"),  # each is 18 letters
    "capital letters of one that are two": repeated("\u0130"),
    "characters of four bytes": repeated("\U0001f600"),
    "line ends of other kinds": repeated("a\u2028"),
    # sections, entries and rows
    "sections": repeated("[a]\n"),
    "different sections": _numbered("[a{n}]\n"),
    "sections in sections": _numbered("[a.b.c.d.e.f.g.h{n}]\n"),
    "items": repeated("[[a]]\n"),
    "items of items": repeated("[[a]]\n[[a.b]]\n"),
    "entries": repeated("a = 1\n"),
    "different entries": _numbered("a{n} = 1\n"),
    "entries of parts": _numbered("a.b.c.d.e.f.g.h{n} = 1\n"),
    "entries of an object": _numbered('"a{n}": 1,', "{", '"": 1}'),
    "objects in a list": repeated('{"a": 1},', "[", "{}]"),
    "rows": _numbered("{n},name {n},submission {n}\n", "id,name,submission\n"),
    "columns": _numbered("c{n},", "id,", "\n" + "a\n" * 1000),
    "columns and rows": lambda size: "id" + ",c" * (size // 4) + "\n" * (size // 4) + "a\n",
    # YAML
    "dashes": repeated("- "),
    "anchors": _numbered("a{n}: &a{n} [*a{n}, *a{n}]\n"),
    "documents": repeated("---\n"),
    "questions": repeated("? "),
    "tags": repeated("!a "),
    "folded lines": repeated("\n x", "a: >"),
    "students": _numbered("s{n}:\n  :submitters:\n  - :name: Ada {n}\n    :sid: '{n}'\n"),
}
"""By name, a function from a size to a text of about so many characters."""
