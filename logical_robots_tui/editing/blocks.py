"""The file of a level in pieces: its head, and one block for each thing.

Each block is a piece of TOML for itself, so a change of one leaves the bytes of all others alone.
Comments directly above a block belong to it.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

from logical_robots_tui.editing.things import KINDS, Kind

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Block", "Blocks"]

_HEADER = re.compile(
    r"^[ \t]*\[\[[ \t]*(robots|beacons|areas)[ \t]*\]\][ \t]*(?:#[^\n]*)?$", re.MULTILINE
)


@dataclass
class Block:
    """The text of one thing, with the comments above it and the empty lines below.

    Attributes:
        kind: What it is.
        text: Its lines.
        new: Whether it was not in the file, so that empty lines have to set it apart.
    """

    kind: Kind
    text: str
    new: bool = False


class Blocks:
    """A file in pieces.

    Attributes:
        head: What comes before the first block.
        blocks: In file order.

    Args:
        text: The file's text, with line feeds between lines.

    Raises:
        ValueError: It is laid out otherwise, so that pieces don't make sense for themselves.
    """

    def __init__(self, text: str) -> None:
        # A row of a drawing may look like a comment.
        if not (self._split(text, with_comments=True) or self._split(text, with_comments=False)):
            raise ValueError("The pieces say something else than the whole.")

    def _split(self, text: str, *, with_comments: bool) -> bool:
        """Take a text to pieces; return whether they say the same as the whole."""
        found = list(_HEADER.finditer(text))
        starts = [match.start() for match in found]
        if with_comments:
            starts = [_comments_above(text, start) for start in starts]
        bounds = [0, *starts, len(text)]
        pieces = [text[start:stop] for start, stop in pairwise(bounds)]
        self.head = pieces[0]
        self.blocks = [
            Block(cast("Kind", match[1]), piece)
            for match, piece in zip(found, pieces[1:], strict=True)
        ]
        try:
            return _joined(map(tomllib.loads, pieces)) == tomllib.loads(text)
        except ValueError:
            return False

    def of(self, kind: Kind) -> list[Block]:
        """Return the blocks of a kind, in file order."""
        return [block for block in self.blocks if block.kind == kind]

    def replace(self, kind: Kind, wanted: Sequence[Block]) -> None:
        """Put other blocks of a kind in place of those there; known ones keep their places.

        Args:
            kind: Of the blocks.
            wanted: In their order, which known ones among them may not change.
        """
        kept = {id(block) for block in wanted}
        self.blocks = [b for b in self.blocks if b.kind != kind or id(b) in kept]
        place = self._first_place(kind)
        for block in wanted:
            known = next((i for i, b in enumerate(self.blocks) if b is block), None)
            if known is None:
                self.blocks.insert(place, block)
                known = place
            place = known + 1

    def text(self) -> str:
        """Return the file's text."""
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

    def _first_place(self, kind: Kind) -> int:
        """Return where a block of a kind goes if none is there: behind those of kinds before."""
        before = KINDS[: KINDS.index(kind)]
        places = [i + 1 for i, block in enumerate(self.blocks) if block.kind in before]
        first = [i for i, block in enumerate(self.blocks) if block.kind == kind]
        return first[0] if first else max(places, default=0)


def _comments_above(text: str, start: int) -> int:
    """Return where the comments begin that stand directly above a line."""
    while start:
        line = text.rfind("\n", 0, start - 1) + 1
        if not text[line:start].lstrip(" \t").startswith("#"):
            break
        start = line
    return start


def _joined(pieces: Any) -> dict[str, Any]:
    """Return what pieces of TOML say together."""
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
