"""A game that speaks Textual's protocol of web servers, and what a browser would show of it."""

import json
import os
import socket
import subprocess
from typing import Self

from textual.drivers._byte_stream import ByteStream

from tests.terminal import Terminal

WEB_DRIVER = "textual.drivers.web_driver:WebDriver"


class WebTerminal(Terminal):
    """Runs a command as a web server does; what it says besides its screen is in `meta`."""

    def __enter__(self) -> Self:
        self._packets, self._preamble = ByteStream(), b""
        self.meta: list[dict[str, object]] = []
        self._socket, theirs = socket.socketpair()
        self._ours = self._socket.fileno()
        size = {"COLUMNS": str(self._screen.columns), "ROWS": str(self._screen.lines)}
        self.process = subprocess.Popen(
            self._command,
            stdin=theirs.fileno(),
            stdout=theirs.fileno(),
            stderr=subprocess.PIPE,
            env={**self._env, **size, "TERM": "dumb"},
            start_new_session=True,
        )
        theirs.close()
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate(timeout=self.patience)
        self._socket.close()

    def send(self, keys: str, sees: str = "") -> None:
        if keys:
            self._send(b"D", keys.encode())
        if sees:
            self.wait_for(sees)

    def resize(self, columns: int, lines: int) -> None:
        self._screen.resize(lines, columns)
        self.tell({"type": "resize", "width": columns, "height": lines})

    def tell(self, meta: dict[str, object]) -> None:
        self._send(b"M", json.dumps(meta).encode())

    def hang_up(self) -> tuple[int, str]:
        """Leave as a killed server does; return the game's status and what it said."""
        self._socket.shutdown(socket.SHUT_RDWR)
        _, said = self.process.communicate(timeout=self.patience)
        return self.process.returncode, said.decode()

    def _send(self, kind: bytes, payload: bytes) -> None:
        os.write(self._ours, kind + len(payload).to_bytes(4, "big") + payload)

    def _keep(self, chunk: bytes) -> None:
        if not self._preamble.endswith(b"\n"):
            start, newline, chunk = chunk.partition(b"\n")
            self._preamble += start + newline
        for kind, payload in self._packets.feed(chunk) if chunk else ():
            if kind == "D":
                super()._keep(payload)
            else:
                self.meta.append(json.loads(payload))
