"""What the chooser can choose from: levels and programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.tui.dialogs.chooser import Card
from logical_robots_tui.world import list_levels, load_level

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.game import Source
    from logical_robots_tui.world import Level

__all__ = ["LevelShelf", "ProgramShelf"]


@dataclass(frozen=True)
class LevelShelf:
    """The levels that came with the game, and level files."""

    title: str = "Choose a level"
    placeholder: str = "type to filter, or the path of a .toml or .json file"

    def names(self) -> Sequence[str]:
        """Names of the shipped levels."""
        return list_levels()

    def card(self, name: str) -> Card:
        """Title, number of robots and briefing of a level."""
        try:
            level = load_level(name)
        except InputError as error:
            return Card("can't be used", str(error), is_error=True)
        count = len(level.robots)
        robots = "1 robot" if count == 1 else f"{count} robots"
        preview = f"{level.title}\n{robots}\n\n{level.briefing}".rstrip()
        return Card(f"{level.title} · {robots}", preview)

    def take(self, name_or_path: str) -> Level:
        """Load a level; raises `LevelError`."""
        return load_level(_expanded(name_or_path))


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
        return load_program(_expanded(name_or_path), self.own)


def _expanded(name_or_path: str) -> str:
    return str(Path(name_or_path).expanduser()) if "/" in name_or_path else name_or_path


def _first_comment(source: Source) -> str:
    for line in source.text.splitlines()[:20]:
        if line.lstrip().startswith("#"):
            return line.lstrip().lstrip("#").strip()
    return ""
