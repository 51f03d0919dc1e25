"""What the outline of the first picture is painted with, kept from one start to the next.

The screen knows its theme, and how the terminal shows it, only when it is loaded. So it leaves for
the next start what it has found, with a stamp that says for which circumstances that holds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.tui.app.facts import settings_path

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["NIGHT", "NIGHT_NAME", "Dress", "dress_from", "stamp_for"]

NIGHT_NAME = "night"
"""The game's own theme."""


class Dress(NamedTuple):
    """Colours and keys of an outline.

    Attributes:
        colours: By what is painted: the codes that choose its colour for ink, and for paper.
        keys: Names of the keys that go to the labyrinth and to the program.
    """

    colours: Mapping[str, tuple[str, str]]
    keys: tuple[str, str] = ("1", "2")

    def as_text(self, stamp: str) -> str:
        """Return what `dress_from` understands where the stamp is the same."""
        colours = (f"{name} {ink} {paper}" for name, (ink, paper) in self.colours.items())
        return "\n".join((stamp, "\t".join(self.keys), *colours))


_NIGHT = {
    "background": ("11;14;20", 233),
    "surface": ("15;19;28", 233),
    "panel": ("23;29;43", 234),
    "void": ("8;8;12", 232),
    "frame": ("42;49;73", 237),
    "frame-here": ("111;131;214", 68),
    "title": ("157;176;255", 147),
    "dim": ("119;129;164", 103),
    "key": ("254;180;84", 215),
    "here": ("35;43;69", 236),
}
"""The theme Night: red, green and blue, and which of 256 colours stands for it."""

NIGHT = {
    "truecolor": Dress({k: (f"38;2;{rgb}", f"48;2;{rgb}") for k, (rgb, _) in _NIGHT.items()}),
    "256": Dress({k: (f"38;5;{n}", f"48;5;{n}") for k, (_, n) in _NIGHT.items()}),
}
"""How the game looks to who has configured nothing, by what the terminal can show."""


def stamp_for(colours: str, theme: str) -> str:
    """Return what is the same as long as the game looks the same.

    Args:
        colours: What the terminal can show.
        theme: The theme in the player's record, or "".
    """
    try:
        file = settings_path().stat()
    except OSError:
        return f"{colours} {theme} -"
    return f"{colours} {theme} {file.st_mtime_ns} {file.st_size}"


def dress_from(text: str, stamp: str) -> Dress | None:
    """Return what `Dress.as_text` kept; None if it is damaged, or for other circumstances."""
    first, *lines = text.split("\n")
    if first != stamp or len(lines) != 1 + len(_NIGHT):
        return None
    keys = lines[0].split("\t")
    colours = {name: codes for name, *codes in (line.split(" ") for line in lines[1:])}
    if len(keys) != 2 or colours.keys() != _NIGHT.keys():
        return None
    if any(len(codes) != 2 for codes in colours.values()):
        return None
    return Dress({name: (ink, paper) for name, (ink, paper) in colours.items()}, (keys[0], keys[1]))
