"""Where a player's own things are kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["folder_of", "own_programs"]


def folder_of(data_dir: Path | None, player: str | None = None) -> Path:
    """The folder for everything of a player's.

    Args:
        data_dir: The folder that was named, or None for the system's place for it.
        player: A name, where many players share an account.
    """
    if data_dir is None:
        from platformdirs import user_data_path

        data_dir = user_data_path("logical-robots", appauthor=False)
    return data_dir / "players" / player if player else data_dir


def own_programs(data_dir: Path | None) -> Path:
    """The folder with the player's own programs.

    Args:
        data_dir: The folder for everything of the player's, or None for the system's place for it.
    """
    return folder_of(data_dir) / "programs"
