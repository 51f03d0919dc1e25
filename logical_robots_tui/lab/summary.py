"""What many runs amount to: shares of starts won with their intervals, and plots for a terminal."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from statistics import NormalDist, median
from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.lab.exporting import Done, check_extra, done_runs

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from logical_robots_tui.lab.folder import Cell, Manifest
    from logical_robots_tui.lab.ledger import Ledger

_WIDTH = 78
_MOST_BARS = 40


class Share(NamedTuple):
    """The share of runs that were won, its interval, and the median of ticks to win, or None."""

    won: int
    tried: int
    low: float
    high: float
    ticks: float | None

    @property
    def share(self) -> float:
        return self.won / self.tried if self.tried else 0.0


def share_of(done: Iterable[Done]) -> Share:
    """Return the share of runs won, with its 95 % interval (Wilson's score interval)."""
    results = [each.result for each in done]
    ticks = [result.ticks for result in results if result.outcome == "won"]
    won, tried = len(ticks), len(results)
    if not tried:
        return Share(0, 0, 0.0, 1.0, None)
    z = NormalDist().inv_cdf(0.975)
    share, z2 = won / tried, z * z / tried
    middle = (share + z2 / 2) / (1 + z2)
    half = z / (1 + z2) * math.sqrt(share * (1 - share) / tried + z2 / tried / 4)
    low = 0.0 if not won else middle - half
    high = 1.0 if won == tried else middle + half
    return Share(won, tried, low, high, median(ticks) if ticks else None)


def by_cell(done: Iterable[Done]) -> list[tuple[Cell, list[Done]]]:
    found: dict[int, tuple[Cell, list[Done]]] = {}
    for each in done:
        found.setdefault(id(each.cell), (each.cell, []))[1].append(each)
    return list(found.values())


def by_level(done: Iterable[Done]) -> dict[str, list[Done]]:
    found: dict[str, list[Done]] = defaultdict(list)
    for each in done:
        found[each.cell.level_name].append(each)
    return dict(found)


def setting_text(cell: Cell) -> str:
    """Return what was varied in a cell, such as ``Near = 40, Far = 90``."""
    return ", ".join(f"{name} = {value}" for name, value in cell.settings.items())


def lines_of(manifest: Manifest, ledger: Ledger) -> list[str]:
    """Return a short report with text plots; raises InputError without the library."""
    if manifest.kind == "tournament":
        from logical_robots_tui.lab.tournament.reporting import tournament_lines

        return tournament_lines(manifest, ledger)
    check_extra("plotext", "a report")
    done = list(done_runs(manifest, ledger))
    if manifest.kind == "grade":
        from logical_robots_tui.lab.grading import grades_of

        points = [grade.points for grade in grades_of(manifest, ledger)]
        given = by_level(each for each in done if not each.start)
        winners = {level: share_of(runs).won for level, runs in given.items()}
        lines = _bars("Students who win from the given start", winners)
        counts = Counter(math.floor(point) for point in points)
        return lines + _bars("Students by points", {str(n): counts[n] for n in sorted(counts)})
    has_levels = len({cell.level_name for cell in manifest.cells}) > 1
    has_programs = len({cell.program_name for cell in manifest.cells}) > 1
    shares = {}
    for cell, runs in by_cell(done)[:_MOST_BARS]:
        names = [cell.level_name] * has_levels + [cell.program_name] * has_programs
        label = " ".join([*names, setting_text(cell) or cell.program_name])
        shares[label] = share_of(runs).share
    return _bars("Starts won", shares)


def _bars(title: str, values: Mapping[str, float]) -> list[str]:
    import plotext

    if not values:
        return []
    plotext.clear_figure()
    plotext.simple_bar(list(values), list(values.values()), width=_WIDTH, title=title)
    text: str = plotext.uncolorize(plotext.build())
    return text.rstrip().split("\n")
