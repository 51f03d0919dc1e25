"""``logical-robots ladder``: rank the programs that players hand in, in the background."""

from __future__ import annotations

import argparse
import asyncio
import os
import signal
import time
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import harmless
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.paths import write_atomically
from logical_robots_tui.processes.lifeline import LIFELINE, signal_when_closed
from logical_robots_tui.wording import count_of
from logical_robots_tui.world import Level, list_arenas, load_level

if TYPE_CHECKING:
    from logical_robots_tui.progress.board import Board
    from logical_robots_tui.progress.ladder import Ladder, LadderRank

FOLDER_NAME = "ladder"
_STARTS = 4  # varied ones, beside the given one
_MATCH_SECONDS = 60.0  # of processor; a longer match has no result
_LOOK_SECONDS = 5.0
_LOWEST_PRIORITY = 19


@command.declare(
    "ladder",
    command.until_interrupted,
    command.option("folder", "FOLDER", "the folder of a board", type=Path),
    command.flag("--once", "end when all programs that are there are ranked"),
    command.number("--workers", command.number_from(1), 1, "processes that play matches"),
)
def ladder(options: argparse.Namespace) -> int:
    """rank the programs that players hand in

    Let the programs that players hand in from the game play against each other, at low priority.

    Only what changed is played, and a ladder that was stopped picks up where it left off.

    examples:
      logical-robots ladder ./board --once
      logical-robots host ./host --board ./board    in the background of a host

    exit status: 0 after ^C or when done, 2 if the board can't be used
    """
    from logical_robots_tui.lab.folder import Folder
    from logical_robots_tui.progress.board import Board
    from logical_robots_tui.progress.ladder import Ladder

    if LIFELINE in os.environ:
        signal_when_closed(int(os.environ[LIFELINE]), signal.SIGTERM)
    os.nice(_LOWEST_PRIORITY)
    board = Board(options.folder)
    board.create()
    folder = options.folder / FOLDER_NAME
    ranked: dict[str, dict[str, str]] = {}
    with Folder(folder).lock():
        while True:
            for arena in list_arenas():
                standings = Ladder(board, arena)
                programs = standings.programs()
                if programs and ranked.get(arena) != programs:
                    _rank(board, standings, folder / arena, programs, options.workers)
                    ranked[arena] = standings.programs()
            if options.once:
                return 0
            time.sleep(_LOOK_SECONDS)


def _rank(
    board: Board, standings: Ladder, folder: Path, programs: Mapping[str, str], workers: int
) -> None:
    """Play what has not been played yet, and record ranks and matches."""
    from logical_robots_tui.progress.ladder import HOUSE, LadderRank
    from logical_robots_tui.progress.store import program_digest

    level = load_level(standings.arena)
    texts = {HOUSE: shipped_texts()[level.starter]}
    missing = dict[str, LadderRank]()
    for player, digest in programs.items():
        if player != HOUSE:
            try:
                texts[player] = board.program(player, digest)
            except InputError as error:
                missing[player] = LadderRank(problem=error.message)
    ranks, pairs = _play(level, folder, texts, workers) if len(texts) > 1 else ({}, [])
    digests = {player: program_digest(text) for player, text in texts.items()}
    standings.rank({**digests, **programs}, ranks | missing)
    existing = standings.matches()
    replays = {}
    for upper, lower in pairs:
        both = f"{digests[upper]} {digests[lower]}"
        if existing.get((upper, lower)) != both:
            content = _replay(level, texts[upper], texts[lower])
            if content is not None:
                replays[upper, lower] = both, content
    standings.keep_matches(pairs, replays)
    print(harmless(f"{level.title}: {count_of(len(ranks), 'program')} ranked."), flush=True)


def _play(
    level: Level, folder: Path, texts: Mapping[str, str], workers: int
) -> tuple[dict[str, LadderRank], list[tuple[str, str]]]:
    """Return the ranks by player, the best first, and who has met, the better one first."""
    from logical_robots_tui.lab import tournament
    from logical_robots_tui.lab.exporting import RunRecords
    from logical_robots_tui.lab.folder import Folder
    from logical_robots_tui.lab.ranking import ranking_of
    from logical_robots_tui.progress.ladder import LadderRank

    # Not the players' own names, in which those of learning platforms would be looked for.
    players = {f"player{player.encode().hex()}": player for player in texts}
    programs = folder / "programs"
    programs.mkdir(mode=0o700, parents=True, exist_ok=True)
    for name, player in players.items():
        write_atomically(programs / f"{name}.l", texts[player])
    for path in programs.iterdir():
        if path.stem not in players:
            path.unlink()
    specification = {
        "tournament": {"title": level.title, "level": level.name, "starts": _STARTS},
        "limits": {"seconds": _MATCH_SECONDS},
    }
    results = Folder(folder / "results")
    tournament(specification, programs, results.path, workers=workers, progress=False)
    with results.ledger() as ledger:
        manifest = results.manifest()
        ranking = ranking_of(RunRecords(manifest, ledger))
    problems = {player.name: player.lost for player in manifest.players}
    ranks = {
        players[s.player]: LadderRank(
            s.rank, s.share, s.low, s.high, s.strength, problems[s.player]
        )
        for s in ranking.standings
    }
    names = [s.player for s in ranking.standings if not problems[s.player]]
    pairs = [pair for pair in combinations(names, 2) if pair in ranking.pairings]
    return ranks, [(players[upper], players[lower]) for upper, lower in pairs]


def _replay(level: Level, *texts: str) -> bytes | None:
    """Return the match of two programs from the given start; None if it can't be recorded."""
    from logical_robots_tui.cli.replay import record_run
    from logical_robots_tui.progress.board import MOST_GHOST_BYTES

    teams = {team.name: texts[seat % 2] for seat, team in enumerate(level.teams)}
    try:
        program = Program.compile(teams)
        replay = asyncio.run(
            record_run(level, program, level.match_ticks, level.name, with_programs=False)
        )
        content = replay.to_bytes()
    except (ProgramError, InputError):
        return None
    return content if len(content) <= MOST_GHOST_BYTES else None
