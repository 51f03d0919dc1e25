"""``logical-robots doctor`` and ``config``: this computer, this terminal, and the settings."""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

from logical_robots_tui import __version__
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import folder_of, harmless, print_json
from logical_robots_tui.paths import is_folder, is_there

FINE, PROBLEM, WRONG = 0, 1, 2


@command.declare(
    "config",
    command.flag("--path", "print only the path of the file"),
    command.flag("--default", "print the defaults instead"),
)
def print_settings(options: argparse.Namespace) -> int:
    """show the settings and keys, and where to change them

    Print the settings and keys in the format of the configuration file.

    examples:
      logical-robots config             the settings and the keys of all commands
      logical-robots config --path      the path of the configuration file
      logical-robots config --default   the defaults, to start your own file

    exit status: 0 the file is valid, 2 it has errors, which are printed to stderr
    """
    from logical_robots_tui.player.settings import Settings, as_toml, read_settings, settings_path
    from logical_robots_tui.tui.commands.keymap import KeyMap
    from logical_robots_tui.tui.commands.table import COMMANDS

    path = settings_path()
    if options.path:
        print(path)
        return FINE
    settings = Settings() if options.default else read_settings(path, KeyMap(COMMANDS).read)
    head = "settings from" if is_there(path) and not options.default else "defaults, to be put into"
    print(f"# Logical Robots: {head} {harmless(str(path))}", *as_toml(settings), "", sep="\n")
    print(*KeyMap(COMMANDS, settings.keys).as_toml(), sep="\n")
    for complaint in settings.complaints:
        print(harmless(complaint), file=sys.stderr)
    return WRONG if settings.complaints else FINE


PACKAGES = ("logica", "textual", "rich", "numpy", "orjson", "sqlglot")

SAFE_SQLITE = (3, 50, 2)
"""The first SQLite without a known vulnerability that a query of a robot's program might reach."""


Fact: TypeAlias = tuple[str, str, str]
"""A name, its value, and the problem with it, or ""."""


@command.declare("doctor", command.JSON, command.DATA_DIR)
def diagnose_machine(options: argparse.Namespace) -> int:
    """check this computer and this terminal

    Print what the game detects on this computer and in this terminal.

    examples:
      logical-robots doctor           what the game detects (for bug reports)
      logical-robots doctor --json    the same as JSON

    exit status: 0 the game can be played here, 1 there are problems, marked with !
    """
    parts = {
        "terminal": [*_terminal()],
        "versions": [*_versions()],
        "places": [*_places(options.data_dir)],
    }
    if options.json:
        keys = ("part", "name", "value", "problem")
        rows = [(part, *fact) for part, facts in parts.items() for fact in facts]
        print_json([dict(zip(keys, fact, strict=True)) for fact in rows])
    else:
        for part, facts in parts.items():
            print(part)
            for name, value, problem in facts:
                note = f"  ({problem})" if problem else ""
                print(f"{'!' if problem else ' '} {name:<14} {harmless(value)}{note}")
    return PROBLEM if any(fact[2] for facts in parts.values() for fact in facts) else FINE


def _terminal() -> Iterator[Fact]:
    """Yield the facts about the terminal that need no query."""
    from rich.console import Console

    from logical_robots_tui.tui.layout.arrangement import LEAST_HEIGHT, LEAST_WIDTH
    from logical_robots_tui.tui.terminal.capabilities import (
        assume_colours,
        drawing_for,
        may_use_mouse,
        writes_utf_8,
    )

    environ = dict(os.environ)
    assume_colours(environ)
    console = Console(_environ=environ, file=sys.__stdout__, force_terminal=True)
    is_there = sys.stdin.isatty() and sys.stdout.isatty()
    yield "name", environ.get("TERM", "") or "none", ""
    yield "output", "to the terminal" if is_there else "to a pipe or file", ""
    if is_there:
        columns, lines = os.get_terminal_size(sys.stdout.fileno())
        is_small = columns < LEAST_WIDTH or lines < LEAST_HEIGHT
        problem = f"at least {LEAST_WIDTH}x{LEAST_HEIGHT} needed" if is_small else ""
        yield "size", f"{columns}x{lines}", problem
    colourless = "NO_COLOR" in environ
    counts = {"truecolor": "16 million", "256": "256", "standard": "16", "windows": "16"}
    colours = "none (NO_COLOR)" if colourless else counts.get(console.color_system or "", "none")
    yield "colours", colours, ""
    encoding = console.encoding
    limitation = "" if writes_utf_8(encoding) else "ASCII only; set LANG to a UTF-8 locale"
    yield "encoding", encoding, limitation
    drawing = drawing_for(environ, console.color_system, encoding, colourless=colourless)
    yield "drawing", drawing.value, ""
    variables = [name for name in ("TMUX", "STY", "SSH_CONNECTION") if environ.get(name)]
    words = {"TMUX": "tmux", "STY": "GNU screen", "SSH_CONNECTION": "ssh"}
    yield "inside", ", ".join(words[name] for name in variables) or "neither tmux nor ssh", ""
    yield "mouse", "used" if may_use_mouse(environ) else "off in GNU screen", ""
    yield "editor", environ.get("VISUAL") or environ.get("EDITOR") or "vi", ""


def _versions() -> Iterator[Fact]:
    import sqlite3
    from importlib.metadata import PackageNotFoundError, version

    yield "logical-robots", __version__, ""
    yield "python", f"{platform.python_version()} on {platform.platform()}", ""
    sqlite = sqlite3.sqlite_version
    if sqlite3.sqlite_version_info < SAFE_SQLITE:
        # Not a problem: distributions patch it without changing the version.
        sqlite += ": vulnerable (CVE-2025-6965) unless your system has patched it"
    yield "sqlite", sqlite, ""
    sandbox = shutil.which("bwrap")
    yield "bubblewrap", sandbox or "not installed, a sandbox for classes", ""
    for package in PACKAGES:
        try:
            yield package, version(package), ""
        except PackageNotFoundError:
            yield package, "not installed", "required by the game"


def _places(data_dir: Path | None) -> Iterator[Fact]:
    from logical_robots_tui.mind.compilation import compiled_programs
    from logical_robots_tui.player.settings import read_settings, settings_path
    from logical_robots_tui.tui.commands.keymap import KeyMap
    from logical_robots_tui.tui.commands.table import COMMANDS

    yield _place("data", folder_of(data_dir), "your work can't be saved")
    settings = settings_path()
    complaints = read_settings(settings, KeyMap(COMMANDS).read).complaints
    problem = "it has errors; run logical-robots config" if complaints else ""
    value = f"{settings}{'' if is_there(settings) else ' (none)'}"
    yield "configuration", value, problem
    cache = compiled_programs().place
    if cache is None:
        yield "cache", "none", ""
    else:
        yield _place("cache", cache, "programs are compiled again each time")


def _place(name: str, folder: Path, consequence: str) -> Fact:
    ancestor = folder
    while not is_there(ancestor) and ancestor != ancestor.parent:
        ancestor = ancestor.parent
    is_writable = is_folder(ancestor) and os.access(ancestor, os.W_OK | os.X_OK)
    return name, str(folder), "" if is_writable else f"not writable: {consequence}"
