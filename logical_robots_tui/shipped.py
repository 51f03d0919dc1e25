"""The levels and programs that come with the game, found by name."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["ShippedKind", "did_you_mean", "shipped_folder", "shipped_names"]

ShippedKind: TypeAlias = Literal["levels", "programs"]


def shipped_folder(kind: ShippedKind) -> Path:
    """Return the folder of the shipped levels or programs.

    An installed copy has it inside the package, a checkout beside the package.

    Args:
        kind: ``levels`` or ``programs``.
    """
    package = Path(__file__).resolve().parent
    inside = package / kind
    return inside if inside.is_dir() else package.parent / kind


def shipped_names(kind: ShippedKind, suffix: str) -> list[str]:
    """Return the names of what is shipped, without their ending, sorted.

    Args:
        kind: ``levels`` or ``programs``.
        suffix: The ending of the files, such as ``.toml``.

    Returns:
        Names; none if the folder is missing.
    """
    return sorted(path.stem for path in shipped_folder(kind).glob(f"*{suffix}"))


def did_you_mean(word: str, options: Iterable[str]) -> str:
    """Return a question naming the option most like a mistyped word, or "".

    Args:
        word: What was typed.
        options: What would have been right.
    """
    by_folded = {option.casefold(): option for option in options}
    close = difflib.get_close_matches(word.casefold(), by_folded, n=1, cutoff=0.6)
    return f'Did you mean "{by_folded[close[0]]}"?' if close else ""
