"""What pages of the inspector share: heading, view, message, and a query in the background."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass
from math import isclose
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Static

from logical_robots_tui.game import Frame, NoSuchTickError, Superseded
from logical_robots_tui.mind import QueryError, Table
from logical_robots_tui.tui.inspector.widgets.line_views import LinesView
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.clock import Clock
    from logical_robots_tui.explain import Node
    from logical_robots_tui.game import Inquiry
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable


MOST_ROBOTS = 100
"""With more robots, replaying a past tick would hold up the screen."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The rows of every predicate at a tick, or why there are none, and at the tick before."""

    program: Program
    frame: Frame
    tables: dict[str, Table | QueryError]
    before: dict[str, Table | QueryError]

    def count(self, predicate: str) -> str:
        table = self.tables.get(predicate)
        if not isinstance(table, Table):
            return "" if table is None else "!"
        return f"{len(table.rows)}{'+' if table.truncated else ''}"

    def differs(self, predicate: str) -> bool:
        now, before = self.tables.get(predicate), self.before.get(predicate)
        return isinstance(now, Table) and isinstance(before, Table) and now != before


class Questions:
    """Queries the robots' program; raises `Superseded` without one or after newer ones."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._level: Level | None = None
        self._asked: Inquiry | None = None
        self._surveyed: Survey | None = None

    @property
    def program(self) -> Program:
        """The program that the robots think with, or raise Superseded if there is none yet."""
        if self._session.game is None:
            raise Superseded
        return self._session.game.program

    def about(self) -> tuple[Inquiry, Program]:
        return self._inquiry(), self.program

    def is_by_another_program(self, tick: int) -> bool:
        history, program = self._session.history, self._session.program
        decided = history.program_at(tick) if history else None
        return bool(decided and program and decided.texts != program.texts)

    def is_function(self, name: str) -> bool:
        known = (each for each in self._session.predicates if each.name == name)
        return any(each.kind == "program" and each.is_function for each in known)

    async def rows(self, predicate: str, robot: str, frame: Frame) -> Table:
        """A predicate's rows, or a function's calls for a robot, or raise QueryError."""
        if self.is_function(predicate):
            return await self._inquiry().calls(self.program, robot, frame, predicate)
        game = self._session.game
        if game is None:
            raise Superseded
        return await game.query(predicate, frame)

    async def survey(self, frame: Frame) -> Survey:
        program, last = self.program, self._surveyed
        if known := self.surveyed(frame):
            return known
        inquiry = self._inquiry()
        before: dict[str, Table | QueryError] = {}
        earlier = self._frame_before(frame)
        if last is not None and last.program is program and last.frame is earlier:
            before = last.tables
        elif earlier is not None:
            before = await inquiry.survey(program, earlier)
        tables = await inquiry.survey(program, frame)
        self._surveyed = Survey(program, frame, tables, before)
        return self._surveyed

    def surveyed(self, frame: Frame) -> Survey | None:
        """Return the survey of a frame if it is known; never computes one."""
        last, game = self._surveyed, self._session.game
        if last is None or game is None:
            return None
        return last if last.frame is frame and last.program is game.program else None

    async def close(self) -> None:
        inquiry, self._asked = self._asked, None
        if inquiry is not None:
            await inquiry.close()

    def _inquiry(self) -> Inquiry:
        from logical_robots_tui.game import Inquiry

        level = self._session.level
        seen_alike = self._level is not None and self._level.visibility == level.visibility
        if self._asked is None or not seen_alike:
            old, self._level = self._asked, level
            if old is not None:
                self._session.release(old.close)
            self._asked = Inquiry(self._level)
            self._surveyed = None
        return self._asked

    def _frame_before(self, frame: Frame) -> Frame | None:
        game = self._session.game
        if game is None or frame.tick == 0 or len(frame.sensors) > MOST_ROBOTS:
            return None
        if self._surveyed is not None and self._surveyed.frame.after is frame.before:
            return self._surveyed.frame
        try:
            return game.frame_at(frame.tick - 1)
        except NoSuchTickError:
            return None


NO_PROGRAM = "There is no program to query yet."


class Page(Vertical):
    """Shows one thing about the current tick; `pending` is the query that escape cancels."""

    DEFAULT_CSS = """
    Page { height: 1fr; }
    Page > .heading { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    Page > .message { height: auto; padding: 1 2; display: none; }
    """

    title: ClassVar[str]
    replays = True
    """Whether it computes past ticks with the current program, which may not have decided them."""

    @dataclass
    class Ready(Message):
        """A hidden page has something to show."""

        page: Page

    class Changed(Message):
        """The page has something else to show for the same tick."""

    @dataclass
    class Opened(Message):
        """The player followed a link to a predicate, a query or another page."""

        name: str

    @dataclass
    class Left(Message):
        """The player returned to what was shown before this page."""

        name: str

    def __init__(
        self,
        session: Session,
        questions: Questions,
        view: Widget,
        *,
        above: Sequence[Widget] = (),
        below: Sequence[Widget] = (),
    ) -> None:
        self._session, self._questions = session, questions
        self._heading = Static(classes="heading")
        self._message = Static(classes="message")
        self.view = view
        middle = () if view in above else (view,)
        children = (self._heading, *above, self._message, *middle, *below)
        super().__init__(*children, id=type(self).__name__)
        self.robot = ""
        self.table: ValueTable | None = None
        self.pending = BackgroundQuery(session.clock)

    @property
    def depends_on_robot(self) -> bool:
        return False

    async def show(self, frame: Frame) -> None:
        """Show a tick; cancelled when another tick or page is wanted."""
        raise NotImplementedError

    def show_survey(self, survey: Survey) -> None:
        """Use the rows of all predicates at the current tick, which have just been counted."""

    def head(self, tick: int, more: str = "", title: str = "") -> None:
        name = Content.styled(one_line(title or self.title), f"bold {INK.title}")
        parts = [name, Content(f"tick {tick}"), *([Content(more)] if more else [])]
        if self.replays and self._questions.is_by_another_program(tick):
            parts.append(Content.styled("by the current program", INK.warn))
        self._heading.update(Content(" · ").join(parts), layout=False)
        if not self.display:
            self.post_message(self.Ready(self))

    def redraw(self) -> None:
        """Draw now: Textual loses the resize of a widget that is shown while another scrolls."""
        if isinstance(self.view, LinesView):
            self.view.redraw()
        if self.table is not None:
            self.table.redraw()

    def say(self, words: Content | str) -> None:
        content = words if isinstance(words, Content) else Content.styled(one_line(words), INK.warn)
        self._message.update(content)
        self._message.display = bool(content)


T = TypeVar("T")

_INTERVAL = 0.1  # seconds between two steps of the spinner; quicker queries show none
_SPINNER = "▖▘▝▗"


class Cancelled(Exception):  # noqa: N818 - the player's wish, and no error
    """The player has cancelled the query."""


class BackgroundQuery:
    """Waits for one answer at a time; `seconds` is how long the last query ran so far."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.seconds = 0.0
        self._task: asyncio.Future[Any] | None = None

    @property
    def is_long(self) -> bool:
        """Whether a query has been running long enough to show its progress."""
        return self._task is not None and self.seconds > 0

    async def run(self, work: Coroutine[Any, Any, T], report: Callable[[], None]) -> T:
        """Run a query, reporting ten times a second; raise Cancelled after `cancel`."""
        task = asyncio.ensure_future(work)
        self._task, self.seconds = task, 0.0
        began = self._clock.now()
        try:
            while not (await asyncio.wait({task}, timeout=_INTERVAL))[0]:
                self.seconds = self._clock.now() - began
                report()
            if task.cancelled():
                raise Cancelled
            return task.result()
        finally:
            task.cancel()
            if self._task is task:
                self._task = None

    def cancel(self) -> None:
        if self._task is not None:
            self._task.cancel()


def progress(what: str, seconds: float) -> Content:
    spin = _SPINNER[int(seconds / _INTERVAL) % len(_SPINNER)]
    return Content.assemble(
        (f"{spin} ", INK.key),
        (one_line(what), INK.text),
        (f"  {seconds:.1f} s", INK.number),
        ("  esc here stops it", INK.dim),
    )


@dataclass
class Placed(Message):
    """Highlight a place: offsets of its first character and behind its last one."""

    program: str
    place: tuple[int, int]


@dataclass
class Sighted(Message):
    """Highlight a robot or a ray in the labyrinth, or nothing."""

    highlight: Highlight | None
    frame: Frame


def sight(node: Node, robot: str, frame: Frame) -> Highlight | None:
    """The robot or ray that a proof's node is about; of equal rays, that of `robot`."""
    if node.robot:
        return Highlight(node.robot)
    if node.ray is None or len(node.values) > 1:
        return None
    value = node.values[0]
    assert isinstance(value, Mapping)
    for row in sorted(frame.sensors, key=lambda row: row["robot_name"] != robot):
        for ray in row["sensor"]["radar"]:
            # SQLite may change the last digits of an angle.
            if isclose(node.ray, ray["angle"], abs_tol=1e-9) and value == {
                **ray,
                "angle": node.ray,
            }:
                return Highlight(row["robot_name"], ray["angle"])
    return None


def definition(program: Program | None, name: str) -> Placed | None:
    predicate = None if program is None else program.predicate(name)
    if program is None or predicate is None or predicate.line is None:
        return None
    lines = program.text.split("\n")
    start = sum(len(line) + 1 for line in lines[: predicate.line - 1])
    return Placed(program.text, (start, start + len(name)))
