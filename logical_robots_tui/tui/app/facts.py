"""Which choices a player has made, where they are kept, and what a player may do."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from platformdirs import user_config_path

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["NIGHT_NAME", "THEME", "TOUR", "Permissions", "settings_path"]

NIGHT_NAME = "night"
"""The game's own theme."""

THEME, TOUR = "theme", "tour"
"""Facts in the player's record: which theme was chosen, and that the tour is over."""


def settings_path() -> Path:
    """Return the place of the configuration file, whether there is one or not."""
    return user_config_path("logical-robots", appauthor=False) / "config.toml"


class Permissions(NamedTuple):
    """Everything on one's own machine; less on a shared or public one.

    Attributes:
        programs: Whether other programs may use the terminal: an editor, or the shell after
            suspending.
        clipboard: Whether the game may write to the terminal's clipboard.
    """

    programs: bool = True
    clipboard: bool = True
