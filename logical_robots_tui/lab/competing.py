"""A tournament: its players, and who plays whom in each round."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Literal

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.exporting import RunRecords
from logical_robots_tui.lab.folder import Cell, Ledger, Manifest, TournamentPlayer, digest
from logical_robots_tui.lab.handins import Submission, entries_of, stems_of
from logical_robots_tui.lab.ranking import ranking_of
from logical_robots_tui.lab.sweeping import Limit, Name, Positive, Starts, level_with_text
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.toml_files import Given, TomlFile
from logical_robots_tui.world import Level
from logical_robots_tui.world.symmetry import has_equal_seats


class TournamentTable(msgspec.Struct, frozen=True):
    """``[tournament]``; a match lasts as many ticks as the level says, or fewer."""

    level: Name
    title: str = ""
    starts: Starts = 20
    ticks: Positive | None = None
    format: Literal["all", "swiss"] | None = None


class Tournament(msgspec.Struct, frozen=True):
    tournament: TournamentTable
    limits: Limit = Limit()


SWISS_FROM = 40
"""The number of players from which on not everybody plays everybody."""

_MORE_ROUNDS = 2  # of a Swiss tournament than are needed to find its winner


def plan_tournament(file: Given, players: Path) -> tuple[Manifest, dict[str, str]]:
    """Return a tournament's first round, and the texts of level and programs by digest.

    `players` holds one program or folder per player. Raises TomlFileError, or InputError
    for fewer than two players.
    """
    spec = TomlFile(file)
    tournament = spec.draft(Tournament)
    table, limits = tournament.tournament, tournament.limits
    level, text = _level(spec, table.level)
    ticks = min(table.ticks or level.match_ticks, level.match_ticks)
    inputs = {digest(text): text}
    entries = entries_of(players, stems_of([level.name]))
    named_entries = sorted(item for item in entries.items() if not item[1].is_stray)
    if len(named_entries) < 2:
        raise InputError("There are fewer than two players", place=str(players), hint=_HINT)
    contestants = [_player(name, entry, level, inputs) for name, entry in named_entries]
    is_swiss = table.format == "swiss" or (not table.format and len(contestants) >= SWISS_FROM)
    count, most_rounds = len(contestants), 1
    if is_swiss:
        most_rounds = min(math.ceil(math.log2(count)) + _MORE_ROUNDS, count - 1 + count % 2)
    manifest = Manifest(
        "tournament",
        table.title or spec.file.stem,
        spec.text,
        table.starts,
        False,
        (),
        (),
        limits.steps,
        limits.seconds,
        (),
        players=tuple(contestants),
        teams=tuple(team.name for team in level.teams),
        match=Cell(
            digest(text),
            *("", level.name, "", ticks),
            parity=0 if has_equal_seats(level) else None,
        ),
        most_rounds=most_rounds,
    )
    pairs = tuple(combinations(range(count), 2))
    if is_swiss:
        pairs = pair_off(manifest, {}) or ()
    return _with_round(manifest, pairs), inputs


_HINT = "Each has a program such as ada.l, or a folder with one that is named like the level."


def _level(spec: TomlFile, name: str) -> tuple[Level, str]:
    """Return level and text; raises TomlFileError if it is not a level for a match."""
    path = ("tournament", "level")
    try:
        level, text = level_with_text(name, spec.folder)
    except InputError as error:
        spec.problem(path, str(error))
    else:
        if len(level.teams) < 2:
            spec.problem(path, f"{level.name} has no teams that could play against each other")
        elif not level.scores:
            spec.problem(path, f"Nothing gives points in {level.name}: it has no [[scores]]")
    spec.refuse()
    return level, text


def _player(name: str, entry: Submission, level: Level, inputs: dict[str, str]) -> TournamentPlayer:
    text = next(iter(entry.programs.values()), None)
    if text is None:
        return TournamentPlayer(name, "", "; ".join(entry.remarks))
    inputs[digest(text)] = text
    loss_reason = ""
    try:
        Program.compile(text)
    except ProgramError as error:
        diagnostic = error.first
        loss_reason = f"line {diagnostic.line}: {diagnostic.message}"
    return TournamentPlayer(name, digest(text), loss_reason)


def _with_round(manifest: Manifest, pairs: Sequence[tuple[int, int]]) -> Manifest:
    players, cells = manifest.players, list(manifest.cells)
    for pair in pairs:
        opponents = [players[index] for index in pair]
        if any(player.lost for player in opponents):
            continue
        # Between equal seats players change them from start to start; programs decide who begins.
        opponents.sort(key=lambda player: player.program)
        for shift in (0, 1):
            lineup = [opponents[(seat + shift) % 2] for seat in range(len(manifest.teams))]
            names = (player.name for player in lineup)
            cells.append(
                msgspec.structs.replace(
                    manifest.match,
                    program_name=f"{lineup[0].name} against {lineup[1].name}",
                    settings=dict(zip(manifest.teams, names, strict=True)),
                    parts=tuple(player.program for player in lineup),
                    parity=None if manifest.match.parity is None else shift,
                )
            )
    rounds = (*manifest.rounds, tuple(pairs))
    return msgspec.structs.replace(manifest, cells=tuple(cells), rounds=rounds)


def next_round(manifest: Manifest, ledger: Ledger) -> Manifest | None:
    """Return the manifest with the next round; None if there is no other round.

    All matches of the manifest must have been played.
    """
    if len(manifest.rounds) >= manifest.most_rounds:
        return None
    ranking = ranking_of(RunRecords(manifest, ledger), resamples=1)
    shares = {standing.player: standing.share for standing in ranking.standings}
    pairs = pair_off(manifest, shares)
    return None if pairs is None else _with_round(manifest, pairs)


def pair_off(manifest: Manifest, shares: Mapping[str, float]) -> tuple[tuple[int, int], ...] | None:
    """Return the next round's pairs, neighbours by standing that have not met, or None.

    If the number is odd, the last player that has always played sits out. Programs break ties,
    not names. `shares` are average shares by name; none in the first round.
    """
    players = manifest.players

    def standing(index: int) -> tuple[float, str, str]:
        player = players[index]
        return -shares.get(player.name, 0.5), player.program, player.name

    matches = {frozenset(pair) for pairs in manifest.rounds for pair in pairs}
    order = sorted(range(len(players)), key=standing)
    trials = iter(range(_MOST_TRIALS))
    if len(order) % 2 == 0:
        return _pair(order, matches, trials)
    for index in reversed(order):
        if all(any(index in pair for pair in pairs) for pairs in manifest.rounds):
            pairs = _pair([i for i in order if i != index], matches, trials)
            if pairs is not None:
                return pairs
    return None


def _pair(
    order: list[int], matches: set[frozenset[int]], trials: Iterator[int]
) -> tuple[tuple[int, int], ...] | None:
    """Pair each with the next one it has not met; None if no such pairing turns up in `trials`."""
    if not order:
        return ()
    first, *opponents = order
    for opponent in opponents:
        if next(trials, None) is None:
            return None
        if frozenset((first, opponent)) not in matches:
            other_pairs = _pair([i for i in opponents if i != opponent], matches, trials)
            if other_pairs is not None:
                return (min(first, opponent), max(first, opponent)), *other_pairs
    return None


_MOST_TRIALS = 100_000
"""Of an opponent, as there may be exponentially many where nearly all have met."""
