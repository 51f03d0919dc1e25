"""``logical-robots help``: the functions, aggregates and operators of the language."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import columns, new_command
from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.mind.reference import FunctionHelp

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots help               list everything
  logical-robots help ArgMin        explain one of them
  logical-robots help '%'           operators need quotes

exit status: 0, or 2 if there is no such function
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "help",
        start=start,
        summary="explain the functions that a program can use",
        description="Explain the functions, aggregates and operators that a program can use.",
        epilog=EPILOG,
    )
    command.add_argument("name", metavar="FUNCTION", nargs="?", help="what to explain")


def start(options: argparse.Namespace) -> int:
    """Print help on one function, or the list of all."""
    from logical_robots_tui.mind.reference import REFERENCE, find_help, similar

    if options.name is None:
        for kind in ("operator", "aggregate", "function"):
            rows: list[tuple[str, ...]] = [
                (entry.name, entry.summary) for entry in REFERENCE if entry.kind == kind
            ]
            print(f"{kind.capitalize()}s", *(f"  {row}" for row in columns(rows)), "", sep="\n")
        print("logical-robots help NAME explains one, with an example.")
        return 0
    entry = find_help(options.name)
    if entry is None:
        close = similar(options.name)
        hint = f"Did you mean {close}?" if close else "`logical-robots help` lists all functions."
        raise InputError(f"there is no function {options.name}.", hint=hint)
    print(_explained(entry))
    return 0


def _explained(entry: FunctionHelp) -> str:
    article = "an" if entry.kind[0] in "ao" else "a"
    return "\n".join(
        [
            entry.signature,
            f"  {entry.summary} ({article} {entry.kind})",
            "",
            f"  {entry.example}",
            f"  gives {entry.result}",
        ]
    )
