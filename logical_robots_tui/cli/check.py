"""``logical-robots check``, ``programs``, ``help``, ``lsp``: programs, mistakes, functions."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from dataclasses import asdict

from logical_robots_tui import game, mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import columns, harmless, own_programs, print_json
from logical_robots_tui.errors import InputError, check_installed

FINE, WRONG = 0, 2
FORMATS = ("text", "json", "github")
WIDEST = 100  # columns of an excerpt


@command.declare(
    "check",
    command.option("programs", "PROGRAM", "a program's name or file", nargs="+"),
    command.flag("--web", "also print what would fail or mean something else on the web platform"),
    command.option("--level", "LEVEL", "warn about names that no robot can sense in a level"),
    command.one_of(
        command.JSON,
        command.option(
            "--format",
            None,
            "text (the default), json, or github for annotations",
            choices=FORMATS,
            default="text",
        ),
    ),
    command.DATA_DIR,
    command.NO_SOLUTIONS,
)
def check(options: argparse.Namespace) -> int:
    """check a program for errors without running it

    Check programs for errors without running them.

    examples:
      logical-robots check my-program.l          print errors and warnings
      logical-robots check *.l                   check several programs
      logical-robots check my-program.l --web    and what fails on the web platform
      logical-robots check my-program.l --json   output for scripts
      logical-robots check *.l --format=github   annotations in a workflow of GitHub
      cat my-program.l | logical-robots check -  check standard input
      logical-robots check my-program.l --level 05-lighthouse
                                                 and names that the level lacks

    exit status: 0 all programs can run (there may be warnings), 2 one can't
    """
    is_json = options.json = options.json or options.format == "json"  # for errors, too
    level = world.load_level(options.level) if options.level else None
    results = []
    status = FINE
    folder = own_programs(options)
    for name in options.programs:
        text = game.load_program(name, folder, pipes=True).text
        findings = diagnostics(text, level, web=options.web)
        if any(diagnostic.severity == "error" for diagnostic in findings):
            status = WRONG
        results.append({"file": name, "diagnostics": [asdict(d) for d in findings]})
        as_lines = _annotation if options.format == "github" else _lines
        for diagnostic in findings if not is_json else ():
            print(*map(harmless, as_lines(name, text, diagnostic)), sep="\n")
    if is_json:
        print_json({"ok": status == FINE, "programs": results})
    return status


def diagnostics(
    text: str, level: world.Level | None = None, *, web: bool = False
) -> tuple[mind.Diagnostic, ...]:
    """Return a program's errors, or its warnings if it can run: in a level, and for the web."""
    try:
        program = mind.Program.compile(text)
    except mind.ProgramError as error:
        return error.diagnostics
    return game.warnings_in(program, level, web=web)


def _annotation(file: str, _text: str, diagnostic: mind.Diagnostic) -> Iterator[str]:
    """Yield a workflow command, by which GitHub shows a diagnostic beside the line."""
    place = f"file={_escaped(file)},line={diagnostic.line},col={diagnostic.column}"
    message = f"{diagnostic.message}. {diagnostic.hint}" if diagnostic.hint else diagnostic.message
    yield f"::{diagnostic.severity} {place}::{message.replace('%', '%25')}"


def _escaped(value: str) -> str:
    """Escape a property of a workflow command."""
    for sign in "%:,":  # the escape's own sign first
        value = value.replace(sign, f"%{ord(sign):02X}")
    return value


def _lines(file: str, text: str, diagnostic: mind.Diagnostic) -> Iterator[str]:
    place = f"{file}:{diagnostic.line}:{diagnostic.column}"
    yield f"{place}: {diagnostic.severity}: {diagnostic.message}"
    lines = text.split("\n")
    line = lines[diagnostic.line - 1] if diagnostic.line <= len(lines) else ""
    if line.strip():
        start = max(0, diagnostic.column - WIDEST // 2) if len(line) > WIDEST else 0
        excerpt = line[start : start + WIDEST].replace("\t", " ").rstrip()
        prefix = harmless(excerpt[: diagnostic.column - 1 - start])
        length = max(1, min(len(diagnostic.excerpt), len(excerpt) - diagnostic.column + 1 + start))
        yield f"  {excerpt}"
        yield f"  {' ' * len(prefix)}{'^' * length}"
    if diagnostic.hint:
        yield f"  {diagnostic.hint}"


@command.declare("programs", command.JSON, command.DATA_DIR, command.NO_SOLUTIONS)
def list_all_programs(options: argparse.Namespace) -> int:
    """list the shipped programs and your own

    List the programs that come with the game and those you saved in it.
    """
    folder = own_programs(options)
    sources = [game.load_program(name, folder) for name in game.list_programs(folder)]
    if options.json:
        entries = [
            {"name": source.name, "file": str(source.path), "shipped": source.shipped}
            for source in sources
        ]
        print_json(entries)
        return 0
    rows = [
        (source.name, "comes with the game" if source.shipped else str(source.path))
        for source in sources
    ]
    print(*columns([("NAME", "FROM"), *rows]), sep="\n")
    return 0


@command.declare("help", command.option("name", "FUNCTION", "what to explain", nargs="?"))
def print_help(options: argparse.Namespace) -> int:
    """explain the functions that a program can use

    Explain the functions, aggregates and operators that a program can use.

    examples:
      logical-robots help               list everything
      logical-robots help ArgMin        explain one of them
      logical-robots help '%'           operators need quotes

    exit status: 0, or 2 if there is no such function
    """
    from logical_robots_tui.language.reference import REFERENCE, find_help, similar

    if options.name is None:
        for kind in ("operator", "aggregate", "function"):
            rows: list[tuple[str, ...]] = [
                (entry.name, entry.summary) for entry in REFERENCE if entry.kind == kind
            ]
            print(f"{kind.capitalize()}s", *(f"  {row}" for row in columns(rows)), "", sep="\n")
        print("logical-robots help NAME explains one, with an example.")
        return 0
    entry = find_help(options.name)
    if entry is None:
        guess = similar(options.name)
        hint = f"Did you mean {guess}?" if guess else "`logical-robots help` lists all functions."
        raise InputError(f"There is no function {options.name}.", hint=hint)
    article = "an" if entry.kind[0] in "ao" else "a"
    print(entry.signature, f"  {entry.summary} ({article} {entry.kind})", "", sep="\n")
    print(f"  {entry.example}", f"  gives {entry.result}", sep="\n")
    return 0


@command.declare("lsp")
def serve(_options: argparse.Namespace) -> int:
    """answer a text editor about programs

    Answer a text editor about programs, in the Language Server Protocol on standard
    input and output: errors while typing, completion, help, references, renaming.
    Editors start it themselves; docs/editors.md says how to tell yours.

    It needs pygls: pip install 'logical-robots-tui[lsp]'

    exit status: 0 the editor has ended it, 2 pygls is missing
    """
    check_installed("pygls", "The language server", "'logical-robots-tui[lsp]'")
    from logical_robots_tui.lsp import features, server  # noqa: F401 - features join the server

    # It closes its streams; ours stay open for what prints at the end.
    server.SERVER.start_io(os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb"))
    return 0
