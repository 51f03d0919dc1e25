"""Games and compile processes that warm processes fork: how they are asked for, and what is told.

Connections are sockets in the file system that only one account can use. Packets are whole
messages; descriptors of terminals, pipes and shared memory come with them.
"""

from __future__ import annotations

import json
import os
import select
import signal
import socket
from contextlib import suppress
from mmap import mmap
from pathlib import Path
from selectors import EVENT_READ, BaseSelector
from typing import IO, NamedTuple

from logical_robots_tui.processes.lifeline import HEARTBEAT_BYTES, signal_when_closed

SOCKET = "host.socket"
"""Name of the socket in a host's folder."""

LARGEST = 200_000
"""Bytes of a request."""

VERSION = f"{__file__} {Path(__file__).stat().st_mtime_ns}"
"""What client and host must have in common."""

DESCRIPTORS = 5
"""With a request: standard input, output and error, shared memory, and a lifeline."""

_PATIENCE = 5.0  # seconds for an answer, after which a game starts without the host
_SMALL = 100  # bytes of an answer at most


class GameRequest(NamedTuple):
    """What a client's game needs besides descriptors; `encodings` are those of the streams."""

    words: list[str]
    environment: dict[str, str]
    folder: str
    encodings: list[str]
    version: str = VERSION


class Fork(NamedTuple):
    """A process that a host has forked for a client."""

    pid: int
    client: socket.socket

    def watch(self, selector: BaseSelector) -> None:
        """Let a selector say when the process has ended."""
        selector.register(os.pidfd_open(self.pid), EVENT_READ, self)

    def tell_end(self, selector: BaseSelector, process: int) -> None:
        """Tell the client the exit status of the process, which a selector said has ended."""
        selector.unregister(process)
        os.close(process)
        status = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        with suppress(OSError):
            self.client.send(str(status).encode())


class HostedGame:
    """A game that a host has forked, as its client sees it.

    Attributes:
        pid: Its process.
        heartbeat: Memory shared with it.
    """

    def __init__(self, pid: int, connection: socket.socket, heartbeat: mmap, lifeline: int) -> None:
        self.pid, self.heartbeat = pid, heartbeat
        self._connection, self._lifeline = connection, lifeline
        self._process = os.pidfd_open(pid)
        # News of its end arrives as of a child's end.
        signal_when_closed(connection.fileno(), signal.SIGCHLD)

    def status(self) -> int | None:
        """Return its exit status, None while it runs, and that of a kill if nobody can tell."""
        answer = b""
        try:
            answer = self._connection.recv(_SMALL, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return None
        except OSError:
            pass
        if answer:
            return int(answer)
        has_ended = bool(select.select([self._process], [], [], 0)[0])  # the host is gone
        return -signal.SIGKILL if has_ended else None

    def wait(self) -> int:
        """Return its exit status when it has ended."""
        while (status := self.status()) is None:
            select.select([self._process, self._connection.fileno()], [], [])
        return status


def request_game(folder: str, words: list[str], encodings: list[str]) -> HostedGame | None:
    """Ask a host for a game in this terminal; return None if there is none, or another version."""
    lifeline, write_end = os.pipe()
    memory = os.memfd_create("heartbeat")
    os.ftruncate(memory, HEARTBEAT_BYTES)
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    connection.settimeout(_PATIENCE)
    request = GameRequest(words, dict(os.environ), str(Path.cwd()), encodings)
    try:
        connection.connect(str(Path(folder) / SOCKET))
        content = json.dumps(request).encode()
        socket.send_fds(connection, [content], [0, 1, 2, memory, lifeline])
        answer = connection.recv(_SMALL)
        if answer:
            connection.settimeout(None)
            heartbeat = mmap(memory, HEARTBEAT_BYTES)
            return HostedGame(int(answer), connection, heartbeat, write_end)
    except OSError:
        pass
    finally:
        os.close(lifeline)
        os.close(memory)
    connection.close()
    os.close(write_end)
    return None


_compile_host: list[socket.socket] = []  # in a game that has one


def use_compile_host(connection: socket.socket) -> None:
    """Let compile processes of this game be forked."""
    _compile_host[:] = [connection]


class HostedHelper:
    """A compile process that was forked for this game; as `Helper`, or raises OSError."""

    def __init__(self, connection: socket.socket, *arguments: str) -> None:
        self._connection = connection
        self.returncode: int | None = None
        connection.send(" ".join(arguments).encode())
        answer, descriptors, *_ = socket.recv_fds(connection, _SMALL, 3)
        if not answer:
            raise ConnectionResetError
        self.pid = int(answer)
        stdin, stdout, self._lifeline = descriptors
        self.stdin: IO[bytes] = os.fdopen(stdin, "wb", 0)
        self.stdout: IO[bytes] = os.fdopen(stdout, "rb", 0)

    def poll(self) -> int | None:
        """Return its exit status, or None while it runs."""
        return self._status(socket.MSG_DONTWAIT)

    def _status(self, flags: int = 0) -> int | None:
        if self.returncode is None:
            with suppress(BlockingIOError):
                answer = b""
                with suppress(ConnectionError):
                    answer = self._connection.recv(_SMALL, flags)
                self.returncode = int(answer) if answer else -signal.SIGKILL
        return self.returncode

    def end(self) -> None:
        """Kill the process, wait for its end, and close the pipes."""
        if self._lifeline >= 0:
            os.close(self._lifeline)
            self._lifeline = -1
        self._status()
        for pipe in (self.stdin, self.stdout):
            with suppress(OSError):
                pipe.close()


def forked_compile_process(*arguments: str) -> HostedHelper | None:
    """Return a compile process that a host has forked, or None if there is no host any more."""
    for connection in _compile_host:
        try:
            return HostedHelper(connection, *arguments)
        except OSError:
            _compile_host.clear()
            break
    return None
