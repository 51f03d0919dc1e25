"""Families of texts that keep readers of files busy: openers, quotes, names, again and again."""

from collections.abc import Callable


def _repeated(piece: str, begin: str = "", end: str = "") -> Callable[[int], str]:
    return lambda size: begin + piece * (size // len(piece)) + end


def _numbered(piece: str, begin: str = "", end: str = "") -> Callable[[int], str]:
    """A family of lines or items that differ in a number, which `piece` has as ``{n}``."""
    length = len(piece.format(n=10_000))
    return lambda size: begin + "".join(piece.format(n=n) for n in range(size // length)) + end


FAMILIES: dict[str, Callable[[int], str]] = {
    # brackets
    "lists that are open": _repeated("["),
    "a header of blanks": _repeated(" ", "x = [\n[", "\n]]"),
    "a header without an end": _repeated("a ", "x = [\n['", "'\n]]"),
    "a list of blanks": _repeated(" \n", "x = [", "]"),
    "a list of strings": _repeated('"",', "x = [", "]"),
    "headers of blanks": _repeated("[" + " " * 98 + "\n"),
    "lists that are closed": _repeated("[]", "x = [", "]"),
    "closers": _repeated("]"),
    "tables that are open": _repeated("{a = "),
    "objects that are open": _repeated('{"a":'),
    "parentheses": _repeated("(", "", ")"),
    # quotes, escapes and blanks
    "quotes": _repeated('"'),
    "apostrophes": _repeated("'"),
    "long strings": _repeated("x = '''"),
    "quotes and blanks": _repeated('" '),
    "backslashes": _repeated("\\", 'title = "'),
    "escaped quotes": _repeated('\\"', 'title = "'),
    "blanks": _repeated(" ", "a", "b"),
    "tabs": _repeated("\t", "a", "b"),
    "empty lines": _repeated("\n", "a", "b"),
    "carriage returns": _repeated("\r"),
    "blank lines": _repeated(" \n", "a = 1"),
    # names, keys and numbers
    "a name": _repeated("a"),
    "a capital name": _repeated("A"),
    "words": _repeated("a "),
    "underscores": _repeated("_", "a", "!"),
    "words and underscores": _repeated("a_", "", "!"),
    "digits": _repeated("9", "x = "),
    "hyphens": _repeated("-"),
    "dots": _repeated("a."),
    "dots and blanks": _repeated("a . "),
    "slashes": _repeated("a/"),
    "colons": _repeated("a: "),
    "commas": _repeated("a,"),
    "stars": _repeated("*a"),
    "hashes": _repeated("#"),
    "hashes in lines": _repeated("#\n"),
    "equal signs": _repeated("="),
    # characters
    "combining marks": _repeated("\u0301\u0327\u0323", "e"),
    "ligatures": _repeated("\ufdfa"),  # each is 18 letters
    "capital letters of one that are two": _repeated("\u0130"),
    "characters of four bytes": _repeated("\U0001f600"),
    "line ends of other kinds": _repeated("a\u2028"),
    # sections, entries and rows
    "sections": _repeated("[a]\n"),
    "different sections": _numbered("[a{n}]\n"),
    "sections in sections": _numbered("[a.b.c.d.e.f.g.h{n}]\n"),
    "items": _repeated("[[a]]\n"),
    "items of items": _repeated("[[a]]\n[[a.b]]\n"),
    "entries": _repeated("a = 1\n"),
    "different entries": _numbered("a{n} = 1\n"),
    "entries of parts": _numbered("a.b.c.d.e.f.g.h{n} = 1\n"),
    "entries of an object": _numbered('"a{n}": 1,', "{", '"": 1}'),
    "objects in a list": _repeated('{"a": 1},', "[", "{}]"),
    "rows": _numbered("{n},name {n},submission {n}\n", "id,name,submission\n"),
    "columns": _numbered("c{n},", "id,", "\n" + "a\n" * 1000),
    "columns and rows": lambda size: "id" + ",c" * (size // 4) + "\n" * (size // 4) + "a\n",
    # YAML
    "dashes": _repeated("- "),
    "anchors": _numbered("a{n}: &a{n} [*a{n}, *a{n}]\n"),
    "documents": _repeated("---\n"),
    "questions": _repeated("? "),
    "tags": _repeated("!a "),
    "folded lines": _repeated("\n x", "a: >"),
    "students": _numbered("s{n}:\n  :submitters:\n  - :name: Ada {n}\n    :sid: '{n}'\n"),
}
"""By name, a function from a size to a text of about so many characters."""
