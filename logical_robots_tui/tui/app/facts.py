"""Where a player's choices are kept; nothing here is slow to load."""

from __future__ import annotations

from typing import TYPE_CHECKING

from platformdirs import user_config_path

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["DRESS", "THEME", "TOUR", "settings_path"]

THEME, TOUR, DRESS = "theme", "tour", "dress"
"""Facts in the player's record: which theme was chosen, that the tour is over, and how the screen
looked."""


def settings_path() -> Path:
    """Return the place of the configuration file, whether there is one or not."""
    return user_config_path("logical-robots", appauthor=False) / "config.toml"
