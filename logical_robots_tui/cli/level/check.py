"""``logical-robots level check``: errors and warnings in levels, printed like a compiler's."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.editing.checks import Finding

__all__ = ["declare"]

FINE, WRONG = 0, 2

EPILOG = """\
examples:
  logical-robots level check maze.toml          print errors and warnings
  logical-robots level check *.toml *.json      check several levels
  logical-robots level check maze.toml --json   output for scripts

Positions are x:y in map units from the upper left corner.

exit status: 0 no errors (there may be warnings), 2 a level can't be loaded
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "check",
        start=start,
        wants_json=lambda options: bool(options.json),
        summary="check a level for likely mistakes",
        description="Check levels for likely mistakes: unreachable goals, gaps in the rim, things\n"
        "inside walls, unknown names, and names used twice.",
        epilog=EPILOG,
    )
    command.add_argument("levels", metavar="LEVEL", nargs="+", help="a level's name or file")
    command.add_argument("--json", action="store_true", help="print JSON")


def start(options: argparse.Namespace) -> int:
    """Check each level and print the findings."""
    results = []
    status = FINE
    for name in options.levels:
        found = findings(name)
        if any(finding.forbids for finding in found):
            status = WRONG
        results.append({"file": name, "findings": [asdict(finding) for finding in found]})
        if not options.json:
            for finding in found:
                print(harmless(_line(name, finding)))
    if options.json:
        print(json.dumps({"ok": status == FINE, "levels": results}, indent=2))
    return status


def findings(name: str) -> list[Finding]:
    """Return likely mistakes in a level, or why it can't be loaded."""
    from logical_robots_tui.editing.checks import Finding, check
    from logical_robots_tui.world import LevelError, load_level

    try:
        return check(load_level(name))
    except LevelError as error:
        inner = error.place.removeprefix(name).lstrip(":, ")
        text = f"{inner}: {error.message}" if inner else error.message
        return [Finding(f"{text} {error.hint}".rstrip(), forbids=True)]


def _line(name: str, finding: Finding) -> str:
    place = "" if finding.x is None else f":{finding.x:.0f}:{finding.y:.0f}"
    return f"{name}{place}: {'error' if finding.forbids else 'warning'}: {finding.text}"
