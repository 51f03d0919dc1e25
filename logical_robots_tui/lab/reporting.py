"""The report: one HTML page without scripts or links, with plots as SVG."""

from __future__ import annotations

import html
import math
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from statistics import NormalDist, median
from typing import Any, NamedTuple

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
    shade,
    tables_of_runs,
)
from logical_robots_tui.lab.folder import Cell, Folder, Ledger, Manifest, digest
from logical_robots_tui.lab.grading import duplicates, export_grades, gradebook, grades_of
from logical_robots_tui.lab.submissions import account_of
from logical_robots_tui.lab.tournament import (
    export_tournament,
    tournament_lines,
    tournament_parts,
    tournament_tables,
)

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
        return tournament_lines(manifest, ledger)
    check_extra("plotext", "a report")
    done = list(done_runs(manifest, ledger))
    if manifest.kind == "grade":
        grades = grades_of(manifest, ledger)
        points = [grade.points for grade in grades if grade.points is not None]
        left = [f"{each.student.called}: {each.said}" for each in grades if each.points is None]
        given = by_level(each for each in done if not each.start)
        winners = {level: share_of(runs).won for level, runs in given.items()}
        lines = _bars("Students who win from the given start", winners)
        counts = Counter(math.floor(point) for point in points)
        return (
            lines + _bars("Students by points", {str(n): counts[n] for n in sorted(counts)}) + left
        )
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


_BARS = 20


def write_report(folder: Folder, manifest: Manifest, ledger: Ledger) -> str:
    """Write the report; return its path, or raise InputError, also for a missing library."""
    done = list(done_runs(manifest, ledger))
    failures = _failures(manifest, ledger, done)
    if manifest.kind == "tournament":
        parts = [*tournament_parts(manifest, ledger, done), failures]
    else:
        check_extra("pygal", "a report")
        is_grade = manifest.kind == "grade"
        main = _grades(manifest, ledger) if is_grade else _variation(manifest, done)
        parts = [_overview(done), main, _ticks(done), failures, _cells(manifest, done)]
    file = folder.path / "report.html"
    folder.put(file, as_page(manifest.title, parts))
    return str(file)


def export(folder: Folder, manifest: Manifest, ledger: Ledger) -> list[str]:
    """Write all tables; return the names of what was written, or raise InputError."""
    written = export_runs(folder, manifest, ledger)
    if manifest.kind == "grade":
        written += export_grades(folder, manifest, ledger)
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
    given = ("programs", "won from the given start", "share", "95 % interval")
    shifted = ("shifted starts", "won", "share", "95 % interval")
    head = ("level", *given, *shifted, "median ticks to win")
    return "<h2>Levels</h2>" + as_table(head, rows)


def _grades(manifest: Manifest, ledger: Ledger) -> str:
    grades = grades_of(manifest, ledger)
    levels = [level.level for level in grades[0].levels] if grades else []
    rows = [
        (
            grade.student.id,
            grade.student.name,
            grade.said if grade.points is None else grade.points,
            grade.most,
            grade.student.lateness,
            *("not graded yet" if level.points is None else level.points for level in grade.levels),
            "; ".join(grade.remarks),
        )
        for grade in grades
    ]
    head = ("id", "name", "points", "most", "late", *levels, "remarks")
    same = [(level, ", ".join(ids)) for level, _, ids in duplicates(manifest)]
    text = "<h2>Submissions</h2>"
    text += "".join(f"<p>{html.escape(harmless_text(line))}</p>" for line in account_of(manifest))
    text += "<h2>Students</h2>" + as_table(head, rows)
    if same:
        text += "<h2>The same program</h2><p>The same but for comments and space.</p>"
        text += as_table(("level", "students"), same)
    return text


def _variation(manifest: Manifest, done: list[Done]) -> str:
    cells = by_cell(done)
    names = list(dict.fromkeys(name for cell in manifest.cells for name in cell.settings))
    full = [(cell, runs) for cell, runs in cells if len(cell.settings) == len(names)]
    groups: dict[str, list[tuple[Cell, list[Done]]]] = {}
    for cell, runs in full:
        groups.setdefault(f"{cell.program_name} in {cell.level_name}", []).append((cell, runs))
    parts = [f"<h2>Share of starts won, over {html.escape(' and '.join(names))}</h2>"]
    for title, group in groups.items():
        if len(names) == 1:
            parts.append(_curve(title, names[0], group))
        elif len(names) == 2:
            parts.append(f"<h3>{html.escape(harmless_text(title))}</h3>")
            parts.append(_heat_map(names[0], names[1], group))
    return "\n".join(parts) if names and len(parts) > 1 else ""


def _curve(title: str, name: str, group: list[tuple[Cell, list[Done]]]) -> str:
    chart = _pygal().Line(**_style(title), range=(0, 100), x_title=name, y_title="% won")
    chart.x_labels = [str(cell.settings[name]) for cell, _ in group]
    shares = [share_of(runs) for _, runs in group]
    chart.add("won", [100 * share.share for share in shares])
    for label, values in (
        ("from (95 %)", [100 * share.low for share in shares]),
        ("to (95 %)", [100 * share.high for share in shares]),
    ):
        chart.add(label, values, stroke_style={"dasharray": "4"})
    return _svg(chart, title)


def _heat_map(across: str, down: str, group: list[tuple[Cell, list[Done]]]) -> str:
    shares = {(c.settings[across], c.settings[down]): share_of(runs) for c, runs in group}
    columns, lines = (list(dict.fromkeys(key[i] for key in shares)) for i in (0, 1))

    def cell(share: Share) -> str:
        said = f"{as_percent(share.share)} ({share.won} of {share.tried}, {_interval(share)})"
        return shade(share.share, said)

    rows = [
        (str(line), *(cell(shares[key]) if (key := (c, line)) in shares else "" for c in columns))
        for line in lines
    ]
    return as_table((f"{down} \\ {across}", *map(str, columns)), rows)


def _ticks(done: list[Done]) -> str:
    parts = ["<h2>Ticks to win</h2>"]
    for level, runs in by_level(done).items():
        ticks = sorted(each.result.ticks for each in runs if each.result.outcome == "won")
        if not ticks:
            continue
        width = max(1, -(-(ticks[-1] + 1 - ticks[0]) // _BARS))
        counts = Counter((tick - ticks[0]) // width for tick in ticks)
        chart = _pygal().Bar(**_style(level), show_legend=False, x_title="ticks", y_title="runs")
        chart.x_label_rotation = 40
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
    names = {student.id: student.called for student in manifest.students}
    for (level, outcome, why), runs in sorted(kinds.items(), key=lambda kind: -len(kind[1])):
        who = dict.fromkeys(names[each.cell.student] for each in runs if names)
        whose = (", ".join(who),) if names else ()
        rows.append((level, outcome, why, len(runs), *whose, as_code(runs[0].replay)))
    head = ("level", "how it ended", "why", "runs", *(("whose",) if names else ()), "one of them")
    title = "What failed" if manifest.kind == "tournament" else "Not won"
    return f"<h2>{title}</h2>" + as_table(head, rows) if rows else ""


def _cells(manifest: Manifest, done: list[Done]) -> str:
    rows: list[Sequence[Any]] = []
    names = {student.id: student.called for student in manifest.students}
    for cell, runs in by_cell(done):
        share = share_of(runs)
        # A run that was lost, from a shifted start if there is one, else the given start.
        shown = next((r for r in runs[::-1] if r.result.outcome != "won"), runs[0])
        rows.append(
            (
                names.get(cell.student) or setting_text(cell),
                cell.level_name,
                cell.program_name,
                runs[0].result.outcome,
                f"{share.won} of {share.tried}",
                _interval(share),
                share.ticks,
                as_code(shown.replay),
            )
        )
    head = ("", "level", "program", "given start", "won", "95 % interval", "median ticks", "replay")
    said = "The commands are typed in this folder; why instead of play explains a tick."
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
    }


def _svg(chart: Any, title: str) -> str:
    """Return a chart as SVG that is identical each time."""
    text: str = chart.render(is_unicode=True)
    text = re.sub(r"<!--.*?-->|<script.*?</script>", "", text, flags=re.DOTALL)
    return text.replace(chart.uuid, f"plot-{digest(title)[:12]}")
