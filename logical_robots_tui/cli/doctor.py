"""``logical-robots doctor``: what the game detects on this machine and in this terminal."""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from logical_robots_tui import __version__
from logical_robots_tui.cli.command import Commands, add_data_dir, folder_of, harmless, new_command
from logical_robots_tui.paths import is_folder, is_there

FINE, PROBLEM = 0, 1
PACKAGES = ("logica", "textual", "rich", "numpy", "orjson", "sqlglot")

SAFE_SQLITE = (3, 50, 2)
"""The first SQLite without a known hole that a query of a robot's program might reach."""


@dataclass(frozen=True)
class Fact:
    part: str
    name: str
    value: str
    problem: str = ""


def declare(commands: Commands) -> None:
    command = new_command(commands, "doctor", start)
    command.add_argument("--json", action="store_true", help="print JSON")
    add_data_dir(command)


def start(options: argparse.Namespace) -> int:
    """check this machine and this terminal

    Print what the game detects on this machine and in this terminal.

    examples:
      logical-robots doctor           what the game detects (for bug reports)
      logical-robots doctor --json    the same as JSON

    exit status: 0 the game can be played here, 1 there are problems, marked with !
    """
    found = [*_terminal(), *_versions(), *_places(options.data_dir)]
    if options.json:
        print(json.dumps([asdict(fact) for fact in found], indent=2))
    else:
        for part in dict.fromkeys(fact.part for fact in found):
            print(part)
            for fact in found:
                if fact.part == part:
                    sign = "!" if fact.problem else " "
                    said = f"  ({fact.problem})" if fact.problem else ""
                    print(f"{sign} {fact.name:<14} {harmless(fact.value)}{said}")
    return PROBLEM if any(fact.problem for fact in found) else FINE


def _terminal() -> Iterator[Fact]:
    """Yield what is known about the terminal without querying it."""
    from rich.console import Console

    from logical_robots_tui.tui.layout.arrangement import LEAST_HEIGHT, LEAST_WIDTH
    from logical_robots_tui.tui.terminal.capabilities import (
        assume_colours,
        drawing_for,
        may_use_mouse,
    )

    environ = dict(os.environ)
    assume_colours(environ)
    console = Console(_environ=environ, file=sys.__stdout__, force_terminal=True)
    is_there = sys.stdin.isatty() and sys.stdout.isatty()
    yield _fact("name", environ.get("TERM", "") or "none")
    yield _fact("output", "to the terminal" if is_there else "to a pipe or file")
    if is_there:
        columns, lines = os.get_terminal_size(sys.stdout.fileno())
        is_small = columns < LEAST_WIDTH or lines < LEAST_HEIGHT
        problem = f"at least {LEAST_WIDTH}x{LEAST_HEIGHT} needed" if is_small else ""
        yield _fact("size", f"{columns}x{lines}", problem)
    colourless = "NO_COLOR" in environ
    colours = "none (NO_COLOR)" if colourless else _colours(console.color_system)
    yield _fact("colours", colours)
    encoding = console.encoding
    poor = "" if "utf" in encoding.lower() else "ASCII only; set LANG to a UTF-8 locale"
    yield _fact("encoding", encoding, poor)
    drawing = drawing_for(environ, console.color_system, encoding, colourless=colourless)
    yield _fact("drawing", drawing.value)
    around = [name for name in ("TMUX", "STY", "SSH_CONNECTION") if environ.get(name)]
    words = {"TMUX": "tmux", "STY": "GNU screen", "SSH_CONNECTION": "ssh"}
    yield _fact("inside", ", ".join(words[name] for name in around) or "neither tmux nor ssh")
    yield _fact("mouse", "used" if may_use_mouse(environ) else "off in GNU screen")
    yield _fact("editor", environ.get("VISUAL") or environ.get("EDITOR") or "vi")


def _fact(name: str, value: str, problem: str = "") -> Fact:
    return Fact("terminal", name, value, problem)


def _colours(system: str | None) -> str:
    known = {"truecolor": "16 million", "256": "256", "standard": "16", "windows": "16"}
    return known.get(system or "", "none")


def _versions() -> Iterator[Fact]:
    import sqlite3
    from importlib.metadata import PackageNotFoundError, version

    yield Fact("versions", "logical-robots", __version__)
    yield Fact("versions", "python", f"{platform.python_version()} on {platform.platform()}")
    sqlite = sqlite3.sqlite_version
    if sqlite3.sqlite_version_info < SAFE_SQLITE:
        # Not a problem: distributions mend it without changing the version.
        sqlite += ", which has a hole (CVE-2025-6965) unless your system has mended it"
    yield Fact("versions", "sqlite", sqlite)
    sandbox = shutil.which("bwrap")
    yield Fact("versions", "bubblewrap", sandbox or "not installed, a sandbox for classes")
    for package in PACKAGES:
        try:
            yield Fact("versions", package, version(package))
        except PackageNotFoundError:
            yield Fact("versions", package, "not installed", "required by the game")


def _places(data_dir: Path | None) -> Iterator[Fact]:
    from logical_robots_tui.mind.compilation import compiled_programs
    from logical_robots_tui.player.settings import read_settings, settings_path
    from logical_robots_tui.tui.commands.keymap import KeyMap
    from logical_robots_tui.tui.commands.table import COMMANDS

    yield _place("data", folder_of(data_dir), "your work can't be saved")
    settings = settings_path()
    complaints = read_settings(settings, KeyMap(COMMANDS).read).complaints
    wrong = "it has errors; run logical-robots config" if complaints else ""
    value = f"{settings}{'' if is_there(settings) else ' (none)'}"
    yield Fact("places", "configuration", value, wrong)
    compiled = compiled_programs().place
    if compiled is None:
        yield Fact("places", "cache", "none")
    else:
        yield _place("cache", compiled, "programs are compiled again each time")


def _place(name: str, folder: Path, lost: str) -> Fact:
    there = folder
    while not is_there(there) and there != there.parent:
        there = there.parent
    can = is_folder(there) and os.access(there, os.W_OK | os.X_OK)
    return Fact("places", name, str(folder), "" if can else f"not writable: {lost}")
