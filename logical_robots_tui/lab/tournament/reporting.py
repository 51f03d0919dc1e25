"""What came out of a tournament: ranking, matrix and cycles for a terminal, a page and CSV."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from logical_robots_tui.lab.exporting import (
    Done,
    Table,
    as_code,
    as_table,
    csv_of,
    harmless_text,
    shade,
)
from logical_robots_tui.lab.folder import Folder, Manifest
from logical_robots_tui.lab.ledger import Ledger
from logical_robots_tui.lab.tournament.ranking import Ranking, ranking_of

_WIDEST = 30  # players of a matrix in a terminal
_MOST_CYCLES = 20
_DIGITS = 4
_HEAD = ("rank", "player", "share", "95 % interval", "strength", "opponents", "remark")


def _rows(manifest: Manifest, ranking: Ranking) -> list[tuple[str, ...]]:
    lost = {player.name: player.lost for player in manifest.players}
    return [
        (
            each.rank,
            harmless_text(each.player),
            f"{100 * each.share:.1f} %",
            f"{100 * each.low:.1f} to {100 * each.high:.1f} %",
            f"{each.strength:+.0f}",
            str(each.pairings),
            "does not play: " + harmless_text(lost[each.player]) if lost[each.player] else "",
        )
        for each in ranking.standings
    ]


def tournament_lines(manifest: Manifest, ledger: Ledger) -> list[str]:
    ranking = ranking_of(manifest, ledger)
    lines = _align([_HEAD, *_rows(manifest, ranking)], left=(1, len(_HEAD) - 1))
    names = [each.player for each in ranking.standings]
    if len(names) <= _WIDEST:
        numbers = [str(n) for n in range(1, len(names) + 1)]
        rows = [("%", "", *numbers)]
        for number, name in zip(numbers, names, strict=True):
            pairings = (ranking.pairings.get((name, other)) for other in names)
            cells = ("·" if each is None else f"{100 * each.share:.0f}" for each in pairings)
            rows.append((number, harmless_text(name), *cells))
        lines += ["", "The row's share of the points against the column:", *_align(rows, left=(1,))]
    for cycle in ranking.cycles[:_MOST_CYCLES]:
        lines.append(_cycle_text(cycle))
    if (more := len(ranking.cycles) - _MOST_CYCLES) > 0:
        lines.append(f"and {more:,} more cycles")
    return lines


def _cycle_text(cycle: Sequence[str]) -> str:
    return "Cycle: " + " beats ".join(harmless_text(name) for name in (*cycle, cycle[0]))


def _align(rows: Sequence[Sequence[str]], left: Sequence[int]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if n in left else cell.rjust(width)
            for n, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def tournament_parts(manifest: Manifest, ledger: Ledger, done: Sequence[Done]) -> list[str]:
    ranking = ranking_of(manifest, ledger)
    names = [each.player for each in ranking.standings]
    parts = ["<h2>Ranking</h2>" + as_table(_HEAD, _rows(manifest, ranking))]
    rows: list[Sequence[Any]] = []
    for name in names:
        cells = [ranking.pairings.get((name, other)) for other in names]
        rows.append((name, *(p and shade(p.share, f"{100 * p.share:.0f}") for p in cells)))
    said = "<p>The row's share of the points against the column, in percent.</p>"
    parts.append("<h2>Pairs</h2>" + said + as_table(("", *names), rows))
    if ranking.cycles:
        rows = [(_cycle_text(cycle).partition(" ")[2],) for cycle in ranking.cycles]
        parts.append(f"<h2>Cycles</h2>{as_table(('each beats the next beyond doubt',), rows)}")
    rows = []
    for each in done:
        if each.start == 0:
            at = each.cell.settings
            points = ", ".join(f"{at[t]} ({t}) {n:,g}" for t, n in each.result.points.items())
            rows.append((each.cell.program_name, points, as_code(each.replay)))
    said = (
        "<p>Each from the given start; runs.csv has all. The commands are typed in this folder; "
        "replay record instead of play keeps a match in a file.</p>"
    )
    parts.append("<h2>Matches</h2>" + said + as_table(("match", "points", "to see it"), rows))
    return parts


def export_tournament(folder: Folder, manifest: Manifest, ledger: Ledger) -> list[str]:
    """Write ranking and pairs as CSV; return the names of the files, or raise InputError."""
    ranking = ranking_of(manifest, ledger)
    lost = {player.name: player.lost for player in manifest.players}
    names = [each.player for each in ranking.standings]
    standings = [
        (
            each.player,
            each.best,
            each.worst,
            *(round(n, _DIGITS) for n in (each.share, each.low, each.high)),
            round(each.strength, 1),
            each.pairings,
            lost[each.player],
        )
        for each in ranking.standings
    ]
    head = ("player", "best_rank", "worst_rank", "share", "low", "high", "strength", "opponents")
    pairs = [
        (name, other, *(round(n, _DIGITS) for n in ranking.pairings[name, other]))
        for name in names
        for other in names
        if (name, other) in ranking.pairings
    ]
    tables = {
        "ranking": Table((*head, "remark"), list(standings)),
        "pairs": Table(("player", "opponent", "share", "low", "high"), list(pairs)),
        "cycles": Table(("beats_second", "beats_third", "beats_first"), list(ranking.cycles)),
    }
    for name, table in tables.items():
        folder.put(folder.path / f"{name}.csv", csv_of(table))
    return [f"{name}.csv" for name in tables]
