"""Running the command: in this process, and in a pseudo-terminal of its own."""

import io
import json
import os
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import pyte
import pytest

from logical_robots_tui.cli.main import main
from tests.terminal import Terminal
from tests.waiting import PATIENCE

__all__ = ["Ask", "Command", "Shown", "Told", "in_terminal", "shown"]


@dataclass(frozen=True)
class Told:
    """What a finished command left behind."""

    status: int
    out: str
    err: str

    @property
    def data(self) -> Any:
        return json.loads(self.out, parse_constant=_refuse)

    @property
    def success(self) -> str:
        assert self.status == 0, self
        return self.out

    @property
    def refusal(self) -> str:
        assert self.status == 2, self
        return self.err


Ask = Callable[..., Told]
"""What runs the command with some of its words."""


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON")


class Command:
    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(
        self, *arguments: object, typed: Sequence[str] | None = None, status: int | None = None
    ) -> Told:
        """What the command leaves behind; lines can be typed into it, and a status expected."""
        with pytest.MonkeyPatch.context() as patch:
            if typed is not None:
                patch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in typed)))
            try:
                end_status = main([str(argument) for argument in arguments])
            except SystemExit as end:
                end_status = int(end.code or 0)
        caught = self._capsys.readouterr()
        told = Told(end_status, caught.out, caught.err)
        assert status in (None, end_status), told
        return told


@dataclass(frozen=True)
class Shown:
    """What a finished command left behind on a terminal."""

    screen: pyte.Screen

    @property
    def lines(self) -> list[str]:
        return [line.rstrip() for line in self.screen.display]

    @property
    def text(self) -> str:
        return "\n".join(self.lines).rstrip()


def shown(*arguments: object, size: tuple[int, int] = (100, 40), status: int = 0) -> Shown:
    """What the command shows until it ends with a status; it can't be typed to.

    It runs in this process and takes its output for a terminal.
    """
    ours, theirs = os.openpty()
    screen = pyte.Screen(*size)
    reading = threading.Thread(target=_draw, args=(ours, screen))
    reading.start()
    with (
        open(theirs, "w", encoding="utf-8") as terminal,  # noqa: PTH123 - it has no path
        pytest.MonkeyPatch.context() as patch,
    ):
        for name, value in zip(("COLUMNS", "LINES"), size, strict=True):
            patch.setenv(name, str(value))
        patch.setenv("TERM", "xterm-256color")
        patch.setenv("COLORTERM", "truecolor")
        patch.setattr(sys, "stdout", terminal)
        patch.setattr(sys, "stderr", terminal)
        end_status = main([str(argument) for argument in arguments])
    reading.join(PATIENCE)
    os.close(ours)
    assert end_status == status, screen.display
    return Shown(screen)


def _draw(terminal: int, screen: pyte.Screen) -> None:
    stream = pyte.ByteStream(screen)
    while True:
        try:
            chunk = os.read(terminal, 65536)
        except OSError:  # how Linux says that nobody writes any more
            return
        if not chunk:
            return
        stream.feed(chunk)


def in_terminal(*arguments: object, size: tuple[int, int] = (100, 40)) -> Terminal:
    return Terminal([sys.executable, "-m", "logical_robots_tui", *arguments], size=size)
