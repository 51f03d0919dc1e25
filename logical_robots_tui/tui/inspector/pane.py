"""The inspector: the robots, why they did it, answers, or the rows of any predicate, at a tick."""

from __future__ import annotations

import asyncio
from importlib import import_module
from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.message import Message
from textual.widgets import OptionList, Static

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import QueryError, Table
from logical_robots_tui.tui.background import in_background
from logical_robots_tui.tui.inspector.answers import NO_PROGRAM, counted, shown_rows
from logical_robots_tui.tui.inspector.choice import (
    ASK,
    DECISION,
    DIAGNOSIS,
    ROBOTS,
    WATCH,
    WHY,
    Choice,
)
from logical_robots_tui.tui.inspector.questions import Questions
from logical_robots_tui.tui.inspector.robots import RobotsView
from logical_robots_tui.tui.pane import Pane
from logical_robots_tui.tui.plain import one_line
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from textual.widget import Widget
    from textual.worker import Worker

    from logical_robots_tui.game import Frame
    from logical_robots_tui.tui.inspector.arranging import Arrangement
    from logical_robots_tui.tui.inspector.pages import Pages
    from logical_robots_tui.tui.inspector.questions import Survey
    from logical_robots_tui.tui.inspector.table import ValueTable
    from logical_robots_tui.tui.inspector.watch import WatchView
    from logical_robots_tui.tui.inspector.why import WhyView
    from logical_robots_tui.tui.session import Session

__all__ = ["InspectorPane"]

_PAUSE = 0.25  # seconds between two pictures while the game runs
_AT_LEISURE = 0.2  # seconds until what may be wanted is loaded


class InspectorPane(Pane):
    """Follows the tick on the screen, a few times a second while the game runs.

    Args:
        session: Whom to ask.
    """

    command_id: ClassVar[str] = "inspector"

    class Placed(Message):
        """What the cursor is on stands at a place in the program.

        Attributes:
            program: The program's text.
            place: Offset of its first character, and offset behind its last one.
        """

        def __init__(self, program: str, place: tuple[int, int]) -> None:
            super().__init__()
            self.program, self.place = program, place

    DEFAULT_CSS = """
    InspectorPane #subject { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    InspectorPane #views { width: 1fr; }
    InspectorPane #said { padding: 1 2; }
    InspectorPane ValueTable, InspectorPane RobotsView, InspectorPane #decision { margin: 0 1; }
    InspectorPane #value {
        height: auto; max-height: 40%; border-top: solid $ink-faint; padding: 0 1;
    }
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._choice = Choice()
        self._subject = Static(id="subject")
        self.robots = RobotsView()
        self.questions = Questions(session)
        self._said = Static(id="said")
        self._views = Vertical(self._subject, self.robots, self._said, id="views")
        super().__init__(Horizontal(self._choice, self._views), title="Inspector")
        self._pages: Pages | None = None
        self._inspected = ROBOTS
        self._robot: str | None = None
        self._survey: Survey | None = None
        self._stale = False
        self._follower: Worker[None] | None = None

    @property
    def pages(self) -> Pages:
        """The pages besides that of the robots."""
        if self._pages is None:
            from logical_robots_tui.tui.inspector.pages import Pages

            self._pages = Pages(self._session, self.questions)
            self._pages.asking.knows(self._session.predicates)
            self._views.mount(*self._pages.widgets)
        return self._pages

    async def _load_pages(self) -> None:
        """Have the pages ready before they are wanted; keys are answered meanwhile."""
        await asyncio.sleep(_AT_LEISURE)
        await asyncio.to_thread(import_module, "logical_robots_tui.tui.inspector.pages")
        if self._views.is_attached:  # the player may have left meanwhile
            _ = self.pages

    @property
    def table(self) -> ValueTable:
        """The rows of a predicate."""
        return self.pages.table

    @property
    def pins(self) -> WatchView:
        """What is pinned."""
        return self.pages.pins

    @property
    def inspected(self) -> str:
        """What is being inspected: `ROBOTS` or the name of a predicate."""
        return self._inspected

    def on_mount(self) -> None:
        """Begin with the robots; the other pages can wait until the first picture stands."""
        in_background(self, self._load_pages, "pages")
        self._list_predicates()
        self._show_only(self.robots)
        self.follow()

    def on_show(self) -> None:
        """Catch up after having been hidden."""
        self.follow()

    async def on_unmount(self) -> None:
        """Stop asking."""
        await self.questions.close()

    def enter(self) -> None:
        """Put the focus on the list of predicates."""
        self.screen.set_focus(self._choice)

    def choose(self, robot_name: str) -> None:
        """Tell of a robot from now on, where one is told of."""
        self._robot = robot_name
        self.robots.choose(robot_name)
        if self._inspected in (DECISION, WHY):
            self.follow()

    def why(self) -> None:
        """Go to why the predicate that is inspected has its rows, or why the robot did it."""
        own = {p.name for p in self._session.predicates if p.kind == "program"}
        self.pages.reasons.begin(self._inspected if self._inspected in own else "Robot")
        self._enter_page(WHY)

    def ask(self, query: str = "") -> None:
        """Go to the line for queries, and ask one if it is given."""
        self._enter_page(ASK)
        self.pages.asking.put(query)

    def go_to_pins(self) -> None:
        """Go to what is pinned."""
        self._enter_page(WATCH)

    def diagnose(self) -> None:
        """Go to what stands out in the whole run."""
        self._enter_page(DIAGNOSIS)

    @property
    def shown_table(self) -> ValueTable | None:
        """The table on the screen, or None if there is none."""
        pages = self.pages
        if pages.table.display:
            return pages.table
        return pages.asking.table if pages.asking.display and pages.asking.table.display else None

    def rearrange(self, how: Arrangement) -> None:
        """Show the rows of the table on the screen in another way."""
        table = self.shown_table
        if table is not None:
            table.rearrange(how)
            self.follow()

    @property
    def robot(self) -> str:
        """Name of the robot that is told of."""
        names = [robot.name for robot in self._session.level.robots]
        return self._robot if self._robot in names else names[0]

    def inspect(self, name: str) -> None:
        """Show `ROBOTS` or the rows of a predicate."""
        self._inspected = name
        if self._follower is not None:
            self._follower.cancel()  # it may be waiting for rows that nobody wants any more
            self._follower = None
        self.follow()

    def open(self, name: str) -> None:
        """Go to the rows of a predicate."""
        if name in self._choice.names:
            self._go_to_page(name)
            self.enter()
        else:
            self.notify(f"The program has no predicate {name}.", markup=False)

    def follow(self) -> None:
        """Show the present tick, at once or, while the game runs, within a moment."""
        if self._choice.predicates != self._session.predicates:
            self._list_predicates()
        self._stale = True
        if self.display and (self._follower is None or self._follower.is_finished):
            self._follower = in_background(self, self._catch_up, "inspect")

    async def _catch_up(self) -> None:
        # The tick comes to the screen before what there is to say about it.
        await self.wait_for_refresh()
        while self._stale and self.display:
            self._stale = False
            frame = self._session.frame
            if self._inspected == ROBOTS:
                self._show_robots(frame)
            elif self._inspected == DECISION:
                self._show_decision(frame)
            elif self._inspected == WHY:
                await self._show_reasons(frame)
            elif self._inspected == ASK:
                await self._show_answer(frame)
            elif self._inspected == WATCH:
                self._say_subject("Watch", frame.tick, "")
                self._show_only(self.pages.pins)
                await self.pages.watching.follow(frame)
            elif self._inspected == DIAGNOSIS:
                self._say_subject("Diagnosis", frame.tick, "")
                self._show_only(self.pages.diagnosis)
                self.pages.diagnosis.follow()
            else:
                await self._show_rows(self._inspected, frame)
            if self._session.running:
                await asyncio.sleep(_PAUSE)
            else:
                await self._take_survey(frame)

    def _show_robots(self, frame: Frame) -> None:
        self._say_subject("Robots", frame.tick, "")
        self._show_only(self.robots)
        self.robots.show(self._session.level, frame)

    def _show_decision(self, frame: Frame) -> None:
        robot = self.robot
        self._say_subject(f"Decision of {robot}", frame.tick, "")
        self._show_only(self.pages.decision)
        survey = self._survey if self._survey and self._survey.frame is frame else None
        self.pages.decision.show(self._session.program, frame, robot, survey)

    async def _show_reasons(self, frame: Frame) -> None:
        if self._session.game is None:
            self._say("Why", frame.tick, NO_PROGRAM)
            return
        self._say_subject("Why", frame.tick, "" if frame.tick else "nobody has thought yet")
        self._show_only(self.pages.reasons)
        await self.pages.reasons.follow(self.robot, frame)

    async def _show_answer(self, frame: Frame) -> None:
        self._say_subject("Ask", frame.tick, "")
        self._show_only(self.pages.asking)
        table = await self.pages.asking.follow(frame)
        if table is not None:
            self._say_subject("Ask", frame.tick, counted(table))

    async def _take_survey(self, frame: Frame) -> None:
        """Count the rows of every predicate, and see which differ from those of the tick before."""
        if not self.display:
            return
        try:
            survey = await self.questions.survey(frame)
        except Superseded:
            return
        if survey is not self._survey and survey.frame is self._session.frame:
            self._survey = survey
            self._choice.count(survey)
            if self._inspected == DECISION:
                self._show_decision(frame)
            table = survey.tables.get(self._inspected)
            if isinstance(table, Table) and self.table.display:
                self._show_table(self._inspected, frame, table)

    async def _show_rows(self, name: str, frame: Frame) -> None:
        try:
            table = await self._session.query(name, frame)
        except Superseded:
            if self._session.game is None:
                self._say(name, frame.tick, NO_PROGRAM)
            return
        except QueryError as error:
            if name == self._inspected:
                self._say(name, frame.tick, str(error))
            return
        if name == self._inspected:
            self._show_table(name, frame, table)

    def _show_table(self, name: str, frame: Frame, table: Table) -> None:
        more = self.table.how.words
        self._say_subject(name, frame.tick, counted(table) + (f", {more}" if more else ""))
        self._show_only(self.table)
        columns, rows = shown_rows(table)
        survey = self._survey
        known = survey.before.get(name) if survey is not None and survey.frame is frame else None
        self.table.show(columns, rows, shown_rows(known)[1] if isinstance(known, Table) else None)

    def _say(self, name: str, tick: int, message: str) -> None:
        self._say_subject(name, tick, "")
        self._said.update(Content(one_line(message)))
        self._show_only(self._said)

    def _say_subject(self, name: str, tick: int, more: str) -> None:
        parts = [Content.styled(one_line(name), f"bold {INK.title}"), Content(f"tick {tick}")]
        if more:
            parts.append(Content(more))
        if self._inspected != ROBOTS and self.questions.is_by_another_program(tick):
            parts.append(Content.styled("by the present program", INK.warn))
        self._subject.update(Content(" · ").join(parts), layout=False)

    def _go_to_page(self, page: str) -> None:
        self._choice.go_to(page)
        self.inspect(page)

    def _enter_page(self, page: str) -> None:
        self._go_to_page(page)
        self.screen.set_focus(self.pages.entered(page))

    def _show_only(self, view: Widget) -> None:
        for each in (self.robots, self._said):
            each.display = each is view
        if self._pages is not None:
            self._pages.show_only(view)

    def _list_predicates(self) -> None:
        self._survey = None
        self._choice.list(self._session.predicates, self._inspected)
        if self._pages is not None:
            self._pages.asking.knows(self._session.predicates)

    @on(OptionList.OptionHighlighted)
    def _choice_moved(self, event: OptionList.OptionHighlighted) -> None:
        event.stop()
        if event.option_id is not None and event.option_id != self._inspected:
            self.inspect(event.option_id)
            self._place_definition(event.option_id)

    @on(OptionList.OptionSelected)
    def _choice_made(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        view = self.robots if self._inspected == ROBOTS else self.pages.entered(self._inspected)
        if view.display:
            view.focus()

    def _place_definition(self, name: str) -> None:
        """Show where a predicate is defined."""
        program = self._session.program
        predicate = program.predicate(name) if program is not None else None
        if program is not None and predicate is not None and predicate.line is not None:
            before = program.text.split("\n")[: predicate.line - 1]
            start = sum(len(line) + 1 for line in before)
            self._place(start, start + len(name))

    def _place(self, start: int, stop: int) -> None:
        if self._session.program is not None:
            self.post_message(self.Placed(self._session.program.text, (start, stop)))

    # Messages of the pages go by the names of methods: to name the classes would load them.

    def on_why_view_pointed(self, event: WhyView.Pointed) -> None:
        """Show the place in the program that a reason comes from."""
        event.stop()
        if event.line.span is not None:
            self._place(event.line.span.start, event.line.span.stop)

    def on_reasons_page_asked(self, event: Message) -> None:
        """Answer."""
        event.stop()
        self.follow()

    on_ask_view_asked = on_watch_view_changed = on_reasons_page_asked

    def on_watch_view_opened(self, event: WatchView.Opened) -> None:
        """Go to the rows of a predicate that is pinned, or ask the question that is."""
        event.stop()
        (self.open if event.predicate.isidentifier() else self.ask)(event.predicate)

    def on_value_table_pointed(self, event: Message) -> None:
        """Tell the value under the cursor."""
        event.stop()
        self.pages.tell_value()
