"""A command, and how the table of commands declares one."""

from __future__ import annotations

import re
import string
import unicodedata
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, Literal, NamedTuple, TypeAlias, TypeVar

from textual.keys import KEY_NAME_REPLACEMENTS

if TYPE_CHECKING:
    from logical_robots_tui.player.session_state import Spawn

Target = TypeVar("Target")

Place: TypeAlias = Literal["anywhere", "editor", "outside"]
"""Where the command bar offers a command: always, only in the text editor, only outside of it."""

Scope: TypeAlias = Literal["screen", "level", "text"]
"""Where the keys of a command act: on the main screen, in the level editor, in the text editor.

The text editor binds its keys itself, and a player can't change them.
"""

Need: TypeAlias = Literal["browser", "board", "class"]
"""What not every game has: it is shown in a browser, has a board, or is one of a class."""


def _key_of(character: str) -> str:
    name = unicodedata.name(character).lower().replace("-", "_").replace(" ", "_")
    return KEY_NAME_REPLACEMENTS.get(name, name)


CHARACTERS = {_key_of(character): character for character in string.punctuation}
"""The printable characters that Textual has names for, by these."""

_NAMES = {**CHARACTERS, "escape": "esc"}


class Command(NamedTuple):
    """Something that a player can ask for.

    Attributes:
        id: Its name in the configuration file and in texts that name its key.
        keys: As Textual names them. Printable ones act only while nobody is typing.
        act: Does it, given the main screen, or the edit mode for one of the level editor.
        bar: Label in the command bar, or "" to leave it out; not shown beside an equal key.
        spare: How early the bar drops it when there is little room; 0 is never.
        also: Other words that the palette finds it by.
        needs: What a game must have to offer it.
        worker: The group of workers that an asynchronous `act` runs in, one at a time; "" for
            one that is not asynchronous.
    """

    id: str
    title: str
    help: str
    group: str
    scope: Scope
    keys: tuple[str, ...]
    act: Callable[[Any], Any]
    bar: str = ""
    place: Place = "outside"
    spare: int = 0
    worker: str = ""
    also: str = ""
    needs: Need | None = None
    without_key: str = "^P"

    def run(self, target: object, spawn: Spawn) -> None:
        if self.worker:
            spawn(partial(self.act, target), self.worker, exclusive=True)
        else:
            self.act(target)

    @property
    def key_name(self) -> str:
        """The first key as printed on a keyboard, or `without_key`."""
        return key_name(self.keys[0]) if self.keys else self.without_key

    def match(self, words: Sequence[str]) -> float:
        """How well words fit: 0.0 unless each begins a word of the title, the help or `also`."""
        title, also = self.title.casefold(), f"{self.id.replace('_', ' ')} {self.also}".casefold()
        scores = [
            max(
                1.0 * title.startswith(word),
                0.9 * _has(title, word),
                0.8 * _has(also, word),
                0.7 * title.replace(" ", "").startswith(word),
                0.4 * _has(self.help.casefold(), word),
            )
            for word in words
        ]
        if not scores or not all(scores):
            return 0.0
        return sum(scores) / len(scores) - 0.001 * len(title)  # a short title fits as a whole

    def bar_key(self, *, typing: bool) -> str:
        """Return the key to show in the command bar, or "" if none works while typing."""
        keys = [
            key for key in self.keys if not typing or (len(key_name(key)) > 1 and key != "space")
        ]
        return key_name(keys[0]) if keys else ""


def _has(text: str, word: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(word)}", text) is not None


class CommandGroup(Generic[Target]):
    """The commands under one heading of the help, in order; each acts on a `Target`."""

    def __init__(self, title: str, scope: Scope = "screen") -> None:
        self.title, self.scope = title, scope
        self.commands: list[Command] = []

    def add(
        self,
        name: str,
        title: str,
        keys: str,
        act: Callable[[Target], object],
        text: str,
        **options: Any,
    ) -> None:
        """Declare a command; `keys` are separated by spaces, `text` is the help."""
        about = name, title, text, self.title, self.scope, tuple(keys.split())
        self.commands.append(Command(*about, act, **options))


def key_name(key: str) -> str:
    if key.startswith("ctrl+"):
        letter = key.removeprefix("ctrl+")
        name = _NAMES.get(letter, letter)
        return f"^{name.upper() if len(name) == 1 else name}"
    if key[0] == "f" and key[1:].isdigit():
        return key.upper()
    return _NAMES.get(key, key)
