"""Open programs: their lines, and places in them as the editor counts and as we count."""

from __future__ import annotations

from bisect import bisect_left
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from lsprotocol import types
from pygls.uris import to_fs_path
from pygls.workspace import PositionCodec

from logical_robots_tui.language.source_text import line_of, place_of, with_newlines

if TYPE_CHECKING:
    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.mind import Program


class Document:
    """A version of an open program.

    Attributes:
        text: With all lines ended by newlines, and as long as the editor's text.
        program: What the last version that compiled has become.
        diagnostics: What is published about this version.
    """

    program: Program | None = None
    diagnostics: tuple[Diagnostic, ...] = ()

    def __init__(self, uri: str, text: str, version: int | None, codec: PositionCodec) -> None:
        self.uri, self.version, self._codec = uri, version, codec
        self.text = with_newlines(text)
        self.path = Path(to_fs_path(uri) or "untitled.l")

    @cached_property
    def lines(self) -> list[str]:
        return self.text.split("\n")

    def position(self, row: int, column: int) -> types.Position:
        """Return the editor's position for a row and a column from 0."""
        prefix = self.lines[row][:column]
        units = len(prefix) if prefix.isascii() else self._codec.client_num_units(prefix)
        return types.Position(row, units)

    def range(self, start: int, stop: int) -> types.Range:
        """Return the editor's range between two offsets."""
        (line, column), (last, end) = place_of(self.text, start), place_of(self.text, stop)
        return types.Range(self.position(line - 1, column - 1), self.position(last - 1, end - 1))

    def cursor(self, position: types.Position) -> tuple[int, int]:
        """Return row and column of an editor's position, or the nearest that there are."""
        row = min(position.line, len(self.lines) - 1)
        columns = range(len(self.lines[row]))
        return row, bisect_left(
            columns, position.character, key=lambda column: self.position(row, column).character
        )

    def offset(self, position: types.Position) -> int:
        row, column = self.cursor(position)
        return line_of(self.text, row + 1) + column
