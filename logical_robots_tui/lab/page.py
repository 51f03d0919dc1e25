"""A page of HTML without scripts or links, and the tables on it."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from typing import Any

from logical_robots_tui.lab.exporting import harmless_text

_MOST_ROWS = 1_000
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto }}
table {{ border-collapse: collapse; margin: 1rem 0; display: block; overflow-x: auto }}
th, td {{ border: 1px solid #bbb; padding: .2rem .6rem; text-align: left }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums }}
code {{ font-size: 12px; white-space: nowrap }}
svg {{ max-width: 48rem; display: block }}
</style></head><body>
<h1>{title}</h1>
{body}
</body></html>
"""


def as_page(title: str, parts: Iterable[str]) -> str:
    return _PAGE.format(title=html.escape(harmless_text(title)), body="\n".join(parts))


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


def as_table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    def cell(value: Any) -> str:
        if isinstance(value, Html):
            return f"<td>{value}</td>"
        if isinstance(value, bool) or value is None:
            value = {None: "", True: "yes", False: "no"}[value]
        if isinstance(value, str):
            return f"<td>{html.escape(harmless_text(value))}</td>"
        return f'<td class="number">{value:,.10g}</td>'

    names = "".join(f"<th>{html.escape(harmless_text(name))}</th>" for name in head)
    lines = ["<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows]
    more = ""
    if len(lines) > _MOST_ROWS:
        more = f"<p>The first {_MOST_ROWS:,} of {len(lines):,} rows; runs.csv has all runs.</p>"
    return f"<table><tr>{names}</tr>\n" + "\n".join(lines[:_MOST_ROWS]) + f"</table>{more}"


def as_code(text: str) -> Html:
    return Html(f"<code>{html.escape(text)}</code>")


def as_percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def shade(share: float, text: str) -> Html:
    """Return a text on a colour between red, for a share of 0, and green, for 1."""
    shade = f"background: hsl({120 * share:.0f} 60% 80%); padding: .2rem"
    return Html(f'<span style="{shade}">{html.escape(text)}</span>')
