"""``logical-robots config``: the settings, and where the configuration file is."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command
from logical_robots_tui.paths import is_there

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

FINE, WRONG = 0, 2

EPILOG = """\
examples:
  logical-robots config             the settings and the keys of all commands
  logical-robots config --path      the path of the configuration file
  logical-robots config --default   the defaults, to start your own file

exit status: 0 the file is valid, 2 it has errors, which are printed to stderr
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "config",
        start=start,
        summary="show the settings and keys, and where to change them",
        description="Print the settings and keys in the format of the configuration file.",
        epilog=EPILOG,
    )
    command.add_argument("--path", action="store_true", help="print only the path of the file")
    command.add_argument("--default", action="store_true", help="print the defaults instead")


def start(options: argparse.Namespace) -> int:
    """Print the settings."""
    from logical_robots_tui.tui.app.settings import Settings, as_toml, read_settings, settings_path

    path = settings_path()
    if options.path:
        print(path)
        return FINE
    settings = Settings() if options.default else read_settings(path)
    what = "settings from" if is_there(path) and not options.default else "defaults, to be put into"
    print(f"# Logical Robots: {what} {harmless(str(path))}", as_toml(settings), sep="\n")
    for complaint in settings.complaints:
        print(harmless(complaint), file=sys.stderr)
    return WRONG if settings.complaints else FINE
