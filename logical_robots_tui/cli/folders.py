"""Where a player's own things are kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["own_programs"]


def own_programs(data_dir: Path | None) -> Path:
    """The folder with the player's own programs.

    Args:
        data_dir: The folder for everything of the player's, or None for the system's place for it.
    """
    if data_dir is None:
        from platformdirs import user_data_path

        data_dir = user_data_path("logical-robots", appauthor=False)
    return data_dir / "programs"
