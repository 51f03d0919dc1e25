"""Results of a level as lines of text: a table, and scales with the reference programs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world.level import SecondGoal

if TYPE_CHECKING:
    from logical_robots_tui.game.measuring import Trial
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.progress import Bests, Measures

_TITLES = ("ticks", "rules", "distance", "robust")
_WIDTHS = (9, 7, 10, 11)
_LABEL = 11


def results_lines(recorder: ProgressRecorder) -> list[Content]:
    """Return lines of equal width: victory, bests (new ones starred), solution, scales, trial.

    If several programs won together, the last one alone is measured, from the start.
    """
    references, bests = recorder.references.values(), recorder.record.bests
    rows = [_row("", _TITLES, INK.dim)]
    if recorder.latest is not None and not recorder.is_reference:
        label = "from start" if recorder.is_mixed else "this run"
        rows.append(_latest(label, recorder.latest, recorder.former, recorder.trial))
    rows.append(_row("your bests", _numbers(bests), INK.text))
    if references:
        rows.append(_row("reference", _numbers(next(iter(references))), INK.dim))
        rows.append(
            Content.styled(f"{'':<{_LABEL}}{_MINE} your best  {_REFERENCE} references", INK.dim)
        )
    rows += scale_lines(references, bests)
    rows += goal_lines(recorder.goals, bests.goals)
    if recorder.trial is not None:
        told = f"trial of shifted starts: {recorder.trial.tried} so far …"
        rows.append(Content.styled(f"{told:^{_LABEL + sum(_WIDTHS)}}", INK.dim))
    width = max(row.cell_length for row in rows)
    return [row.pad_right(width - row.cell_length) for row in rows]


_SCALE = 21
_MINE, _REFERENCE = "●", "┼"


def scale_lines(references: Iterable[Measures], bests: Bests) -> Iterator[Content]:
    """Yield a scale, from best to worst, of ticks, rules and distance, with references' marks."""
    for title, mine, *others in zip(
        _TITLES, bests[:3], *(each[:3] for each in references), strict=False
    ):
        known = sorted({round(value) for value in others})
        if known:
            yield _scale(title, known, None if mine is None else round(mine))


def _scale(title: str, known: list[int], mine: int | None) -> Content:
    values = sorted({*known, *([] if mine is None else [mine])})
    low, high = values[0], max(values[-1], values[0] + 1)
    places = {value: (value - low) * (_SCALE - 1) // (high - low) for value in values}
    marks = dict.fromkeys((places[value] for value in known), _REFERENCE)
    if mine is not None:
        marks[places[mine]] = _MINE
    line = Content.styled(f"{title:<{_LABEL}}", INK.dim)
    for place in range(_SCALE):
        line = line.append(_ink(marks.get(place, "─")))
    for value in values:
        line = line.append(_ink(f"  {value}{_MINE * (value == mine)}"))
    return line


def goal_lines(goals: Iterable[SecondGoal], reached: Collection[str]) -> Iterator[Content]:
    told = [
        Content.styled(f"✓ {goal.words}", f"bold {INK.good}")
        if goal.words in reached
        else Content.styled(f"· {goal.words}", INK.text)
        for goal in goals
    ]
    if told:
        yield Content.styled(f"{'goals':<{_LABEL}}", INK.dim).append(Content("   ").join(told))


def _ink(text: str) -> Content:
    if _MINE in text:
        return Content.styled(text, f"bold {INK.key}")
    return Content.styled(text, INK.faint if text == "─" else INK.text)


def _latest(label: str, latest: Measures, former: Bests, trial: Trial | None) -> Content:
    cells = list(_numbers(latest))
    fresh = [
        former.ticks is None or latest.ticks < former.ticks,
        former.rules is None or latest.rules < former.rules,
        former.distance is None or latest.distance < former.distance - 0.5,
        latest.wins is not None and (former.wins is None or latest.wins > former.wins),
    ]
    if trial is not None and latest.wins is None:
        cells[3] = "…"
    row = Content.styled(f"{label:<{_LABEL}}", f"bold {INK.key}")
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
