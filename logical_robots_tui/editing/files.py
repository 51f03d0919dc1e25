"""Saving levels in either format; a file of this game changes in as few bytes as possible."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Array

from logical_robots_tui.editing.checks import load_errors
from logical_robots_tui.editing.level_text import (
    KINDS,
    Entity,
    Kind,
    Record,
    block_text,
    kind_of,
    needs_leniency,
    record_of,
    toml_text,
    words_of,
    write_native,
    write_web,
)
from logical_robots_tui.paths import is_there, real, shipped_folder, write_atomically
from logical_robots_tui.world.level import Level, LevelError, alike
from logical_robots_tui.world.levels.fields import MOST_BYTES
from logical_robots_tui.world.levels.load import SUFFIXES, is_web_file, load_level, read_text
from logical_robots_tui.world.levels.native import (
    coarsest_cell,
    draw_rows,
    expresses,
    find_drawing,
    read_native,
)


def save_level(level: Level, path: Path, *, replace_all: bool = False) -> Level:
    """Write a level atomically, in the format of the ending; return it as in the file.

    An existing file of this game changes only where the levels differ, unless `replace_all`.
    Missing folders are created. Raises LevelError if it can't be written or loaded again.
    """
    place = str(path)
    if path.suffix.lower() not in SUFFIXES:
        hint = "Use .toml, or .json for the web platform."
        raise LevelError("The file has no ending of a level format.", place=place, hint=hint)
    for finding in load_errors(level):
        raise LevelError(finding.text, place=place)
    try:
        if shipped_folder("levels").resolve() in real(path).parents:
            message = "The levels of the game can't be changed."
            raise LevelError(message, place=place, hint="Save it in another folder.")
        path.parent.mkdir(parents=True, exist_ok=True)
        old_text, text = _old_and_new_text(level, path, replace_all)
        if len(text.encode()) > MOST_BYTES:
            message = f"The file would be larger than {MOST_BYTES // 2**20} MB."
            raise LevelError(message, place=place)
        if text != old_text:
            write_atomically(path, text)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Save it under another name or in another folder."
        raise LevelError(f"The file can't be written: {reason}.", place=place, hint=hint) from error
    return replace(level, name=path.stem, source=place)


def is_made_here(path: Path) -> bool:
    """Return whether this game wrote a file, as far as its text shows, or there is none.

    Saving in a file of the web platform's format replaces all of it.
    """
    if not is_web_file(path) or not is_there(path):
        return True
    try:
        return write_web(load_level(path)) == read_text(path)
    except LevelError:
        return False


def _old_and_new_text(level: Level, path: Path, replace_all: bool) -> tuple[str, str]:
    is_web = is_web_file(path)
    if replace_all:
        return "", write_web(level) if is_web else write_native(level)
    try:
        old_text = read_text(path)
        if not is_web:
            return old_text, rewrite_text(old_text, level)
        old_level = load_level(path)
    except LevelError:  # it doesn't exist, or is not a level
        return _old_and_new_text(level, path, replace_all=True)
    text = write_web(level)
    return old_text, old_text if write_web(old_level) == text else text


_ALTERNATIVES = {"angle": "heading", "heading": "angle"}


def rewrite_text(text: str, level: Level) -> str:
    """Return the text of a level file, changed to describe another level, or raise LevelError.

    Comments, key order and unchanged parts are kept, if the file's layout allows it.
    """
    mark = "\ufeff" if text.startswith("\ufeff") else ""
    of_windows = text.count("\r\n") * 2 > text.count("\n")
    plain = text.removeprefix(mark).replace("\r\n", "\n")
    old_level = read_native(plain, level.name, level.source)
    if alike(old_level, level):
        return text
    new_text = _rewrite(plain, old_level, level)
    if new_text is None:
        new_text = write_native(level)
    return mark + (new_text.replace("\n", "\r\n") if of_windows else new_text)


def _rewrite(text: str, old_level: Level, level: Level) -> str | None:
    """Return the changed text, or None if it would not describe the level."""
    try:
        blocks = _Blocks(text)
        inline = []
        for kind in KINDS:
            old, new = getattr(old_level, kind), getattr(level, kind)
            if old == new:
                continue
            old_blocks = [block for block in blocks.blocks if block.kind == kind]
            if len(old_blocks) == len(old):
                blocks.replace(kind, _blocks(old_blocks, old, new))
            else:
                inline.append(kind)
        blocks.head = _head(blocks.head, old_level, level, inline)
        new_text = blocks.text()
        return new_text if alike(read_native(new_text, "", ""), level) else None
    except (ValueError, KeyError, TOMLKitError, LevelError):
        return None


def _blocks(blocks: list[_Block], old: Sequence[Entity], new: Sequence[Entity]) -> list[_Block]:
    new_blocks: list[_Block] = []
    matcher = SequenceMatcher(None, old, new, autojunk=False)
    for _, start, stop, new_start, new_stop in matcher.get_opcodes():
        pairs = _pairs(old[start:stop], new[new_start:new_stop])
        for entity, index in zip(new[new_start:new_stop], pairs, strict=True):
            if index is None:
                kind = kind_of(entity)
                new_blocks.append(_Block(kind, block_text(kind, record_of(entity)), new=True))
                continue
            block = blocks[start + index]
            old_entity = old[start + index]
            if old_entity != entity:
                document = tomlkit.parse(block.text)
                tables = document[block.kind]
                assert isinstance(tables, AoT)
                _update(tables[0], record_of(old_entity), record_of(entity))
                block.text = document.as_string()
            new_blocks.append(block)
    return new_blocks


def _pairs(old: Sequence[Entity], new: Sequence[Entity]) -> list[int | None]:
    """Return the index of the old object for each new one, ascending; matched by name first."""
    names = {entity.name for entity in old} & {entity.name for entity in new}
    if len(old) == len(new) or not names:
        return [i if i < len(old) else None for i in range(len(new))]
    pairs: list[int | None] = []
    start = 0
    for entity in new:
        match = next((i for i in range(start, len(old)) if old[i].name == entity.name), None)
        pairs.append(match)
        start = start if match is None else match + 1
    return pairs


def _update(table: Any, old_record: Record, new_record: Record) -> None:
    for key in old_record:
        if key not in new_record and key in table:
            del table[key]
    for key, value in new_record.items():
        if key in old_record and old_record[key] == value:
            continue
        if key in _ALTERNATIVES and _ALTERNATIVES[key] in table:
            del table[_ALTERNATIVES[key]]
        node = table.get(key)
        if isinstance(value, dict) and isinstance(node, dict):
            old_value = old_record.get(key)
            _update(node, old_value if isinstance(old_value, dict) else {}, value)
        elif isinstance(value, list) and isinstance(node, Array) and len(value) == len(node):
            for i, item in enumerate(value):
                if node[i] != item:
                    node[i] = item
        else:
            table[key] = tomlkit.value(toml_text(key, value))


def _head(head: str, old_level: Level, level: Level, inline: Sequence[Kind]) -> str:
    """Return the changed head; `inline` are the kinds listed there that differ."""
    same_walls = np.array_equal(old_level.walls, level.walls)
    old, new = words_of(old_level), words_of(level)
    lenient = needs_leniency(level) and not needs_leniency(old_level)
    if same_walls and old == new and not inline and not lenient:
        return head
    drawing: str = tomllib.loads(head)["walls"]
    place = find_drawing(drawing, head)
    mark = "the drawing"
    if place is not None:  # tomlkit is slow for long texts, and unchanged rows must be preserved
        while mark in head:
            mark += " itself"
        head = head[:place] + mark + head[place + len(drawing) :]
    body = head.rstrip("\n")
    document = tomlkit.parse(body)
    _update(document, old, new)
    if lenient:
        document["lenient"] = True
    for kind in inline:
        records = [record_of(entity) for entity in getattr(level, kind)]
        document[kind] = tomlkit.value(toml_text(kind, records))
    if not same_walls:
        drawing = _drawing(document, drawing, level)
        if place is None:
            document["walls"] = tomlkit.value(f"'''\n{drawing}'''")
    new_text = document.as_string().rstrip("\n") + (head[len(body) :] or "\n")
    return new_text if place is None else new_text.replace(mark, drawing)


def _drawing(document: tomlkit.TOMLDocument, drawing: str, level: Level) -> str:
    cell = int(str(document["cell"]))
    old_lines = drawing.removesuffix("\n").split("\n")
    if not expresses(level.walls, cell):
        document["cell"] = cell = coarsest_cell(level.walls)
        old_lines = []
    lines = "\n".join(draw_rows(level.walls, cell, old_lines))
    return lines + ("\n" if drawing.endswith("\n") else "")


_HEADER = re.compile(
    r"^[ \t]*\[\[[ \t]*(robots|beacons|areas)[ \t]*\]\][ \t]*(?:#[^\n]*)?$", re.MULTILINE
)


@dataclass
class _Block:
    """The text of one object, with the comments above it and the empty lines below."""

    kind: Kind
    text: str
    new: bool = False


class _Blocks:
    """A file split into blocks; raises ValueError if its layout does not allow that."""

    def __init__(self, text: str) -> None:
        # A row of the drawing may look like a comment.
        if not (self._split(text, with_comments=True) or self._split(text, with_comments=False)):
            raise ValueError("The pieces mean something other than the whole.")

    def _split(self, text: str, *, with_comments: bool) -> bool:
        """Split a text; return whether its pieces together mean the same."""
        headers = list(_HEADER.finditer(text))
        starts = [match.start() for match in headers]
        if with_comments:
            starts = [_comments_above(text, start) for start in starts]
        bounds = [0, *starts, len(text)]
        pieces = [text[start:stop] for start, stop in pairwise(bounds)]
        self.head = pieces[0]
        self.blocks = [
            _Block(cast("Kind", match[1]), piece)
            for match, piece in zip(headers, pieces[1:], strict=True)
        ]
        try:
            return _merge(map(tomllib.loads, pieces)) == tomllib.loads(text)
        except ValueError:
            return False

    def replace(self, kind: Kind, blocks: Sequence[_Block]) -> None:
        """Replace the blocks of a kind; existing ones must be in order, and keep their places."""
        kept_ids = {id(block) for block in blocks}
        self.blocks = [b for b in self.blocks if b.kind != kind or id(b) in kept_ids]
        earlier_kinds = KINDS[: KINDS.index(kind)]
        stops = [i + 1 for i, b in enumerate(self.blocks) if b.kind in earlier_kinds]
        starts = [i for i, b in enumerate(self.blocks) if b.kind == kind]
        place = starts[0] if starts else max(stops, default=0)
        for block in blocks:
            index = next((i for i, b in enumerate(self.blocks) if b is block), None)
            if index is None:
                self.blocks.insert(place, block)
                index = place
            place = index + 1

    def text(self) -> str:
        text = self.head
        after_new = False
        for block in self.blocks:
            if text and not text.endswith("\n"):
                text += "\n"
            if (block.new or after_new) and not text.endswith("\n\n"):
                text += "\n"
            text += block.text
            after_new = block.new
        return text


def _comments_above(text: str, start: int) -> int:
    while start:
        line = text.rfind("\n", 0, start - 1) + 1
        if not text[line:start].lstrip(" \t").startswith("#"):
            break
        start = line
    return start


def _merge(pieces: Any) -> dict[str, Any]:
    whole: dict[str, Any] = {}
    for number, piece in enumerate(pieces):
        for key, value in piece.items():
            if number and key in KINDS and isinstance(value, list):
                whole.setdefault(key, []).extend(value)
            elif key in whole:
                raise ValueError(f"{key} is there twice.")
            else:
                whole[key] = value
    return whole
