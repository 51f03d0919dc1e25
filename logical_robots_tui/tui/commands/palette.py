"""The palette: all commands by a part of their name."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from textual.command import CommandPalette, DiscoveryHit, Hit, Provider

from logical_robots_tui.tui.commands.keymap import commands
from logical_robots_tui.tui.layout.dialogs import ClosedOnce

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.command import Hits

    from logical_robots_tui.tui.commands.command import Command

__all__ = ["CommandProvider", "EditingProvider", "Palette"]


class Palette(CommandPalette, ClosedOnce[None]):
    """A line to type in, and what can be had by that."""


class CommandProvider(Provider):
    """Offers every command but those of the level editor."""

    def offered(self) -> list[Command]:
        """The commands, in the order in which they are shown."""
        return commands("screen", "text")

    async def discover(self) -> Hits:
        """All commands, before anything is typed."""
        for entry in self.offered():
            if entry.id != "palette":
                yield DiscoveryHit(
                    _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    async def search(self, query: str) -> Hits:
        """The commands whose title or help matches."""
        matcher = self.matcher(query)
        for entry in self.offered():
            score = max(matcher.match(entry.title), matcher.match(entry.help) * 0.5)
            if score > 0 and entry.id != "palette":
                yield Hit(
                    score, _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    def _caller(self, entry: Command) -> Callable[[], object]:
        return partial(self.screen.run_action, f"command('{entry.id}')")


class EditingProvider(CommandProvider):
    """Offers the commands of the level editor first, then all others."""

    def offered(self) -> list[Command]:
        """The commands, in the order in which they are shown."""
        return commands("level") + super().offered()


def _title(entry: Command) -> str:
    return f"{entry.title}   {entry.key_names}" if entry.keys else entry.title
