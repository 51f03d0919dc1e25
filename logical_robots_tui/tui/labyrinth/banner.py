"""The banner over the labyrinth: a victory with its measures, or the results so far."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from textual.content import Content
from textual.style import Style
from textual.widgets import Static

from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.labyrinth.results import results_lines
from logical_robots_tui.tui.theme.safe_text import clip
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual import events

    from logical_robots_tui.tui.library.progress_recorder import ProgressRecorder

_OFFERS = (
    ("next level", "next_level"),
    ("again", "restart"),
    ("lesson", "lesson"),
    ("stay", "leave"),
)
_LOOKED_UP = (("reference programs", "solution"), ("versions", "versions"), ("close", "results"))
_CONFETTI = "·*✦•˚+"
_COLOURS = (INK.bad, INK.warn, INK.good, INK.robot, INK.record, INK.key)
_ROOMY = 24  # lines of the pane from which there is space between the parts


class Overlay(Static):
    """Text over the picture; a click closes it. It never takes the focus."""

    DEFAULT_CSS = """
    Overlay { layer: over; display: none; background: $panel 92%; width: 100%; height: auto; }
    """

    def on_click(self, event: events.Click) -> None:
        event.stop()
        self.close()

    def close(self) -> None:
        """Hide, and repaint what was below: Textual's layout alone may leave remnants."""
        if self.display:
            self.display = False
            self.call_after_refresh(self.screen.refresh)


class VictoryBanner(Overlay):
    """Celebrates a victory; its keys are ordinary commands, so typing is not disturbed."""

    DEFAULT_CSS = """
    VictoryBanner { dock: top; height: auto; text-wrap: nowrap; }
    """

    def __init__(self) -> None:
        super().__init__(id="banner")
        self._said = ""
        self._seed: int | None = None
        self._rows: Sequence[Content] = ()
        self._offers: Sequence[tuple[str, str]] = _OFFERS

    def celebrate(self, ticks: int, who: str, recorder: ProgressRecorder) -> None:
        self._seed, self._offers = ticks, _OFFERS
        self._said = f"★ {clip(who, 50)} — {counted(ticks, 'tick')} ★"
        self._show(recorder)

    def toggle(self, recorder: ProgressRecorder) -> None:
        if self.display:
            self.close()
            return
        self._seed, self._offers, self._said = None, _LOOKED_UP, "Results"
        self._show(recorder)

    def follow(self, recorder: ProgressRecorder) -> None:
        if self.display and (rows := self._table(recorder)) != self._rows:
            same = len(rows) == len(self._rows)
            self._rows = rows
            self.refresh(layout=not same)

    def _show(self, recorder: ProgressRecorder) -> None:
        self._rows = self._table(recorder)
        self.display = True
        self.refresh(layout=True)

    def _table(self, recorder: ProgressRecorder) -> list[Content]:
        rows = results_lines(recorder)
        if self._seed is not None and recorder.is_reference:
            note = "Won by a reference program: not counted."
            return [Content.styled(note, INK.dim), *rows]
        return rows

    def render(self) -> Content:
        width = self.size.width
        chance = random.Random(self._seed)  # noqa: S311 - confetti
        said = Content.styled(self._said, f"bold {INK.key}")
        offers = Content("   ").join(_offer(label, name) for label, name in self._offers)
        air = [Content("")] if self.screen.size.height >= _ROOMY + 6 else []
        lines = [*air, said, *air, *self._rows, *air, offers, *air]
        density = 0.0 if self._seed is None else 0.14
        return Content("\n").join(_confetti(width, line, chance, density) for line in lines)


def _offer(label: str, command_id: str) -> Content:
    key = command(command_id).key_name
    content = Content.assemble((key, f"bold {INK.key}"), f" {label}")
    return content.stylize(Style.from_meta({"@click": f"screen.command('{command_id}')"}))


def _confetti(width: int, middle: Content, chance: random.Random, density: float) -> Content:
    left = max((width - middle.cell_length) // 2 - 2, 0)
    right = max(width - middle.cell_length - left - 4, 0)
    if not middle.cell_length:
        return _sprinkle(width, chance, density)
    sides = _sprinkle(left, chance, density), _sprinkle(right, chance, density)
    return Content("  ").join([sides[0], middle, sides[1]])


def _sprinkle(width: int, chance: random.Random, density: float) -> Content:
    parts = [
        (chance.choice(_CONFETTI), chance.choice(_COLOURS)) if chance.random() < density else " "
        for _ in range(width)
    ]
    return Content.assemble(*parts)
