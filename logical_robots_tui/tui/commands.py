"""Every command of the game, each declared once.

A declaration yields the key binding, the entry in the command bar, the entry in the palette and
the line in the help.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.binding import Binding

from logical_robots_tui.tui.command import Command, Place, key_name
from logical_robots_tui.tui.looking_commands import GROUPS as LOOKING_GROUPS
from logical_robots_tui.tui.looking_commands import LOOKING
from logical_robots_tui.tui.playing_commands import GROUPS as PLAYING_GROUPS
from logical_robots_tui.tui.playing_commands import PLAYING

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["COMMANDS", "GROUPS", "Command", "Place", "bindings", "command", "key_name"]

COMMANDS = PLAYING + LOOKING
GROUPS = PLAYING_GROUPS + LOOKING_GROUPS

_BY_ID = {entry.id: entry for entry in COMMANDS}


def command(command_id: str) -> Command:
    """The command of that name."""
    return _BY_ID[command_id]


def bindings() -> Iterator[Binding]:
    """The key bindings of all commands."""
    for entry in COMMANDS:
        if entry.keys:
            yield Binding(
                ",".join(entry.keys),
                f"command('{entry.id}')",
                entry.title,
                tooltip=entry.help,
                show=False,
                id=entry.id,
            )
