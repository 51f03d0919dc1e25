"""Loading levels of either format, by path or name."""

from __future__ import annotations

from pathlib import Path

from logical_robots_tui.confinement import check_mine
from logical_robots_tui.paths import (
    ARENAS,
    did_you_mean,
    read_ordinary,
    shipped_folder,
    shipped_names,
)
from logical_robots_tui.world.level import Level, LevelError
from logical_robots_tui.world.levels.fields import MOST_BYTES
from logical_robots_tui.world.levels.native import read_native
from logical_robots_tui.world.levels.web import read_web

NATIVE, WEB = SUFFIXES = (".toml", ".json")
"""The file name endings of this game and of the web platform."""

_FORMATS = "A level is a .toml file of this game or a .json file of the web platform."


def list_levels() -> list[str]:
    """Return the names of the shipped levels except the arenas, sorted by file name."""
    return sorted({name for suffix in SUFFIXES for name in shipped_names("levels", suffix)})


def list_shipped() -> list[str]:
    """Return the names of all shipped levels, the arenas last."""
    return [*list_levels(), *list_arenas()]


def list_arenas() -> list[str]:
    """Return the names of the shipped levels for matches of teams, sorted by file name."""
    return shipped_names("levels", NATIVE, ARENAS)


def load_level(path_or_name: str | Path) -> Level:
    """Read a level.

    Args:
        path_or_name: Path of a ``.toml`` level of this game or a ``.json`` level of the web
            platform; the format of any other file is guessed from its first character. Text without
            a folder and an ending is the name of a shipped level or of a labyrinth of the day.

    Raises:
        LevelError: The level doesn't exist, can't be read, or is invalid. Its ``place`` names the
            file and the line or key.
    """
    if isinstance(path_or_name, str) and _is_name(path_or_name):
        if (daily := _daily(path_or_name)) is not None:
            return daily
        path = _shipped_path(path_or_name)
    else:
        path = Path(path_or_name)
    text = read_text(path)
    is_web = path.suffix.lower() == WEB or (path.suffix.lower() != NATIVE and is_of_web(text))
    return (read_web if is_web else read_native)(text.removeprefix("\ufeff"), path.stem, str(path))


def read_level(text: str, name: str) -> Level:
    """Return the level of a text, whose first character tells the format, or raise LevelError."""
    return (read_web if is_of_web(text) else read_native)(text.removeprefix("\ufeff"), name, name)


def is_of_web(text: str) -> bool:
    """Return whether a text is a level in the web platform's format."""
    return text.removeprefix("\ufeff").lstrip().startswith("{")


def _is_name(text: str) -> bool:
    return not set(text) & {"/", "\\"} and Path(text).suffix == "" and text not in {".", ".."}


def _daily(name: str) -> Level | None:
    if not name.startswith("daily-"):
        return None
    from logical_robots_tui.world.levels.labyrinths import Daily

    daily = Daily.named(name)
    return daily and daily.level(str(shipped_folder("levels") / f"{name}{NATIVE}"))


def _shipped_path(name: str) -> Path:
    folder, known = shipped_folder("levels"), list_shipped()
    for path in (
        *(folder / f"{name}{suffix}" for suffix in SUFFIXES),
        folder / ARENAS / f"{name}{NATIVE}",
    ):
        if name in known and path.is_file():
            return path
    hint = did_you_mean(name, known) or "A path needs its ending, such as maze.toml."
    raise LevelError(f'There is no level called "{name}".', hint=hint)


def read_text(path: Path) -> str:
    """Return a level file's text, exact to line ends and byte order mark, or raise LevelError."""
    try:
        check_mine(path)
        if path.is_dir():
            raise LevelError("This is a folder, not a level.", place=str(path), hint=_FORMATS)
        if not path.is_file():
            raise _not_there(path)
        content = read_ordinary(path, MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LevelError(f"The file can't be read: {reason}.", place=str(path)) from None
    if len(content) > MOST_BYTES:
        message = f"The file is larger than {MOST_BYTES // 2**20} MB."
        raise LevelError(message, place=str(path), hint=_FORMATS)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        place = f"{path}, line {line}"
        raise LevelError("This file is not UTF-8 text.", place=place, hint=_FORMATS) from None
    return text


def _not_there(path: Path) -> LevelError:
    if path.exists():
        return LevelError("This is not a regular file.", place=str(path), hint=_FORMATS)
    siblings = path.parent.iterdir() if path.parent.is_dir() else ()
    hint = did_you_mean(path.name, [p.name for p in siblings if p.suffix in SUFFIXES])
    return LevelError("There is no such file.", place=str(path), hint=hint)
