"""A real sshd on a free port of this machine, with keys of its own, and a line to it."""

import getpass
import os
import shutil
import socket
import subprocess
import threading
from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from typing import Self

from tests.installed import clean_environment
from tests.waiting import PATIENCE, until

__all__ = ["SSHD", "Line", "Server", "is_listening"]

SSHD = shutil.which("sshd", path=os.pathsep.join((os.environ.get("PATH", ""), "/usr/sbin")))

_CONFIG = """\
ListenAddress 127.0.0.1:{port}
HostKey {folder}/host
PidFile none
AuthorizedKeysFile {folder}/keys
StrictModes no
UsePAM no
PasswordAuthentication no
PermitRootLogin prohibit-password
MaxStartups 100
Subsystem sftp internal-sftp
"""


class Server:
    """Runs an sshd in which only the user who runs the tests can log in, by throw-away keys.

    Args:
        folder: Where keys, configuration and log are.
        config: Added to the configuration.
        players: Names; each gets a key.
        keys: A line of the file of keys, made by ``str.format`` with ``name`` and ``key``.
        inside: What starts sshd, such as a shell in namespaces of its own.
    """

    def __init__(
        self,
        folder: Path,
        config: str = "",
        players: Sequence[str] = ("player",),
        keys: str = "{key}",
        inside: Sequence[str] = (),
    ) -> None:
        self.folder, self._inside = folder, inside
        self.log = folder / "log"
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = int(free.getsockname()[1])
        for name in ("host", *players):
            subprocess.run(
                ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f", folder / name],
                check=True,
                timeout=PATIENCE,
            )
        lines = [
            keys.format(name=name, key=(folder / f"{name}.pub").read_text().strip())
            for name in players
        ]
        (folder / "keys").write_text("\n".join(lines) + "\n")
        (folder / "sshd_config").write_text(_CONFIG.format(port=self.port, folder=folder) + config)

    def __enter__(self) -> Self:
        if os.geteuid() == 0:
            Path("/run/sshd").mkdir(mode=0o755, exist_ok=True)  # as the system's own service does
        assert SSHD
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [*self._inside, SSHD, "-D", "-e", "-f", self.folder / "sshd_config"],
                stdin=subprocess.DEVNULL,
                stderr=log,
                env=clean_environment(),
            )
        until(lambda: is_listening(self.port), self.log.read_text)
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        self.process.wait(PATIENCE)

    def client(self, *options: str, player: str = "player", port: int | None = None) -> list[str]:
        """What to type to log in, by way of the server's port or that of a line to it."""
        return [
            *("ssh", "-F", "none", "-p", str(port or self.port), "-i", str(self.folder / player)),
            *("-o", "IdentitiesOnly=yes", "-o", "UserKnownHostsFile=/dev/null"),
            *("-o", "StrictHostKeyChecking=no", "-o", "LogLevel=ERROR"),
            *options,
            f"{getpass.getuser()}@127.0.0.1",
        ]


def is_listening(port: int) -> bool:
    try:
        socket.create_connection(("127.0.0.1", port), 1).close()
    except OSError:
        return False
    return True


class Line:
    """Stands between ssh clients and a server, counts what comes from the server, and is slow.

    Args:
        port: The server's.
        rate: Bytes a second towards the client, 0 for as many as there are.
    """

    BUCKET = 2048  # bytes that may come at once

    def __init__(self, port: int, rate: int = 0) -> None:
        self.rate = rate
        self.traffic = 0
        self._server = port
        self._door = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._door.getsockname()[1])
        self._ends: list[socket.socket] = []

    def __enter__(self) -> Self:
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._door.shutdown(socket.SHUT_RDWR)
        self._door.close()
        self.cut()

    def cut(self) -> None:
        for end in self._ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                continue

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._door.accept()
            except OSError:
                return
            # As little as the system allows is buffered here: the line alone is to be what waits.
            server = socket.socket()
            if self.rate:
                server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, self.BUCKET)
            server.connect(("127.0.0.1", self._server))
            for end in (client, server):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._ends += client, server
            chunk = self.BUCKET if self.rate else 65536
            for ends in ((client, server), (server, client, chunk)):
                threading.Thread(target=self._pump, args=ends, daemon=True).start()

    def _pump(self, source: socket.socket, target: socket.socket, chunk: int = 0) -> None:
        """Carry bytes until one side ends; those in chunks are counted and take their time."""
        free_at = monotonic()
        pause = threading.Event()
        try:
            while data := source.recv(chunk or 65536):
                if chunk:
                    self.traffic += len(data)
                    if self.rate:
                        credit = self.BUCKET / self.rate
                        free_at = max(free_at, monotonic() - credit) + len(data) / self.rate
                        pause.wait(max(0.0, free_at - monotonic()))
                target.sendall(data)
        except OSError:
            pass
        for end in (source, target):
            end.close()
