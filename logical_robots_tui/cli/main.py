"""The command ``logical-robots``: reads the arguments, starts a command, reports what fails."""

from __future__ import annotations

import argparse
import errno
import logging
import os
import sys
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui import __version__
from logical_robots_tui.cli import failure
from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.garbage import collect_seldom

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["PROGRAM", "main"]

PROGRAM = "logical-robots"

_HOMES = {
    "play": "play",
    "run": "runs.run",
    "trace": "runs.trace",
    "query": "runs.query",
    "when": "runs.when",
    "why": "runs.why",
    "origin": "runs.origin",
    "diagnose": "runs.diagnose",
    "check": "check",
    "help": "help",
    "levels": "listing",
    "programs": "listing",
    "level": "level.command",
    "config": "config",
    "doctor": "doctor",
    "completion": "completion",
}
"""The module of each command, in the order of the help."""

INTERRUPTED = 130  # 128 + SIGINT, as a shell reports it
PIPE_CLOSED = 141  # 128 + SIGPIPE
OUTPUT_FAILS = (errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)

EXAMPLES = """\
examples:
  logical-robots                       play the first level
  logical-robots levels                list the levels
  logical-robots play 02-open-space    play one of them
  logical-robots programs              list the programs
  logical-robots check first-steps     say what is wrong with a program
  logical-robots run 01-first-steps first-steps
                                       run without a screen
  logical-robots trace 01-first-steps first-steps
                                       tell every tick as JSON
  logical-robots query 01-first-steps first-steps --tick 90 Robot
                                       ask anything about a tick
  logical-robots when 01-first-steps first-steps Robot
                                       say in which ticks something holds
  logical-robots why 01-first-steps first-steps --tick 90 --robot Ada --tree
                                       say why a robot did what it did
  logical-robots origin 06-breadcrumbs breadcrumbs --tick 300 --robot Crow
                                       say where a value comes from
  logical-robots diagnose 01-first-steps first-steps
                                       look through a run for mistakes
  logical-robots help ArgMin           explain a function of the language
  logical-robots level new maze.toml   make a level
  logical-robots config                show settings and keys
  logical-robots doctor                say what was found on this machine

Levels and programs are names from these lists or paths of files.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status.

    Args:
        arguments: What was typed after the command's name; by default ``sys.argv``.

    Raises:
        SystemExit: By argparse, for ``--help``, ``--version`` and mistyped arguments.
    """
    collect_seldom()
    # Our arrays are small: more threads of numpy's would take longer to begin than they save.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _open_what_is_closed()
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr] # typed as TextIO
    logging.getLogger("logical_robots_tui").handlers = [failure.CrashLog(logging.ERROR)]
    typed = _with_command(sys.argv[1:] if arguments is None else arguments)
    options = parser(typed[0]).parse_args(typed)
    try:
        status = _start(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as error:  # others are told of, with the name of a file, where they arise
        # What is still buffered would fail again when Python flushes it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED if isinstance(error, BrokenPipeError) else failure.report_output(error)
    return status


def _start(options: argparse.Namespace) -> int:
    """Start a command, report what is wrong, and return the exit status.

    Raises:
        OSError: Standard output can't be written.
    """
    try:
        status: int = options.start(options)
    except LogicalRobotsError as error:
        return failure.report(error, as_json=options.wants_json(options))
    except Exception as error:
        if isinstance(error, OSError) and error.errno in OUTPUT_FAILS and error.filename is None:
            raise
        return failure.report_own_mistake(error, as_json=options.wants_json(options))
    return status


def parser(command: str = "") -> argparse.ArgumentParser:
    """The parser of all commands; each command's options carry its ``start`` function.

    Args:
        command: If this is one of them, no other is loaded, so that it starts sooner.
    """
    top = argparse.ArgumentParser(
        prog=PROGRAM,
        description="Robots in a labyrinth, programmed in logic. Without a command: play.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    wanted = [command] if command in _HOMES else _HOMES
    for home in dict.fromkeys(_HOMES[name] for name in wanted):
        import_module(f"logical_robots_tui.cli.{home}").declare(commands)
    return top


def _open_what_is_closed() -> None:
    """Put nothing in the place of a standard stream that the process was started without.

    Else it would be None, and its number that of the next file to be opened.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            nothing = Path(os.devnull).open(mode, encoding="utf-8")  # noqa: SIM115 - for good
            setattr(sys, name, nothing)


def _with_command(arguments: Sequence[str]) -> list[str]:
    """Put in the command ``play`` where none was typed."""
    first = arguments[0] if arguments else ""
    asks_about_all = first in {"-h", "--help", "--version"}
    if not first or (first.startswith("-") and not asks_about_all):
        return ["play", *arguments]
    return list(arguments)
