"""Recordings as asciicasts, version 2 (https://docs.asciinema.org/manual/asciicast/v2/)."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from rich.color import ColorSystem

from logical_robots_tui.tui.terminal.cell_diff import Difference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.segment import Segment

__all__ = ["Cast"]

_BEGIN = "\x1b[?25l\x1b[2J"
"""No cursor, and nothing on the screen."""


class Cast:
    """Turns what a screen shows from time to time into the lines of an asciicast.

    Args:
        write: Takes each line, with its end.
        columns: Cells across.
        rows: Cells down.
        title: What it is called.
    """

    def __init__(self, write: Callable[[str], object], columns: int, rows: int, title: str) -> None:
        self._write = write
        self._shown = Difference(columns, rows, ColorSystem.TRUECOLOR)
        head = {"version": 2, "width": columns, "height": rows, "title": title}
        self._line({**head, "env": {"TERM": "xterm-256color"}})
        self._line([0.0, "o", _BEGIN])

    def show(self, seconds: float, lines: Sequence[Sequence[Segment]]) -> None:
        """Show something else; only the cells that differ are written.

        Args:
            seconds: Since the beginning; never less than the last time.
            lines: The whole screen, from the top; none as long as it is not laid out.
        """
        if not lines:
            return
        columns = max(sum(segment.cell_length for segment in line) for line in lines)
        if (columns, len(lines)) != (self._shown.columns, self._shown.rows):
            self._shown = Difference(columns, len(lines), ColorSystem.TRUECOLOR)
            self._line([round(seconds, 4), "r", f"{columns}x{len(lines)}"])
            self._line([round(seconds, 4), "o", _BEGIN])
        self._shown.take((row, 0, line) for row, line in enumerate(lines))
        sent = self._shown.sequence()
        if sent:
            self._line([round(seconds, 4), "o", sent])

    def wait(self, seconds: float) -> None:
        """Leave the screen as it is until then."""
        self._line([round(seconds, 4), "o", ""])

    def _line(self, what: object) -> None:
        self._write(json.dumps(what, ensure_ascii=False) + "\n")
