"""Draw ``docs/screenshot.svg``: the game plays in a terminal, and its cells become a picture.

With the one argument ``levels`` draw ``docs/levels.svg``, the level screen after some victories.

Block and line characters become rectangles, so that the picture has no seams in any font.
"""

from __future__ import annotations

import sys
import tempfile
from html import escape
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.game import reference_for
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import list_levels, load_level
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pyte

TARGET = Path(__file__).with_name("screenshot.svg")
SIZE = (120, 40)
WIDTH, HEIGHT, FONT = 8.4, 18.0, 14.0
INK, PAPER = "c9d1d9", "0d1117"
FONTS = "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace"

# A shape is a list of rectangles (x, y, width, height), as parts of a cell.
Shape: TypeAlias = list[tuple[float, float, float, float]]
QUARTERS: Shape = [(0, 0, 0.5, 0.5), (0.5, 0, 0.5, 0.5), (0, 0.5, 0.5, 0.5), (0.5, 0.5, 0.5, 0.5)]
THIN = 1.2
STROKES = {
    "n": ((WIDTH - THIN) / 2 / WIDTH, 0, THIN / WIDTH, 0.5),
    "s": ((WIDTH - THIN) / 2 / WIDTH, 0.5, THIN / WIDTH, 0.5),
    "w": (0, (HEIGHT - THIN) / 2 / HEIGHT, 0.5, THIN / HEIGHT),
    "e": (0.5, (HEIGHT - THIN) / 2 / HEIGHT, 0.5, THIN / HEIGHT),
}
SHAPES: dict[str, Shape] = {
    **{
        "▘▝▀▖▌▞▛▗▚▐▜▄▙▟█"[n - 1]: [q for i, q in enumerate(QUARTERS) if n >> i & 1]
        for n in range(1, 16)
    },
    **{char: [(0, 1 - n / 8, 1, n / 8)] for n, char in enumerate("▁▂▃▄▅▆▇█", 1)},
    **{char: [(0, 0, n / 8, 1)] for n, char in enumerate("▏▎▍▌▋▊▉█", 1)},
    **{
        char: [STROKES[side] for side in sides]
        for char, sides in {
            "│": "ns",
            "─": "ew",
            "╭": "se",
            "╮": "sw",
            "╰": "ne",
            "╯": "nw",
        }.items()
    },
}


def main() -> None:
    """Play the game to a good moment and draw it."""
    if sys.argv[1:] == ["levels"]:
        draw_levels()
        return
    level, program, ticks = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with tempfile.TemporaryDirectory() as data_dir:
        game = [sys.executable, "-m", "logical_robots_tui", "play", level, program]
        with Terminal([*game, "--data-dir", data_dir], size=SIZE) as terminal:
            terminal.wait_for("· applied")
            for tick in range(1, ticks + 1):
                terminal.send("n")
                terminal.wait_for(f"tick {tick} ")
            terminal.wait_for_quiet()
            terminal.send(" ")
            terminal.wait_for("RUNNING")
            TARGET.write_text(svg(terminal.screen), encoding="utf-8")


def draw_levels() -> None:
    """Win some levels, begin another, and draw the level screen."""
    with tempfile.TemporaryDirectory() as data_dir:
        progress = Progress(Path(data_dir) / FILE_NAME)
        *won, begun = list_levels()[:5]
        for level in won:
            progress.win(level, level, reference_for(load_level(level)))
        progress.begin(begun)
        progress.close()
        game = [sys.executable, "-m", "logical_robots_tui", "play", begun]
        with Terminal([*game, "--data-dir", data_dir], size=SIZE) as terminal:
            terminal.wait_for("· applied")
            terminal.send("l")
            terminal.wait_for("LEVELS")
            terminal.wait_for_quiet()
            TARGET.with_name("levels.svg").write_text(svg(terminal.screen), encoding="utf-8")


def svg(screen: pyte.Screen) -> str:
    """A terminal's screen as SVG."""
    width, height = screen.columns * WIDTH, screen.lines * HEIGHT
    box = f"-8 -8 {width + 16:.0f} {height + 16:.0f}"
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}"'
        f' font-family="{FONTS}" font-size="{FONT}">'
        f'<rect x="-8" y="-8" width="100%" height="100%" rx="8" fill="#{PAPER}"/>'
    )
    rows = range(screen.lines)
    papers = [piece for y in rows for piece in _papers(screen, y)]
    shapes = [piece for y in rows for piece in _shapes(screen, y)]
    texts = [piece for y in rows for piece in _texts(screen, y)]
    crisp = ['<g shape-rendering="crispEdges">', *papers, *shapes, "</g>"]
    return "\n".join([head, *crisp, *texts, "</svg>", ""])


def _papers(screen: pyte.Screen, y: int) -> Iterator[str]:
    for paper, xs in groupby(range(screen.columns), lambda x: _colors(screen, x, y)[1]):
        run = list(xs)
        if paper != PAPER:
            yield _rectangle(run[0], y, len(run), 1, paper)


def _shapes(screen: pyte.Screen, y: int) -> Iterator[str]:
    """Rectangles for block and line characters; those that touch become one."""
    open_ends: dict[tuple[float, float, str], tuple[float, float]] = {}
    for x in range(screen.columns):
        ink = _colors(screen, x, y)[0]
        for left, top, width, height in SHAPES.get(screen.buffer[y][x].data, []):
            key = top, height, ink
            begin, end = open_ends.pop(key, (0.0, -1.0))
            if end != x + left:
                if end >= 0:
                    yield _rectangle(begin, y + top, end - begin, height, ink)
                begin = x + left
            open_ends[key] = begin, x + left + width
    for (top, height, ink), (begin, end) in open_ends.items():
        yield _rectangle(begin, y + top, end - begin, height, ink)


def _texts(screen: pyte.Screen, y: int) -> Iterator[str]:
    row = screen.buffer[y]

    def look(x: int) -> tuple[str, bool] | None:
        cell = row[x]
        is_text = cell.data != " " and cell.data not in SHAPES
        return (_colors(screen, x, y)[0], cell.bold) if is_text else None

    for found, xs in groupby(range(screen.columns), look):
        run = list(xs)
        if found is None:
            continue
        ink, bold = found
        text = escape("".join(row[x].data for x in run))
        weight = ' font-weight="bold"' if bold else ""
        yield (
            f'<text x="{run[0] * WIDTH:.1f}" y="{(y + 0.75) * HEIGHT:.1f}" fill="#{ink}"'
            f'{weight} textLength="{len(run) * WIDTH:.1f}">{text}</text>'
        )


def _rectangle(x: float, y: float, columns: float, lines: float, color: str) -> str:
    return (
        f'<rect x="{x * WIDTH:.1f}" y="{y * HEIGHT:.1f}" width="{columns * WIDTH:.1f}"'
        f' height="{lines * HEIGHT:.1f}" fill="#{color}"/>'
    )


def _colors(screen: pyte.Screen, x: int, y: int) -> tuple[str, str]:
    cell = screen.buffer[y][x]
    ink = INK if cell.fg == "default" else cell.fg
    paper = PAPER if cell.bg == "default" else cell.bg
    return (paper, ink) if cell.reverse else (ink, paper)


if __name__ == "__main__":
    main()
