"""Saving levels in either format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from logical_robots_tui.editing.checks import refusals
from logical_robots_tui.editing.level_text import write_native, write_web
from logical_robots_tui.editing.rewriting import rewritten
from logical_robots_tui.paths import is_there, real, shipped_folder, write_atomically
from logical_robots_tui.world.level import Level, LevelError
from logical_robots_tui.world.levels.fields import MOST_BYTES
from logical_robots_tui.world.levels.load import SUFFIXES, is_web_file, load_level, read_text


def save_level(level: Level, path: Path, *, anew: bool = False) -> Level:
    """Write a level atomically, in the format of the ending; return it as in the file.

    An existing file of this game changes only where the levels differ, unless `anew`. Missing
    folders are created. Raises LevelError if it can't be written or loaded again.
    """
    place = str(path)
    if path.suffix.lower() not in SUFFIXES:
        hint = "Use .toml, or .json for the web platform."
        raise LevelError("The file has no ending of a level format.", place=place, hint=hint)
    for finding in refusals(level):
        raise LevelError(finding.text, place=place)
    try:
        if shipped_folder("levels").resolve() in real(path).parents:
            message = "The levels of the game can't be changed."
            raise LevelError(message, place=place, hint="Save it in another folder.")
        path.parent.mkdir(parents=True, exist_ok=True)
        before, text = _texts(level, path, anew)
        if len(text.encode()) > MOST_BYTES:
            message = f"The file would be larger than {MOST_BYTES // 2**20} MB."
            raise LevelError(message, place=place)
        if text != before:
            write_atomically(path, text)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Save it under another name or in another folder."
        raise LevelError(f"The file can't be written: {reason}.", place=place, hint=hint) from error
    return replace(level, name=path.stem, source=place)


def is_made_here(path: Path) -> bool:
    """Return whether this game wrote a file, as far as its text shows, or there is none. Blocks.

    Saving in a file of the web platform's format replaces all of it.
    """
    if not is_web_file(path) or not is_there(path):
        return True
    try:
        return write_web(load_level(path)) == read_text(path)
    except LevelError:
        return False


def _texts(level: Level, path: Path, anew: bool) -> tuple[str, str]:
    is_web = is_web_file(path)
    if anew:
        return "", write_web(level) if is_web else write_native(level)
    try:
        before = read_text(path)
        if not is_web:
            return before, rewritten(before, level)
        earlier = load_level(path)
    except LevelError:  # it doesn't exist, or is not a level
        return _texts(level, path, anew=True)
    text = write_web(level)
    return before, before if write_web(earlier) == text else text
