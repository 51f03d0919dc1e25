"""Textual's driver for terminals, with an ear for what the terminal answers."""

from __future__ import annotations

import os
import re
import select
import threading
from codecs import getincrementaldecoder
from typing import Any

from textual import events
from textual._xterm_parser import XTermParser
from textual.drivers.linux_driver import LinuxDriver

from logical_robots_tui.tui.outline import ENTER, OUTLINE

__all__ = ["Ear", "ListeningDriver", "Unmarked"]

_LAST_ANSWER = 0.5  # seconds to wait for it before the terminal is somebody else's

_CHUNK = 4096
_LOOK_UP_EVERY = 0.1  # seconds

_ANSWER = re.compile(r"\x1b\[(\d+);(\d+)R")
_BEGUN = re.compile(r"\x1b\[[\d;]*\Z")

_MARK = re.compile(r"\x1b\[20([01])~")
_TEXT = re.compile(r"[^\x00-\x08\x0b\x0c\x0e-\x1f\x7f]{64,}")
"""More than anybody types at once, and nothing but letters, tabs and ends of lines."""


class Ear:
    """Takes a terminal's answers out of what a player types or pastes.

    A terminal answers at once, even if a paste comes in at that moment, and the parser of Textual
    takes anything within a paste for text.
    """

    def __init__(self) -> None:
        self._begun = ""

    def listen(self, typed: str) -> tuple[str, int]:
        """Return what was typed and how many answers came in between.

        Args:
            typed: What came in. An answer that has only begun is kept for the next time.
        """
        typed, answers = _ANSWER.subn("", self._begun + typed)
        begun = _BEGUN.search(typed)
        self._begun = begun[0] if begun else ""
        return typed.removesuffix(self._begun), answers


class Unmarked:
    """Knows a paste from keys where the terminal, or GNU screen in it, does not mark pastes.

    As keys it would be worked off letter by letter, for minutes; and out of the editor each letter
    is a command.
    """

    def __init__(self) -> None:
        self._is_marked = self._is_escape_begun = False

    def paste_in(self, typed: str) -> str:
        """Return what was pasted, with line feeds, or "" if those are keys or marked pastes.

        Args:
            typed: All that came in at once, after all that came in before.
        """
        is_plain = not self._is_marked and not self._is_escape_begun
        self._is_escape_begun = typed.endswith("\x1b")
        for mark in _MARK.finditer(typed):
            self._is_marked = mark[1] == "0"
        text = typed.replace("\r\n", "\n").replace("\r", "\n")
        is_several_lines = "\n" in text.rstrip("\n")  # and not one line, then enter
        return text if is_plain and is_several_lines and _TEXT.fullmatch(text) else ""


class ListeningDriver(LinuxDriver):
    """Tells the app of each answer by ``CursorPosition``, wherever it comes in."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._asked = 0
        self._all_answered = threading.Condition()

    def write(self, data: str) -> None:
        """Write to the terminal, but do not go where the outline has gone already."""
        if data != ENTER or not OUTLINE.hand_over():
            super().write(data)

    def ask(self, text: str) -> None:
        """Write something that ends in a question to the terminal."""
        with self._all_answered:
            self._asked += 1
        self.write(text)

    def disable_input(self) -> None:
        """Stop listening; an answer that is due is waited for, lest the next program reads it."""
        with self._all_answered:
            self._all_answered.wait_for(lambda: not self._asked, _LAST_ANSWER)
            self._asked = 0
        super().disable_input()

    def run_input_thread(self) -> None:
        """Pass on what comes in until the driver stops."""
        parser = XTermParser(self._debug)
        ear, unmarked = Ear(), Unmarked()
        decode = getincrementaldecoder("utf-8")(errors="replace").decode
        terminal = select.poll()
        terminal.register(self.fileno, select.POLLIN)
        while not self.exit_event.is_set():
            typed = ""
            if terminal.poll(1000 * _LOOK_UP_EVERY):
                try:
                    data = os.read(self.fileno, _CHUNK)
                except OSError:  # the terminal is gone
                    break
                if not data:
                    break
                typed, answers = ear.listen(decode(data))
                for _ in range(answers):
                    self._hear()
            if pasted := unmarked.paste_in(typed):
                self.process_message(events.Paste(pasted))
                typed = ""
            for message in (*(parser.feed(typed) if typed else ()), *parser.tick()):
                self.process_message(message)

    def _hear(self) -> None:
        self.process_message(events.CursorPosition(0, 0))
        with self._all_answered:
            self._asked = max(0, self._asked - 1)
            self._all_answered.notify_all()
