"""Tables of results as CSV and Parquet, and texts as Markdown or HTML without scripts or links."""

from __future__ import annotations

import csv
import html
import io
import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from statistics import fmean
from typing import Any, NamedTuple, TypeAlias

from logical_robots_tui.errors import is_installed
from logical_robots_tui.lab.coordinating import cell_to_run, split_starts
from logical_robots_tui.lab.folder import ATTEMPTS, MEASURES, Cell, Folder, Ledger, Manifest, digest
from logical_robots_tui.lab.tasks import QueryMeasure, Reduction, Result
from logical_robots_tui.language.diagnostics import printable

Row: TypeAlias = "tuple[Any, ...]"

_FORMULA = ("=", "+", "-", "@", "\t", "\r")


class RunRecord(NamedTuple):
    cell: Cell
    start: int
    job: str
    result: Result

    @property
    def reason(self) -> str:
        """Its first mistake or notice, or ""."""
        if self.result.mistakes:
            return self.result.mistakes[0].message
        return self.result.first[2] if self.result.first else ""


class ResultTable(NamedTuple):
    columns: tuple[str, ...]
    rows: list[Row]


class RunRecords:
    """The runs of a manifest that a ledger has; each kind is read once, when it is needed."""

    def __init__(self, manifest: Manifest, ledger: Ledger) -> None:
        self.manifest, self.ledger = manifest, ledger

    @cached_property
    def finished(self) -> list[RunRecord]:
        manifest, results = self.manifest, self.ledger.results()
        outcomes = {job: result.outcome for job, result in results.items()}
        records = []
        for cell in manifest.cells:
            cell = cell_to_run(manifest, cell, outcomes)
            for start in split_starts(manifest, cell, outcomes)[0]:
                job = manifest.job(cell, start)
                records.append(RunRecord(cell, start, job, results[job]))
        return records

    @cached_property
    def failed(self) -> list[RunRecord]:
        manifest, all_reasons = self.manifest, self.ledger.failures()
        failures = {
            job: reasons[-1] for job, reasons in all_reasons.items() if len(reasons) >= ATTEMPTS
        }
        outcomes = self.ledger.outcomes() if failures else {}
        records = []
        for cell in manifest.cells if failures else ():
            cell = cell_to_run(manifest, cell, outcomes)
            for start in manifest.starts_of(cell):
                job = manifest.job(cell, start)
                if job in failures:
                    result = Result("infrastructure", first=(0, "", failures[job]))
                    records.append(RunRecord(cell, start, job, result))
        return records


def export_runs(folder: Folder, records: RunRecords) -> list[str]:
    """Write runs and questions' rows as tables; return the files' names, or raise InputError."""
    cells = records.manifest.cells
    digests = {name for cell in cells for name in (cell.level, cell.program, *cell.parts)}
    for name in sorted(digests - {""}):
        folder.text(name)
    file_names = []
    for name, table in tables_of_runs(records).items():
        file_names += write_tables(folder, {name: table})
        if is_installed("pyarrow"):
            import pyarrow.parquet as pq

            buffer = io.BytesIO()
            pq.write_table(arrow_of(table), buffer)
            folder.put(folder.path / f"{name}.parquet", buffer.getvalue())
            file_names.append(f"{name}.parquet")
    return file_names


SPREADSHEET_MARK = "\ufeff"
"""What tells a spreadsheet that a table is UTF-8."""


def write_tables(folder: Folder, tables: Mapping[str, ResultTable], mark: str = "") -> list[str]:
    """Write tables as CSV, after a mark; return the names of the files, or raise InputError."""
    for name, table in tables.items():
        folder.put(folder.path / f"{name}.csv", mark + csv_of(table))
    return [f"{name}.csv" for name in tables]


def tables_of_runs(records: RunRecords) -> dict[str, ResultTable]:
    tables = {"runs": _runs(records)}
    if records.manifest.asked or records.manifest.until:
        tables["series"] = _series(records.manifest, records.finished)
    return tables


def settings_of(manifest: Manifest) -> list[str]:
    return list(dict.fromkeys(name for cell in manifest.cells for name in cell.settings))


def reduce_series(result: Result, measure: QueryMeasure, kind: Reduction) -> float | None:
    """Return one number of a run; None if there is none, or if not all could be measured."""
    series = result.series.get(measure.name)
    numbers = [number for _, number in series.numbers if number is not None] if series else []
    if series is None or not numbers or len(numbers) < len(series.numbers):
        return None
    return _REDUCERS[kind](numbers)


_REDUCERS: dict[str, Callable[[list[float]], float]] = {
    "last": lambda numbers: numbers[-1],
    "min": min,
    "max": max,
    "mean": fmean,
    "sum": sum,
}


def measures_of(manifest: Manifest) -> dict[str, Callable[[Result], float | None]]:
    """Return the measures of a run by name, those of queries last."""
    measures = {name: MEASURES[name] for name in manifest.measures}
    for measure in manifest.asked:
        if not measure.every:
            measures[measure.name] = partial(reduce_series, measure=measure, kind="last")
        for kind in measure.reduce:
            name = f"{measure.name}_{kind}"
            measures[name] = partial(reduce_series, measure=measure, kind=kind)
    return measures


def _run_columns(manifest: Manifest) -> tuple[str, ...]:
    """Return the columns that identify a run in every table of runs."""
    return ("level", "program", *settings_of(manifest), "start")


def _run_cells(names: list[str], run: RunRecord) -> Row:
    cell = run.cell
    settings = (cell.settings.get(name) for name in names)
    return (cell.level_name, cell.program_name, *settings, run.start)


def _runs(records: RunRecords) -> ResultTable:
    manifest, engines = records.manifest, records.ledger.engines()
    student = ("student",) if manifest.kind == "grade" else ()
    measures, settings = measures_of(manifest), settings_of(manifest)
    columns = ("run", *student, *_run_columns(manifest), "outcome", *measures)
    columns += tuple(f"points_{team}" for team in manifest.teams)
    columns += ("forfeit",) * bool(manifest.teams)
    columns += ("last_tick", "notices", "first_notice", "engine", "replay")
    rows: list[Row] = []
    for run in (*records.finished, *records.failed):
        cell, _, job, result = run
        first_notice = run.reason
        if result.mistakes:
            first_notice = f"line {result.mistakes[0].line}: {first_notice}"
        elif result.first and result.outcome != "infrastructure":
            first_notice = "tick {}, {}: {}".format(*result.first)
        rows.append(
            (
                manifest.run(job),
                *((cell.student,) if student else ()),
                *_run_cells(settings, run),
                result.outcome,
                *(measure(result) for measure in measures.values()),
                *(result.points.get(team) for team in manifest.teams),
                *(", ".join(result.forfeit) for _ in manifest.teams[:1]),
                result.ticks,
                sum(result.notices.values()),
                first_notice,
                engines.get(job, ""),
                manifest.command(run.cell, run.start),
            )
        )
    return ResultTable(columns, rows)


def _series(manifest: Manifest, runs: list[RunRecord]) -> ResultTable:
    rows: list[Row] = []
    settings = settings_of(manifest)
    for run in runs:
        cells = (manifest.run(run.job), *_run_cells(settings, run))
        for name, series in run.result.series.items():
            number = last_tick = 0
            for tick, *values in series.rows:
                number, last_tick = (number + 1 if tick == last_tick else 1), tick
                for column, value in zip(series.columns[1:], values, strict=True):
                    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
                    text = value if isinstance(value, str) else json.dumps(value)
                    rows.append(
                        (*cells, name, tick, number, column, value if is_number else None, text)
                    )
            if series.failure:
                rows.append((*cells, name, None, None, "failure", None, series.failure))
    columns = ("measure", "tick", "row", "column", "number", "text")
    return ResultTable(("run", *_run_columns(manifest), *columns), rows)


def csv_of(table: ResultTable) -> str:
    """Return a table as CSV in which no cell is a formula or holds a control character."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(map(harmless_cell, table.columns))
    for row in table.rows:
        writer.writerow(map(harmless_cell, row))
    return buffer.getvalue()


def harmless_cell(value: Any) -> Any:
    if isinstance(value, bool):
        return str(value).lower()
    if not isinstance(value, str):
        return value
    text = harmless_text(value)
    return f"'{text}" if text.lstrip().startswith(_FORMULA) else text


def harmless_text(text: str) -> str:
    """Return a text on one line without control, invisible and bidirectional characters."""
    return printable(text.replace("\n", " ").replace("\t", " "))


def arrow_of(table: ResultTable) -> Any:
    import pyarrow as pa

    return pa.table(columns_of(table))


def columns_of(table: ResultTable) -> dict[str, list[Any]]:
    """Return the values by column, those of one column of one type."""
    columns: dict[str, list[Any]] = {}
    all_values = list(zip(*table.rows, strict=True)) or [()] * len(table.columns)
    for name, values in zip(table.columns, all_values, strict=True):
        kinds = {type(value) for value in values if value is not None}
        if kinds <= {int, float}:
            cells = [float(v) if v is not None and float in kinds else v for v in values]
        elif len(kinds) == 1:
            cells = [harmless_text(v) if isinstance(v, str) else v for v in values]
        else:
            cells = [None if v is None else harmless_text(str(v)) for v in values]
        columns[name] = cells
    return columns


_MOST_ROWS = 1_000
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto }}
body {{ padding: 0 1rem }}
table {{ border-collapse: collapse; margin: 1rem 0; display: block; overflow-x: auto }}
th, td {{ border: 1px solid #bbb; padding: .2rem .6rem; text-align: left }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums }}
code {{ font-size: 12px; overflow-wrap: anywhere }}
svg {{ max-width: min(48rem, 100%); height: auto; display: block }}
figure {{ margin: 1rem 0; break-inside: avoid }}
.beside {{ display: flex; flex-wrap: wrap; gap: 1rem }}
.beside > div {{ flex: 1 1 20rem; min-width: 0 }}
pre {{ font-size: 12px; white-space: pre-wrap; overflow-wrap: anywhere }}
@media (max-width: 40rem) {{
  tbody, tr, td {{ display: block }} thead {{ display: none }}
  tr {{ border: 1px solid #bbb; margin-bottom: .6rem }} td {{ border: 0 }}
  td.number {{ text-align: left }} td:empty {{ display: none }}
  td[data-head]:not([data-head=""])::before {{ content: attr(data-head) ": "; color: #555 }}
}}
@media print {{
  body {{ font-size: 9pt; max-width: none; margin: 0 }}
  table {{ display: table; font-size: 8pt }} th, td {{ padding: .1rem .3rem }}
  tr, li {{ break-inside: avoid }} h2, h3 {{ break-after: avoid }}
  * {{ print-color-adjust: exact }}
}}
</style></head><body>
<h1>{title}</h1>
{body}
</body></html>
"""


def escape_html(text: str) -> str:
    return html.escape(harmless_text(text))


def as_page(title: str, parts: Iterable[str]) -> str:
    return _PAGE.format(title=escape_html(title), body="\n".join(parts))


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


def table_section(
    title: str, head: Sequence[str], rows: Iterable[Sequence[Any]], intro: str = ""
) -> str:
    """Return a table below a heading and an introduction, which are HTML already."""
    names = [escape_html(name) for name in head]

    def cell(name: str, value: Any) -> str:
        start = f'<td data-head="{name}"'
        if isinstance(value, Html):
            return f"{start}>{value}</td>"
        if isinstance(value, bool) or value is None:
            value = {None: "", True: "yes", False: "no"}[value]
        if isinstance(value, str):
            return f"{start}>{escape_html(value)}</td>"
        return f'{start} class="number">{value:,.10g}</td>'

    heads = "".join(f"<th>{name}</th>" for name in names)
    lines = ["<tr>" + "".join(map(cell, names, row)) + "</tr>" for row in rows]
    note = ""
    if len(lines) > _MOST_ROWS:
        note = f"<p>The first {_MOST_ROWS:,} of {len(lines):,} rows; runs.csv has all runs.</p>"
    body = "\n".join(lines[:_MOST_ROWS])
    opening = f"<h2>{title}</h2>" + f"<p>{intro}</p>" * bool(intro)
    return f"{opening}<table><thead><tr>{heads}</tr></thead><tbody>\n{body}</tbody></table>{note}"


def as_code(text: str) -> Html:
    return Html(f"<code>{html.escape(text)}</code>")


def new_chart(kind: str, title: str, **options: Any) -> Any:
    import pygal

    # Without its importer, which makes Python 3.11 warn.
    sys.meta_path[:] = [finder for finder in sys.meta_path if hasattr(finder, "find_spec")]
    return getattr(pygal, kind)(
        title=harmless_text(title),
        js=[],
        disable_xml_declaration=True,
        height=400,
        explicit_size=True,
        x_label_rotation=30,
        legend_at_bottom=True,
        truncate_legend=-1,
        **options,
    )


def svg_of(chart: Any, title: str) -> str:
    """Return a chart as SVG that is identical each time."""
    text: str = chart.render(is_unicode=True)
    text = re.sub(r"<!--.*?-->|<script.*?</script>", "", text, flags=re.DOTALL)
    return text.replace(chart.uuid, f"plot-{digest(title)[:12]}")


def as_percent(share: float) -> str:
    return f"{100 * share:.0f}%"


def shade(share: float, text: str) -> Html:
    """Return a text on a colour between red, for a share of 0, and green, for 1."""
    style = f"background: hsl({120 * share:.0f} 60% 80%); padding: .2rem"
    return Html(f'<span style="{style}">{html.escape(text)}</span>')


Parts: TypeAlias = "Sequence[tuple[str, list[str]]]"
"""Headings and the sentences below them, with code in backticks."""

_CODE = re.compile("`([^`]+)`")


def parts_as_markdown(title: str, parts: Parts) -> str:
    lines = [f"# {_markdown(title)}"]
    for number, (head, sentences) in enumerate(parts):
        lines += ["", "## " * bool(number) + _markdown(head)]
        lines += [""] * bool(sentences) + [f"- {_markdown(sentence)}" for sentence in sentences]
    return "\n".join(lines) + "\n"


def parts_as_html(parts: Parts, pictures: Sequence[str]) -> list[str]:
    """Return the same as blocks of a page, with a picture or "" below each part."""
    blocks = []
    for number, ((head, sentences), picture) in enumerate(zip(parts, pictures, strict=True)):
        tag = "h2" if number else "p"
        items = [_CODE.sub(r"<code>\1</code>", escape_html(sentence)) for sentence in sentences]
        body = f"<ul><li>{'</li><li>'.join(items)}</li></ul>" * bool(sentences) + picture
        blocks.append(f"<{tag}>{escape_html(head)}</{tag}>{body}")
    return blocks


def _markdown(text: str) -> str:
    parts = _CODE.split(harmless_text(text))  # every other one is code, in which nothing is markup
    escape = re.compile(r"([\\`*_{}\[\]<>#|!&~])")
    return "".join(f"`{p}`" if n % 2 else escape.sub(r"\\\1", p) for n, p in enumerate(parts))
