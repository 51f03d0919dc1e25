"""A command of the game: what a player can ask for."""

from __future__ import annotations

import string
from dataclasses import dataclass
from typing import Literal, TypeAlias

from textual.keys import _character_to_key

__all__ = ["CHARACTERS", "Command", "Place", "key_name"]

Place: TypeAlias = Literal["anywhere", "editor", "outside"]
"""Where the command bar offers a command: always, only in the editor, only outside of it."""

CHARACTERS = {_character_to_key(char): char for char in string.punctuation}
"""The printable characters that Textual has names for, by these."""

_NAMES = {**CHARACTERS, "escape": "esc"}


@dataclass(frozen=True, slots=True)
class Command:
    """Something that a player can ask for.

    Attributes:
        id: Its name in code, and that of the method that does it.
        title: What it does, a few words that start with a capital letter.
        help: One sentence for the help and the palette.
        group: The heading it stands under in the help.
        keys: Keys that ask for it, as Textual names them. Printable ones act only while nobody
            is typing.
        bar: Label in the command bar, or "" to leave it out; beside an equal key it is not said.
        place: Where the bar shows it.
        spare: How easily the bar does without it where there is little room; 0 is not at all.
        without_key: What to name where it has no key: that of the palette, which finds all.
    """

    id: str
    title: str
    help: str
    group: str
    keys: tuple[str, ...]
    bar: str = ""
    place: Place = "outside"
    spare: int = 0
    without_key: str = "^P"

    @property
    def key_name(self) -> str:
        """The first key as printed on a keyboard, or what to name instead."""
        return key_name(self.keys[0]) if self.keys else self.without_key

    @property
    def key_names(self) -> str:
        """The keys as printed on a keyboard, such as ``space, F5``."""
        return ", ".join(key_name(key) for key in self.keys)

    def bar_key(self, *, typing: bool) -> str:
        """The key that the command bar names, or "" if there is none.

        Args:
            typing: Whether printable keys are text at the moment.
        """
        keys = [
            key for key in self.keys if not typing or (len(key_name(key)) > 1 and key != "space")
        ]
        return key_name(keys[0]) if keys else ""


def key_name(key: str) -> str:
    """A key as printed on a keyboard, such as ``^R`` or ``F5``."""
    if key.startswith("ctrl+"):
        letter = key.removeprefix("ctrl+")
        name = _NAMES.get(letter, letter)
        return f"^{name.upper() if len(name) == 1 else name}"
    if key[0] == "f" and key[1:].isdigit():
        return key.upper()
    return _NAMES.get(key, key)
