"""The table of measures: this victory and the bests beside those of the reference program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.game.measuring import Trial
    from logical_robots_tui.progress import Bests, Measures
    from logical_robots_tui.tui.library.progress_recorder import ProgressRecorder

__all__ = ["brief", "results_lines"]

_TITLES = ("ticks", "rules", "distance", "robust")
_WIDTHS = (9, 7, 10, 11)
_LABEL = 11


def results_lines(recorder: ProgressRecorder) -> list[Content]:
    """Return lines of equal width: titles, then the victory, the bests and the reference.

    A new best is marked with a star; unknown values are a dot.
    """
    rows = [_row("", _TITLES, INK.dim)]
    if recorder.latest is not None and not recorder.is_reference:
        rows.append(_latest(recorder.latest, recorder.former, recorder.trial))
    elif recorder.trial is not None:
        rows.append(_row("this run", ("·", "·", "·", _trial(recorder.trial)), INK.text))
    rows.append(_row("your bests", _numbers(recorder.record.bests), INK.text))
    if recorder.reference is not None:
        rows.append(_row("reference", _numbers(recorder.reference), INK.dim))
    return rows


def brief(bests: Bests, width: int) -> str:
    """Return the bests in a few words that fit, or "" if there are none."""
    if bests.ticks is None:
        return ""
    ticks, rules, distance, _ = _numbers(bests)
    parts = [f"{ticks} ticks", f"{rules} rule{'s' * (rules != '1')}", f"{distance} far"]
    if bests.wins is not None:
        parts.append(f"{bests.wins}/{bests.starts}")
    told = " · ".join(parts)
    return told if len(told) <= width else "  ".join(parts)


def _latest(latest: Measures, former: Bests, trial: Trial | None) -> Content:
    cells = list(_numbers(latest))
    fresh = [
        former.ticks is None or latest.ticks < former.ticks,
        former.rules is None or latest.rules < former.rules,
        former.distance is None or latest.distance < former.distance - 0.5,
        latest.wins is not None and (former.wins is None or latest.wins > former.wins),
    ]
    if trial is not None and latest.wins is None:
        cells[3] = _trial(trial)
    row = Content.styled(f"{'this run':<{_LABEL}}", f"bold {INK.key}")
    for cell, width, is_fresh in zip(cells, _WIDTHS, fresh, strict=True):
        style = f"bold {INK.good}" if is_fresh else INK.text
        row = row.append(Content.styled(f"{cell:>{width - 2}}{' ★' if is_fresh else '  '}", style))
    return row


def _row(label: str, cells: tuple[str, ...], style: str) -> Content:
    numbers = "".join(f"{cell:>{width - 2}}  " for cell, width in zip(cells, _WIDTHS, strict=True))
    return Content.assemble((f"{label:<{_LABEL}}", INK.dim), (numbers, style))


def _numbers(found: Bests | Measures) -> tuple[str, str, str, str]:
    distance = "·" if found.distance is None else f"{found.distance:.0f}"
    wins = "·" if found.wins is None else f"{found.wins} of {found.starts}"
    return _number(found.ticks), _number(found.rules), distance, wins


def _number(value: int | None) -> str:
    return "·" if value is None else str(value)


def _trial(trial: Trial) -> str:
    return f"{trial.wins} of {trial.tried}…" if trial.tried else "trying…"
