"""The commands with the keys that a player gave them; each app has its own."""

from __future__ import annotations

from contextvars import ContextVar
from dataclasses import replace
from typing import TYPE_CHECKING

from textual.binding import Binding

from logical_robots_tui.tui.commands.command import key_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from logical_robots_tui.tui.commands.command import Command, Scope

__all__ = ["KEY_MAP", "KeyMap", "command", "commands", "with_keys"]


class KeyMap:
    """All commands, with their keys.

    Args:
        commands: The commands with the keys that they come with.
        keys: Other keys, by the id of the command.

    Attributes:
        by_id: The commands with the keys that they have now.
    """

    def __init__(
        self, commands: Iterable[Command], keys: Mapping[str, tuple[str, ...]] | None = None
    ) -> None:
        given = keys or {}
        found = {
            entry.id: replace(entry, keys=given.get(entry.id, entry.keys)) for entry in commands
        }
        # Without a key of its own the palette is still in the bar, to be clicked.
        palette = found["palette"]
        instead = key_name(palette.keys[0]) if palette.keys else palette.bar
        self.by_id = {entry.id: replace(entry, without_key=instead) for entry in found.values()}

    def bindings(self) -> Iterator[Binding]:
        """The key bindings of the main screen."""
        for entry in self.by_id.values():
            if entry.keys and entry.scope == "screen":
                yield Binding(
                    ",".join(entry.keys),
                    f"command('{entry.id}')",
                    entry.title,
                    tooltip=entry.help,
                    show=False,
                    id=entry.id,
                )


KEY_MAP: ContextVar[KeyMap] = ContextVar("key_map")
"""The key map of the app that is running, set by it."""


def commands(*scopes: Scope) -> list[Command]:
    """The commands whose keys act in one of these scopes, or all."""
    return [entry for entry in KEY_MAP.get().by_id.values() if not scopes or entry.scope in scopes]


def command(command_id: str) -> Command:
    """The command of that name."""
    return KEY_MAP.get().by_id[command_id]


def with_keys(text: str) -> str:
    """Put the player's keys into a text that names commands in braces, such as ``{run} runs``."""
    known = KEY_MAP.get().by_id
    return text.format_map({name: entry.key_name for name, entry in known.items()})
