"""Draw the README's pictures: the game plays in a terminal, and its cells become SVG.

``python -m docs.screenshot playing`` draws the first program of the README winning the first level,
as a moving picture; ``levels`` draws the level screen after some victories; ``convoy`` draws a
whole run of level 8, as `replay export` does. ``browser`` takes a PNG of the page in Chromium.

Block and line characters become rectangles, so that the picture has no seams in any font.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections import defaultdict
from copy import deepcopy
from html import escape
from itertools import groupby, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.game import reference_for
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.mind import Program
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.simulation import Simulation
from logical_robots_tui.tui.labyrinth.svg import moving_svg
from logical_robots_tui.world import list_levels, load_level
from tests.browser import Seat, chromium, serving
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    import pyte

DOCS = Path(__file__).parent
SIZE = (120, 40)
FRAMES, FRAME_SECONDS, REST_SECONDS = 24, 0.4, 3.0
NEAR = 4  # cells between changed ones that are drawn with them
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
            "─": "we",
            "╭": "se",
            "╮": "sw",
            "╰": "ne",
            "╯": "nw",
        }.items()
    },
}


def main() -> None:
    """Draw the pictures that are named, or all."""
    for name in sys.argv[1:] or (*PICTURES, "browser"):
        if name == "browser":
            (DOCS / "browser.png").write_bytes(photograph_browser())
        else:
            (DOCS / f"{name}.svg").write_text(PICTURES[name](), encoding="utf-8")


def draw_playing() -> str:
    """Let the program of the README win the first level, and draw frames on the way."""
    text = (DOCS.parent / "README.md").read_text(encoding="utf-8")
    program = re.findall(r"^```prolog\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)[0]
    level = load_level(list_levels()[0])
    ticks = play_through(level, Program.compile(program), 5_000).won_at
    assert ticks is not None
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bend.l"
        file.write_text(program, encoding="utf-8")
        game = [sys.executable, "-m", "logical_robots_tui", "play", level.name, str(file)]
        with Terminal([*game, "--data-dir", f"{folder}/data"], size=SIZE) as terminal:
            terminal.wait_for("· applied")
            frames = [deepcopy(terminal.screen)]
            for tick in (ticks * number // FRAMES for number in range(1, FRAMES + 1)):
                terminal.send("U")
                terminal.wait_for("Run until tick")
                terminal.send(f"{tick}\r")
                terminal.wait_for("★ won" if tick == ticks else f"tick {tick} of {tick}")
                if tick == ticks:
                    terminal.wait_for("Again")
                    terminal.press_until("\x1b", lambda: "Again" not in terminal.text)
                terminal.wait_for_quiet()
                frames.append(deepcopy(terminal.screen))
    return moving(frames)


def draw_levels() -> str:
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
            return svg(terminal.screen)


def draw_convoy() -> str:
    """Let the solution win the level of robots that follow each other, and draw all of it."""
    with Simulation("08-formation", "formation") as simulation:
        states = [simulation.frame.after]
        while not simulation.over:
            states.append(simulation.step().after)
    return moving_svg(simulation.level, states, simulation.tick)[0]


def photograph_browser() -> bytes:
    """Return a picture of a page in which robots are on their way."""
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder), "05-lighthouse", "lighthouse") as address,
        chromium() as browser,
    ):
        seat = Seat(browser, address, {"width": 1080, "height": 680})
        seat.sees("· applied")
        seat.press("U", sees="Run until tick")
        seat.page.keyboard.type("200\n")
        seat.shows("tick 200 of 200")
        seat.shows("Robots · tick 200")
        return seat.page.screenshot()


PICTURES = {"playing": draw_playing, "levels": draw_levels, "convoy": draw_convoy}


def svg(screen: pyte.Screen) -> str:
    """A terminal's screen as SVG."""
    return "\n".join([*_head(screen), *_drawn(screen, _whole(screen)), "</svg>", ""])


def moving(frames: Sequence[pyte.Screen]) -> str:
    """Screens one after the other as SVG; after the first, only cells that have changed.

    What a frame draws stays until all begin again. Without motion, it is the last frame.
    """
    seconds = (len(frames) - 1) * FRAME_SECONDS + REST_SECONDS
    pieces = [*_head(frames[0]), *_drawn(frames[0], _whole(frames[0]))]
    rules = [f"g[class]{{animation:{seconds:g}s step-end infinite}}"]
    for number, (before, after) in enumerate(pairwise(frames), 1):
        begin = 100 * number * FRAME_SECONDS / seconds
        rules.append(
            f"@keyframes f{number}{{0%{{visibility:hidden}}{begin:.2f}%{{visibility:visible}}}}"
        )
        rules.append(f".f{number}{{animation-name:f{number}}}")
        pieces += [f'<g class="f{number}">', *_drawn(after, _changed(before, after)), "</g>"]
    rules.append("@media (prefers-reduced-motion){g[class]{animation:none}}")
    return "\n".join([pieces[0], "<style>", *rules, "</style>", *pieces[1:], "</svg>", ""])


def _head(screen: pyte.Screen) -> Iterator[str]:
    width, height = screen.columns * WIDTH, screen.lines * HEIGHT
    box = f"-8 -8 {width + 16:.0f} {height + 16:.0f}"
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}"'
        f' font-family="{FONTS}" font-size="{FONT}">'
    )
    yield f'<rect x="-8" y="-8" width="100%" height="100%" rx="8" fill="#{PAPER}"/>'


Strip: TypeAlias = tuple[int, range]
"""Cells side by side: a line, and its columns."""


def _whole(screen: pyte.Screen) -> list[Strip]:
    return [(y, range(screen.columns)) for y in range(screen.lines)]


def _changed(before: pyte.Screen, after: pyte.Screen) -> list[Strip]:
    """The strips of cells that differ; those with few cells between them are one."""
    strips: list[Strip] = []
    for y in range(after.lines):
        xs = [x for x in range(after.columns) if before.buffer[y][x] != after.buffer[y][x]]
        for x in xs:
            if strips and strips[-1][0] == y and x - strips[-1][1].stop < NEAR:
                strips[-1] = y, range(strips[-1][1].start, x + 1)
            else:
                strips.append((y, range(x, x + 1)))
    return strips


Rectangle: TypeAlias = tuple[str, float, float, float, float]
"""A color, and x, y, width and height in cells."""


def _drawn(screen: pyte.Screen, strips: Sequence[Strip]) -> Iterator[str]:
    yield f'<g shape-rendering="crispEdges" transform="scale({WIDTH:g} {HEIGHT:g})">'
    for pieces in (_papers, _shapes):
        yield from _paths(each for strip in strips for each in pieces(screen, *strip))
    yield "</g>"
    for strip in strips:
        yield from _texts(screen, *strip)


def _paths(rectangles: Iterable[Rectangle]) -> Iterator[str]:
    """One path for each color."""
    paths = defaultdict(list)
    for color, x, y, width, height in rectangles:
        x, y, width, height = (round(n, 3) for n in (x, y, width, height))
        paths[color].append(f"M{x:g} {y:g}h{width:g}v{height:g}h-{width:g}z")
    for color, outlines in paths.items():
        yield f'<path fill="#{color}" d="{"".join(outlines)}"/>'


def _papers(screen: pyte.Screen, y: int, columns: range) -> Iterator[Rectangle]:
    for paper, xs in groupby(columns, lambda x: _colors(screen, x, y)[1]):
        run = list(xs)
        if paper != PAPER or len(columns) < screen.columns:
            yield paper, run[0], y, len(run), 1


def _shapes(screen: pyte.Screen, y: int, columns: range) -> Iterator[Rectangle]:
    """Rectangles for block and line characters; those that touch become one."""
    open_ends: dict[tuple[float, float, str], tuple[float, float]] = {}
    for x in columns:
        ink = _colors(screen, x, y)[0]
        for left, top, width, height in SHAPES.get(screen.buffer[y][x].data, []):
            key = top, height, ink
            begin, end = open_ends.pop(key, (0.0, -1.0))
            if end != x + left:
                if end >= 0:
                    yield ink, begin, y + top, end - begin, height
                begin = x + left
            open_ends[key] = begin, x + left + width
    for (top, height, ink), (begin, end) in open_ends.items():
        yield ink, begin, y + top, end - begin, height


def _texts(screen: pyte.Screen, y: int, columns: range) -> Iterator[str]:
    row = screen.buffer[y]

    def look(x: int) -> tuple[str, bool] | None:
        cell = row[x]
        is_text = cell.data != " " and cell.data not in SHAPES
        return (_colors(screen, x, y)[0], cell.bold) if is_text else None

    for found, xs in groupby(columns, look):
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


def _colors(screen: pyte.Screen, x: int, y: int) -> tuple[str, str]:
    cell = screen.buffer[y][x]
    ink = INK if cell.fg == "default" else cell.fg
    paper = PAPER if cell.bg == "default" else cell.bg
    return (paper, ink) if cell.reverse else (ink, paper)


if __name__ == "__main__":
    main()
