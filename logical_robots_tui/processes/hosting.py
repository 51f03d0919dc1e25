"""The host: a warm process that forks the games of a shared computer.

It has no threads, opens no file, and reads nothing of a player's: a game sets its limits and
permissions after the fork, as one that starts alone.
"""

from __future__ import annotations

import gc
import json
import mimetypes
import os
import pkgutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from mmap import mmap
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector

from logical_robots_tui.errors import InputError
from logical_robots_tui.processes.helper import (
    COMPILE_PROCESS,
    collect_later,
    helper_command,
    helper_environment,
    share_heap,
)
from logical_robots_tui.processes.hosted import (
    DESCRIPTORS,
    LARGEST,
    SOCKET,
    VERSION,
    Fork,
    GameRequest,
    use_compile_host,
)
from logical_robots_tui.processes.lifeline import (
    HEARTBEAT_BYTES,
    share_heartbeat,
    signal_when_closed,
)

_PARTS = ("tui", "player", "game", "editing", "world", "progress")
"""Parts of the package that a game may load, now or later."""

_STREAMS = ("stdin", "stdout", "stderr")
_FIRST_PASSED = 3  # descriptor of systemd's socket


def listen(folder: Path) -> socket.socket:
    """Return a socket in a folder, or the one that systemd passed; raise InputError."""
    if os.environ.get("LISTEN_PID") == str(os.getpid()):
        return socket.socket(fileno=_FIRST_PASSED)
    path = folder / SOCKET
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if path.is_socket():
            with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as client:
                if client.connect_ex(str(path)) == 0:
                    raise InputError("A host is at work there already", place=str(folder))
            path.unlink()
        listener.bind(str(path))
        path.chmod(0o600)
        listener.listen()
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"The folder can't be used: {reason}", place=str(folder)) from None
    return listener


class GameHost:
    """Forks games, and tells their clients how they ended.

    `companions` are pipes that keep other processes running; games close them.
    """

    def __init__(self, listener: socket.socket) -> None:
        self.companions: list[int] = []
        self._listener = listener
        self._compile_host: socket.socket | None = None
        self._selector = DefaultSelector()
        self._selector.register(listener, EVENT_READ)
        listener.setblocking(False)

    def warm_up(self, rehearse: Callable[[], object]) -> None:
        """Load what games and compile processes may need, and try a game, so that they share it."""
        self._start_compile_host()
        share_heap()
        collect_later()
        for part in _PARTS:
            package = import_module(f"logical_robots_tui.{part}")
            for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
                import_module(module.name)
        mimetypes.init(())
        rehearse()
        gc.collect()
        gc.freeze()

    def serve(self) -> list[str]:
        """Wait for clients for ever; return in each game that is forked, with its words."""
        while True:
            for key, _ in self._selector.select():
                if isinstance(key.data, Fork):
                    key.data.tell_end(self._selector, key.fd)
                    key.data.client.close()
                elif key.fileobj is self._listener:
                    with suppress(OSError):
                        client, _ = self._listener.accept()
                        client.setblocking(False)
                        self._selector.register(client, EVENT_READ)
                else:
                    assert isinstance(key.fileobj, socket.socket)
                    self._selector.unregister(key.fileobj)
                    words = self._start_game(key.fileobj)
                    if words is not None:
                        return words

    def _start_game(self, client: socket.socket) -> list[str] | None:
        """Fork a game for a client that has sent its request; return its words in the game."""
        request, descriptors = None, list[int]()
        with suppress(OSError, ValueError, TypeError):
            content, descriptors, *_ = socket.recv_fds(client, LARGEST, DESCRIPTORS)
            request = GameRequest(*json.loads(content))
        if request is None or request.version != VERSION or len(descriptors) != DESCRIPTORS:
            client.close()
            for descriptor in descriptors:
                os.close(descriptor)
            return None
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        has_compile_host = self._pass_on(theirs)
        pid = os.fork()
        if pid == 0:
            self._forget()
            _become(request, descriptors, ours if has_compile_host else None)
            return request.words
        ours.close()
        for descriptor in descriptors:
            os.close(descriptor)
        Fork(pid, client).watch(self._selector)
        with suppress(OSError):
            client.send(str(pid).encode())
        return None

    def _start_compile_host(self) -> None:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            subprocess.Popen(  # noqa: S603 - our own module
                helper_command(COMPILE_PROCESS, "host", str(theirs.fileno())),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd="/",
                env=helper_environment(),
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        self._compile_host = ours

    def _pass_on(self, game: socket.socket) -> bool:
        """Give the other end of a game's connection to the compile host, which may have ended."""
        with game:
            for _ in range(2):
                assert self._compile_host is not None
                try:
                    socket.send_fds(self._compile_host, [b"game"], [game.fileno()])
                except OSError:
                    self._compile_host.close()
                    self._start_compile_host()
                else:
                    return True
        return False

    def _forget(self) -> None:
        """Leave the host's connections, in a game."""
        for key in [*self._selector.get_map().values()]:
            for connection in (key.fileobj, getattr(key.data, "client", None)):
                if isinstance(connection, socket.socket):
                    connection.close()
            if isinstance(key.data, Fork):
                os.close(key.fd)
        self._selector.close()
        for pipe in self.companions:
            os.close(pipe)
        if self._compile_host is not None:
            self._compile_host.close()


def _become(
    request: GameRequest, descriptors: list[int], compile_host: socket.socket | None
) -> None:
    """Take over a client's terminal, environment, folder and lifeline."""
    os.setsid()
    *streams, memory, lifeline = descriptors
    for number, descriptor in enumerate(streams):
        os.dup2(descriptor, number)
        os.close(descriptor)
    share_heartbeat(mmap(memory, HEARTBEAT_BYTES))
    os.close(memory)
    signal_when_closed(lifeline, signal.SIGHUP)
    os.environ.clear()
    os.environ.update(request.environment)
    time.tzset()
    os.chdir(request.folder)
    sys.argv[1:] = request.words
    # New ones, because the host's may be files, and of another encoding.
    for number, (name, encoding) in enumerate(zip(_STREAMS, request.encodings, strict=True)):
        stream = open(number, "w" if number else "r", 1, encoding, closefd=False)  # noqa: SIM115 - stays open
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    from textual import constants

    vars(constants)["DRIVER"] = os.environ.get("TEXTUAL_DRIVER") or None  # as it would be read
    if compile_host is not None:
        use_compile_host(compile_host)
