"""Reading an exported progress file, which anybody may have written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import read_ordinary
from logical_robots_tui.progress import Measures

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["read_claims"]

_MOST_BYTES = 20_000_000

_Count = Annotated[int, msgspec.Meta(ge=0, le=1_000_000_000)]


class _Victory(msgspec.Struct):
    program: str
    ticks: _Count
    rules: _Count
    distance: Annotated[float, msgspec.Meta(ge=0)]
    wins: _Count | None = None
    starts: _Count = 0
    goals: tuple[str, ...] = ()


class _Level(msgspec.Struct):
    level: str
    victories: list[_Victory]


class _Export(msgspec.Struct):
    format: int
    levels: list[_Level]


def read_claims(file: Path, version: int) -> Iterator[tuple[str, str, Measures]]:
    """Read an exported file, and return level, program and measures of each victory.

    Raises:
        InputError: It can't be read, or is not such a file; with the key that is wrong.
    """
    try:
        content = read_ordinary(file, _MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f"Can't be read: {error.strerror or error}.", place=str(file)) from error
    if len(content) > _MOST_BYTES:
        raise InputError(f"The file has more than {_MOST_BYTES:,} bytes.", place=str(file))
    try:
        export = msgspec.json.decode(content, type=_Export)
    except (msgspec.DecodeError, RecursionError) as error:
        raise InputError(
            f"This is not an exported progress file: {error}",
            place=str(file),
            hint="logical-robots progress --json writes one.",
        ) from error
    if export.format != version:
        raise InputError(
            f"The file has format {export.format}; this version of the game reads {version}.",
            place=f"{file}: format",
        )
    return (
        (each.level, won.program, Measures(*(getattr(won, name) for name in Measures._fields)))
        for each in export.levels
        for won in each.victories
    )
