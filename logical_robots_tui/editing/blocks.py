"""A level file split into its head and one block for each object.

Each block is valid TOML on its own, so changing one leaves the bytes of all others untouched.
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
    """The text of one object, with the comments above it and the empty lines below.

    Attributes:
        kind: The kind of object.
        text: Its lines.
        new: Whether it is not yet in the file, so that it needs empty lines around it.
    """

    kind: Kind
    text: str
    new: bool = False


class Blocks:
    """A file split into blocks.

    Attributes:
        head: The text before the first block.
        blocks: In file order.

    Args:
        text: The file's text, with line feeds between lines.

    Raises:
        ValueError: The file has another layout, in which pieces are not valid on their own.
    """

    def __init__(self, text: str) -> None:
        # A row of the drawing may look like a comment.
        if not (self._split(text, with_comments=True) or self._split(text, with_comments=False)):
            raise ValueError("The pieces say something else than the whole.")

    def _split(self, text: str, *, with_comments: bool) -> bool:
        """Split a text; return whether the pieces mean the same as the whole."""
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
        """Replace the blocks of a kind; existing blocks keep their places.

        Args:
            kind: The kind of the blocks.
            wanted: The new blocks; existing ones among them must be in their old order.
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
        """Return the position for the first block of a kind: after those of preceding kinds."""
        before = KINDS[: KINDS.index(kind)]
        places = [i + 1 for i, block in enumerate(self.blocks) if block.kind in before]
        first = [i for i, block in enumerate(self.blocks) if block.kind == kind]
        return first[0] if first else max(places, default=0)


def _comments_above(text: str, start: int) -> int:
    """Return the start of the comments directly above a line."""
    while start:
        line = text.rfind("\n", 0, start - 1) + 1
        if not text[line:start].lstrip(" \t").startswith("#"):
            break
        start = line
    return start


def _joined(pieces: Any) -> dict[str, Any]:
    """Return the merged content of pieces of TOML."""
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
