"""Finding shipped levels and programs by name."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable

ShippedKind: TypeAlias = Literal["levels", "programs"]


ARENAS = "arenas"
"""The folder inside that of the levels, and of the programs, with those for several teams."""


def shipped_folder(kind: ShippedKind) -> Path:
    """Return the folder of shipped files, in an installed package or beside it in a checkout."""
    package = Path(__file__).resolve().parent
    inside = package / kind
    return inside if inside.is_dir() else package.parent / kind


def shipped_names(kind: ShippedKind, suffix: str, within: str = "") -> list[str]:
    folder = shipped_folder(kind) / within
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


def did_you_mean(word: str, options: Iterable[str]) -> str:
    by_folded = {option.casefold(): option for option in options}
    close = difflib.get_close_matches(word.casefold(), by_folded, n=1, cutoff=0.6)
    return f'Did you mean "{by_folded[close[0]]}"?' if close else ""
