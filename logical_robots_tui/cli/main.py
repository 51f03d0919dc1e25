"""The command ``logical-robots``: parse and complete arguments, run a command, report errors."""

from __future__ import annotations

import argparse
import errno
import logging
import os
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path

from logical_robots_tui import __version__
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    CrashLog,
    add_command,
    folder_of,
    report,
    report_bug,
    report_output,
)
from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.processes.helper import collect_seldom

PROGRAM = "logical-robots"

_MODULES = (
    ("play", "play serve host"),
    ("ladder", "ladder"),
    ("run", "run trace"),
    ("query", "query when"),
    ("why", "why origin"),
    ("query", "diagnose"),
    ("learn", "learn"),
    ("check", "check"),
    ("check", "help"),
    ("level", "levels"),
    ("check", "programs"),
    ("check", "lsp"),
    ("doctor", "config"),
    ("replay", "replay"),
    ("progress", "progress"),
    ("board", "board"),
    ("level", "level"),
    ("lab", "sweep grade grade-kit tournament lab"),
    ("doctor", "doctor"),
    ("main", "completion"),
)
"""The modules of the commands, in the order of the help."""

_HOMES = {name.replace("-", " "): module for module, names in _MODULES for name in names.split()}

PIPE_CLOSED = 141  # 128 + SIGPIPE
OUTPUT_FAILS = (errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)

EXAMPLES = """\
examples:
  logical-robots                       continue, or start the first level
  logical-robots levels                list the levels
  logical-robots play 02-open-space    play one of them
  logical-robots serve                 play in a browser
  logical-robots programs              list the programs
  logical-robots check first-steps     check a program for errors
  logical-robots run 01-first-steps first-steps
                                       run without a screen
  logical-robots trace 01-first-steps first-steps
                                       print every tick as JSON
  logical-robots query 01-first-steps first-steps --tick 90 Robot
                                       query one tick of a run
  logical-robots when 01-first-steps first-steps Robot
                                       find the ticks in which something holds
  logical-robots why 01-first-steps first-steps --tick 90 --robot Ada --tree
                                       explain what a robot did
  logical-robots origin 06-breadcrumbs breadcrumbs --tick 300 --robot Crow
                                       find out where a value comes from
  logical-robots diagnose 01-first-steps first-steps
                                       scan a run for likely mistakes
  logical-robots learn 01-first-steps  read a lesson and answer its questions
  logical-robots replay record 01-first-steps first-steps -o first.replay
                                       record a run in a file
  logical-robots help ArgMin           explain a function of the language
  logical-robots progress              list your results
  logical-robots board show ./board    compare the players of a server
  logical-robots level new maze.toml   create a level
  logical-robots sweep experiment.toml -o out
                                       run an experiment
  logical-robots config                show settings and keys
  logical-robots doctor                check this computer and this terminal

Levels and programs are names from these lists, or file paths.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status; argparse may raise SystemExit."""
    collect_seldom()
    # Our arrays are small: starting more numpy threads would take longer than they save.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Closed standard streams get the null device, before a file gets their descriptor.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            null = Path(os.devnull).open(mode, encoding="utf-8")  # noqa: SIM115 - stays open
            setattr(sys, name, null)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr] # typed as TextIO
    logging.getLogger("logical_robots_tui").handlers = [CrashLog(logging.ERROR)]
    words = list(sys.argv[1:] if arguments is None else arguments)
    first = words[0] if words else ""
    if not first or (first.startswith("-") and first not in {"-h", "--help", "--version"}):
        words.insert(0, "play")
    if (name := " ".join(words[:2])) in _HOMES:  # it looks like an argument of the first word
        words[:2] = [name]
    options = parser(words[0]).parse_args(words)
    try:
        status = _start(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return int(options.status_after_interrupt)
    except OSError as error:  # errors about files are reported where they arise
        # What is still buffered would fail again when Python flushes it at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PIPE_CLOSED if isinstance(error, BrokenPipeError) else report_output(error)
    return status


def _start(options: argparse.Namespace) -> int:
    """Run a command and report errors; raise OSError if standard output can't be written."""
    try:
        return int(options.start(options))
    except LogicalRobotsError as error:
        return report(error, as_json=options.wants_json(options))
    except Exception as error:
        if isinstance(error, OSError) and error.errno in OUTPUT_FAILS and error.filename is None:
            raise
        return report_bug(error, as_json=options.wants_json(options))


def parser(name: str = "") -> argparse.ArgumentParser:
    """Return the argument parser; parsed options hold the command's ``start`` function.

    If a command is named, only its module is loaded, which is faster.
    """
    top = argparse.ArgumentParser(
        prog=PROGRAM,
        description="Program robots in a labyrinth in Logica. The default command is play.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    commands = top.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for member in [name] if name in _HOMES else _HOMES:
        import_module(f"logical_robots_tui.cli.{_HOMES[member]}")
        add_command(commands, member)
    return top


SHELLS = ("bash", "zsh", "fish")
NAMES = ("levels", "programs")


@command.declare(
    "completion",
    command.option("what", None, "the shell, or names to print", choices=(*SHELLS, *NAMES)),
)
def complete(options: argparse.Namespace) -> int:
    """print a completion script for your shell

    Print a script that completes commands, options, levels and programs.

    examples:
      logical-robots completion bash \\
        > ~/.local/share/bash-completion/completions/logical-robots
      logical-robots completion zsh > ~/.zfunc/_logical-robots
      logical-robots completion fish \\
        > ~/.config/fish/completions/logical-robots.fish

    Create the folder first if it does not exist; zsh also needs fpath+=~/.zfunc in
    ~/.zshrc. For the current shell only:
      eval "$(logical-robots completion bash)"

    The scripts call `completion levels` and `completion programs`, which print one
    name per line.
    """
    if options.what == "levels":
        from logical_robots_tui.paths import ARENAS, shipped_names

        for subfolder in ("", ARENAS):
            print(*shipped_names("levels", ".toml", subfolder), sep="\n")
    elif options.what == "programs":
        from logical_robots_tui.game import list_programs

        print(*list_programs(folder_of(None) / "programs"), sep="\n")
    else:
        import shtab

        top = parser()
        completions: dict[str, object] = {
            "FILE": "file",
            "FOLDER": "directory",
            "LEVEL": _names_or_files("levels", ("toml", "json")),
            "PROGRAM": _names_or_files("programs", ("l",)),
        }
        for action in _arguments(top):
            if completion := completions.get(str(action.metavar)):
                action.complete = completion  # type: ignore[attr-defined] # read by shtab
        print(shtab.complete(top, options.what))
    return 0


def _arguments(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for inner in dict.fromkeys(action.choices.values()):
                yield from _arguments(inner)


def _names_or_files(kind: str, endings: tuple[str, ...]) -> dict[str, object]:
    name = f"_logical_robots_{kind}"
    shell_command = f"logical-robots completion {kind} 2>/dev/null"
    globs = " ".join(f"'!*.{ending}'" for ending in endings)
    return {
        "bash": name,
        "zsh": name,
        "fish": f"({name})",
        "preamble": {
            "bash": f"""
{name}() {{
  compgen -W "$({shell_command})" -- "$1"
  local glob
  for glob in {globs}; do compgen -f -X "$glob" -- "$1"; done
  compgen -d -- "$1"
}}""",
            "zsh": f"""
{name}() {{
  local -a names
  names=(${{(f)"$({shell_command})"}})
  compadd -a names
  _files -g '*.({"|".join(endings)})'
}}""",
            "fish": f"""
function {name}
  {shell_command}
  __fish_complete_suffix {" ".join(f".{ending}" for ending in endings)}
end""",
        },
    }
