"""Where a player's choices are kept; nothing here is slow to load."""

from __future__ import annotations

from typing import TYPE_CHECKING

from platformdirs import user_config_path

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["NIGHT_NAME", "THEME", "TOUR", "settings_path"]

NIGHT_NAME = "night"
"""The game's own theme."""

THEME, TOUR = "theme", "tour"
"""Facts in the player's record: which theme was chosen, and that the tour is over."""


def settings_path() -> Path:
    """Return the place of the configuration file, whether there is one or not."""
    return user_config_path("logical-robots", appauthor=False) / "config.toml"
