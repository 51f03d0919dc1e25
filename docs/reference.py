"""Write tables from their data: functions, fields, typed commands: ``python -m docs.reference``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.plain import table
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.schema import tables

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

TARGET = Path(__file__).with_name("reference.md")
PROGRAMS = Path(__file__).with_name("programs.md")
COMMANDS = Path(__file__).with_name("commands.md")
HEAD = """\
# Functions

`logical-robots help` shows the same text. An aggregate is written with braces, as in
`Sum{x :- P(x)}`, or in the head of a rule, as in `P(name, total? Sum= x) distinct :- Q(name, x);`.
Null means "no value"; almost every operation on null gives null. Booleans are shown as 1 and 0.
"""


def page() -> str:
    """The whole page of functions."""
    return "\n".join([HEAD, *_tables(), "## Fields\n", *tables(), ""])


def programs() -> str:
    """The page on programs, with the table of fields as it should be."""
    return _with(PROGRAMS, "fields", tables())


def commands() -> str:
    """The page on the command line, with the table of what is typed in plain text."""
    return _with(COMMANDS, "typed commands", table())


def _with(page: Path, name: str, lines: Iterable[str]) -> str:
    """A page with new lines between two marks."""
    before, begin, rest = page.read_text(encoding="utf-8").partition(f"<!-- {name} -->")
    _, end, after = rest.partition(f"<!-- end of {name} -->")
    return "\n".join([before + begin, *lines, end + after])


def _tables() -> Iterator[str]:
    for kind in ("operator", "aggregate", "function"):
        yield f"## {kind.capitalize()}s\n"
        yield "| how to write it | what it gives | example | result |"
        yield "|---|---|---|---|"
        for entry in REFERENCE:
            if entry.kind == kind:
                cells = (entry.signature, entry.summary, entry.example, entry.result)
                signature, summary, example, result = (c.replace("|", "\\|") for c in cells)
                yield f"| `{signature}` | {summary} | `{example}` | `{result}` |"
        yield ""


if __name__ == "__main__":
    TARGET.write_text(page(), encoding="utf-8")
    PROGRAMS.write_text(programs(), encoding="utf-8")
    COMMANDS.write_text(commands(), encoding="utf-8")
