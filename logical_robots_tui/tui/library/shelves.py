"""What the chooser can choose from: programs, and versions of a program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.paths import typed_path
from logical_robots_tui.tui.library.chooser import Card

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from logical_robots_tui.game import Source
    from logical_robots_tui.progress import Version

__all__ = ["ProgramShelf", "VersionShelf"]


@dataclass(frozen=True)
class ProgramShelf:
    """The programs that came with the game, the player's own, and program files."""

    own: Path
    title: str = "Choose a program"
    placeholder: str = "type to filter, or the path of a .l file"

    def names(self) -> Sequence[str]:
        """Names of the shipped programs, then of the player's own."""
        return list_programs(self.own)

    def card(self, name: str) -> Card:
        """The first comment and the text of a program."""
        try:
            source = load_program(name, self.own)
        except InputError as error:
            return Card("can't be used", str(error), is_error=True)
        return Card(_first_comment(source) or ("" if source.shipped else "your own"), source.text)

    def take(self, name_or_path: str) -> Source:
        """Load a program; raises `InputError`."""
        wanted = typed_path(name_or_path) if "/" in name_or_path else name_or_path
        return load_program(wanted, self.own)


@dataclass(frozen=True)
class VersionShelf:
    """What a player has tried at a level."""

    versions: Sequence[Version]
    title: str = "Earlier versions"
    placeholder: str = "type to filter"

    def names(self) -> Sequence[str]:
        """When each was last used, the newest first."""
        return [self._name(version) for version in self.versions]

    def card(self, name: str) -> Card:
        """Whether it has won and how well, and its text."""
        version = self.take(name)
        return Card(_verdict(version), version.text)

    def take(self, name_or_path: str) -> Version:
        """The version of that name; raises `InputError`."""
        for version in self.versions:
            if self._name(version) == name_or_path:
                return version
        raise InputError("There is no such version.")

    def _name(self, version: Version) -> str:
        return f"{version.kept.astimezone():%d %b %H:%M} #{version.number}"


def _verdict(version: Version) -> str:
    lines = version.text.count("\n") + 1
    measures = version.measures
    if measures is None:
        return "★ won" if version.won else f"{lines} lines"
    robust = f", {measures.wins}/{measures.starts}" if measures.wins is not None else ""
    return f"★ {measures.ticks} ticks{robust}"


def _first_comment(source: Source) -> str:
    for line in source.text.splitlines()[:20]:
        if line.lstrip().startswith("#"):
            return line.lstrip().lstrip("#").strip()
    return ""
