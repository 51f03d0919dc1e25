"""The report: one HTML page without scripts or links, with plots as SVG."""

from __future__ import annotations

import html
import math
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from statistics import NormalDist, median, quantiles
from typing import Any, NamedTuple, TypeAlias

from logical_robots_tui.lab.classroom import (
    class_parts,
    export_similar,
    fault_lines,
    play_command,
)
from logical_robots_tui.lab.competing import (
    export_tournament,
    tournament_lines,
    tournament_parts,
    tournament_tables,
)
from logical_robots_tui.lab.exporting import (
    Done,
    Table,
    as_code,
    as_page,
    as_percent,
    as_table,
    check_extra,
    done_runs,
    export_runs,
    failed_runs,
    harmless_text,
    measures_of,
    settings_of,
    shade,
    tables_of_runs,
)
from logical_robots_tui.lab.folder import Cell, Folder, Ledger, Manifest, digest
from logical_robots_tui.lab.grading import Draw, export_grades, gradebook, grades_of

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


def share_of(done: Iterable[Done]) -> Share:
    """Return the share of runs won, with its 95% interval (Wilson's score interval)."""
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
        return tournament_lines(manifest, ledger)
    check_extra("plotext", "A report")
    done = list(done_runs(manifest, ledger))
    if manifest.kind == "grade":
        grades = grades_of(manifest, ledger)
        points = [grade.points for grade in grades if grade.points is not None]
        left = [f"{each.student.called}: {each.said}" for each in grades if each.points is None]
        given = by_level(each for each in done if not each.start)
        winners = {level: share_of(runs).won for level, runs in given.items()}
        lines = _bars("Students who win from the given start", winners)
        counts = Counter(math.floor(point) for point in points)
        lines += _bars("Students by points", {str(n): counts[n] for n in sorted(counts)})
        return lines + left + fault_lines(manifest, ledger, _WIDTH)
    return _sweep_lines(manifest, done)


def _sweep_lines(manifest: Manifest, done: list[Done]) -> list[str]:
    cells = _by_label(manifest, done)
    ways = {"": cells}
    if len(cells) > _MOST_BARS:
        ways = {f", over {name}": _by_value(name, done) for name in _varied(manifest)}
    lines = []
    for over, groups in ways.items():
        shares = {label: share_of(runs).share for label, runs in groups.items()}
        lines += _bars(f"Starts won{over}", shares)
        for name, measure in measures_of(manifest).items():
            spreads = {label: _spread(map(measure, runs)) for label, runs in groups.items()}
            medians = {label: spread[0] for label, spread in spreads.items() if spread}
            if len({*medians.values()}) > 1:
                lines += _bars(f"{name}, medians{over}", medians)
    for name, (ticks, found) in _over_time(manifest, done).items():
        lines += _plot(name, ticks, found)
    return lines


def _bars(title: str, values: Mapping[str, float]) -> list[str]:
    import plotext

    if not values:
        return []
    plotext.clear_figure()
    plotext.simple_bar(list(values), list(values.values()), width=_WIDTH, title=title)
    is_count = all(isinstance(value, int) for value in values.values())
    return [line.removesuffix(".00") if is_count else line for line in _built()]


def _built() -> list[str]:
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
    return _built()


_BARS = 20


def write_report(folder: Folder, manifest: Manifest, ledger: Ledger) -> str:
    """Write the report; return its path, or raise InputError, also for a missing library."""
    done = list(done_runs(manifest, ledger))
    if manifest.kind == "tournament":
        parts = [*tournament_parts(manifest, ledger, done), _failures(manifest, ledger, done)]
    else:
        check_extra("pygal", "A report")
        if manifest.kind == "grade":
            main = [*class_parts(folder, manifest, ledger), _overview(done), _ticks(done)]
        else:
            main = [_overview(done), _variation(manifest, done), _ticks(done)]
            main.append(_failures(manifest, ledger, done))
        parts = [*main, _cells(folder, manifest, done)]
    file = folder.path / "report.html"
    folder.put(file, as_page(manifest.title, parts))
    return str(file)


def export(
    folder: Folder, manifest: Manifest, ledger: Ledger, draw: Draw | None = None
) -> list[str]:
    """Write all tables; return the names of what was written, or raise InputError.

    Feedback has pictures of what was not won, if there is something that draws them.
    """
    written = export_runs(folder, manifest, ledger)
    if manifest.kind == "grade":
        written += export_grades(folder, manifest, ledger, draw)
        written += export_similar(folder, manifest)
    elif manifest.kind == "tournament":
        written += export_tournament(folder, manifest, ledger)
    return written


def tables_of(manifest: Manifest, ledger: Ledger) -> dict[str, Table]:
    """Return all tables by name, the one of most interest first."""
    runs = tables_of_runs(manifest, ledger)
    if manifest.kind == "grade":
        return {"gradebook": gradebook(grades_of(manifest, ledger)), **runs}
    return (tournament_tables(manifest, ledger) if manifest.kind == "tournament" else {}) | runs


def _interval(share: Share) -> str:
    return f"{as_percent(share.low)} to {as_percent(share.high)}"


def _overview(done: list[Done]) -> str:
    rows: list[Sequence[Any]] = []
    for level, runs in by_level(done).items():
        cells: list[Any] = [level]
        for wanted in (False, True):
            share = share_of(run for run in runs if bool(run.start) == wanted)
            cells += [share.tried, share.won, as_percent(share.share) if share.tried else ""]
            cells.append(_interval(share) if share.tried else "")
        rows.append((*cells, share_of(runs).ticks))
    given = ("programs", "won from the given start", "share", "95% interval")
    varied = ("varied starts", "won", "share", "95% interval")
    head = ("level", *given, *varied, "median ticks to win")
    return "<h2>Levels</h2>" + as_table(head, rows)


Spread: TypeAlias = tuple[float, float, float]
"""A median and the two quartiles, or a share and its interval."""


def _spread(values: Iterable[float | None]) -> Spread | None:
    found = [value for value in values if value is not None]
    if not found:
        return None
    low, middle, high = quantiles(found, method="inclusive") if len(found) > 1 else found * 3
    return middle, low, high


def _share(runs: list[Done]) -> Spread:
    share = share_of(runs)
    return 100 * share.share, 100 * share.low, 100 * share.high


def _varied(manifest: Manifest) -> list[str]:
    cells = manifest.cells
    names = ["level"] * (len({cell.level_name for cell in cells}) > 1)
    names += ["program"] * (len({cell.program_name for cell in cells}) > 1)
    return [*names, *settings_of(manifest)]


def _value_of(cell: Cell, name: str) -> bool | int | float | str:
    own = {"level": cell.level_name, "program": cell.program_name}
    return cell.settings.get(name, own.get(name, "as written"))


def _by_value(name: str, done: list[Done]) -> dict[str, list[Done]]:
    """Return runs by the value of what was varied, of many numbers by parts of their range."""
    found: dict[Any, list[Done]] = {}
    for each in done:
        found.setdefault(_value_of(each.cell, name), []).append(each)
    numbers = sorted(value for value in found if type(value) in (int, float))
    others = {str(value): runs for value, runs in found.items() if type(value) not in (int, float)}
    if len(numbers) <= _MOST_VALUES:
        return {f"{value:.6g}": found[value] for value in numbers} | others
    low, width = numbers[0], (numbers[-1] - numbers[0]) / _PARTS
    parts: dict[str, list[Done]] = {}
    for value in numbers:
        begin = low + min(int((value - low) / width), _PARTS - 1) * width
        parts.setdefault(f"{begin:.4g} to {begin + width:.4g}", []).extend(found[value])
    return parts | others


def _by_label(manifest: Manifest, done: list[Done]) -> dict[str, list[Done]]:
    """Return runs by all that was varied."""
    names = _varied(manifest)
    found: dict[str, list[Done]] = {}
    for each in done:
        own = [_value_of(each.cell, name) for name in names if name in ("level", "program")]
        label = " ".join(map(str, [*own, setting_text(each.cell)])).strip()
        found.setdefault(label or each.cell.program_name, []).append(each)
    return found


def _over_time(
    manifest: Manifest, done: list[Done]
) -> dict[str, tuple[list[int], dict[str, list[Spread | None]]]]:
    """Return, for each question that is asked over time, ticks and what it gave at them."""
    groups = _by_label(manifest, done)
    if len(groups) > _MOST_LINES:
        groups = {"all runs": done}
    found = {}
    for asked in manifest.asked:
        if not asked.every:
            continue
        numbers = {
            label: [dict(s.numbers) for r in runs if (s := r.result.series.get(asked.name))]
            for label, runs in groups.items()
        }
        last = max((max(each, default=0) for runs in numbers.values() for each in runs), default=0)
        step = asked.every * max(1, -(-last // asked.every // _MOST_POINTS))
        ticks = sorted({1, *range(step, last + 1, step)})
        found[asked.name] = (
            ticks,
            {
                label: [_spread(each.get(tick) for each in runs) for tick in ticks]
                for label, runs in numbers.items()
            },
        )
    return found


_INTERVAL = "95%"


def _variation(manifest: Manifest, done: list[Done]) -> str:
    names = _varied(manifest)
    parts = []
    for name in names:
        groups = _by_value(name, done)
        parts.append(f"<h2>Over {html.escape(harmless_text(name))}</h2>")
        won = {"won": [_share(runs) for runs in groups.values()]}
        parts.append(_chart(f"% of starts won, over {name}", name, [*groups], won, _INTERVAL))
        for what, measure in measures_of(manifest).items():
            spreads = [_spread(map(measure, runs)) for runs in groups.values()]
            if len({spread for spread in spreads if spread}) > 1:
                parts.append(_chart(f"{what}, over {name}", name, [*groups], {"median": spreads}))
    if len(names) == 2:
        parts.append(_grid(manifest, names[0], names[1], done))
    for name, (ticks, found) in _over_time(manifest, done).items():
        parts.append(f"<h2>{html.escape(harmless_text(name))} over time</h2>")
        parts.append(_chart(f"{name}, medians", "tick", [f"{t:,}" for t in ticks], found))
    return "\n".join(parts)


def _chart(
    title: str,
    across: str,
    labels: list[str],
    lines: Mapping[str, Sequence[Spread | None]],
    band: str = "quartiles",
) -> str:
    chart = _pygal().Line(**_style(title), x_title=harmless_text(across))
    chart.range = (0, 100) if band == _INTERVAL else None
    chart.x_labels = [harmless_text(label) for label in labels]
    if len(labels) > _MOST_VALUES:
        chart.x_labels_major_count = _PARTS
        chart.show_minor_x_labels = chart.show_dots = False
    for label, spreads in lines.items():
        chart.add(harmless_text(label), [spread and spread[0] for spread in spreads])
    for label, spreads in lines.items() if len(lines) <= _MOST_BANDS else ():
        for which, said in ((1, "from"), (2, "to")):
            called = harmless_text(f"{label}, {said}" * (len(lines) > 1) or said) + f" ({band})"
            values = [spread and spread[which] for spread in spreads]
            chart.add(called, values, stroke_style={"dasharray": "4"}, show_dots=False)
    return _svg(chart, title)


def _grid(manifest: Manifest, across: str, down: str, done: list[Done]) -> str:
    columns, measures = _by_value(across, done), measures_of(manifest)
    column_of = {id(each): name for name, runs in columns.items() for each in runs}

    def cell(runs: list[Done]) -> str:
        if not runs:
            return ""
        share = share_of(runs)
        said = [f"{as_percent(share.share)} ({share.won} of {share.tried}, {_interval(share)})"]
        spreads = {name: _spread(map(measure, runs)) for name, measure in measures.items()}
        said += [f"{name} {spread[0]:,.6g}" for name, spread in spreads.items() if spread]
        return shade(share.share, "; ".join(said))

    rows = [
        (line, *(cell([each for each in runs if column_of[id(each)] == c]) for c in columns))
        for line, runs in _by_value(down, done).items()
    ]
    said = "<h2>The grid</h2><p>Won, and medians of what was measured.</p>"
    return said + as_table((f"{down} \\ {across}", *columns), rows)


def _ticks(done: list[Done]) -> str:
    parts = ["<h2>Ticks to win</h2>"]
    for level, runs in by_level(done).items():
        ticks = sorted(each.result.ticks for each in runs if each.result.outcome == "won")
        if not ticks:
            continue
        width = max(1, -(-(ticks[-1] + 1 - ticks[0]) // _BARS))
        counts = Counter((tick - ticks[0]) // width for tick in ticks)
        chart = _pygal().Bar(**_style(level), show_legend=False, x_title="ticks", y_title="runs")
        chart.x_labels = [f"{ticks[0] + n * width:,}" for n in range(max(counts) + 1)]
        chart.y_labels = range(0, max(counts.values()) + 1, max(1, max(counts.values()) // 5))
        chart.add("runs", [counts[n] for n in range(max(counts) + 1)])
        parts.append(_svg(chart, level))
    return "\n".join(parts) if len(parts) > 1 else ""


def _failures(manifest: Manifest, ledger: Ledger, done: list[Done]) -> str:
    kinds: dict[tuple[str, str, str], list[Done]] = {}
    for each in done:
        result = each.result
        if result.outcome == "won" or (result.outcome == "played" and not result.first):
            continue
        why = (
            result.mistakes[0].message
            if result.mistakes
            else result.first[2]
            if result.first
            else ""
        )
        kinds.setdefault((each.cell.level_name, result.outcome, why), []).append(each)
    for each in failed_runs(manifest, ledger):
        why = each.result.first[2] if each.result.first else ""
        kinds.setdefault((each.cell.level_name, each.result.outcome, why), []).append(each)
    rows: list[Sequence[Any]] = []
    for (level, outcome, why), runs in sorted(kinds.items(), key=lambda kind: -len(kind[1])):
        rows.append((level, outcome, why, len(runs), as_code(manifest.command(*runs[0][:2]))))
    head = ("level", "how it ended", "why", "runs", "one of them")
    title = "What failed" if manifest.kind == "tournament" else "Not won"
    return f"<h2>{title}</h2>" + as_table(head, rows) if rows else ""


_EXPLAIN = "replace <code>play</code> with <code>why</code> to explain a tick."


def _cells(folder: Folder, manifest: Manifest, done: list[Done]) -> str:
    rows: list[Sequence[Any]] = []
    names = {student.id: student.called for student in manifest.students}
    measures = measures_of(manifest)
    if manifest.kind != "sweep":
        measures = {"ticks": measures["ticks"]}
    for cell, runs in by_cell(done):
        share = share_of(runs)
        # A run that was lost, from a varied start if there is one, else the given start.
        shown = next((r for r in runs[::-1] if r.result.outcome != "won"), runs[0])
        rows.append(
            (
                names.get(cell.student) or setting_text(cell),
                cell.level_name,
                cell.program_name,
                runs[0].result.outcome,
                f"{share.won} of {share.tried}",
                _interval(share),
                *((spread := _spread(map(each, runs))) and spread[0] for each in measures.values()),
                as_code(
                    play_command(folder, manifest, cell, shown.start)
                    if names
                    else manifest.command(cell, shown.start)
                ),
            )
        )
    medians = [f"median {name}" for name in measures]
    head = ("", "level", "program", "given start", "won", "95% interval", *medians, "replay")
    said = f"Run the commands in this folder; {_EXPLAIN}"
    if names:
        said = "Run the commands where this folder is. In one from runs.csv, "
        said += _EXPLAIN
    return f"<h2>Programs in levels</h2><p>{said}</p>" + as_table(head, rows)


def _pygal() -> Any:
    """Return the library for plots, without its importer, which makes Python 3.11 warn."""
    import pygal

    sys.meta_path[:] = [each for each in sys.meta_path if hasattr(each, "find_spec")]
    return pygal


def _style(title: str) -> dict[str, Any]:
    return {
        "title": harmless_text(title),
        "js": [],
        "disable_xml_declaration": True,
        "height": 400,
        "explicit_size": True,
        "x_label_rotation": 30,
        "legend_at_bottom": True,
        "truncate_legend": -1,
    }


def _svg(chart: Any, title: str) -> str:
    """Return a chart as SVG that is identical each time."""
    text: str = chart.render(is_unicode=True)
    text = re.sub(r"<!--.*?-->|<script.*?</script>", "", text, flags=re.DOTALL)
    return text.replace(chart.uuid, f"plot-{digest(title)[:12]}")
