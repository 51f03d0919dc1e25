"""The commands with the keys that a player gave them, and how keys are written."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from contextvars import ContextVar
from string import ascii_lowercase
from types import MappingProxyType

from textual.binding import Binding, BindingsMap

from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.player.settings import Complain, Keys, toml_line
from logical_robots_tui.tui.commands.command import CHARACTERS, Command, Need, Scope, key_name


class KeyMap:
    """All commands, with their keys or those that a player gave them, by the command's id."""

    def __init__(
        self,
        commands: Iterable[Command],
        keys: Keys = MappingProxyType({}),
        *,
        has: Collection[Need] = (),
    ) -> None:
        entries = {
            entry.id: entry._replace(keys=keys.get(entry.id, entry.keys)) for entry in commands
        }
        if "browser" in has:  # the first key is the one that is shown
            for name, entry in entries.items():
                reachable_first = sorted(entry.keys, key=_TAKEN_BY_BROWSERS.__contains__)
                entries[name] = entry._replace(keys=(*reachable_first,))
        self._has = has
        # Without a key of its own the palette is still in the bar, to be clicked.
        palette = entries["palette"]
        instead = key_name(palette.keys[0]) if palette.keys else palette.bar
        self.by_id = {entry.id: entry._replace(without_key=instead) for entry in entries.values()}

    @property
    def available(self) -> list[Command]:
        """The commands that this game has."""
        return [entry for entry in self.by_id.values() if entry.needs in (None, *self._has)]

    @property
    def changeable(self) -> dict[str, Command]:
        """The commands whose keys a player can change, by id."""
        return {name: entry for name, entry in self.by_id.items() if entry.scope != "text"}

    def read(self, table: Mapping[str, object], complain: Complain) -> Keys:
        """Return the keys in the table of a file; one may have one command of each scope."""
        entries = self.changeable
        owners = {
            (entry.scope, key): entry.id
            for entry in entries.values()
            if entry.id not in table
            for key in entry.keys
        }
        keys_by_id: dict[str, tuple[str, ...]] = {}
        for name, value in table.items():
            if name not in entries:
                hint = did_you_mean(name, entries) or "logical-robots config lists all."
                complain(name, f'keys: there is no command "{name}". {hint}')
                continue
            keys = []
            for text in value if isinstance(value, list) else [value]:
                try:
                    keys.append(_take(text, entries[name], owners))
                except ValueError as error:
                    complain(name, f"keys.{name}: {error}")
            if keys or value == []:
                keys_by_id[name] = tuple(keys)
        for name in table.keys() & entries.keys() - keys_by_id.keys():
            entry = entries[name]
            keys_by_id[name] = tuple(key for key in entry.keys if (entry.scope, key) not in owners)
        return keys_by_id

    def as_toml(self) -> Iterator[str]:
        """Yield the lines of a file's table of keys."""
        yield "[keys]"
        for entry in self.changeable.values():
            yield toml_line(entry.id, [key_name(key) for key in entry.keys], entry.title)


KEY_MAP: ContextVar[KeyMap] = ContextVar("key_map")
"""The key map of the app that is running, set by it."""


def commands(*scopes: Scope) -> list[Command]:
    return [entry for entry in KEY_MAP.get().available if not scopes or entry.scope in scopes]


def command(command_id: str) -> Command:
    return KEY_MAP.get().by_id[command_id]


def key_of(name: str) -> str:
    """Return a command's key; return any other text unchanged."""
    entry = KEY_MAP.get().by_id.get(name)
    return name if entry is None else entry.key_name


def key_bindings(*entries: Command, does: str = "") -> BindingsMap:
    """Return what binds the keys of commands to them, or to another one."""
    return BindingsMap(
        Binding(",".join(entry.keys), f"screen.command('{does or entry.id}')", show=False)
        for entry in entries
        if entry.keys
    )


def with_keys(text: str) -> str:
    """Insert the player's keys for commands in braces, such as ``{run} runs``."""
    entries = KEY_MAP.get().by_id
    return text.format_map({name: entry.key_name for name, entry in entries.items()})


_TAKEN_BY_BROWSERS = frozenset(("ctrl+n", "ctrl+t", "ctrl+w"))
"""Keys for windows and tabs, which no page gets."""

_OTHERS = {
    "ctrl+a": "GNU screen uses it",
    "ctrl+b": "tmux uses it",
    "ctrl+c": "it leaves the game",
    "ctrl+h": "terminals send it for backspace",
    "ctrl+i": "terminals send it for tab",
    "ctrl+j": "terminals send it for enter",
    "ctrl+m": "terminals send it for enter",
    "ctrl+q": "it resumes a stopped terminal",
    "ctrl+z": "it suspends the game",
    "ctrl+left_square_bracket": "terminals send it for escape",
}
"""Keys with Ctrl that others use, and how."""

_MOVES = "it moves within a pane, or types"
_MOVING = (
    *("enter", "tab", "backspace", "delete", "insert", "home", "end", "pageup", "pagedown"),
    *("up", "down", "left", "right"),
)
_KEYS = {char: key for key, char in CHARACTERS.items()}
_CONTROLS = {f"ctrl+{_KEYS.get(key, key)}" for key in (*ascii_lowercase, *"]\\_^@", "space")}
_NAMES = {"esc": "escape", " ": "space", "tabulator": "tab", "return": "enter"}


_ONLY_EDITING = ("enter", "tab", "shift+tab", "delete", "backspace")
"""Keys that only commands of the level editor can have, by their printed names."""


def _take(text: object, entry: Command, owners: dict[tuple[Scope, str], str]) -> str:
    is_free = entry.scope == "level" and isinstance(text, str) and text in _ONLY_EDITING
    key = str(text) if is_free else key_from(text)
    owner = owners.setdefault((entry.scope, key), entry.id)
    if owner != entry.id:
        raise ValueError(
            f"{key_name(key)} is the key of {owner}. Give that another key, or none: {owner} = []"
        )
    return key


def key_from(text: object) -> str:
    """Return Textual's name for a key such as ``n``, ``?``, ``F5``, ``^R`` or ``space``.

    Raises ValueError, which says why, if there is no such key or it can't be used.
    """
    if not isinstance(text, str) or not text:
        raise ValueError(f"{text!r} is not a key; write it as a string")
    name = _name_of(text)
    reason = _OTHERS.get(name, _MOVES if name in _MOVING else "")
    if not reason and "+" in name and not name.startswith("ctrl+"):
        reason = "many terminals can't tell it from the key without Shift or Alt"
    if not reason and name.startswith("ctrl+") and name not in _CONTROLS:
        reason = "many terminals can't tell it from the key without Ctrl"
    if reason:
        raise ValueError(f"{key_name(name)} can't be used: {reason}")
    is_function = name[:1] == "f" and name[1:].isdecimal() and 1 <= int(name[1:]) <= 12
    if name in _CONTROLS or is_function or name in ("space", "escape"):
        return name
    if len(text) == 1 and text.isascii() and text.isprintable():
        return name
    raise ValueError(f'There is no key "{text}"; write n, ?, F5, ^R or space')


def _name_of(text: str) -> str:
    """Convert a key to Textual's name; return anything else unchanged."""
    if len(text) == 1:
        return _NAMES.get(text, _KEYS.get(text, text))
    folded = _NAMES.get(text.lower(), text.lower())
    if folded.startswith("^"):
        folded = f"ctrl+{folded[1:]}"
    head, plus, last = folded.rpartition("+")
    return f"{head}{plus}{_KEYS.get(last, last)}"
