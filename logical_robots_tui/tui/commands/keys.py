"""Keys as a player writes them, and those that can't be used."""

from __future__ import annotations

from logical_robots_tui.tui.commands.command import CHARACTERS, key_name

__all__ = ["key_from"]

_OTHERS = {
    "ctrl+a": "GNU screen uses it",
    "ctrl+b": "tmux uses it",
    "ctrl+c": "it leaves the game",
    "ctrl+h": "terminals send it for backspace",
    "ctrl+i": "terminals send it for tab",
    "ctrl+j": "terminals send it for enter",
    "ctrl+m": "terminals send it for enter",
    "ctrl+q": "it resumes a stopped terminal",
    "ctrl+s": "it stops the terminal",
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
_CONTROLS = "abcdefghijklmnopqrstuvwxyz]\\_^@"
_NAMES = {"esc": "escape", " ": "space", "tabulator": "tab", "return": "enter"}


def key_from(text: object) -> str:
    """Return Textual's name for a key.

    Args:
        text: As on a keyboard, such as ``n``, ``?``, ``F5``, ``^R``, ``ctrl+r`` or ``space``.

    Raises:
        ValueError: There is no such key, or it can't be used; the message says why.
    """
    if not isinstance(text, str) or not text:
        raise ValueError(f"{text!r} is not a key; write it as a string")
    wanted = _named(text)
    reason = _OTHERS.get(wanted, _MOVES if wanted in _MOVING else "")
    if not reason and "+" in wanted and not wanted.startswith("ctrl+"):
        reason = "many terminals can't tell it from the key without Shift or Alt"
    if not reason and wanted.startswith("ctrl+") and not _is_control(wanted):
        reason = "many terminals can't tell it from the key without Ctrl"
    if reason:
        raise ValueError(f"{key_name(wanted)} can't be used: {reason}")
    is_function = wanted[:1] == "f" and wanted[1:].isdecimal() and 1 <= int(wanted[1:]) <= 12
    if _is_control(wanted) or is_function or wanted in ("space", "escape"):
        return wanted
    if len(text) == 1 and text.isascii() and text.isprintable():
        return wanted
    raise ValueError(f'there is no key "{text}"; write n, ?, F5, ^R or space')


def _named(text: str) -> str:
    """A key by Textual's name; what is not a key stays as it is."""
    if len(text) == 1:
        return _NAMES.get(text, _KEYS.get(text, text))
    folded = _NAMES.get(text.lower(), text.lower())
    if folded.startswith("^"):
        folded = f"ctrl+{folded[1:]}"
    head, plus, last = folded.rpartition("+")
    return f"{head}{plus}{_KEYS.get(last, last)}"


def _is_control(name: str) -> bool:
    return name in {f"ctrl+{_KEYS.get(key, key)}" for key in _CONTROLS} | {"ctrl+space"}
