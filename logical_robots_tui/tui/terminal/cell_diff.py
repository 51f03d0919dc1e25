"""The output that updates a terminal to show other cells: only cells that differ."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from math import inf
from typing import NamedTuple, TypeAlias

from rich.cells import cell_len
from rich.color import Color, ColorSystem, ColorType
from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region

from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, MOST_STYLES, PAPER, colour_of

_CLOSE = 3  # equal cells between two changed ones that are cheaper to rewrite than to skip

_ATTRIBUTES = (
    *((1, "bold"), (2, "dim"), (3, "italic"), (4, "underline"), (5, "blink"), (6, "blink2")),
    *((7, "reverse"), (8, "conceal"), (9, "strike"), (21, "underline2")),
    *((51, "frame"), (52, "encircle"), (53, "overline")),
)
"""Codes and names of Rich's attributes."""


class CellStyle(NamedTuple):
    """The style of a cell as codes for ``CSI … m``; "" is the terminal's default."""

    attributes: str
    ink: str
    paper: str


_PLAIN = CellStyle("", "", "")

Cell: TypeAlias = tuple[str, CellStyle]
"""A character, or "" for the second half of a wide one, and its style."""


class CellDiff:
    """What a terminal shows, what it should show, and the output that leads there.

    `colours` is None for no colours; `looks` are styles by packed style of `Cells`.
    """

    def __init__(self, columns: int, rows: int, colours: ColorSystem | None) -> None:
        self.columns, self.rows = columns, rows
        self.looks = _CellStyles(colours)
        self._colours = colours
        self._current: list[list[Cell | None]] = [[None] * columns for _ in range(rows)]
        self._target: list[list[Cell | None]] = [[None] * columns for _ in range(rows)]
        self._behind: dict[int, tuple[int, int]] = {}
        self._turn = 0

    def take(self, pieces: Iterable[tuple[int, int, Sequence[Segment]]]) -> None:
        """Show pieces (row, first column, segments), ignoring those outside the terminal."""
        for row, column, segments in pieces:
            self.put(row, column, _cells(segments, self._colours))

    def put(self, row: int, column: int, cells: Sequence[Cell]) -> None:
        """Show cells of a row, ignoring those outside a terminal that was just resized."""
        if not 0 <= row < self.rows or column >= self.columns:
            return
        if column < 0:
            cells, column = cells[-column:], 0
        cells = cells[: self.columns - column]
        if not cells:
            return
        target, stop = self._target[row], column + len(cells)
        # Overwriting half of a wide character also clears its other half.
        if column and _is_second_half(target[column]):
            target[column - 1] = None
        if stop < self.columns and _is_second_half(target[stop]):
            target[stop] = None
        target[column:stop] = cells
        self._mark(row, column, stop)

    def forget(self) -> None:
        """Forget what the terminal shows, so that everything is sent again."""
        self._current = [[None] * self.columns for _ in range(self.rows)]
        self._behind = dict.fromkeys(range(self.rows), (0, self.columns))

    def sequence(self, limit: float = inf, last: Region | None = None) -> str:
        """Return text and escape sequences that update the terminal, or "".

        After `limit` bytes no further run of cells is started; `last` cells, the moving picture,
        are sent last, their rows in turns. The style is plain afterwards, the cursor anywhere.
        """
        spans = self._spans(last)
        self._behind.clear()
        sent: list[str] = []
        pen, size = _PLAIN, 0
        cursor: tuple[int, int] | None = None
        for number, (row, first, stop) in enumerate(spans):
            if size >= limit:
                self._turn = row
                for span in spans[number:]:
                    self._mark(*span)
                break
            for start, end in self._runs(row, first, stop):
                run = [_move(cursor, row, start)]
                pen = self._write(run, pen, row, start, end)
                # After the last column the cursor's place is undefined.
                cursor = (row, end) if end < self.columns else None
                sent += run
                size += len("".join(run).encode())
        if pen != _PLAIN:
            sent.append("\x1b[m")
        return "".join(sent)

    def _mark(self, row: int, first: int, stop: int) -> None:
        span = self._behind.get(row, (first, stop))
        self._behind[row] = min(first, span[0]), max(stop, span[1])

    def _spans(self, last: Region | None) -> list[tuple[int, int, int]]:
        soon: list[tuple[int, int, int]] = []
        late: list[tuple[int, int, int]] = []
        for row, (first, stop) in sorted(self._behind.items()):
            if last is None or not last.y <= row < last.bottom:
                soon.append((row, first, stop))
                continue
            left, right = max(first, last.x), min(stop, last.right)
            beside = (first, min(stop, left)), (max(first, right), stop)
            soon += [(row, start, end) for start, end in beside if start < end]
            if left < right:
                late.append((row, left, right))
        late.sort(key=lambda span: (span[0] < self._turn, span[0]))
        return soon + late

    def _runs(self, row: int, first: int, stop: int) -> Iterator[tuple[int, int]]:
        target, current = self._target[row], self._current[row]
        differing = [
            place
            for place, (new, old) in enumerate(
                zip(target[first:stop], current[first:stop], strict=True), first
            )
            if new is not None and new != old
        ]
        start = end = -1
        for place in differing:
            if start >= 0 and (place - end > _CLOSE or None in target[end:place]):
                yield self._whole(row, start, end)
                start = -1
            start, end = (place if start < 0 else start), place
        if start >= 0:
            yield self._whole(row, start, end)

    def _whole(self, row: int, first: int, last: int) -> tuple[int, int]:
        target, current, stop = self._target[row], self._current[row], last + 1

        def cut(place: int) -> bool:
            return _is_second_half(target[place]) or _is_second_half(current[place])

        while first > 0 and cut(first) and target[first - 1] is not None:
            first -= 1
        while stop < self.columns and cut(stop) and target[stop] is not None:
            stop += 1
        return first, stop

    def _write(self, run: list[str], pen: CellStyle, row: int, start: int, stop: int) -> CellStyle:
        current = self._current[row]
        if start and _is_second_half(current[start]):
            current[start - 1] = None
        if stop < self.columns and _is_second_half(current[stop]):
            current[stop] = None
        current[start:stop] = cells = self._target[row][start:stop]
        for cell in cells:
            assert cell is not None
            text, look = cell
            if look is not pen and text:
                # A blank looks the same in any foreground colour.
                if text == " " and not look.attributes:
                    look = CellStyle("", pen.ink if not pen.attributes else "", look.paper)
                run.append(_change(pen, look))
                pen = look
            run.append(text)
        return pen


class _CellStyles(dict[int, CellStyle]):
    """The style of each packed style, computed on demand."""

    def __init__(self, colours: ColorSystem | None) -> None:
        super().__init__()
        self._colours = colours

    def __missing__(self, packed: int) -> CellStyle:
        if len(self) > MOST_STYLES:
            self.clear()
        attributes, ink, paper = "1" if packed & BOLD else "", "", ""
        if self._colours is not None:
            ink = _codes_of(colour_of(packed >> 24 & PAPER), self._colours, is_ink=True)
            paper = _codes_of(colour_of(packed & PAPER), self._colours, is_ink=False)
        self[packed] = look = _same(CellStyle(attributes, ink, paper))
        return look


def _codes_of(color: Color, colours: ColorSystem, *, is_ink: bool) -> str:
    return ";".join(reduce_colour(color, colours).get_ansi_codes(foreground=is_ink))


def _is_second_half(cell: Cell | None) -> bool:
    return cell is not None and cell[0] == ""


def _cells(segments: Sequence[Segment], colours: ColorSystem | None) -> list[Cell]:
    """Return text and style of each cell; an empty text follows a wide character."""
    cells: list[Cell] = []
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
            elif cells and char not in _TURNING:
                base = -1 if cells[-1][0] else -2
                cells[base] = (cells[base][0] + char, cells[base][1])
    return cells


_TURNING = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Characters with which a text would turn the direction of everything around it."""

_width = lru_cache(maxsize=4096)(cell_len)


@lru_cache(maxsize=MOST_STYLES)
def look_of(style: Style | None, colours: ColorSystem | None) -> CellStyle:
    if style is None:
        return _PLAIN
    codes = ";".join(str(code) for code, name in _ATTRIBUTES if getattr(style, name))
    ink = paper = ""
    if colours is not None:
        if style.color is not None and not style.color.is_default:
            ink = _codes_of(style.color, colours, is_ink=True)
        if style.bgcolor is not None and not style.bgcolor.is_default:
            paper = _codes_of(style.bgcolor, colours, is_ink=False)
    return _same(CellStyle(codes, ink, paper))


@lru_cache(maxsize=MOST_STYLES)
def _same(look: CellStyle) -> CellStyle:
    """Return one object for equal styles, which makes comparisons faster."""
    return look


@lru_cache(maxsize=MOST_STYLES)
def _change(pen: CellStyle, look: CellStyle) -> str:
    if pen == look:
        return ""
    adds_only = pen.attributes == "" and (look.ink or not pen.ink) and (look.paper or not pen.paper)
    if adds_only or (pen.attributes == look.attributes and look.ink and look.paper):
        codes = [new for old, new in zip(pen, look, strict=True) if new != old]
    else:
        codes = [code for code in ("0", *look) if code]
    return f"\x1b[{';'.join(codes)}m"


def _move(cursor: tuple[int, int] | None, row: int, column: int) -> str:
    if cursor is None or cursor[0] != row or cursor[1] > column:
        return f"\x1b[{row + 1};{column + 1}H"
    steps = column - cursor[1]
    return "" if not steps else "\x1b[C" if steps == 1 else f"\x1b[{steps}C"


_LEVELS = (0, 95, 135, 175, 215, 255)  # channel values of the colour cube with 256 colours
_FOR_A_HUE = 5  # how much worse a colour may be than a grey, to keep its hue

_GREYS = tuple(8 + 10 * step for step in range(24))


@lru_cache(maxsize=MOST_STYLES)
def reduce_colour(color: Color, colours: ColorSystem) -> Color:
    """Return the terminal's nearest colour.

    With 256 colours by sight: the grey ramp counts, because the cube's only dark colour is
    black, and hue more than in Rich's own choice.
    """
    if color.type != ColorType.TRUECOLOR or colours != ColorSystem.EIGHT_BIT:
        return color.downgrade(colours)
    assert color.triplet is not None
    triplet = color.triplet
    cube = [min(range(6), key=lambda n: abs(_LEVELS[n] - value)) for value in triplet]
    # A dominant channel must not vanish: it gets the first level of the cube.
    strongest = max(triplet)
    if 40 <= strongest < 75 and strongest - min(triplet) >= 22:
        cube = [
            1 if value == strongest else level for value, level in zip(triplet, cube, strict=True)
        ]
    grey = min(range(24), key=lambda n: sum((_GREYS[n] - value) ** 2 for value in triplet))
    colourful = sum((_LEVELS[n] - value) ** 2 for n, value in zip(cube, triplet, strict=True))
    plain = sum((_GREYS[grey] - value) ** 2 for value in triplet)
    is_hue = strongest - min(triplet) >= 22 and colourful <= _FOR_A_HUE * plain
    if plain < colourful and not is_hue:
        return Color.from_ansi(232 + grey)
    red, green, blue = cube
    if red == green == blue and plain < colourful:
        return Color.from_ansi(232 + grey)
    return Color.from_ansi(16 + 36 * red + 6 * green + blue)
