"""Textual's driver for a browser: pipes to a web server instead of a terminal."""

from __future__ import annotations

import asyncio
import json
import os
import signal
from base64 import b64decode
from contextlib import suppress
from threading import Event, Lock
from typing import TYPE_CHECKING, Any

from textual.drivers.web_driver import WebDriver

from logical_robots_tui.processes.lifeline import note_screen
from logical_robots_tui.tui.terminal.driver import ListeningDriver, Uploaded

if TYPE_CHECKING:
    from textual.app import App

_HEAD = 5  # bytes of a packet's kind and length
_STDIN = 0
_LAST_INPUT = 1.0  # seconds
_MODES = "\x1b[?1049h\x1b[?1000h\x1b[?1003h\x1b[?1015h\x1b[?1006h\x1b[?25l\x1b[?2004h"
"""What Textual sets at its start, for another page that takes over the game."""


class BrowserDriver(ListeningDriver, WebDriver):
    """Textual's driver with the input filter of terminals, and whole packets in any case."""

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self._write_lock, self._has_drawn, self._input_end = Lock(), Event(), Event()
        self._has_started = False
        self._write = self._write_whole  # type: ignore[assignment] # typed as a partial of os.write

    def _write_whole(self, packet: bytes) -> None:
        """Write a packet of one thread; none where the server is gone, which ends the game."""
        with self._write_lock, suppress(BrokenPipeError):
            while packet:
                packet = packet[os.write(self.fileno, packet) :]

    def write(self, text: str) -> None:
        super().write(text)
        if self._has_started:
            self._has_drawn.set()

    def start_application_mode(self) -> None:
        loop = asyncio.get_running_loop()
        handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
        super().start_application_mode()
        note_screen(is_left=False)
        # Textual's exit without keeping unsaved text.
        for number, handler in handlers.items():
            loop.remove_signal_handler(number)
            signal.signal(number, handler)
        self._has_started = True

    def disable_input(self) -> None:
        self._has_drawn.set()
        super().disable_input()

    def stop_application_mode(self) -> None:
        super().stop_application_mode()
        self._input_end.wait(_LAST_INPUT)  # or a key could come after the event loop
        note_screen(is_left=True)

    def tell_page(self, kind: str, **content: str) -> bool:
        # Textual's own server warns of what it does not know.
        is_ours = os.environ.get("TERM_PROGRAM") == "logical-robots"
        if is_ours:
            self.write_meta({"type": kind, **content})
        return is_ours

    def on_meta(self, packet_type: str, payload: dict[str, Any]) -> None:
        """Handle what a server says besides keys; Textual would quit without keeping text."""
        if packet_type == "quit":
            os.kill(os.getpid(), signal.SIGHUP)
        elif packet_type == "attach":
            self.write(_MODES)
            self.tell_page("title", title=self.app.title)
            self.process_message(self.SignalResume())
            super().on_meta("resize", payload)
        elif packet_type == "upload":
            content = b""
            with suppress(ValueError):
                content = b64decode(payload["content"])
            self.process_message(Uploaded(payload["name"], content))
        else:
            super().on_meta(packet_type, payload)

    def _listen(self) -> None:
        packets = b""
        self._has_drawn.wait()  # Textual's own size at the start would come after the page's
        for chunk in self._chunks(_STDIN):
            packets += chunk
            while len(packets) >= (end := _HEAD + int.from_bytes(packets[1:_HEAD], "big")):
                kind, payload, packets = packets[:1], packets[_HEAD:end], packets[end:]
                if kind == b"D":
                    self._receive(payload)
                else:
                    meta = json.loads(payload)
                    self.on_meta(meta["type"], meta)
            self._receive(b"")
        self._input_end.set()
