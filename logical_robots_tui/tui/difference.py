"""What to send to a terminal so that it shows other cells: only those that differ."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len

from logical_robots_tui.tui.reduction import reduced

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rich.color import ColorSystem
    from rich.segment import Segment
    from rich.style import Style

__all__ = ["Difference", "Look", "look_of"]

_CLOSE = 3
"""Cells that are the same, between two that differ, up to which writing them again is shorter."""

_ATTRIBUTES = ("1", "2", "3", "4", "5", "6", "7", "8", "9", "21", "51", "52", "53")
"""Codes of Rich's attributes, bit by bit."""


class Look(NamedTuple):
    """What a cell looks like, as codes for ``CSI … m``; "" is the terminal's own."""

    attributes: str
    ink: str
    paper: str


_PLAIN = Look("", "", "")


class Difference:
    """What a terminal shows, and how to make it show something else.

    Args:
        columns: Cells across.
        rows: Cells down.
        colours: What the terminal can show; None is no colour at all.
    """

    def __init__(self, columns: int, rows: int, colours: ColorSystem | None) -> None:
        self.columns, self.rows = columns, rows
        self._colours = colours
        self._texts: list[list[str | None]] = [[None] * columns for _ in range(rows)]
        self._looks: list[list[Look]] = [[_PLAIN] * columns for _ in range(rows)]

    def sequence(self, pieces: Iterable[tuple[int, int, Sequence[Segment]]]) -> str:
        """Return what to write so that the terminal shows pieces of lines.

        Args:
            pieces: (row, first column, segments). What lies outside the terminal is left out.

        Returns:
            Text and escape sequences, or "" if all of it is there already. They leave the style
            plain and the cursor anywhere.
        """
        sent: list[str] = []
        pen = _PLAIN
        at: tuple[int, int] | None = None
        for row, column, segments in pieces:
            if not 0 <= row < self.rows:
                continue
            texts, looks = self._texts[row], self._looks[row]
            for start, stop, found in self._runs(row, column, segments):
                sent.append(_move(at, row, start))
                # Half of a character that is overwritten takes the other half with it.
                if start and texts[start] == "":
                    texts[start - 1] = None
                if stop < self.columns and texts[stop] == "":
                    texts[stop] = None
                for place, (text, look) in enumerate(found, start):
                    texts[place], looks[place] = text, look
                    if look is not pen and text:
                        # A blank looks the same in any ink.
                        if text == " " and not look.attributes:
                            look = Look("", pen.ink if not pen.attributes else "", look.paper)
                        sent.append(_change(pen, look))
                        pen = look
                    sent.append(text)
                # After the last column a terminal's cursor is wherever it likes.
                at = (row, stop) if stop < self.columns else None
        if pen != _PLAIN:
            sent.append("\x1b[m")
        return "".join(sent)

    def _runs(
        self, row: int, column: int, segments: Sequence[Segment]
    ) -> Iterator[tuple[int, int, list[tuple[str, Look]]]]:
        """Return the runs of cells that differ, as (first column, column after the last, cells)."""
        cells = _cells(segments, self._colours)
        if column < 0:
            cells, column = cells[-column:], 0
        cells = cells[: self.columns - column]
        texts, looks = self._texts[row], self._looks[row]
        differing = [
            place
            for place, (text, look) in enumerate(cells, column)
            if texts[place] != text or (looks[place] is not look and looks[place] != look)
        ]
        first = last = -1
        for place in differing:
            if first >= 0 and place - last > _CLOSE:
                yield self._whole(row, column, first, last, cells)
                first = -1
            first, last = (place if first < 0 else first), place
        if first >= 0:
            yield self._whole(row, column, first, last, cells)

    def _whole(
        self, row: int, column: int, first: int, last: int, cells: list[tuple[str, Look]]
    ) -> tuple[int, int, list[tuple[str, Look]]]:
        """Return a run, widened so that no character of two cells is cut."""
        texts, stop = self._texts[row], last + 1
        while first > column and (cells[first - column][0] == "" or texts[first] == ""):
            first -= 1
        while stop < column + len(cells) and (cells[stop - column][0] == "" or texts[stop] == ""):
            stop += 1
        return first, stop, cells[first - column : stop - column]


def _cells(segments: Sequence[Segment], colours: ColorSystem | None) -> list[tuple[str, Look]]:
    """Return text and look of each cell; a character of two cells is followed by an empty text."""
    cells: list[tuple[str, Look]] = []
    for text, style, control in segments:
        if control:
            continue
        look = look_of(style, colours)
        if text.isascii():
            cells += [(char, look) for char in text]
            continue
        for char in text:
            width = _width(char)
            if width:
                cells.append((char, look))
                if width == 2:
                    cells.append(("", look))
            elif cells:
                base = -1 if cells[-1][0] else -2
                cells[base] = (cells[base][0] + char, cells[base][1])
    return cells


_width = lru_cache(maxsize=4096)(cell_len)


@lru_cache(maxsize=20_000)
def look_of(style: Style | None, colours: ColorSystem | None) -> Look:
    """Return what a style looks like on a terminal.

    Args:
        style: Rich's style.
        colours: What the terminal can show; None is no colour at all.
    """
    if style is None:
        return _PLAIN
    bits = style._attributes & style._set_attributes
    codes = ";".join(code for bit, code in enumerate(_ATTRIBUTES) if bits >> bit & 1)
    ink = paper = ""
    if colours is not None:
        if style.color is not None and not style.color.is_default:
            ink = ";".join(reduced(style.color, colours).get_ansi_codes())
        if style.bgcolor is not None and not style.bgcolor.is_default:
            paper = ";".join(reduced(style.bgcolor, colours).get_ansi_codes(foreground=False))
    return _same(Look(codes, ink, paper))


@lru_cache(maxsize=40_000)
def _same(look: Look) -> Look:
    """Return one object for equal looks, which is compared faster."""
    return look


@lru_cache(maxsize=40_000)
def _change(pen: Look, look: Look) -> str:
    """Return how to go from one look to another."""
    if pen == look:
        return ""
    adds_only = pen.attributes == "" and (look.ink or not pen.ink) and (look.paper or not pen.paper)
    if adds_only or (pen.attributes == look.attributes and look.ink and look.paper):
        codes = [new for old, new in zip(pen, look, strict=True) if new != old]
    else:
        codes = [code for code in ("0", *look) if code]
    return f"\x1b[{';'.join(codes)}m"


def _move(at: tuple[int, int] | None, row: int, column: int) -> str:
    """Return how to bring the cursor to a cell."""
    if at is None or at[0] != row or at[1] > column:
        return f"\x1b[{row + 1};{column + 1}H"
    steps = column - at[1]
    return "" if not steps else "\x1b[C" if steps == 1 else f"\x1b[{steps}C"
