"""Who plays whom: from a file and a folder of players to matches, round after round."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.folder import Cell, Manifest, Player, digest
from logical_robots_tui.lab.specification import Specification, Tournament
from logical_robots_tui.lab.submissions import entries_of, stems_of
from logical_robots_tui.lab.sweeping import level_with_text
from logical_robots_tui.lab.tournament.ranking import ranking_of
from logical_robots_tui.mind import Program, ProgramError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from logical_robots_tui.lab.ledger import Ledger
    from logical_robots_tui.lab.submissions import Submission
    from logical_robots_tui.world import Level

SWISS_FROM = 40
"""The number of players from which on not everybody plays everybody."""

_MORE_ROUNDS = 2  # of a Swiss tournament than are needed to find its winner


def plan_tournament(file: Path, players: Path) -> tuple[Manifest, dict[str, str]]:
    """Return a tournament's first round, and the texts of level and programs by digest.

    `players` holds one program or folder per player. Raises SpecificationError, or InputError
    for fewer than two players.
    """
    spec = Specification(file)
    tournament = spec.read(Tournament)
    table, limits = tournament.tournament, tournament.limits
    level, text = _level(spec, table.level)
    ticks = min(table.ticks or level.match_ticks, level.match_ticks)
    inputs = {digest(text): text}
    named = sorted(entries_of(players, stems_of([level.name])).items())
    if len(named) < 2:
        raise InputError("there are fewer than two players", place=str(players), hint=_HINT)
    entered = [_player(name, entry, level, inputs) for name, entry in named]
    is_swiss = table.format == "swiss" or (not table.format and len(entered) >= SWISS_FROM)
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
        players=tuple(entered),
        teams=tuple(team.name for team in level.teams),
        match=Cell(digest(text), "", level.name, "", ticks),
        most_rounds=_rounds(len(entered)) if is_swiss else 1,
    )
    pairs = tuple(combinations(range(len(entered)), 2))
    if is_swiss:
        pairs = pair_off(manifest, {}) or ()
    return _with_round(manifest, pairs), inputs


_HINT = "Each has a program such as ada.l, or a folder with one that is named like the level."


def _level(spec: Specification, name: str) -> tuple[Level, str]:
    """Return level and text; raises SpecificationError if it is no level for a match."""
    path = ("tournament", "level")
    try:
        level, text = level_with_text(name, spec.folder)
    except InputError as error:
        spec.problem(path, str(error))
    else:
        if len(level.teams) < 2:
            spec.problem(path, f"{level.name} has no teams that could play against each other")
        elif not level.scores:
            spec.problem(path, f"nothing gives points in {level.name}: it has no [[scores]]")
    spec.refuse()
    return level, text


def _player(name: str, entry: Submission, level: Level, inputs: dict[str, str]) -> Player:
    text = next(iter(entry.programs.values()), None)
    if text is None:
        return Player(name, "", "; ".join(entry.remarks))
    inputs[digest(text)] = text
    lost = ""
    try:
        Program.compile(text)
    except ProgramError as error:
        first = error.diagnostics[0]
        lost = f"line {first.line}: {first.message}"
    return Player(name, digest(text), lost)


def _with_round(manifest: Manifest, pairs: Sequence[tuple[int, int]]) -> Manifest:
    """Return the manifest with one more round."""
    players, cells = manifest.players, list(manifest.cells)
    for pair in pairs:
        both = [players[index] for index in pair]
        if any(player.lost for player in both):
            continue
        for seated in _seatings(both, len(manifest.teams)):
            names = (player.name for player in seated)
            cells.append(
                msgspec.structs.replace(
                    manifest.match,
                    program_name=f"{seated[0].name} against {seated[1].name}",
                    settings=dict(zip(manifest.teams, names, strict=True)),
                    parts=tuple(player.program for player in seated),
                )
            )
    rounds = (*manifest.rounds, tuple(pairs))
    return msgspec.structs.replace(manifest, cells=tuple(cells), rounds=rounds)


def _seatings(pair: Sequence[Player], seats: int) -> Iterator[list[Player]]:
    for first in (0, 1):
        yield [pair[(seat + first) % 2] for seat in range(seats)]


def _rounds(players: int) -> int:
    return min(math.ceil(math.log2(players)) + _MORE_ROUNDS, players - 1 + players % 2)


def next_round(manifest: Manifest, ledger: Ledger) -> Manifest | None:
    """Return the manifest with the next round; None if there is no other round.

    All matches of the manifest must have been played.
    """
    if len(manifest.rounds) >= manifest.most_rounds:
        return None
    shares = {s.player: s.share for s in ranking_of(manifest, ledger, resamples=1).standings}
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

    met = {frozenset(pair) for pairs in manifest.rounds for pair in pairs}
    ranked = sorted(range(len(players)), key=standing)
    if len(ranked) % 2 == 0:
        return _paired(ranked, met)
    for index in reversed(ranked):
        rests = any(all(index not in pair for pair in pairs) for pairs in manifest.rounds)
        if not rests and (found := _paired([i for i in ranked if i != index], met)) is not None:
            return found
    return None


def _paired(ranked: list[int], met: set[frozenset[int]]) -> tuple[tuple[int, int], ...] | None:
    """Pair each with the next one it has not met, leaving none over; None if impossible."""
    if not ranked:
        return ()
    first, *others = ranked
    for other in others:
        if frozenset((first, other)) not in met:
            rest = _paired([index for index in others if index != other], met)
            if rest is not None:
                return (min(first, other), max(first, other)), *rest
    return None
