"""The report: one HTML page without scripts or links, with plots as SVG."""

from __future__ import annotations

import html
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from statistics import NormalDist, fmean, median, quantiles
from typing import Any, NamedTuple, TypeAlias, TypeVar

from logical_robots_tui.errors import check_installed
from logical_robots_tui.lab.classroom import (
    class_parts,
    fault_lines,
    play_command,
    similar_table,
)
from logical_robots_tui.lab.exporting import (
    SPREADSHEET_MARK,
    ResultTable,
    RunRecord,
    RunRecords,
    as_code,
    as_page,
    as_percent,
    export_runs,
    harmless_text,
    measures_of,
    new_chart,
    settings_of,
    shade,
    svg_of,
    table_section,
    tables_of_runs,
    write_tables,
)
from logical_robots_tui.lab.feedback import Draw, export_grades, gradebook
from logical_robots_tui.lab.folder import Cell, Folder, Manifest
from logical_robots_tui.lab.grading import grades_of
from logical_robots_tui.lab.ranking import tournament_lines, tournament_parts, tournament_tables

K = TypeVar("K")

_WIDTH, _HEIGHT = 78, 18
_MOST_BARS = 40
_MOST_VALUES = 20  # of what was varied, before they are taken together
_PARTS = 10
_MOST_LINES = 6  # of a plot
_MOST_BANDS = 3
_MOST_POINTS = 100  # of a line


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


def share_of(runs: Iterable[RunRecord]) -> Share:
    """Return the share of runs won, with its 95% interval (Wilson's score interval)."""
    results = [run.result for run in runs]
    ticks = [result.ticks for result in results if result.outcome == "won"]
    won, total = len(ticks), len(results)
    if not total:
        return Share(0, 0, 0.0, 1.0, None)
    z = NormalDist().inv_cdf(0.975)
    share, z2 = won / total, z * z / total
    middle = (share + z2 / 2) / (1 + z2)
    half = z / (1 + z2) * math.sqrt(share * (1 - share) / total + z2 / total / 4)
    low = 0.0 if not won else middle - half
    high = 1.0 if won == total else middle + half
    return Share(won, total, low, high, median(ticks) if ticks else None)


def _group(runs: Iterable[RunRecord], key: Callable[[RunRecord], K]) -> dict[K, list[RunRecord]]:
    groups: dict[K, list[RunRecord]] = {}
    for run in runs:
        groups.setdefault(key(run), []).append(run)
    return groups


def setting_text(cell: Cell) -> str:
    """Return what was varied in a cell, such as ``Near = 40, Far = 90``."""
    return ", ".join(f"{name} = {value}" for name, value in cell.settings.items())


def lines_of(records: RunRecords) -> list[str]:
    """Return a short report with text plots; raises InputError without the library."""
    manifest, runs = records.manifest, records.finished
    if manifest.kind == "tournament":
        return tournament_lines(records)
    check_installed("plotext", "A report")
    if manifest.kind == "grade":
        grades = grades_of(records)
        points = [grade.points for grade in grades if grade.points is not None]
        ungraded = [f"{g.student.label}: {g.points_text}" for g in grades if g.points is None]
        given_runs = (run for run in runs if not run.start)
        groups = _group(given_runs, lambda run: run.cell.level_name)
        winners = {level: share_of(level_runs).won for level, level_runs in groups.items()}
        lines = _bars("Students who win from the given start", winners)
        counts = Counter(math.floor(point) for point in points)
        lines += _bars("Students by points", {str(n): counts[n] for n in sorted(counts)})
        return lines + ungraded + fault_lines(records, _WIDTH)
    return _sweep_lines(manifest, runs)


def _sweep_lines(manifest: Manifest, all_runs: list[RunRecord]) -> list[str]:
    cells = _by_label(manifest, all_runs)
    groupings = {"": cells}
    if len(cells) > _MOST_BARS:
        groupings = {f", over {name}": _by_value(name, all_runs) for name in _axes(manifest)}
    lines = []
    for suffix, groups in groupings.items():
        shares = {label: share_of(runs).share for label, runs in groups.items()}
        lines += _bars(f"Starts won{suffix}", shares)
        spreads = {label: _spreads(manifest, runs) for label, runs in groups.items()}
        for name in _spreads(manifest, []):
            medians = {
                label: spread[0]
                for label, by_measure in spreads.items()
                if (spread := by_measure[name])
            }
            if len({*medians.values()}) > 1:
                lines += _bars(f"{name}, medians{suffix}", medians)
    for name, (ticks, curves) in _over_time(manifest, all_runs).items():
        lines += _plot(name, ticks, curves)
    return lines


def _bars(title: str, values: Mapping[str, float]) -> list[str]:
    import plotext

    if not values:
        return []
    plotext.clear_figure()
    plotext.simple_bar(list(values), list(values.values()), width=_WIDTH, title=title)
    is_count = all(isinstance(value, int) for value in values.values())
    return [line.removesuffix(".00") if is_count else line for line in _plot_lines()]


def _plot_lines() -> list[str]:
    import plotext

    text: str = plotext.uncolorize(plotext.build())
    return text.rstrip().split("\n")


def _plot(title: str, ticks: list[int], lines: Mapping[str, list[Spread | None]]) -> list[str]:
    import plotext

    plotext.clear_figure()
    plotext.plot_size(_WIDTH, _HEIGHT)
    for label, spreads in lines.items():
        points = [(tick, s[0]) for tick, s in zip(ticks, spreads, strict=True) if s]
        if points:
            plotext.plot(*zip(*points, strict=True), label=label)
    plotext.title(f"{title} by tick, medians")
    return _plot_lines()


_BARS = 20


def write_report(folder: Folder, records: RunRecords) -> str:
    """Write the report; return its path, or raise InputError, also for a missing library."""
    manifest, runs = records.manifest, records.finished
    if manifest.kind == "tournament":
        parts = [*tournament_parts(records), _failures(records)]
    else:
        check_installed("pygal", "A report")
        if manifest.kind == "grade":
            main = [*class_parts(folder, records), _overview(runs), _ticks(runs)]
        else:
            main = [_overview(runs), _variation(manifest, runs), _ticks(runs)]
            main.append(_failures(records))
        parts = [*main, _cells(folder, manifest, runs)]
    file = folder.path / "report.html"
    folder.put(file, as_page(manifest.title, parts))
    return str(file)


def export(folder: Folder, records: RunRecords, draw: Draw | None = None) -> list[str]:
    """Write all tables; return the names of what was written, or raise InputError.

    Feedback has pictures of what was not won, if there is something that draws them.
    """
    manifest, file_names = records.manifest, export_runs(folder, records)
    if manifest.kind == "grade":
        file_names += export_grades(folder, records, draw)
        file_names += write_tables(
            folder, {"similar": similar_table(folder, manifest)}, SPREADSHEET_MARK
        )
    elif manifest.kind == "tournament":
        file_names += write_tables(folder, tournament_tables(records))
    return file_names


def tables_of(records: RunRecords) -> dict[str, ResultTable]:
    """Return all tables by name, the one of most interest first."""
    runs, kind = tables_of_runs(records), records.manifest.kind
    if kind == "grade":
        return {"gradebook": gradebook(grades_of(records)), **runs}
    return (tournament_tables(records) if kind == "tournament" else {}) | runs


def _interval(share: Share) -> str:
    return f"{as_percent(share.low)} to {as_percent(share.high)}"


def _overview(all_runs: list[RunRecord]) -> str:
    rows: list[Sequence[Any]] = []
    for level, runs in _group(all_runs, lambda run: run.cell.level_name).items():
        cells: list[Any] = [level]
        for is_varied in (False, True):
            share = share_of(run for run in runs if bool(run.start) == is_varied)
            cells += [share.tried, share.won, as_percent(share.share) if share.tried else ""]
            cells.append(_interval(share) if share.tried else "")
        rows.append((*cells, share_of(runs).ticks))
    given_head = ("programs", "won from the given start", "share", "95% interval")
    varied_head = ("varied starts", "won", "share", "95% interval")
    head = ("level", *given_head, *varied_head, "median ticks to win")
    return table_section("Levels", head, rows)


Spread: TypeAlias = tuple[float, float, float]
"""A median and the two quartiles, or a share and its interval."""


def _spread(values: Iterable[float | None]) -> Spread | None:
    numbers = [value for value in values if value is not None]
    if not numbers:
        return None
    low, middle, high = quantiles(numbers, method="inclusive") if len(numbers) > 1 else numbers * 3
    return middle, low, high


def _spreads(manifest: Manifest, runs: list[RunRecord]) -> dict[str, Spread | None]:
    """Return medians and quartiles by measure; for anything but a sweep, of ticks only."""
    measures = measures_of(manifest)
    names = measures.keys() - {"won", "rules"} if manifest.kind == "sweep" else {"ticks"}
    return {
        name: _spread(measure(run.result) for run in runs)
        for name, measure in measures.items()
        if name in names
    }


def _axes(manifest: Manifest) -> list[str]:
    cells = manifest.cells
    names = ["level"] * (len({cell.level_name for cell in cells}) > 1)
    names += ["program"] * (len({cell.program_name for cell in cells}) > 1)
    return [*names, *settings_of(manifest)]


def _value_of(cell: Cell, name: str) -> bool | int | float | str:
    built_in = {"level": cell.level_name, "program": cell.program_name}
    return cell.settings.get(name, built_in.get(name, "as written"))


def _by_value(name: str, all_runs: list[RunRecord]) -> dict[str, list[RunRecord]]:
    """Return runs by the value of what was varied, of many numbers by parts of their range."""
    groups: dict[Any, list[RunRecord]] = _group(all_runs, lambda run: _value_of(run.cell, name))
    numbers = sorted(value for value in groups if type(value) in (int, float))
    texts = {str(value): runs for value, runs in groups.items() if type(value) not in (int, float)}
    if len(numbers) <= _MOST_VALUES:
        return {f"{value:.6g}": groups[value] for value in numbers} | texts
    low, width = numbers[0], (numbers[-1] - numbers[0]) / _PARTS
    parts: dict[str, list[RunRecord]] = {}
    for value in numbers:
        begin = low + min(int((value - low) / width), _PARTS - 1) * width
        parts.setdefault(f"{begin:.4g} to {begin + width:.4g}", []).extend(groups[value])
    return parts | texts


def _by_label(manifest: Manifest, runs: list[RunRecord]) -> dict[str, list[RunRecord]]:
    """Return runs by all that was varied."""
    names = [name for name in _axes(manifest) if name in ("level", "program")]

    def label(run: RunRecord) -> str:
        values = [str(_value_of(run.cell, name)) for name in names]
        return " ".join([*values, setting_text(run.cell)]).strip() or run.cell.program_name

    return _group(runs, label)


def _over_time(
    manifest: Manifest, all_runs: list[RunRecord]
) -> dict[str, tuple[list[int], dict[str, list[Spread | None]]]]:
    """Return the ticks and the numbers of each query that is measured over time."""
    groups = _by_label(manifest, all_runs)
    if len(groups) > _MOST_LINES:
        groups = {"all runs": all_runs}
    curves = {}
    for measure in manifest.asked:
        if not measure.every:
            continue
        numbers = {
            label: [dict(s.numbers) for r in runs if (s := r.result.series.get(measure.name))]
            for label, runs in groups.items()
        }
        last = max((max(s, default=0) for runs in numbers.values() for s in runs), default=0)
        step = measure.every * max(1, -(-last // measure.every // _MOST_POINTS))
        ticks = sorted({1, *range(step, last + 1, step)})
        curves[measure.name] = (
            ticks,
            {
                label: [_spread(s.get(tick) for s in runs) for tick in ticks]
                for label, runs in numbers.items()
            },
        )
    return curves


_INTERVAL = "95%"
_WON = "% of starts won"


def _variation(manifest: Manifest, all_runs: list[RunRecord]) -> str:
    axes = _axes(manifest)
    varied = [name for name in axes if name != "level"]
    panels = _group(all_runs, lambda run: run.cell.level_name) if varied else {"": all_runs}
    parts = []
    for level, runs in panels.items():
        for name in varied or axes:
            title = f"over {name}" + f" in {level}" * (len(panels) > 1)
            parts.append(f"<h2>{html.escape(harmless_text(title.capitalize()))}</h2>")
            parts += _charts(manifest, title, name, runs)
    if len(axes) == 2:
        parts.append(_grid(manifest, axes[0], axes[1], all_runs))
    for name, (ticks, curves) in _over_time(manifest, all_runs).items():
        parts.append(f"<h2>{html.escape(harmless_text(name))} over time</h2>")
        parts.append(_chart(f"{name}, medians", "tick", ticks, curves))
    return "\n".join(parts)


def _charts(manifest: Manifest, title: str, axis: str, all_runs: list[RunRecord]) -> Iterator[str]:
    """Yield a chart of each measure over what was varied, with a line for each program."""
    groups = _by_value(axis, all_runs)
    values = [[_value_of(run.cell, axis) for run in runs] for runs in groups.values()]
    numbers = [[float(v) for v in group if type(v) in (int, float)] for group in values]
    places = [*map(fmean, numbers)] if [*map(len, numbers)] == [*map(len, values)] else [*groups]
    programs = [*_group(all_runs, lambda run: run.cell.program_name)]
    if axis == "program" or not 1 < len(programs) <= _MOST_LINES:
        programs = [""]
    for name in (_WON, *_spreads(manifest, [])):
        curves: dict[str, list[Spread | None]] = {}
        for program in programs:
            curve = curves[program or ("won" if name == _WON else "median")] = []
            for group in groups.values():
                runs = [run for run in group if program in ("", run.cell.program_name)]
                share = share_of(runs)
                won = (100 * share.share, 100 * share.low, 100 * share.high) if runs else None
                curve.append(won if name == _WON else _spreads(manifest, runs)[name])
        if (
            name == _WON
            or len({point for curve in curves.values() for point in curve if point}) > 1
        ):
            band = _INTERVAL if name == _WON else "quartiles"
            yield _chart(f"{name}, {title}", axis, places, curves, band)


def _chart(
    title: str,
    across: str,
    places: Sequence[float] | Sequence[str],
    lines: Mapping[str, Sequence[Spread | None]],
    band: str = "quartiles",
) -> str:
    """Return a chart; with a numeric axis and lines if the places are numbers, else with dots."""
    is_numeric = not any(isinstance(place, str) for place in places)
    kind = "XY" if is_numeric else "Line"
    chart = new_chart(kind, title, x_title=harmless_text(across), stroke=is_numeric)
    chart.range = (0, 100) if band == _INTERVAL else None
    if not is_numeric:
        chart.x_labels = [harmless_text(str(place)) for place in places]
    chart.x_value_formatter = "{:,.6g}".format
    chart.show_dots = not is_numeric or len(places) <= _MOST_VALUES

    def points(spreads: Sequence[Spread | None], index: int) -> list[Any]:
        numbers = [spread and spread[index] for spread in spreads]
        if not is_numeric:
            return numbers
        return [(x, y) for x, y in zip(places, numbers, strict=True) if y is not None]

    for label, spreads in lines.items():
        chart.add(harmless_text(label), points(spreads, 0))
    for label, spreads in lines.items() if len(lines) <= _MOST_BANDS else ():
        for index, bound in ((1, "from"), (2, "to")):
            name = harmless_text(f"{label}, {bound}" * (len(lines) > 1) or bound) + f" ({band})"
            dashes = {"dasharray": "4"}
            chart.add(name, points(spreads, index), stroke_style=dashes, show_dots=not is_numeric)
    return svg_of(chart, title)


def _grid(manifest: Manifest, across: str, down: str, all_runs: list[RunRecord]) -> str:
    columns = _by_value(across, all_runs)
    column_of = {id(run): name for name, runs in columns.items() for run in runs}

    def cell(runs: list[RunRecord]) -> str:
        if not runs:
            return ""
        share = share_of(runs)
        texts = [f"{as_percent(share.share)} ({share.won} of {share.tried}, {_interval(share)})"]
        for name, spread in _spreads(manifest, runs).items():
            texts += [f"{name} {spread[0]:,.6g}"] if spread else []
        return shade(share.share, "; ".join(texts))

    rows = [
        (line, *(cell([run for run in runs if column_of[id(run)] == c]) for c in columns))
        for line, runs in _by_value(down, all_runs).items()
    ]
    head = (f"{down} \\ {across}", *columns)
    return table_section("The grid", head, rows, "Won, and medians of what was measured.")


def _ticks(all_runs: list[RunRecord]) -> str:
    parts = ["<h2>Ticks to win</h2>"]
    for level, runs in _group(all_runs, lambda run: run.cell.level_name).items():
        ticks = sorted(run.result.ticks for run in runs if run.result.outcome == "won")
        if not ticks:
            continue
        width = max(1, -(-(ticks[-1] + 1 - ticks[0]) // _BARS))
        counts = Counter((tick - ticks[0]) // width for tick in ticks)
        chart = new_chart("Bar", level, show_legend=False, x_title="ticks", y_title="runs")
        chart.x_labels = [f"{ticks[0] + n * width:,}" for n in range(max(counts) + 1)]
        chart.y_labels = range(0, max(counts.values()) + 1, max(1, max(counts.values()) // 5))
        chart.add("runs", [counts[n] for n in range(max(counts) + 1)])
        parts.append(svg_of(chart, level))
    return "\n".join(parts) if len(parts) > 1 else ""


def _failures(records: RunRecords) -> str:
    failures = [
        run
        for run in (*records.finished, *records.failed)
        if run.result.outcome not in ("won", "played")
        or (run.result.outcome == "played" and run.result.first)
    ]
    kinds = _group(failures, lambda run: (run.cell.level_name, run.result.outcome, run.reason))
    rows: list[Sequence[Any]] = []
    for (level, outcome, reason), runs in sorted(kinds.items(), key=lambda kind: -len(kind[1])):
        rows.append(
            (level, outcome, reason, len(runs), as_code(records.manifest.command(*runs[0][:2])))
        )
    head = ("level", "how it ended", "why", "runs", "one of them")
    title = "What failed" if records.manifest.kind == "tournament" else "Not won"
    return table_section(title, head, rows) if rows else ""


def _cells(folder: Folder, manifest: Manifest, all_runs: list[RunRecord]) -> str:
    rows: list[Sequence[Any]] = []
    names = {student.id: student.label for student in manifest.students}
    for runs in _group(all_runs, lambda run: id(run.cell)).values():
        cell, share = runs[0].cell, share_of(runs)
        # A run that was lost, from a varied start if there is one, else the given start.
        example = next((r for r in runs[::-1] if r.result.outcome != "won"), runs[0])
        rows.append(
            (
                names.get(cell.student) or setting_text(cell),
                cell.level_name,
                cell.program_name,
                runs[0].result.outcome,
                f"{share.won} of {share.tried}",
                _interval(share),
                *(spread and spread[0] for spread in _spreads(manifest, runs).values()),
                as_code(
                    play_command(folder, manifest, cell, example.start)
                    if names
                    else manifest.command(cell, example.start)
                ),
            )
        )
    medians = [f"median {name}" for name in _spreads(manifest, [])]
    head = ("", "level", "program", "given start", "won", "95% interval", *medians, "replay")
    place = "in this folder;"
    if names:
        place = "where this folder is. In one from runs.csv,"
    intro = (
        f"Run the commands {place} replace <code>play</code> with <code>why</code> to explain a "
    )
    return table_section("Programs in levels", head, rows, f"{intro}tick.")
