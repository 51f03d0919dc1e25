"""The briefing: the task of a level, beside its map or over the inspector, never over the map."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from itertools import zip_longest
from textwrap import wrap
from typing import TYPE_CHECKING, NamedTuple

from textual import events
from textual.content import Content
from textual.geometry import Size
from textual.message import Message
from textual.widget import Widget

from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line, visible

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

_GAP = 4  # columns between the text and what is beside it
_NARROWEST = 24
_EDGES = 3  # columns of the border and the padding
_LEAST_BESIDE = 48  # columns that are of use beside it: the inspector's list and some of a page
_FOLDED = re.compile(r"(?<=[^.:!?\n])\n(?=\S)")  # line ends within a sentence


class BriefingTask(NamedTuple):
    """What a briefing says: a title, lines of text, goals, and keys that no bar shows."""

    title: str
    lines: Sequence[str]
    goals: Sequence[str]
    keys: Sequence[str]

    @classmethod
    def of(cls, level: Level) -> BriefingTask:
        offers = {"briefing": "hides this"}
        if level.lesson:
            offers["lesson"] = "lesson"
        return cls(
            one_line(level.title),
            [visible(line) for line in (*level.briefing.strip().splitlines(), *level.terms)],
            [f"☐ {goal.words}" for goal in level.second_goals],
            [f"{command(name).key_name} {effect}" for name, effect in offers.items()],
        )

    def stacked(self, width: int) -> Content:
        """Return the text in lines of a width, with the goals and the keys below it."""
        key_lines = ["   ".join(self.keys[n : n + 2]) for n in range(0, len(self.keys), 2)]
        shorter = self._replace(keys=key_lines)
        rows = [*self._text(width), ("", ""), *shorter.goals_and_keys()]
        return Content("\n").join(Content.styled(text, ink) for text, ink in rows)

    def side_by_side(self, width: int, rows: int) -> Content:
        """Return the text beside goals and keys; the goals are folded where the room is small."""
        widest = max((len(text) for text in (*self.goals, *self.keys)), default=0)
        for goals_width in (widest, min(widest, _NARROWEST)):
            right = self.goals_and_keys(goals_width, is_apart=True)
            if len(right) > rows:
                right = self.goals_and_keys(goals_width)
            left = self._text(max(width - _GAP - goals_width, 1))
            if len(left) <= rows:
                break
        across = max(len(text) for text, _ in left) + _GAP
        pairs = zip_longest(left, right, fillvalue=("", ""))
        return Content("\n").join(
            Content.assemble((f"{line:<{across}}", ink), side) for (line, ink), side in pairs
        )

    def _text(self, width: int) -> list[tuple[str, str]]:
        """The title, and the lines as they are written if they are not too long."""
        lines = self.lines
        if any(len(line) > width for line in lines):
            folded = _FOLDED.sub(" ", "\n".join(lines)).splitlines()
            lines = [piece for line in folded for piece in wrap(line, width) or [""]]
        return [(self.title, f"bold {INK.title}"), *((line, INK.text) for line in lines)]

    def goals_and_keys(
        self, width: int = sys.maxsize, *, is_apart: bool = False
    ) -> list[tuple[str, str]]:
        pieces = (piece for goal in self.goals for piece in wrap(goal, width))
        goals = [(piece, INK.record) for piece in pieces]
        return [*goals, *[("", "")] * is_apart, *((key, INK.dim) for key in self.keys)]


class BriefingCard(Widget):
    """Where a briefing may be; a click closes it. It takes as little of its pane as it needs."""

    DEFAULT_CSS = """
    BriefingCard {
        display: none; width: auto; height: 100%; padding: 0 1; background: $panel;
        border-left: solid $frame;
    }
    BriefingCard.-beside { dock: right; layer: picture; }
    BriefingCard.-over { dock: right; layer: over; }
    BriefingCard.-whole { border-left: none; }
    """

    class Closed(Message):
        """The player closes it."""

    def __init__(self, *, is_over: bool) -> None:
        super().__init__(classes="-over" if is_over else "-beside")
        self._is_over = is_over
        self._shown_task: BriefingTask | None = None

    def show(self, task: BriefingTask | None) -> None:
        self.display = task is not None
        if task != self._shown_task:
            self._shown_task = task
            self.refresh(layout=True)

    def on_click(self, event: events.Click) -> None:
        event.stop()
        self.post_message(self.Closed())

    def get_content_width(self, container: Size, viewport: Size) -> int:
        lines = self._fit().split("\n", allow_blank=True)
        room, width = self._room.width, max(line.cell_length for line in lines)
        leaves_a_sliver = self._is_over and room - width < _LEAST_BESIDE
        return container.width if leaves_a_sliver else min(width, room)

    def on_resize(self) -> None:
        """Leave out the border beside the pane's own."""
        self.set_class(self.outer_size.width >= self._room.width + _EDGES, "-whole")

    def render(self) -> Content:
        return self._fit()

    @property
    def _room(self) -> Size:
        assert isinstance(self.parent, Widget)
        return self.parent.content_size - (_EDGES, 0)

    def _fit(self) -> Content:
        room = self._room
        if self._shown_task is None:
            return Content("")
        if self._is_over:
            return self._shown_task.side_by_side(*room)
        content = Content("")
        for width in range(_NARROWEST, max((room.width + _EDGES) // 2, _NARROWEST + 1)):
            content = self._shown_task.stacked(width)
            if content.plain.count("\n") < room.height:
                break
        return content


class Briefing:
    """Shows the task of a level in one of two places.

    Attributes:
        beside: Takes a part of the labyrinth pane.
        over: Covers a part of the inspector.
    """

    bar_keys = (("briefing", "Hide the briefing"), ("lesson", "Lesson"))

    def __init__(self, is_over: Callable[[], bool]) -> None:
        """`is_over` tells whether the inspector can be seen beside the labyrinth."""
        self.beside, self.over = BriefingCard(is_over=False), BriefingCard(is_over=True)
        self._is_over = is_over
        self._task: BriefingTask | None = None
        self.is_open = False

    def tell(self, level: Level) -> None:
        self._task = BriefingTask.of(level) if level.briefing.strip() else None
        self.is_open = self._task is not None
        self.place()

    def toggle(self) -> bool:
        """Open or close it; return whether there is one."""
        self.is_open = self._task is not None and not self.is_open
        self.place()
        return self._task is not None

    def close(self) -> None:
        if self.is_open:
            self.is_open = False
            self.place()

    def place(self) -> None:
        is_over = self._is_over()
        for card, is_it in ((self.over, is_over), (self.beside, not is_over)):
            card.show(self._task if self.is_open and is_it else None)
