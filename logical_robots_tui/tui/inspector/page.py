"""What the pages of the inspector share, and what commands may ask of each."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, TypeAlias, TypeVar

from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Static

from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.questions import (
    NO_PROGRAM,
    BackgroundQuery,
    Cancelled,
    InspectorQuestions,
    Survey,
)
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask
    from logical_robots_tui.explain.why.explanation import Subject
    from logical_robots_tui.game import Breakpoint, Inquiry, Path, Pin
    from logical_robots_tui.mind import Program
    from logical_robots_tui.tui.inspector.table import ValueTable
    from logical_robots_tui.tui.inspector.value_tree import ValueBranch
    from logical_robots_tui.values import Value

T = TypeVar("T")

Scope: TypeAlias = Literal["always", "robot", "predicate", "value"]
"""What a page shows something for: a page "for a robot" does it for the one that is chosen.

The pages for nothing in particular and for a robot are in the list of the inspector, the one for
a predicate is shown for each predicate there, and one for a value when a command asks for it.
"""


class Traced(NamedTuple):
    """A value in a robot's reasoning at a tick, to be traced to its origin.

    A part of a memory is the one after the tick; tick 0 is the start.
    """

    robot: str
    subject: Subject
    tick: int


class PageEntry(NamedTuple):
    """Describes a page before its module, `pages/` and the page's id, is loaded."""

    id: str
    """Unlike the name of a predicate, it begins with a small letter."""
    title: str
    scope: Scope
    widget: str
    """The name of its class."""

    @property
    def is_listed(self) -> bool:
        return self.scope in ("always", "robot")

    def load(self) -> Callable[[PageEntry, InspectorQuestions], Page]:
        module = import_module(f"logical_robots_tui.tui.inspector.pages.{self.id}")
        widget: Callable[[PageEntry, InspectorQuestions], Page] = getattr(module, self.widget)
        return widget


class Page(Vertical):
    """Shows one thing about the current tick; `pending` is the query that escape cancels.

    What commands ask of it are the methods whose names end in ``here``: about the value, row or
    line under the cursor. By default there is none.
    """

    DEFAULT_CSS = """
    Page { height: 1fr; }
    Page > .heading { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    Page > .about {
        height: 1; padding: 0 1; color: $ink-dim; display: none;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    Page > .message { height: auto; padding: 1 2; display: none; }
    """

    beside: ClassVar[str] = "decision"
    """The page beside it in a wide inspector."""
    replays: ClassVar[bool] = True
    """Whether it computes past ticks with the current program, which may not have decided them."""
    fills: ClassVar[bool] = False
    """Whether it shows more where there is more room."""
    table: ValueTable | None = None
    predicate = ""
    """The predicate whose rows the page shows, or ""."""

    @dataclass
    class Ready(Message):
        """A hidden page has something to show."""

        page: Page

    class Changed(Message):
        """The page has something else to show for the same tick."""

    @dataclass
    class LinkOpened(Message):
        """The player followed a link to a predicate or a query."""

        name: str

    @dataclass
    class Left(Message):
        """The player returned to what was shown before this page."""

        name: str

    def __init__(
        self,
        entry: PageEntry,
        questions: InspectorQuestions,
        view: Widget,
        *,
        above: Sequence[Widget] = (),
        below: Sequence[Widget] = (),
    ) -> None:
        self.entry = entry
        self._session, self._questions = questions.session, questions
        self._heading = Static(classes="heading")
        self._about = Static(classes="about")
        self._message = Static(classes="message")
        self.view = view
        middle = () if view in above else (view,)
        children = (self._heading, *above, self._about, self._message, *middle, *below)
        super().__init__(*children, id=type(self).__name__)
        self.pending = BackgroundQuery(self._session.clock)

    @property
    def robot(self) -> str:
        return self._questions.robot

    @property
    def depends_on_robot(self) -> bool:
        return self.entry.scope == "robot"

    # -- what a page shows ---------------------------------------------------------------------

    def begin(self, subject: Any) -> None:
        """Begin with what a command asks for: a predicate, a query, a pin, a value to trace."""
        raise NotImplementedError

    def forget(self) -> None:
        """Forget what is about a level that is left."""

    async def show(self, frame: Frame) -> None:
        """Show a tick; cancelled when another tick or page is wanted."""
        raise NotImplementedError

    def show_survey(self, survey: Survey) -> None:
        """Use the rows of all predicates at the current tick, which have just been counted."""

    async def answer(
        self,
        ask: Callable[[Inquiry, Program], Coroutine[Any, Any, T]],
        doing: Callable[[], str],
        say: Callable[[Content | str], None],
    ) -> T | None:
        """Query in the background; without an answer say why, and return None.

        A long query says what it is `doing`; a superseded one says nothing.
        """
        try:
            return await self.pending.run(ask(*self._questions.context()), doing, say)
        except Superseded:
            if self._session.game is None:
                say(NO_PROGRAM)
        except Cancelled:
            say(self.stopped())
        except QueryError as error:
            say(str(error))
        return None

    def stopped(self) -> str:
        """The player has cancelled a query; return what to say about it."""
        return f"Stopped after {self.pending.seconds:.1f} s."

    def head(self, tick: int, remark: str = "", title: str = "") -> None:
        name = Content.styled(one_line(title or self.entry.title), f"bold {INK.title}")
        # While robots run, the number at the top of the screen is the newer one.
        tick_part = [] if self._session.running else [Content(f"tick {tick}")]
        parts = [name, *tick_part, *([Content(remark)] if remark else [])]
        history, program = self._session.history, self._session.program
        decider = history.program_at(tick) if history else None
        if self.replays and decider and program and decider.texts != program.texts:
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

    def caption(self, content: Content) -> None:
        """Show what the page is about, above everything else."""
        self._about.update(content, layout=not self._about.display)
        self._about.display = bool(content)

    def say(self, words: Content | str) -> None:
        """Show a message instead of content; "" removes it."""
        content = words if isinstance(words, Content) else Content.styled(one_line(words), INK.warn)
        self._message.update(content)
        self._message.display = bool(content)

    def on_value_table_rearranged(self) -> None:
        self.post_message(self.Changed())

    # -- what commands ask of it ---------------------------------------------------------------

    @property
    def table_here(self) -> ValueTable | None:
        return self.table if self.display and self.table and self.table.display else None

    def pin_here(self) -> Pin | None:
        return None

    def values_here(self) -> tuple[str, Sequence[ValueBranch]]:
        """Return a title and what to open as a tree."""
        return "", ()

    def row_here(self) -> tuple[Mapping[str, Value], str] | None:
        """The row of `predicate` under the cursor, and the cursor's column."""
        table = self.table_here
        if table is None or not table.has_focus or table.place is None or not self.predicate:
            return None
        number, column = table.place
        return dict(zip(table.all.columns, table.all.rows[number], strict=True)), column

    def traced_here(self) -> Traced | None:
        if (row := self.row_here()) is None:
            return None
        return traced_value(self.predicate, *row, self.robot, self._session.frame.tick)

    def breakpoint_here(self) -> Breakpoint | None:
        return None

    def breakpoint_at(self, predicate: str, robot: str, column: str = "") -> Breakpoint | None:
        """Return one at which rows of a predicate change; None if it has no rows of its own."""
        matches = (entry for entry in self._session.predicates if entry.name == predicate)
        if not any(entry.has_rows for entry in matches):
            return None
        from logical_robots_tui.game import Breakpoint

        return Breakpoint("change", predicate, robot, column)

    async def change_values_here(self) -> None:
        """Let the player change values of a line of a proof, and ask why again."""
        words = with_keys("Put the cursor on a line of a proof; {why} makes one.")
        self.notify(words, markup=False)


class RobotPage(Page):
    """Stands for the robot's decision and memory where nothing is under the cursor."""

    def pin_here(self) -> Pin | None:
        from logical_robots_tui.game import Pin

        return Pin("Memory", "memory", (("robot_name", self.robot),))

    def values_here(self) -> tuple[str, Sequence[ValueBranch]]:
        from logical_robots_tui.game import Pin
        from logical_robots_tui.tui.inspector.value_tree import ValueBranch

        frame, robot, whose = self._session.frame, self.robot, (("robot_name", self.robot),)
        sensor = next(row["sensor"] for row in frame.sensors if row["robot_name"] == robot)
        memory_before, decision = frame.memories_before.get(robot), frame.decision_of(robot)
        branches = [
            ValueBranch("sensor", sensor, Pin("Sensor", "sensor", whose)),
            ValueBranch("memory before", memory_before, Pin("Memory", "memory", whose)),
        ]
        if decision is not None and (desire := decision.desire) is not None:
            engines = {"left_engine": desire.left_engine, "right_engine": desire.right_engine}
            branches.append(ValueBranch("desire", engines, Pin("Robot", "desire", whose)))
        if decision is not None:
            pin = Pin("Robot", "memory", whose)
            branches.append(ValueBranch("memory after", decision.memory, pin))
        return f"Decision of {robot}", branches

    def traced_here(self) -> Traced | None:
        from logical_robots_tui.explain.why.explanation import Subject

        return Traced(self.robot, Subject(), self._session.frame.tick)


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


def traced_pin(pin: Pin | None, robot: str, tick: int) -> Traced | None:
    """The value that a pin reads, in the reasoning of its robot or else of a given one."""
    if pin is None or pin.is_question or not pin.column:
        return None
    return traced_value(pin.predicate, dict(pin.where), pin.column, robot, tick, pin.path)


def traced_value(
    predicate: str, row: Mapping[str, Value], column: str, robot: str, tick: int, path: Path = ()
) -> Traced | None:
    """A value of a row, in the reasoning of the row's robot or else of a given one.

    `Memory` holds memories as of the tick before, `Robot` as of this tick.
    """
    from logical_robots_tui.explain.why.explanation import Subject

    subject = Subject(path=path)
    whose, call = row_call(predicate, row, robot)
    if predicate == "Sensor":
        return None
    if predicate == "Memory":
        return Traced(whose, subject, max(0, tick - 1)) if column == "memory" else None
    if predicate == "Robot" and column == "memory":
        return Traced(whose, subject, tick)
    return Traced(whose, replace(subject, query=call, column=column), tick)


def row_call(predicate: str, row: Mapping[str, Value], robot: str) -> tuple[str, Ask]:
    """Return in whose reasoning a row is, or else a given robot, and the row as a question."""
    from logical_robots_tui.explain import Ask
    from logical_robots_tui.game import MIND

    viewer = next((row[name] for name in (MIND, "robot_name") if name in row), None)
    call = Ask(predicate, {name: value for name, value in row.items() if name != MIND})
    return viewer if isinstance(viewer, str) else robot, call
