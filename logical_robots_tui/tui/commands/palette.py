"""The palette: all commands by a part of their name."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from textual.command import CommandPalette, DiscoveryHit, Hit, Provider

from logical_robots_tui.tui.app.once import ClosedOnce
from logical_robots_tui.tui.commands.table import commands, editing_commands
from logical_robots_tui.tui.commands.writing import WRITING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from textual.command import Hits

    from logical_robots_tui.tui.commands.table import Command

__all__ = ["CommandProvider", "Palette"]


class Palette(CommandPalette, ClosedOnce[None]):
    """A line to type in, and what can be had by that."""


class CommandProvider(Provider):
    """Offers every command of the game; while a level is edited, those for that come first."""

    async def discover(self) -> Hits:
        """All commands, before anything is typed."""
        for entry in self._offered():
            if entry.id != "palette":
                yield DiscoveryHit(
                    _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    async def search(self, query: str) -> Hits:
        """The commands whose title or help matches."""
        matcher = self.matcher(query)
        for entry in self._offered():
            if entry.id == "palette":
                continue
            score = max(matcher.match(entry.title), matcher.match(entry.help) * 0.5)
            if score > 0:
                yield Hit(
                    score, _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    def _offered(self) -> Iterable[Command]:
        from logical_robots_tui.tui.app.main_screen import MainScreen

        edits = isinstance(self.screen, MainScreen) and self.screen.editing.is_on
        known = (*commands(), *WRITING)
        return (*editing_commands().values(), *known) if edits else known

    def _caller(self, entry: Command) -> Callable[[], object]:
        return partial(self.screen.run_action, f"command('{entry.id}')")


def _title(entry: Command) -> str:
    return f"{entry.title}   {entry.key_names}" if entry.keys else entry.title
