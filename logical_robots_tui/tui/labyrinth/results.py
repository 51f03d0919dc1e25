"""The results of a level: what was won and how well, beside the reference programs."""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING

from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.content import Content
from textual.strip import Strip
from textual.widget import Widget
from textual.widgets import Button, Static

from logical_robots_tui.player.standings import histograms
from logical_robots_tui.tui.commands.keymap import command, with_keys
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line
from logical_robots_tui.world.level import SecondGoal

if TYPE_CHECKING:
    from logical_robots_tui.game.measuring import Trial
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.progress import Bests, Measures
    from logical_robots_tui.progress.board import BoardStanding
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells

_TITLES = ("ticks", "size", "distance", "robust")
_WIDTHS = (9, 7, 10, 11)
_LABEL = 11


def results_lines(
    recorder: ProgressRecorder, seconds: int = 0, histogram: Sequence[Content] = ()
) -> list[Content]:
    """Return lines of equal width: victory, bests (new ones marked), solution, scales, trial.

    If several programs won together, the last one alone is measured, from the start. `seconds`
    have passed since the trial's last step. The `histogram` of a board takes the place of scales.
    """
    references, bests = recorder.references.values(), recorder.record.bests
    rows = [_row("", _TITLES, INK.dim)]
    if recorder.latest is not None:
        label = "from start" if recorder.is_mixed else "this run"
        rows.append(_latest(label, recorder.latest, recorder.former, recorder.trial))
    rows.append(_row("your best", _numbers(bests), INK.text))
    if references:
        rows.append(_row("reference", _numbers(next(iter(references))), INK.dim))
    rows += histogram or scale_lines(references, bests)
    if recorder.trial is not None:
        trial = recorder.trial
        doing = f"tried: {trial.tried} of {trial.of_all}"
        if trial.waits_for:
            doing = f"wait for those of {clip(one_line(trial.waits_for), 18)}"
        trial_line = f"varied starts {doing} … {seconds} s"
        rows.append(Content.styled(f"{trial_line:^{_LABEL + sum(_WIDTHS)}}", INK.dim))
    width = max(row.cell_length for row in rows)
    return [row.pad_right(width - row.cell_length) for row in rows]


_SCALE = 21
_MINE, _REFERENCE, _NEW, _REACHED, OPEN = "●", "┼", "▲", "✓", "☐"
_LEGEND = {
    _NEW: "new best",
    _REACHED: "reached",
    OPEN: "not reached",
    _MINE: "your best",
    _REFERENCE: "reference",
}


def scale_lines(references: Iterable[Measures], bests: Bests) -> Iterator[Content]:
    """Yield a scale, from best to worst, of ticks, size and distance, with references' marks."""
    for title, best, *amounts in zip(
        _TITLES, bests[:3], *(reference[:3] for reference in references), strict=False
    ):
        scale_values = sorted({round(value) for value in amounts})
        if scale_values:
            yield _scale(title, scale_values, None if best is None else round(best))


_LEVELS, _PLAIN_LEVELS = "▁▂▃▄▅▆▇█", "_.-:=+*#"
_BINS = 17
_NAME = 10  # columns of who is first


def histogram_lines(
    standings: Sequence[BoardStanding], *, plain: bool = False
) -> Iterator[Content]:
    """Yield a line for each measure: how many have how much, one's own mark and rank, the first.

    `plain` means ASCII only.
    """
    levels, empty = (_PLAIN_LEVELS, " ") if plain else (_LEVELS, "─")
    for histogram in histograms(standings, _BINS):
        line = Content.styled(f"{histogram.measure:<{_LABEL}}", INK.dim)
        highest = max(histogram.counts)
        for index, count in enumerate(histogram.counts):
            if index == histogram.bin:
                line = line.append(_ink(_MINE))
            elif count:
                level = levels[-(-count * (len(levels) - 1) // highest)]
                line = line.append(Content.styled(level, INK.text))
            else:
                line = line.append(Content.styled(empty, INK.faint))
        leader = Content(one_line(histogram.leader)).truncate(_NAME, ellipsis=True)
        players = f"{histogram.players:,}"
        rank = f"{histogram.rank:,} of {players}" if histogram.rank else f"{players} won"
        line = line.append(Content.styled(f"  {rank:<11}", f"bold {INK.key}"))
        yield line.append(Content.styled(f"best {histogram.best:,.0f} {leader.plain}", INK.dim))


def _scale(title: str, references: list[int], best: int | None) -> Content:
    values = sorted({*references, *([] if best is None else [best])})
    low, high = values[0], max(values[-1], values[0] + 1)
    places = {value: (value - low) * (_SCALE - 1) // (high - low) for value in values}
    marks = dict.fromkeys((places[value] for value in references), _REFERENCE)
    if best is not None:
        marks[places[best]] = _MINE
    line = Content.styled(f"{title:<{_LABEL}}", INK.dim)
    for place in range(_SCALE):
        line = line.append(_ink(marks.get(place, "─")))
    for value in values:
        line = line.append(_ink(f"  {value:,}{_MINE * (value == best)}"))
    return line


def goal_lines(goals: Iterable[SecondGoal], reached_words: Collection[str]) -> Iterator[Content]:
    """Yield a line for each goal, ticked if it is reached."""
    for goal in goals:
        if goal.words in reached_words:
            yield Content.styled(f"{_REACHED} {goal.words}", f"bold {INK.good}")
        else:
            yield Content.styled(f"{OPEN} {goal.words}", INK.text)


def legend(rows: Iterable[Content]) -> Content:
    """Return what the signs in some lines mean."""
    text = "".join(row.plain for row in rows)
    meanings = [f"{sign} {meaning}" for sign, meaning in _LEGEND.items() if sign in text]
    return Content.styled("   ".join(meanings), INK.dim)


def _ink(text: str) -> Content:
    if _MINE in text:
        return Content.styled(text, f"bold {INK.key}")
    return Content.styled(text, INK.faint if text == "─" else INK.text)


def _latest(label: str, latest: Measures, former: Bests, trial: Trial | None) -> Content:
    cells = list(_numbers(latest))
    fresh = [
        former.ticks is None or latest.ticks < former.ticks,
        former.size is None or latest.size < former.size,
        former.distance is None or latest.distance < former.distance - 0.5,
        latest.wins is not None and (former.wins is None or latest.wins > former.wins),
    ]
    if trial is not None and latest.wins is None:
        cells[3] = "…"
    row = Content.styled(f"{label:<{_LABEL}}", f"bold {INK.key}")
    for cell, width, is_fresh in zip(cells, _WIDTHS, fresh, strict=True):
        style = f"bold {INK.good}" if is_fresh else INK.text
        row = row.append(
            Content.styled(f"{cell:>{width - 2}}{f' {_NEW}' if is_fresh else '  '}", style)
        )
    return row


def _row(label: str, cells: tuple[str, ...], style: str) -> Content:
    numbers = "".join(f"{cell:>{width - 2}}  " for cell, width in zip(cells, _WIDTHS, strict=True))
    return Content.assemble((f"{label:<{_LABEL}}", INK.dim), (numbers, style))


def _numbers(measures: Bests | Measures) -> tuple[str, str, str, str]:
    distance = "·" if measures.distance is None else f"{measures.distance:,.0f}"
    wins = "·" if measures.wins is None else f"{measures.wins} of {measures.starts}"
    return _number(measures.ticks), _number(measures.size), distance, wins


def _number(value: int | None) -> str:
    return "·" if value is None else f"{value:,}"


STORY_WIDTH = 58
"""Columns of the story, and of the picture with it."""


class Miniature(Widget):
    """A small picture of a level."""

    def __init__(self, cells: Cells) -> None:
        super().__init__()
        self._cells = cells
        rows, columns = cells.text.shape
        self.styles.width, self.styles.height = columns, rows

    def render_line(self, y: int) -> Strip:
        return self._cells.strip(y)


_CONFETTI = "·*✦•˚+"
_COLOURS = (INK.bad, INK.warn, INK.good, INK.robot, INK.record, INK.key)
_DENSITY = 0.14
_CHALLENGE = ": a challenge, not even the solution does it"
_ROOMY = 30  # lines of the terminal from which confetti falls above and below as well


class ResultsDialog(QuestionDialog):
    """What was won and how well, and what to do next: each answer is a command, with its key.

    Args:
        recorder: Has the results.
        said: What is celebrated, or "" to look results up.
        answers: Ids of commands, with the labels of their buttons.
        note: Why a victory has no measures, with `{command}` for keys, as long as it has none.
        seed: For the confetti.
        story: What is told after a victory.
        picture: The start of what comes next.
        noticing: Seconds before there are answers.
        explains: Whether a last line says what the signs mean.
        histogram: Returns its lines, if there is a board.
    """

    DEFAULT_CSS = """
    ResultsDialog > #box { width: auto; max-width: 100%; max-height: 100%; padding: 0 2; }
    ResultsDialog Static { width: auto; }
    ResultsDialog #story { margin-top: 1; color: $ink-dim; }
    ResultsDialog Miniature { margin-top: 1; }
    ResultsDialog #answers { width: auto; margin: 1 0; }
    """

    def __init__(
        self,
        recorder: ProgressRecorder,
        headline: str,
        answers: Sequence[tuple[str, str]],
        *,
        note: str = "",
        seed: int = 0,
        noticing: float = 0.0,
        story: str = "",
        picture: Cells | None = None,
        explains: bool = True,
        histogram: Callable[[], Sequence[Content]] = tuple,
    ) -> None:
        keyed = [
            (name, f"{label}  {command(name).key_name}" if command(name).keys else label)
            for name, label in answers
        ]
        super().__init__("Victory" if headline else "Results", "", keyed, noticing=noticing)
        self._recorder, self._headline, self._seed = recorder, headline, seed
        self._note, self._story = with_keys(note), story
        self._picture, self._explains = picture, explains
        self._trial, self._seconds, self._histogram = recorder.trial, 0, histogram
        self._rows = self._table()
        self._parts = [Static(id=name) for name in ("said", "goals", "table")]

    def content_widgets(self) -> ComposeResult:
        yield from self._parts[:2]
        if self._story:
            yield Static(Content("\n".join(wrap(one_line(self._story), STORY_WIDTH))), id="story")
        if self._picture is not None:
            yield Miniature(self._picture)
        with Horizontal(id="answers"):
            for name, label in self._answers:
                yield Button(Content(label), id=f"answer-{name}", compact=True)
        yield self._parts[2]

    def on_mount(self) -> None:
        super().on_mount()
        self._tell()
        self.set_interval(1.0, self._wait)

    def _wait(self) -> None:
        self._seconds += 1
        self.follow()

    def follow(self) -> None:
        if self._recorder.trial is not self._trial:
            self._trial, self._seconds = self._recorder.trial, 0
        if self.is_active and (rows := self._table()) != self._rows:
            self._rows = rows
            self._tell()

    def _table(self) -> list[Content]:
        recorder = self._recorder
        goals = [*goal_lines(recorder.goals, recorder.record.bests.goals)]
        challenge = self._challenge() if self._headline else None
        if challenge is not None:
            place = recorder.goals.index(challenge)
            goals[place] = goals[place].append(Content.styled(_CHALLENGE, INK.record))
        rows = [*results_lines(recorder, self._seconds, self._histogram()), *goals]
        if recorder.latest is not None:
            return rows
        return [*(Content.styled(line, INK.warn) for line in wrap(self._note, STORY_WIDTH)), *rows]

    def _challenge(self) -> SecondGoal | None:
        """Return an open goal that the solution does not reach."""
        solution, *_ = (*self._recorder.references.values(), None)
        if solution is None:
            return None
        reached_goals = {*self._recorder.record.bests.goals, *solution.goals}
        return next(
            (goal for goal in self._recorder.goals if goal.words not in reached_goals), None
        )

    def _tell(self) -> None:
        number = len(self._recorder.goals)
        table, goals = self._rows[: len(self._rows) - number], self._rows[-number:][:number]
        legend_rows = [Content(""), legend(self._rows)] * self._explains
        width = max(row.cell_length for row in (*legend_rows, *self._rows))
        lines = [Content.styled(self._headline, f"bold {INK.key}")] if self._headline else []
        if lines and self.app.size.height >= _ROOMY:
            lines = [Content(""), *lines, Content("")]
        chance = random.Random(self._seed)  # noqa: S311 - confetti
        headline_lines = [_with_confetti(line, width, chance) for line in lines]
        for part, rows in zip(
            self._parts, (headline_lines, goals, [*table, *legend_rows]), strict=True
        ):
            part.update(Content("\n").join(rows))
            part.display = bool(rows)

    def on_key(self, event: events.Key) -> None:
        """Answer by the key of a command, which the player may have changed, or open the palette.

        Textual calls the method of `QuestionDialog` as well, which moves between the answers.
        """
        for name in (*dict(self._answers), "palette"):
            if event.key in command(name).keys:
                event.stop()
                self.dismiss(name)
                return


def _with_confetti(middle: Content, width: int, chance: random.Random) -> Content:
    left = max((width - middle.cell_length) // 2 - 2, 0)
    right = max(width - middle.cell_length - left - 4, 0)
    if not middle.cell_length:
        return _confetti(width, chance)
    return Content("  ").join([_confetti(left, chance), middle, _confetti(right, chance)])


def _confetti(width: int, chance: random.Random) -> Content:
    parts = [
        (chance.choice(_CONFETTI), chance.choice(_COLOURS)) if chance.random() < _DENSITY else " "
        for _ in range(width)
    ]
    return Content.assemble(*parts)
