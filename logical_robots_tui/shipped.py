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
    """Return the folder of the shipped levels or programs.

    It is inside an installed package, and beside the package in a checkout.
    """
    package = Path(__file__).resolve().parent
    inside = package / kind
    return inside if inside.is_dir() else package.parent / kind


def shipped_names(kind: ShippedKind, suffix: str, within: str = "") -> list[str]:
    """Return the sorted names of the shipped files, without their ending."""
    folder = shipped_folder(kind) / within
    return sorted(path.stem for path in folder.glob(f"*{suffix}"))


def did_you_mean(word: str, options: Iterable[str]) -> str:
    """Return a question that suggests the option closest to a mistyped word, or ""."""
    by_folded = {option.casefold(): option for option in options}
    close = difflib.get_close_matches(word.casefold(), by_folded, n=1, cutoff=0.6)
    return f'Did you mean "{by_folded[close[0]]}"?' if close else ""
