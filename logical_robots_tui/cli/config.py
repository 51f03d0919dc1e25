"""``logical-robots config``: what the configuration file sets, and where it is."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import new_command
from logical_robots_tui.cli.text import harmless
from logical_robots_tui.paths import is_there

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

FINE, WRONG = 0, 2

EPILOG = """\
examples:
  logical-robots config             what is set, with the keys of all commands
  logical-robots config --path      where the file is to be
  logical-robots config --default   how the game comes; a beginning for a file of your own

exit status: 0 all of the file can be used, 2 something in it can't; stderr says what
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "config",
        start=start,
        summary="show the settings and the keys, and where to change them",
        description="Show the settings and the keys as a configuration file that sets the same.",
        epilog=EPILOG,
    )
    command.add_argument("--path", action="store_true", help="print only where the file is to be")
    command.add_argument("--default", action="store_true", help="leave the file out of account")


def start(options: argparse.Namespace) -> int:
    """Print the settings."""
    from logical_robots_tui.tui.app.facts import settings_path
    from logical_robots_tui.tui.app.settings import Settings, as_toml, read_settings

    path = settings_path()
    if options.path:
        print(path)
        return FINE
    settings = Settings() if options.default else read_settings(path)
    what = "what is set in" if is_there(path) and not options.default else "to be put into"
    print(f"# Logical Robots: {what} {harmless(str(path))}", as_toml(settings), sep="\n")
    for complaint in settings.complaints:
        print(harmless(complaint), file=sys.stderr)
    return WRONG if settings.complaints else FINE
