"""A screen as text that a person can read and compare: the characters, then their looks."""

import re
from collections.abc import Iterator
from itertools import groupby, zip_longest
from string import ascii_letters
from typing import NamedTuple

import pyte

__all__ = ["Cell", "cells_of", "differences", "picture", "read_picture"]

MARKS = ascii_letters + "".join(map(chr, range(0xC0, 0x800)))


class Cell(NamedTuple):
    text: str
    look: str


def cells_of(screen: pyte.Screen) -> list[list[Cell]]:
    lines = []
    for y in range(screen.lines):
        row = [screen.buffer[y][x] for x in range(screen.columns)]
        lines.append([Cell(cell.data, _look(cell)) for cell in row])
    return lines


def picture(lines: list[list[Cell]]) -> str:
    """Write down the cells of a screen.

    First the text, line by line between bars. Then, for each line, runs of cells of one look, as
    a count and a mark; last what each mark stands for.
    """
    looks: dict[str, str] = {}
    text, runs = [], []
    for line in lines:
        text.append("|" + "".join(cell.text for cell in line) + "|")
        marks = [looks.setdefault(cell.look, MARKS[len(looks)]) for cell in line]
        runs.append(" ".join(f"{len(list(run))}{mark}" for mark, run in groupby(marks)))
    legend = [f"{mark} = {look}" for look, mark in looks.items()]
    return "\n".join([*text, "", *runs, "", *legend, ""])


def read_picture(written: str) -> list[list[Cell]]:
    text, runs, legend = (part.splitlines() for part in written.strip("\n").split("\n\n"))
    looks = {line[0]: line[4:] for line in legend}
    lines = []
    for characters, line in zip(text, runs, strict=True):
        counted = (re.fullmatch(r"(\d+)(.)", run) for run in line.split(" "))
        marks = "".join(found[2] * int(found[1]) for found in counted if found)
        pairs = zip(characters[1:-1], marks, strict=True)
        lines.append([Cell(character, looks[mark]) for character, mark in pairs])
    return lines


def differences(wanted: list[list[Cell]], found: list[list[Cell]]) -> Iterator[str]:
    sizes = [f"{max(map(len, lines))}x{len(lines)}" for lines in (wanted, found)]
    if sizes[0] != sizes[1]:
        yield f"{sizes[1]} cells instead of {sizes[0]}"
    nothing: list[Cell] = []
    for y, (should, does) in enumerate(zip_longest(wanted, found, fillvalue=nothing), 1):
        columns = [x for x, (one, other) in enumerate(zip_longest(should, does)) if one != other]
        if columns:
            first, last = columns[0], columns[-1]
            yield f"line {y}, columns {first + 1} to {last + 1}, {len(columns)} cells:"
            for name, line in (("wanted", should), ("found ", does)):
                part = line[first : last + 1] or [Cell("", "nothing")]
                text = "".join(cell.text for cell in part)
                yield f"  {name} |{text}| starting with {part[0].look}"


def _look(cell: pyte.screens.Char) -> str:
    styles = ("underscore", "strikethrough", "reverse", "bold", "italics", "blink")
    on = [style for style in styles if getattr(cell, style)]
    if cell.data == " " and not set(on) & set(styles[:3]):
        return f"blank on {cell.bg}"  # in whatever ink
    return " ".join([f"{cell.fg} on {cell.bg}", *on])
