"""``logical-robots board``: show the board of a server, check it, and watch a class at work."""

from __future__ import annotations

import argparse
import asyncio
import sys
import time
from collections import Counter
from collections.abc import Iterator
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    columns,
    drawn_bar,
    harmless,
    line_of_json,
    print_json,
    say,
)
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.run import level_digest, simulation_digest
from logical_robots_tui.game.verification import (
    SECONDS,
    FileBudget,
    differences,
    load_public_level,
    play_again,
)
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardEntry, MissingProgramError, shown_name
from logical_robots_tui.progress.class_view import HEADINGS, Pupil, pupils
from logical_robots_tui.world import Level

CONFIRMED, NOT_CONFIRMED = 0, 1

command.group(
    "board",
    "show the board of a server, check it, and watch a class at work",
    """\
  logical-robots board show ./board
  logical-robots board check ./board
  logical-robots board watch ./board
""",
)

_FOLDER = command.option(
    "folder",
    "FOLDER",
    "the folder of the board (default: LOGICAL_ROBOTS_BOARD)",
    nargs="?",
    type=Path,
    default=command.board_folder,
)


def _board(options: argparse.Namespace) -> Board:
    if options.folder is None:
        raise InputError("Which board?", hint="Name its folder, or set LOGICAL_ROBOTS_BOARD.")
    return Board(Path(options.folder))


class _RankedEntry(NamedTuple):
    """An entry as it is shown; `rank` is the player's by ticks, at their fastest entry only."""

    level: str
    is_current: bool
    level_digest: str
    rank: int | None
    name: str | None
    ticks: int
    size: int
    distance: float
    won: str
    state: str
    struck: str | None


@command.declare(
    "board show",
    _FOLDER,
    command.option("--level", "LEVEL", "show this level only"),
    command.one_of(command.JSON, command.flag("--csv", "print CSV")),
)
def _show(options: argparse.Namespace) -> int:
    """show the victories of all players

    Show the victories of all players in each level, ranked by ticks.
    Those in an earlier version of a level stand apart.

    examples:
      logical-robots board show ./board
      logical-robots board show ./board --level 01-first-steps
      logical-robots board show ./board --csv

    exit status: 0 shown, 2 the board can't be used
    """
    entries = [*_ranked(_board(options).entries())]
    if options.level is not None:
        name = load_public_level(options.level).name
        entries = [entry for entry in entries if entry.level == name]
    if options.json:
        print_json([entry._asdict() for entry in entries])
    elif options.csv:
        from logical_robots_tui.lab.exporting import ResultTable, csv_of

        print(csv_of(ResultTable(_RankedEntry._fields, list(entries))), end="")
    elif not entries:
        print("Nobody is on the board yet.")
    else:
        tables = groupby(entries, lambda entry: entry[:3])
        print("\n\n".join(_table([*group]) for _, group in tables))
    return CONFIRMED


def _table(entries: list[_RankedEntry]) -> str:
    version = "" if entries[0].is_current else ", an earlier version of the level"
    rows: list[tuple[str, ...]] = [
        ("RANK", "NAME", "TICKS", "SIZE", "DISTANCE", "DATE", "STATE"),
        *(
            (
                "" if entry.rank is None else str(entry.rank),
                shown_name(entry.name),
                *(f"{number:,.0f}" for number in (entry.ticks, entry.size, entry.distance)),
                entry.won[:10],
                f"struck: {entry.struck}" if entry.struck else entry.state,
            )
            for entry in entries
        ),
    ]
    return "\n".join([harmless(entries[0].level) + version, *columns(rows)])


def _ranked(entries: list[BoardEntry]) -> Iterator[_RankedEntry]:
    """Rank entries by ticks; the current version of a level comes first, what is struck last."""
    engine = simulation_digest().hex()
    entries = sorted(entries, key=lambda entry: entry.struck is not None)

    def version(entry: BoardEntry) -> tuple[str, bool, str]:
        level = _current_version(entry)
        return entry.level if level is None else level.name, level is None, entry.level_digest

    for (name, is_earlier, digest), group in groupby(sorted(entries, key=version), version):
        bests: dict[str, int] = {}
        for entry in group:
            rank = None
            if entry.struck is None and entry.player not in bests:
                bests[entry.player] = entry.ticks
                rank = 1 + sum(ticks < entry.ticks for ticks in bests.values())
            state = "confirmed" if entry.confirmed == engine else "unchecked"
            yield _RankedEntry(
                *(name, not is_earlier, digest, rank, entry.name),
                *(entry.ticks, entry.size, entry.distance, entry.won),
                *("struck" if entry.struck else state, entry.struck),
            )


def _current_version(entry: BoardEntry) -> Level | None:
    """Return the level of an entry, or None if it is no longer the same."""
    level, digest = _level(entry.level)
    return level if digest == entry.level_digest else None


@cache
def _level(name: str) -> tuple[Level | None, str]:
    try:
        level = load_public_level(name)
    except InputError:
        return None, ""
    return level, level_digest(level)


@command.declare(
    "board check",
    _FOLDER,
    command.number(
        "--seconds", command.number_from(1), SECONDS, "give up after so many processor seconds"
    ),
    command.JSON,
)
def _check(options: argparse.Namespace) -> int:
    """play the victories again, and strike out what does not hold

    Play every entry again that this version of the game has not confirmed yet, and
    strike out those that do not hold. What was decided before ^C stays decided.

    examples:
      logical-robots board check ./board
      logical-robots board check ./board --seconds 60

    exit status: 0 all confirmed, 1 entries were struck out or not decided, 2 the
    board can't be used
    """
    board, budget = _board(options), FileBudget(options.seconds)
    engine = simulation_digest().hex()
    entries = [entry for entry in board.entries() if entry.confirmed != engine]
    results: list[dict[str, Any]] = []
    for number, entry in enumerate(entries, 1):
        level = _current_version(entry)
        reason = ""
        if level is None:
            verdict = "earlier version"
            reason = "the level is no longer the same, so it can't be played again"
        else:
            with drawn_bar(entry.level) as draw:
                draw(number - 1, len(entries), f"entry {number:,} of {len(entries):,}", "")
                verdict, reason = asyncio.run(_judge(board, entry, level, budget))
            if verdict != "undecided":
                board.judge(entry, engine, reason or None)
        results.append(
            {
                "level": entry.level,
                "name": entry.name,
                "ticks": entry.ticks,
                "verdict": verdict,
                "reason": reason,
            }
        )
        if not options.json:
            line = f"{entry.level:24}  {shown_name(entry.name):16}  {entry.ticks:6}  {verdict}"
            print(harmless(f"{line}: {reason}" if reason else line), flush=True)
    counts = Counter(result["verdict"] for result in results)
    is_confirmed = not counts["struck"] and not counts["undecided"]
    if options.json:
        print_json({"confirmed": is_confirmed, "results": results})
    elif results:
        print(", ".join(f"{count:,} {verdict}" for verdict, count in counts.items()))
    else:
        print("Every entry is confirmed already.")
    return CONFIRMED if is_confirmed else NOT_CONFIRMED


async def _judge(
    board: Board, entry: BoardEntry, level: Level, budget: FileBudget
) -> tuple[str, str]:
    """Return a verdict (confirmed, struck or undecided) and its reason, or ""."""
    claim = Measures(entry.ticks, entry.size, entry.distance)
    try:
        outcome = await play_again(
            level, board.program(entry.player, entry.program), budget, has_starts=False
        )
    except MissingProgramError as error:
        return "struck", error.message
    except InputError as error:
        return "undecided", str(error)
    reason = outcome if isinstance(outcome, str) else "; ".join(differences(claim, outcome))
    return "struck" if reason else "confirmed", reason


_SECONDS = 1.0  # between two looks at a class


@command.declare(
    "board watch",
    command.until_interrupted,
    _FOLDER,
    command.one_of(
        command.flag("--plain", "print a table, then a line for each change"),
        command.flag("--json", "print each player, then each change, as a line of JSON"),
    ),
)
def _watch(options: argparse.Namespace) -> int:
    """watch a class at work

    Show who is in which level, the trouble of the last run, and who asks for help,
    until ^C or q. The program of a player is shown only while they ask for help.
    Players are seen whose games were started with --board and --class.

    examples:
      logical-robots board watch ./board
      logical-robots board watch ./board --plain

    exit status: 0 after ^C or q, 2 the board can't be used
    """
    board = _board(options)
    class_at_work = pupils(board)
    is_terminal = all(stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr))
    if is_terminal and not (options.plain or options.json):
        from logical_robots_tui.cli.play import prepare_screen

        prepare_screen()
        from logical_robots_tui.tui.app.class_view import watch_class

        watch_class(board)
        return 0
    print_pupil = _print_json_line if options.json else _print_pupil
    previous: list[Pupil] = []
    if not options.json:
        say(*columns([HEADINGS, *(pupil.cells() for pupil in class_at_work)]))
        previous = [pupil for pupil in class_at_work if pupil.program is None]
    while True:
        for pupil in class_at_work:
            if pupil not in previous:
                print_pupil(pupil)
        previous = class_at_work
        time.sleep(_SECONDS)
        class_at_work = pupils(board)


def _print_json_line(pupil: Pupil) -> None:
    activity = pupil.activity
    document = {**activity._asdict(), "asks_for_help": activity.asks_for_help}
    print(line_of_json({**document, "program": pupil.program}), flush=True)


def _print_pupil(pupil: Pupil) -> None:
    clock = time.strftime("%H:%M")
    program = (pupil.program or "").splitlines()
    say(f"{clock} {pupil.sentence()}", *(f"  {line}" for line in program))
