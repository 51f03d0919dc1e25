"""Every command of the game, each declared once; those for editing act only while one edits.

A declaration yields the key binding, the entry in the command bar, the entry in the palette and
the line in the help.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from textual.binding import Binding

from logical_robots_tui.tui.commands.command import Command, Place, key_name
from logical_robots_tui.tui.commands.editing import EDITING, MAKING
from logical_robots_tui.tui.commands.editing import GROUPS as EDITING_GROUPS
from logical_robots_tui.tui.commands.looking import GROUPS as LOOKING_GROUPS
from logical_robots_tui.tui.commands.looking import LOOKING
from logical_robots_tui.tui.commands.playing import GROUPS as PLAYING_GROUPS
from logical_robots_tui.tui.commands.playing import PLAYING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

__all__ = [
    "COMMANDS",
    "EDITING",
    "GROUPS",
    "Command",
    "Place",
    "bindings",
    "command",
    "commands",
    "editing_commands",
    "key_name",
    "use_keys",
    "with_keys",
]

COMMANDS = PLAYING + MAKING + LOOKING
"""All commands as they come, but those that act only while a level is edited."""

GROUPS = PLAYING_GROUPS + EDITING_GROUPS + LOOKING_GROUPS

_in_use = {entry.id: entry for entry in COMMANDS}
_in_use_editing = {entry.id: entry for entry in EDITING}


def use_keys(keys: Mapping[str, tuple[str, ...]]) -> None:
    """Give commands other keys, for the whole process.

    Args:
        keys: By the id of the command; those that are not named get back what they came with.
    """
    palette = next(entry for entry in COMMANDS if entry.id == "palette")
    palette_keys = keys.get(palette.id, palette.keys)
    # Without a key of its own the palette is still in the bar, to be clicked.
    instead = key_name(palette_keys[0]) if palette_keys else palette.bar
    for known, in_use in ((COMMANDS, _in_use), (EDITING, _in_use_editing)):
        for entry in known:
            own = keys.get(entry.id, entry.keys)
            in_use[entry.id] = replace(entry, keys=own, without_key=instead)


def commands() -> Iterable[Command]:
    """All commands with the keys that the player gave them, but those for editing."""
    return _in_use.values()


def editing_commands() -> Mapping[str, Command]:
    """The commands that act only while a level is edited, by id, with the player's keys."""
    return _in_use_editing


def command(command_id: str) -> Command:
    """The command of that name."""
    return _in_use[command_id]


def with_keys(text: str) -> str:
    """Put the player's keys into a text that names commands in braces, such as ``{run} runs``."""
    known = (*commands(), *editing_commands().values())
    return text.format_map({entry.id: entry.key_name for entry in known})


def bindings() -> Iterator[Binding]:
    """The key bindings of all commands."""
    for entry in commands():
        if entry.keys:
            yield Binding(
                ",".join(entry.keys),
                f"command('{entry.id}')",
                entry.title,
                tooltip=entry.help,
                show=False,
                id=entry.id,
            )
