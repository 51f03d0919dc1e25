"""Terminal input, separated into answers, pastes and keys; junk is dropped."""

from __future__ import annotations

import re
from codecs import getincrementaldecoder
from collections import deque
from functools import cache
from typing import TYPE_CHECKING

from textual import events
from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual._xterm_parser import XTermParser
from textual.keys import Keys

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from textual.message import Message

MOST_PASTED = 1_000_000
"""Most characters of one paste; the rest is dropped. A program may have a fifth of that."""

_LONGEST = 30  # parameters of a sequence; Textual turns longer ones into keys without meaning
_FORSAKEN = 1.0  # seconds of silence after which a single key ends an unterminated paste
_ONE_KEY = 8  # bytes at most

_ANSWER = re.compile(r"\x1b\[\d{1,6};\d{1,6}R")
_TOO_LONG = re.compile(rf"\x1b\[[0-?]{{{_LONGEST},}}[ -/]*[@-~]?")
_REST = re.compile(r"[0-?]*[ -/]*[@-~]?")
_BEGUN = re.compile(rf"\x1b\[[0-?]{{0,{_LONGEST}}}\Z")
_STRING = re.compile(r"\x1b[]P^_X][^\x07\x1b]+(?:\x07|\x1b\\)")
"""Answers of a terminal about its colours or version, which are not keys."""

_STRING_BEGUN = re.compile(r"\x1b[]P^_X][^\x00-\x1f]*(\x1b?)\Z")
_STRING_END = re.compile(r"\x07|\x1b\\|\x1b(?=.)|[\x00-\x1a\x1c-\x1f]", re.DOTALL)

_PASTE_BEGIN, _PASTE_END = "\x1b[200~", "\x1b[201~"

_SEQUENCE = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]\Z")


class Pasted(str):
    """A complete pasted text, limited in length."""

    __slots__ = ()


class InputFilter:
    """Separates input in linear time and bounded memory; sees answers even in pastes."""

    def __init__(self) -> None:
        self._decode = getincrementaldecoder("utf-8")(errors="replace").decode
        self._begun = ""  # start of a sequence
        self._is_skipping = False  # within a sequence that is too long
        self._paste: deque[str] | None = None
        self._pasted = 0
        self._is_escape_last = False
        self._is_in_string = False
        self._last = 0.0

    def take(self, data: bytes, now: float) -> tuple[list[str | Pasted], int]:
        """Return what was typed and pasted, in order, and the number of answers.

        Incomplete sequences are kept for the next call; `now` is in seconds.
        """
        is_forsaken = now - self._last > _FORSAKEN and len(data) <= _ONE_KEY
        self._last = now
        text = self._whole(self._decode(data))
        text, answers = _ANSWER.subn("", text)
        found: list[str | Pasted] = []
        if self._paste is not None and is_forsaken and text and _PASTE_END not in text:
            found.append(self._finished())
        self._is_in_string = self._is_in_string and not is_forsaken
        found += self._split(text)
        return found, answers

    def _whole(self, text: str) -> str:
        """Return the text without overlong or incomplete sequences."""
        text, self._begun = self._begun + text, ""
        if self._is_skipping:
            rest = _REST.match(text)
            end = rest.end() if rest else 0
            self._is_skipping = end == len(text) and not "@" <= text[-1:] <= "~"
            text = text[end:]
        if found := [*_TOO_LONG.finditer(text)]:
            self._is_skipping = found[-1].end() == len(text) and not "@" <= text[-1:] <= "~"
            text = _TOO_LONG.sub("", text)
        if begun := _BEGUN.search(text):
            text, self._begun = text[: begun.start()], begun[0]
        return text

    def _split(self, text: str) -> Iterator[str | Pasted]:
        if self._paste is None and self._is_escape_last and text.startswith(_PASTE_BEGIN[1:]):
            text = f"\x1b{text}"
        text = self._after_string(text)
        self._is_escape_last = self._paste is None and text.endswith("\x1b")
        while text:
            if self._paste is None:
                keys, begin, text = text.partition(_PASTE_BEGIN)
                if keys := self._without_strings(keys, is_last=not begin):
                    yield keys
                if begin:
                    self._paste, self._pasted = deque(), 0
            else:
                inside, end, text = text.partition(_PASTE_END)
                self._keep(inside)
                if end:
                    yield self._finished()

    def _without_strings(self, keys: str, *, is_last: bool) -> str:
        begun = _STRING_BEGUN.search(keys := _STRING.sub("", keys)) if is_last else None
        if begun is None or len(keys) == 2:  # such as alt with a bracket
            return keys
        self._is_in_string = True
        self._begun = f"{begun[1]}{self._begun}"
        return keys[: begun.start()]

    def _after_string(self, text: str) -> str:
        if not self._is_in_string:
            return text
        if end := _STRING_END.search(text):
            self._is_in_string = False
            return text[end.end() if end[0] in ("\x07", "\x1b\\") else end.start() :]
        if text.endswith("\x1b"):
            self._begun = f"\x1b{self._begun}"
        return ""

    def _keep(self, text: str) -> None:
        assert self._paste is not None
        if text.endswith("\x1b"):
            text, self._begun = text[:-1], f"\x1b{self._begun}"
        if room := MOST_PASTED - self._pasted:
            self._paste.append(text[:room])
            self._pasted += len(text[:room])

    def _finished(self) -> Pasted:
        assert self._paste is not None
        text, self._paste = "".join(self._paste), None
        return Pasted(text.replace("\0", ""))


class TolerantParser(XTermParser):
    """Textual's key parser, changed to drop what it does not understand.

    Textual's raises an error for a key beyond Unicode, and for a mouse event without terminal
    size.
    """

    def parse_mouse_code(self, code: str) -> Message | None:
        try:
            return super().parse_mouse_code(code)
        except ArithmeticError:  # in a terminal that reports no columns or no pixels
            return None

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        try:
            found = [*super()._sequence_to_key_events(sequence, alt)]
        except (ValueError, OverflowError):
            return [_ignored(sequence)]
        if found or not _SEQUENCE.match(sequence) or sequence in _beginnings():
            return found
        mouse = re.match(r"\x1b\[(<?[-\d;]+[mM]|M)", sequence)
        is_report = re.match(r"\x1b\[\?\d+;\d+\$y", sequence)
        return [] if mouse or is_report else [_ignored(sequence)]


def _ignored(sequence: str) -> events.Key:
    return events.Key(Keys.Ignore, sequence)


@cache
def _beginnings() -> frozenset[str]:
    return frozenset(
        sequence[:end] for sequence in ANSI_SEQUENCES_KEYS for end in range(2, len(sequence))
    )
