"""The level that a program is for, and what is in it."""

from __future__ import annotations

import asyncio
import json
import os
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from logical_robots_tui.language.diagnostics import Diagnostic, LevelNames
from logical_robots_tui.language.source_text import diagnostic_at
from logical_robots_tui.paths import ARENAS, is_folder, shipped_names

_COMMENT = re.compile(r"\A\s*#\s*level:[ \t]*(\S.*?)[ \t]*$", re.MULTILINE)
_SUFFIX = ".toml"
_BEGIN = (
    "import sys; from logical_robots_tui import processes, supervisor; "
    "processes.lifeline.signal_when_closed(int(sys.argv.pop(1)), 9); sys.exit(supervisor.main())"
)


class LevelFacts(NamedTuple):
    """What is in a level.

    Attributes:
        names: Those that a program may compare with.
        meanings: What is called by each name, with its place.
        error: Why the level can't be loaded, and what to do.
    """

    names: LevelNames | None = None
    meanings: Mapping[str, str] = {}
    error: tuple[str, str] = ("", "")


def level_of(text: str, path: Path, setting: str) -> str:
    """Return the level that a program is for by comment, file name or setting, or ""."""
    if comment := _COMMENT.match(text):
        return str(comment[1])
    names = [*shipped_names("levels", _SUFFIX), *shipped_names("levels", _SUFFIX, ARENAS)]
    by_name = {re.sub(r"^\d+-", "", name): name for name in names} | {name: name for name in names}
    fits = (name for name in by_name if re.match(rf"{re.escape(name)}(?![a-z0-9])", path.stem))
    return by_name.get(max(fits, key=len, default=""), setting)


async def facts_of(level: str, folder: Path) -> LevelFacts:
    """Return what is in a level, read by a process of its own: it takes 15 MB of numpy."""
    document = await run_command("level", "show", level, "--json", folder=folder)
    if error := document.get("error"):
        return LevelFacts(error=(error["message"], error.get("hint", "")))
    meanings = {
        entity["name"]: f"{kind} of {document['name']} at {entity['x']:g}, {entity['y']:g}"
        for kind in ("area", "beacon", "robot")
        for entity in document[f"{kind}s"]
    }
    return LevelFacts(msgspec.convert(document["names"], LevelNames), meanings)


def unknown_level(text: str, facts: LevelFacts) -> Iterator[Diagnostic]:
    """Yield a warning about a level that a comment names and that can't be loaded."""
    comment = _COMMENT.match(text)
    message, hint = facts.error
    if comment and message:
        length = len(comment[1])
        yield diagnostic_at(text, comment.start(1), length, message, hint, "warning")


async def run_command(*words: str, folder: Path, text: str = "") -> Any:
    """Return what a command of ours answers as JSON; it ends with its caller or this process."""
    read_end, lifeline = os.pipe()
    try:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-P", "-c", _BEGIN, str(read_end), *words),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            cwd=folder if is_folder(folder) else None,
            pass_fds=[read_end],
        )
        output, _ = await process.communicate(text.encode("utf-8", "replace"))
    finally:
        os.close(read_end)
        os.close(lifeline)
    return json.loads(output)
