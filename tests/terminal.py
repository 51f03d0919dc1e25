"""A process in a pseudo-terminal of its own, and what it has drawn there."""

import os
import select
import signal
import struct
import subprocess
import termios
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fcntl import ioctl
from pathlib import Path
from time import monotonic, perf_counter
from typing import Self

import pyte

from tests.waiting import PATIENCE

__all__ = ["WHERE_IS_THE_CURSOR", "Terminal", "hear_signals", "looks"]

CHUNK = 65536
WHERE_IS_THE_CURSOR = b"\x1b[6n"
AT_LEAST = 0.1  # seconds to go on reading before anything is drawn


class Terminal:
    """Runs a command in a terminal only the test sees; its keys are signals if it `controls`."""

    patience = PATIENCE

    def __init__(
        self,
        command: Sequence[object],
        *,
        size: tuple[int, int] = (100, 40),
        env: Mapping[str, str] | None = None,
        controls: bool = False,
    ) -> None:
        self._controls = controls
        self._screen = pyte.Screen(*size)
        self._stream = pyte.ByteStream(self._screen)
        self._raw = bytearray()
        self._undrawn: deque[tuple[float, bytes]] = deque()
        self._answered = 0
        self._command = [str(word) for word in command]
        inherited = {k: v for k, v in os.environ.items() if k not in {"COLUMNS", "LINES"}}
        self._env = {**inherited, "TERM": "xterm-256color", "COLORTERM": "truecolor", **(env or {})}

    def __enter__(self) -> Self:
        self._ours, theirs = os.openpty()
        size = struct.pack("HHHH", self._screen.lines, self._screen.columns, 0, 0)
        ioctl(theirs, termios.TIOCSWINSZ, size)
        self.process = subprocess.Popen(
            self._command,
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            env=self._env,
            start_new_session=True,
            preexec_fn=_take_control if self._controls else hear_signals,
        )
        os.close(theirs)
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(OSError, ValueError):  # it has ended, or has forked no game
            os.kill(self.game, signal.SIGKILL)  # hung up on, it would still write
        self.process.kill()
        self.process.wait(PATIENCE)
        os.close(self._ours)

    @property
    def screen(self) -> pyte.Screen:
        """The cells; drawn when somebody looks, because that takes longer than to receive them."""
        while self._undrawn:
            self._stream.feed(self._undrawn.popleft()[1])
        return self._screen

    @property
    def text(self) -> str:
        return "\n".join(line.rstrip() for line in self.screen.display).rstrip()

    @property
    def everything(self) -> str:
        return self._raw.decode("utf-8", "replace")

    @property
    def game(self) -> int:
        pid = self.process.pid
        (found,) = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        return int(found)

    @property
    def traffic(self) -> int:
        return len(self._raw)

    @property
    def frames(self) -> int:
        """How many frames were ever sent that asked whether they have arrived."""
        return self._answered

    def fileno(self) -> int:
        return self._ours

    def receive(self) -> bool:
        """Read what is there; whether there will be more."""
        return self._read(0.0)

    def has_received(self, text: str, since: int = 0) -> bool:
        return self._raw.find(text.encode(), since) >= 0

    def send(self, keys: str, sees: str = "") -> None:
        """Type, and read on until a text stands on the screen, if one is given."""
        os.write(self._ours, keys.encode())
        if sees:
            self.wait_for(sees)

    def resize(self, columns: int, lines: int) -> None:
        """Tell the game that its terminal has another size; what the test sees keeps its own."""
        ioctl(self._ours, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        if not self._controls:  # else the kernel does
            os.kill(self.game, signal.SIGWINCH)

    def wait_for(self, condition: str | Callable[[], object]) -> None:
        """Read on until a text stands on the screen, or a condition holds."""
        deadline = monotonic() + self.patience
        while not (condition in self.text if isinstance(condition, str) else condition()):
            assert monotonic() < deadline, f"not within {self.patience} s; instead:\n{self.text}"
            assert self._read(deadline), f"it ended before that; its screen:\n{self.text}"

    def press_until(self, keys: str, condition: Callable[[], object]) -> None:
        """Press keys in turn, as a player does again who saw no effect, until a condition holds."""
        deadline = monotonic() + self.patience
        while not condition():
            for key in keys:
                assert monotonic() < deadline, f"not within {self.patience} s:\n{self.text}"
                with suppress(OSError):  # it has ended
                    self.send(key)
                self.read_for(0.5)

    def arrival_of(self, condition: Callable[[], object]) -> float:
        """When that came in, by `perf_counter`, which made a condition true of the screen.

        All is read before any of it is drawn, piece by piece: to draw takes longer than the program
        that is measured, and would hold it up.
        """
        deadline = monotonic() + PATIENCE
        while True:
            self.read_for(AT_LEAST)
            pieces, self._undrawn = self._undrawn, deque()
            while pieces:
                came, piece = pieces.popleft()
                self._stream.feed(piece)
                if condition():
                    self._undrawn = pieces
                    return came
            assert monotonic() < deadline, f"not within {PATIENCE} s; instead:\n{self.text}"

    def wait_to_receive(self, text: str) -> None:
        """Read on until a text comes in; quicker than looking at the screen again and again."""
        begun, sought = len(self._raw), text.encode()
        self.wait_for(lambda: self._raw.find(sought, begun) >= 0)

    def wait_for_quiet(self, seconds: float = 1.0) -> None:
        deadline = monotonic() + PATIENCE
        while select.select([self._ours], [], [], seconds)[0] and self._read(deadline):
            assert monotonic() < deadline, f"it writes on after {PATIENCE} s:\n{self.text}"

    def read_for(self, seconds: float) -> None:
        end = monotonic() + seconds
        while self._read(end) and monotonic() < end:
            pass

    def finish(self) -> int:
        deadline = monotonic() + PATIENCE
        while self._read(deadline):
            assert monotonic() < deadline, f"it goes on after {PATIENCE} s:\n{self.text}"
        return self.process.wait(PATIENCE)

    def _read(self, deadline: float) -> bool:
        readable, _, _ = select.select([self._ours], [], [], max(0.0, deadline - monotonic()))
        if not readable:
            return True
        try:
            chunk = os.read(self._ours, CHUNK)
        except OSError:  # how Linux says that the last process has closed the terminal
            return False
        self._keep(chunk)
        questions = self._raw.count(WHERE_IS_THE_CURSOR)
        if questions > self._answered:
            self.send("\x1b[1;1R" * (questions - self._answered))
        self._answered = questions
        return bool(chunk)

    def _keep(self, chunk: bytes) -> None:
        self._raw += chunk
        self._undrawn.append((perf_counter(), chunk))


def hear_signals() -> None:
    """Undo what a shell does to a command in the background, and nohup to any: make it deaf."""
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def looks(screen: pyte.Screen) -> list[list[tuple[object, ...]]]:
    """All that can be seen of a screen, cell by cell; the ink of a blank can't."""
    shown = []
    for row in range(screen.lines):
        line: list[tuple[object, ...]] = []
        for column in range(screen.columns):
            cell = screen.buffer[row][column]
            if cell.data == " " and not (cell.reverse or cell.underscore):
                line.append((" ", cell.bg))
            else:
                marks = cell.bold, cell.reverse, cell.underscore
                line.append((cell.data, cell.bg, cell.fg, *marks))
        shown.append(line)
    return shown


def _take_control() -> None:
    hear_signals()
    ioctl(0, termios.TIOCSCTTY, 0)
