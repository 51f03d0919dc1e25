"""Write the tables of functions, fields, settings and commands: ``python -m docs.reference``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.plain import table
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.player.settings import rows
from logical_robots_tui.schema import tables

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

TARGET = Path(__file__).with_name("reference.md")
LANGUAGE = TARGET.with_name("dialect.md")
SETTINGS = TARGET.with_name("settings.md")
COMMANDS = TARGET.with_name("commands.md")
HEAD = """\
# Functions

`logical-robots help` shows the same text. An aggregate is written with braces, as in
`Sum{x :- P(x)}`, or in the head of a rule, as in `P(name, total? Sum= x) distinct :- Q(name, x);`.
Null means "no value"; almost every operation on null gives null. Booleans are shown as 1 and 0.
"""


def page() -> str:
    """The whole page of functions."""
    return "\n".join([HEAD, *_tables(), "## Fields\n", *tables(), ""])


def language() -> str:
    """The page on the language, with the table of fields as it should be."""
    return _filled(LANGUAGE, "fields", tables())


def settings() -> str:
    """The page on settings, with their table as it should be."""
    return _filled(SETTINGS, "settings", _settings())


def commands() -> str:
    """The page on the command line, with the table of what is typed in plain text."""
    return _filled(COMMANDS, "typed commands", table())


PAGES = {TARGET: page, LANGUAGE: language, SETTINGS: settings, COMMANDS: commands}


def _filled(page: Path, mark: str, lines: Iterable[str]) -> str:
    begin, end = f"<!-- {mark} -->", f"<!-- end of {mark} -->"
    before, _, rest = page.read_text(encoding="utf-8").partition(begin)
    return "\n".join([before + begin, *lines, end + rest.partition(end)[2]])


def _settings() -> Iterator[str]:
    yield "| setting | values | by default | what it does |"
    yield "|---|---|---|---|"
    for row in rows():
        values = ", ".join(row.kind.choices) or row.kind
        default = "" if row.default is None else f"`{json.dumps(row.default)}`"
        yield f"| `{row.name}` | {values} | {default} | {row.sentence} |"


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
    for path, text in PAGES.items():
        path.write_text(text(), encoding="utf-8")
