"""The timeline: the known ticks on a line, clicked, dragged, or driven with keys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby, islice
from typing import TYPE_CHECKING, NamedTuple

from textual import events
from textual.content import Content
from textual.message import Message

from logical_robots_tui.game import MARK_KINDS, Mark, MarkKind, goals
from logical_robots_tui.game.frame import count_home
from logical_robots_tui.game.history.marks import ROUNDS, STUCK_AFTER
from logical_robots_tui.tui.terminal.diff_app import OneLine
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.player.session import Session

SIGNS: dict[MarkKind, tuple[str, str, str]] = {
    "victory": ("★", f"bold {INK.key}", "victory"),
    "breakpoint": ("◉", f"bold {INK.bad}", "a breakpoint was hit"),
    "program": ("¶", f"bold {INK.title}", "another program is used from here on"),
    "edit": ("✎", f"bold {INK.title}", "the labyrinth was changed by hand"),
    "stuck": ("⊘", f"bold {INK.warn}", f"a robot is stuck: blocked for {STUCK_AFTER} ticks"),
    "circling": ("↻", f"bold {INK.warn}", f"a robot goes in circles: {ROUNDS} times the same"),
    "area": ("◇", INK.good, "an area was switched"),
    "notice": ("!", f"bold {INK.warn}", "a notice"),
    "memory": ("┷", INK.record, "a memory changed; only the selected robot's, if one is selected"),
}
"""The sign, colour and meaning of each kind of mark."""

DIVERGENCE = ("≠", f"bold {INK.number}", "the two branches differ from here on")
_PAST, _KNOWN, _OTHER, _UNKNOWN = "━", "─", "┄", " "
TRACKS = (
    (_PAST, INK.text, "the ticks up to the one on the screen"),
    (_KNOWN, INK.dim, "later ticks that are known"),
    (_OTHER, INK.faint, "ticks of the other branch"),
)
"""The signs of the track, with colours and meanings."""


class TimelineSpan(NamedTuple):
    """The content of the timeline; `other_last` and `diverged` are None without another branch."""

    first: int
    last: int
    tick: int
    other_last: int | None = None
    diverged: int | None = None


class Scale(NamedTuple):
    """The first tick, and ticks per column: 1, 2, 5, 10, 20, 50 and so on."""

    first: int
    ticks_per_column: int

    @classmethod
    def to_hold(cls, span: TimelineSpan, width: int) -> Scale:
        ticks = max(span.last, span.other_last or 0) - span.first + 1
        ticks_per_column, factors = 1, [2, 2.5, 2]
        while ticks_per_column * width < ticks:
            ticks_per_column = round(ticks_per_column * factors[0])
            factors.append(factors.pop(0))
        return cls(span.first, ticks_per_column)

    def column(self, tick: int) -> int:
        return (tick - self.first) // self.ticks_per_column

    def ticks(self, column: int) -> tuple[int, int]:
        begin = self.first + column * self.ticks_per_column
        return begin, begin + self.ticks_per_column - 1


def track(span: TimelineSpan, width: int, has: Callable[[MarkKind, int, int], bool]) -> Content:
    scale = Scale.to_hold(span, width)
    current_column = scale.column(span.tick)
    signs, styles = [], []
    for column in range(width):
        sign, style = _sign_at(span, *scale.ticks(column), has)
        signs.append(sign)
        styles.append(f"{style} reverse" if column == current_column else style)
    text = iter(signs)
    runs = ((style, len(list(run))) for style, run in groupby(styles))
    return Content.assemble(*[("".join(islice(text, length)), style) for style, length in runs])


def _sign_at(
    span: TimelineSpan, begin: int, end: int, has: Callable[[MarkKind, int, int], bool]
) -> tuple[str, str]:
    if span.diverged is not None and begin <= span.diverged <= end:
        return DIVERGENCE[:2]
    if begin <= span.last:
        for kind in MARK_KINDS:
            if has(kind, begin, end):
                return SIGNS[kind][:2]
        return TRACKS[0][:2] if begin <= span.tick else TRACKS[1][:2]
    return TRACKS[2][:2] if begin <= (span.other_last or 0) else (_UNKNOWN, INK.dim)


_NOTE_SHARE = 3  # the note's share of the width is one in so many
_NOTE_WIDTHS = (18, 48)


def _goal_note(session: Session) -> str:
    """Return how many robots are in the goals that count together, or "" without shared goals."""
    all_goals = goals(session.level, session.frame.after)
    shared_goals = [goal for goal in all_goals if len(goal.robots) > 1]
    if not shared_goals:
        return ""
    if session.level.all_goals and len(all_goals) > 1:
        (inside, total), *_ = count_home(session.level, session.frame.after, is_open=True)
        return f" · {inside}/{total} in goals"
    goal = max(shared_goals, key=lambda goal: len(goal.inside))
    return f" · {len(goal.inside)}/{len(goal.robots)} in {one_line(goal.area_name)}"


class Timeline(OneLine, can_focus=True):
    """Shows the current tick among the known ones, and when events happened."""

    DEFAULT_CSS = """
    Timeline { height: 1; background: $background; }
    Timeline:focus { background: $panel; }
    """

    BINDINGS = [
        ("left", "screen.command('back')"),
        ("right", "screen.command('step')"),
        ("pageup", "screen.command('back_ten')"),
        ("pagedown", "screen.command('step_ten')"),
        ("home", "screen.command('first')"),
        ("end", "screen.command('last')"),
        ("up", "screen.command('previous_mark')"),
        ("down", "screen.command('next_mark')"),
    ]
    FOCUS_ON_CLICK = False
    ALLOW_SELECT = False

    @dataclass
    class TickPointed(Message):
        """The pointer is over a column; `tick` is its first tick."""

        tick: int

    def __init__(self) -> None:
        super().__init__(id="timeline")
        self._history: History | None = None
        self._span = TimelineSpan(0, 0, 0)
        self._robot: str | None = None
        self._goal_note = ""
        self._decisions: Sequence[Decision] = ()
        self._line = Content("")
        self._is_dragged = False
        self._pointed: int | None = None

    def show(self, session: Session, robot: str | None) -> None:
        """Show a session's history; without a robot, all memory changes and a goal's count."""
        history = self._history = session.history
        self._robot = robot
        self._goal_note = "" if robot is not None else _goal_note(session)
        self._decisions = session.frame.decisions
        self._span = TimelineSpan(0, 0, session.frame.tick)
        if history is not None:
            other_last = history.other_ticks[-1] if history.other_ticks else None
            diverged = history.divergence.tick if history.divergence else None
            self._span = TimelineSpan(
                history.first, history.last, self._span.tick, other_last, diverged
            )
        line = self._content_line()
        if line != self._line:
            self._line = line
            self.repaint()

    def render(self) -> Content:
        return self._line

    def on_resize(self) -> None:
        self._line = self._content_line()
        self.refresh()

    @property
    def _width(self) -> int:
        low, high = _NOTE_WIDTHS
        note = min(max(self.size.width // _NOTE_SHARE, low), high)
        return max(self.size.width - note - 2, 1)

    def _content_line(self) -> Content:
        width, robot = self._width, self._robot
        marks = self._history.marks if self._history is not None else None

        def has(kind: MarkKind, first: int, last: int) -> bool:
            return marks is not None and marks.has(kind, first, last, robot)

        line = track(self._span, width, has)
        return Content(" ").append(line).append(" ").append(self._note(self.size.width - width - 2))

    def _note(self, width: int) -> Content:
        span, history = self._span, self._history
        marks = history.marks.marks_at(span.tick) if history is not None else ()
        remarks = [(mark.kind, part) for mark in marks if (part := self._describe_mark(mark))]
        short = text = f"tick {span.tick}"
        if span.last > span.first:
            text += f" of {span.last}" if not span.first else f" of {span.first} to {span.last}"
        if not remarks:
            if history is not None and history.dropped and history.dropped <= span.first:
                text += ", no room for earlier ones"
            if len(text + self._goal_note) > width:
                text = short
            text += self._goal_note
            return Content.styled(clip(text, width), INK.dim)
        every = [part for _, part in remarks]
        # Memories change all the time.
        lasting = [part for kind, part in remarks if kind != "memory"]
        for tick, parts in ((text, every), (short, every), (short, lasting)):
            note = Content("  ").join([Content.styled(tick, INK.dim), *parts])
            if note.cell_length + len(self._goal_note) <= width:
                return note.append(Content.styled(self._goal_note, INK.dim))
        note = Content("  ").join([Content.styled(short, INK.dim), *every])
        return note if note.cell_length <= width else note.truncate(width - 1).append("…")

    def _describe_mark(self, mark: Mark) -> Content:
        sign, style, _ = SIGNS[mark.kind]
        words = ", ".join(map(one_line, mark.names))
        if mark.kind == "breakpoint" and self._history is not None:
            hits = self._history.hits_at(self._span.tick)
            words = one_line("; ".join(f"{hit.breakpoint.words}: {hit.values}" for hit in hits))
        elif mark.kind == "notice":
            notices = {
                decision.robot_name: " ".join(notice.message for notice in decision.notices)
                for decision in self._decisions
                if decision.notices
            }
            notice = next((notices[name] for name in mark.names if name in notices), "")
            is_named = len(mark.names) == 1 and mark.names[0] in notice
            words = one_line(notice if is_named else f"{words}: {notice}" if notice else words)
        elif mark.kind == "stuck":
            words += " is stuck" if len(mark.names) == 1 else " are stuck"
        elif mark.kind == "circling":
            words += " goes in circles" if len(mark.names) == 1 else " go in circles"
        elif mark.kind in ("victory", "program", "edit"):
            words = {"victory": "won", "program": "program changed", "edit": "edited"}[mark.kind]
        return Content.assemble((f"{sign} ", style), (words, INK.text))

    def on_mouse_down(self, event: events.MouseDown) -> None:
        event.stop()
        if event.button == 1 and 1 <= event.x <= self._width:
            self._is_dragged = True
            self._pointed = None
            self.capture_mouse()
            self._point(event.x)

    def on_mouse_move(self, event: events.MouseMove) -> None:
        if self._is_dragged:
            last = Scale.to_hold(self._span, self._width).column(self._span.last)
            self._point(min(max(event.x, 1), last + 1))

    def on_mouse_up(self) -> None:
        self._is_dragged = False
        self.release_mouse()

    def _point(self, x: int) -> None:
        scale = Scale.to_hold(self._span, self._width)
        tick, end = scale.ticks(x - 1)
        if tick <= self._span.last <= end:
            tick = self._span.last
        if tick != self._pointed:  # what is shown may be older than the last move
            self._pointed = tick
            self.post_message(self.TickPointed(tick))
