"""Textual's drivers, extended to read the terminal's answers."""

from __future__ import annotations

import asyncio
import os
import re
import select
import shutil
import threading
from abc import abstractmethod
from codecs import getincrementaldecoder
from collections import deque
from collections.abc import Iterable, Iterator
from functools import cache
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from textual import events
from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual._xterm_parser import XTermParser
from textual.driver import Driver
from textual.drivers.linux_driver import LinuxDriver
from textual.geometry import Size
from textual.keys import Keys
from textual.message import Message
from textual.messages import InBandWindowResize

from logical_robots_tui.processes.lifeline import note_screen
from logical_robots_tui.tui.terminal.textual_internals import handle_exception

if TYPE_CHECKING:
    from textual.app import App

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

_CONTINUATIONS = tuple("[]OP^_X")  # of an escape sequence
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

    def take(self, chunk: bytes, time: float) -> tuple[list[str | Pasted], int]:
        """Return what was typed and pasted, in order, and the number of answers.

        Incomplete sequences are kept for the next call; `time` is in seconds.
        """
        is_forsaken = time - self._last > _FORSAKEN and len(chunk) <= _ONE_KEY
        self._last = time
        text = self._whole(self._decode(chunk))
        text, answers = _ANSWER.subn("", text)
        pieces: list[str | Pasted] = []
        if self._paste is not None and is_forsaken and text and _PASTE_END not in text:
            pieces.append(self._finished())
        self._is_in_string = self._is_in_string and not is_forsaken
        pieces += self._split(text)
        return pieces, answers

    def _whole(self, text: str) -> str:
        """Return the text without overlong or incomplete sequences."""
        text, self._begun = self._begun + text, ""
        if self._is_skipping:
            remainder = _REST.match(text)
            end = remainder.end() if remainder else 0
            self._is_skipping = end == len(text) and not "@" <= text[-1:] <= "~"
            text = text[end:]
        if sequences := [*_TOO_LONG.finditer(text)]:
            self._is_skipping = sequences[-1].end() == len(text) and not "@" <= text[-1:] <= "~"
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
    size. It takes a letter within 100 ms of escape for one with Alt, which terminals send at once.
    """

    _is_escape_last = False

    def feed(self, typed: str) -> Iterable[Message]:
        awaits_more = self._is_escape_last and self._timeout_time is not None
        if awaits_more and not typed.startswith(_CONTINUATIONS):
            self._timeout_time = 0.0
            yield from self.tick()
        self._is_escape_last = typed.endswith("\x1b")
        yield from super().feed(typed)

    def parse_mouse_code(self, code: str) -> Message | None:
        try:
            return super().parse_mouse_code(code)
        except ArithmeticError:  # in a terminal that reports no columns or no pixels
            return None

    def _sequence_to_key_events(self, sequence: str, alt: bool = False) -> Iterable[events.Key]:
        try:
            keys = [*super()._sequence_to_key_events(sequence, alt)]
        except (ValueError, OverflowError):
            return [_ignore(sequence)]
        if keys or not _SEQUENCE.match(sequence) or sequence in _beginnings():
            return keys
        mouse = re.match(r"\x1b\[(<?[-\d;]+[mM]|M)", sequence)
        is_report = re.match(r"\x1b\[\?\d+;\d+\$y", sequence)
        return [] if mouse or is_report else [_ignore(sequence)]


def _ignore(sequence: str) -> events.Key:
    return events.Key(Keys.Ignore, sequence)


@cache
def _beginnings() -> frozenset[str]:
    return frozenset(
        sequence[:end] for sequence in ANSI_SEQUENCES_KEYS for end in range(2, len(sequence))
    )


LARGEST = (1000, 400)
"""Columns and lines of the largest screen that is drawn."""

_LATE_ANSWER = 5.0  # seconds after a query, in which its answer comes or never
_BEGIN_OF_KEY_PROTOCOL = re.compile(r"\x1b\[>\d+u")
_END_OF_KEY_PROTOCOL = "\x1b[<u"
_TAKE_TERMINAL, _LEAVE_TERMINAL = "\x1b[?1049h", "\x1b[?1049l"
_CLEAR = "\x1b[m\x1b[2J"

_CHUNK = 4096
_LOOK_UP_EVERY = 0.1  # seconds
_FLOOD = 1000  # unanswered events

_MARK = re.compile(r"\x1b\[20([01])~")
_TEXT = re.compile(r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]{64,}")
"""More than anybody types at once, with only letters, tabs and line ends."""


class UnbracketedPasteDetector:
    """Detects pastes in terminals without bracketed paste, such as GNU screen.

    As keys they would take minutes, and outside the editor each letter is a command.
    """

    def __init__(self) -> None:
        self._is_marked = self._is_escape_begun = False

    def paste_in(self, typed: str) -> str:
        """Return the paste in input that arrived at once, with line feeds, or ""."""
        is_plain = not self._is_marked and not self._is_escape_begun
        self._is_escape_begun = typed.endswith("\x1b")
        for mark in _MARK.finditer(typed):
            self._is_marked = mark[1] == "0"
        text = typed.replace("\r\n", "\n").replace("\r", "\n")
        is_several_lines = "\n" in text.rstrip("\n")  # not one line followed by enter
        return text if is_plain and is_several_lines and _TEXT.fullmatch(text) else ""


class Uploaded(Message):
    """A file from a browser, cut off beyond what is accepted."""

    def __init__(self, name: str, content: bytes) -> None:
        super().__init__()
        self.name, self.content = name, content


class ListeningDriver(Driver):
    """Posts each answer of the terminal to the app, as ``CursorPosition``."""

    exit_event: threading.Event

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self.app, self.loop = app, asyncio.get_running_loop()
        self._parser, self._incoming = TolerantParser(), InputFilter()
        self._unmarked = UnbracketedPasteDetector()
        self._queries: deque[float] = deque()  # when
        self._received: deque[Message] = deque()  # and not yet processed
        self._all_answered = threading.Condition()
        self._is_listening = True  # until the terminal is gone
        self._answers_until = 0.0  # after the last query, or the first to a silent terminal
        self._heard_at: float | None = None  # since it has answered once

    @property
    def silence(self) -> float:
        """Seconds since an answering terminal last sent input; 0 for any other terminal."""
        return 0.0 if self._heard_at is None else monotonic() - self._heard_at

    def ask(self, text: str) -> None:
        time = monotonic()
        with self._all_answered:
            while self._queries and time - self._queries[0] > _LATE_ANSWER:
                self._queries.popleft()
            self._queries.append(time)
            if self._heard_at is not None or not self._answers_until:
                self._answers_until = time + _LATE_ANSWER
        self.write(text)

    def send_message(self, message: Message) -> None:
        self.app.post_message(message)

    def run_input_thread(self) -> None:
        """Forward input until the driver stops; an exception ends the app."""
        self._is_listening = True
        try:
            self._listen()
        except Exception as error:  # it would end the thread unnoticed
            self.loop.call_soon_threadsafe(handle_exception, self.app, error)
        with self._all_answered:
            self._is_listening = False
            self._all_answered.notify_all()

    @abstractmethod
    def _listen(self) -> None:
        """Receive input until the driver stops or the terminal is gone."""

    def _chunks(self, descriptor: int) -> Iterator[bytes]:
        """Yield input until it ends or the driver stops; an empty chunk when there is none."""
        terminal = select.poll()
        terminal.register(descriptor, select.POLLIN)
        while not self.exit_event.is_set():
            chunk = b""
            if terminal.poll(1000 * _LOOK_UP_EVERY):
                try:
                    chunk = os.read(descriptor, _CHUNK)
                except OSError:  # the terminal is gone
                    break
                if not chunk:
                    break
            yield chunk

    def _receive(self, chunk: bytes) -> None:
        """Post what a chunk of input contains; an empty one lets time pass."""
        self._received.extend(self._messages_in(chunk))
        if self._received:
            # Once for all: beside a busy event loop each wake-up waits for Python's lock.
            self.loop.call_soon_threadsafe(self._process_received)

    def _process_received(self) -> None:
        for _ in range(len(self._received)):
            self.process_message(self._received.popleft())

    def _messages_in(self, chunk: bytes) -> Iterator[Message]:
        pieces: list[str | Pasted] = []
        if chunk:
            pieces, answers = self._incoming.take(chunk, monotonic())
            if answers or self._heard_at is not None:
                self._heard_at = monotonic()
            yield from self._answers(answers)
        for piece in pieces:
            if isinstance(piece, Pasted):
                yield events.Paste(piece)
                self._parser = TolerantParser()
            elif self._is_flooded():
                self._parser = TolerantParser()
            elif pasted := self._unmarked.paste_in(piece):
                yield events.Paste(pasted)
            else:
                yield from self._parser.feed(piece)
        yield from self._parser.tick()

    def _is_flooded(self) -> bool:
        """Return whether more input is pending than anybody types; if so, discard it."""
        app = self.app if isinstance(self.app, BacklogApp) else None
        if len(self._received) + (app.backlog if app is not None else 0) < _FLOOD:
            return False
        if app is not None:
            self.loop.call_soon_threadsafe(app.drop_typed)
        return True

    def _answers(self, number: int) -> list[Message]:
        """Return messages for answers, at most as many as there were queries."""
        with self._all_answered:
            answered = [self._queries.popleft() for _ in range(min(number, len(self._queries)))]
            self._all_answered.notify_all()
        return [events.CursorPosition(0, 0) for _ in answered]


class TerminalDriver(ListeningDriver, LinuxDriver):
    """Textual's driver of a terminal, with the game's care for what surrounds it."""

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self._unknown: Size | None = None  # to the app, as it was last looked at
        self._is_key_protocol_begun = self._has_terminal = self._is_told_sizes = False

    def write(self, data: str) -> None:
        """Write to the terminal; no end of its key protocol where that was never begun.

        The screen is cleared before it is left: where its window has grown meanwhile, tmux would
        keep lines of it above the shell's.
        """
        if data in (_TAKE_TERMINAL, _LEAVE_TERMINAL):
            if self._has_terminal and data == _LEAVE_TERMINAL:
                super().write(_CLEAR)
            self._has_terminal = data == _TAKE_TERMINAL
            if self._has_terminal:
                note_screen(is_left=False)
        if _BEGIN_OF_KEY_PROTOCOL.fullmatch(data):
            self._is_key_protocol_begun = True
        if data != _END_OF_KEY_PROTOCOL or self._is_key_protocol_begun:
            super().write(data)

    def disable_input(self) -> None:
        """Stop reading after any pending answers, so that the next program doesn't get them."""
        with self._all_answered:
            seconds = self._answers_until - monotonic()
            self._all_answered.wait_for(lambda: not (self._queries and self._is_listening), seconds)
            self._queries.clear()
        super().disable_input()

    def close(self) -> None:
        super().close()  # after which all is written
        note_screen(is_left=not self._has_terminal)

    def resume_application_mode(self) -> None:
        # After a stop that no process is asked about, Textual would take the terminal twice.
        if self._has_terminal:
            self.suspend_application_mode()
        super().resume_application_mode()

    def process_message(self, message: Message) -> None:
        if isinstance(message, InBandWindowResize) and message.supported:
            self._is_told_sizes = True
        super().process_message(message)

    def mend_size(self) -> None:
        """Post the terminal's size if the app does not know it, nor did a look before.

        Of a window that is dragged about, the signal of the last size may be lost.
        """
        size = drawn_size(Size(*shutil.get_terminal_size()))
        if size == self.app.size or self._is_told_sizes:
            self._unknown = None
        elif size != self._unknown:
            self._unknown = size
        else:
            self._unknown = None
            self.process_message(events.Resize(size, size))

    def _listen(self) -> None:
        for chunk in self._chunks(self.fileno):
            self.mend_size()
            self._receive(chunk)


@runtime_checkable
class BacklogApp(Protocol):
    """An app that counts its keys and other events that wait, and can drop the keys."""

    @property
    def backlog(self) -> int: ...
    def drop_typed(self) -> None: ...


def drawn_size(size: Size) -> Size:
    """Return how much of a terminal of this size is drawn."""
    return Size(*(max(1, min(limit, side)) for limit, side in zip(LARGEST, size, strict=True)))
