"""The levels that a player has made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.paths import is_file
from logical_robots_tui.world.load import SUFFIXES

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["own_levels"]


def own_levels(folder: Path) -> dict[str, Path]:
    """The files of the player's levels by name, sorted; one for each name. Blocks."""
    try:
        files = [file for file in folder.iterdir() if file.suffix in SUFFIXES and is_file(file)]
    except OSError:  # there are none yet, or the folder is out of reach
        return {}
    return {file.stem: file for file in sorted(files, reverse=True)[::-1]}
