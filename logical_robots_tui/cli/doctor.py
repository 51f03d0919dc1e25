"""``logical-robots doctor``: what the game finds on this machine and in this terminal."""

from __future__ import annotations

import json
import os
import platform
import shutil
import sys
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from logical_robots_tui import __version__
from logical_robots_tui.cli.command import add_data_dir, new_command
from logical_robots_tui.cli.text import harmless
from logical_robots_tui.paths import is_folder, is_there

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator
    from pathlib import Path

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

FINE, TROUBLE = 0, 1
PACKAGES = ("logica", "textual", "rich", "numpy", "orjson", "sqlglot")

EPILOG = """\
examples:
  logical-robots doctor           what was found, in words; add it to a report of a fault
  logical-robots doctor --json    the same as JSON

exit status: 0 the game can be played here, 1 something stands in its way, marked with !
"""


@dataclass(frozen=True)
class Finding:
    """Something that was looked at.

    Attributes:
        part: What it belongs to, such as ``terminal``.
        name: What it is.
        value: What was found.
        trouble: What that stands in the way of, or "".
    """

    part: str
    name: str
    value: str
    trouble: str = ""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "doctor",
        start=start,
        wants_json=lambda options: bool(options.json),
        summary="say what the game finds on this machine and in this terminal",
        description="Say what the game finds on this machine and in this terminal.",
        epilog=EPILOG,
    )
    command.add_argument("--json", action="store_true", help="print JSON")
    add_data_dir(command)


def start(options: argparse.Namespace) -> int:
    """Print what is found."""
    found = [*_terminal(), *_versions(), *_places(options.data_dir)]
    if options.json:
        print(json.dumps([asdict(finding) for finding in found], indent=2))
    else:
        for part in dict.fromkeys(finding.part for finding in found):
            print(part)
            for finding in found:
                if finding.part == part:
                    sign = "!" if finding.trouble else " "
                    said = f"  ({finding.trouble})" if finding.trouble else ""
                    print(f"{sign} {finding.name:<14} {harmless(finding.value)}{said}")
    return TROUBLE if any(finding.trouble for finding in found) else FINE


def _terminal() -> Iterator[Finding]:
    """What is known of the terminal without asking it."""
    from rich.console import Console

    from logical_robots_tui.tui.layout.layout import LEAST_HEIGHT, LEAST_WIDTH
    from logical_robots_tui.tui.terminal.capabilities import (
        assume_colours,
        drawing_for,
        may_use_mouse,
    )

    environ = dict(os.environ)
    assume_colours(environ)
    console = Console(_environ=environ, file=sys.__stdout__, force_terminal=True)
    is_there = sys.stdin.isatty() and sys.stdout.isatty()
    yield _finding("name", environ.get("TERM", "") or "none")
    yield _finding("reached", "directly" if is_there else "through a pipe or a file")
    if is_there:
        columns, lines = os.get_terminal_size(sys.stdout.fileno())
        is_small = columns < LEAST_WIDTH or lines < LEAST_HEIGHT
        wish = f"{LEAST_WIDTH}x{LEAST_HEIGHT} needed" if is_small else ""
        yield _finding("size", f"{columns}x{lines}", wish)
    colourless = "NO_COLOR" in environ
    colours = "none (NO_COLOR)" if colourless else _colours(console.color_system)
    yield _finding("colours", colours)
    encoding = console.encoding
    poor = "" if "utf" in encoding.lower() else "plain characters only; set LANG to a UTF-8 locale"
    yield _finding("encoding", encoding, poor)
    drawing = drawing_for(environ, console.color_system, encoding, colourless=colourless)
    yield _finding("drawn in", drawing.value)
    around = [name for name in ("TMUX", "STY", "SSH_CONNECTION") if environ.get(name)]
    words = {"TMUX": "tmux", "STY": "GNU screen", "SSH_CONNECTION": "ssh"}
    yield _finding("inside", ", ".join(words[name] for name in around) or "neither tmux nor ssh")
    yield _finding("mouse", "used" if may_use_mouse(environ) else "not used in GNU screen")
    yield _finding("editor", environ.get("VISUAL") or environ.get("EDITOR") or "vi")


def _finding(name: str, value: str, trouble: str = "") -> Finding:
    return Finding("terminal", name, value, trouble)


def _colours(system: str | None) -> str:
    known = {"truecolor": "16 million", "256": "256", "standard": "16", "windows": "16"}
    return known.get(system or "", "none")


def _versions() -> Iterator[Finding]:
    import sqlite3
    from importlib.metadata import PackageNotFoundError, version

    yield Finding("versions", "logical-robots", __version__)
    yield Finding("versions", "python", f"{platform.python_version()} on {platform.platform()}")
    yield Finding("versions", "sqlite", sqlite3.sqlite_version)
    wall = shutil.which("bwrap")
    yield Finding("versions", "bubblewrap", wall or "not installed, a second wall for classes")
    for package in PACKAGES:
        try:
            yield Finding("versions", package, version(package))
        except PackageNotFoundError:
            yield Finding("versions", package, "not installed", "the game can't do without it")


def _places(data_dir: Path | None) -> Iterator[Finding]:
    """The folders, and whether they can be written to."""
    from platformdirs import user_data_path

    from logical_robots_tui.mind import cache
    from logical_robots_tui.tui.app.facts import settings_path
    from logical_robots_tui.tui.app.settings import read_settings

    data = data_dir or user_data_path("logical-robots", appauthor=False)
    yield _place("data", data, "what you write can't be kept")
    settings = settings_path()
    complaints = read_settings(settings).complaints
    wrong = "logical-robots config says what is wrong" if complaints else ""
    value = f"{settings}{'' if is_there(settings) else ' (none)'}"
    yield Finding("places", "configuration", value, wrong)
    compiled = cache.folder()
    if compiled is None:
        yield Finding("places", "cache", "none")
    else:
        yield _place("cache", compiled, "programs are compiled anew each time")


def _place(name: str, folder: Path, lost: str) -> Finding:
    """A folder that is there or can be made."""
    there = folder
    while not is_there(there) and there != there.parent:
        there = there.parent
    can = is_folder(there) and os.access(there, os.W_OK | os.X_OK)
    return Finding("places", name, str(folder), "" if can else f"can't be written to: {lost}")
