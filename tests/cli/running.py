"""Running the command: in this process, and in a pseudo-terminal of its own."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.main import main
from tests.terminal import Terminal

if TYPE_CHECKING:
    import pytest

__all__ = ["Command", "Told", "in_terminal"]


@dataclass(frozen=True)
class Told:
    """What a finished command left behind."""

    status: int
    out: str
    err: str

    @property
    def data(self) -> Any:
        """Standard output as JSON, as strict as can be."""
        return json.loads(self.out, parse_constant=_refuse)


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON")


class Command:
    """The command in this process, its output caught."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: object) -> Told:
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as end:
            status = int(end.code or 0)
        caught = self._capsys.readouterr()
        return Told(status, caught.out, caught.err)


def in_terminal(*arguments: object, size: tuple[int, int] = (100, 40)) -> Terminal:
    """The command as a process in a terminal of its own."""
    return Terminal([sys.executable, "-m", "logical_robots_tui", *arguments], size=size)
