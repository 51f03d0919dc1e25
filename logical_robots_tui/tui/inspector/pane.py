"""The inspector: the robots, why they did it, answers, or the rows of any predicate, at a tick."""

from __future__ import annotations

import asyncio
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.binding import Binding
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.widgets import OptionList, Static

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import QueryError, Table
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.inspector.answers import NO_PROGRAM, counted, shown_rows
from logical_robots_tui.tui.inspector.choice import (
    ASK,
    DECISION,
    DIAGNOSIS,
    ORIGIN,
    ROBOTS,
    WATCH,
    WHY,
    Choice,
)
from logical_robots_tui.tui.inspector.pages.robots import RobotsView
from logical_robots_tui.tui.inspector.pointing import Sighted, definition
from logical_robots_tui.tui.inspector.questions import Questions
from logical_robots_tui.tui.layout.pane import Pane
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from textual.message import Message
    from textual.widget import Widget
    from textual.worker import Worker

    from logical_robots_tui.game import Frame
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.page_loader import Pages
    from logical_robots_tui.tui.inspector.pages.origin import OriginPage
    from logical_robots_tui.tui.inspector.pages.watch import WatchView
    from logical_robots_tui.tui.inspector.questions import Survey
    from logical_robots_tui.tui.inspector.remembered import Remembered
    from logical_robots_tui.tui.inspector.widgets.arranging import Arrangement
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

__all__ = ["InspectorPane"]

_PAUSE = 0.25  # seconds between two pictures while the game runs
_AT_LEISURE = 0.2  # seconds until what may be wanted is loaded


class InspectorPane(Pane):
    """Follows the tick on the screen, a few times a second while the game runs.

    Args:
        session: Whom to ask.
    """

    command_id: ClassVar[str] = "inspector"

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("escape", "stop", show=False),
    ]

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
        self._following: Frame | None = None
        self._stale = False
        self._follower: Worker[None] | None = None

    @property
    def pages(self) -> Pages:
        """The pages besides that of the robots."""
        if self._pages is None:
            from logical_robots_tui.tui.inspector.page_loader import Pages

            self._pages = Pages(self._session, self.questions)
            self._pages.asking.knows(self._session.predicates)
            self._views.mount(*self._pages.widgets)
        return self._pages

    async def _load_pages(self) -> None:
        """Have the pages ready before they are wanted; keys are answered meanwhile."""
        await asyncio.sleep(_AT_LEISURE)
        await asyncio.to_thread(import_module, "logical_robots_tui.tui.inspector.page_loader")
        _ = self._views.is_attached and self.pages  # the player may have left meanwhile

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
        if self._inspected in (DECISION, WHY) or self.is_function:
            self._give_up()
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

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave escape to others where nothing is under way."""
        del parameters
        return action != "stop" or (self._pages is not None and self._pages.waiting is not None)

    def action_stop(self) -> None:
        """Give up the answer that is under way."""
        if waiting := self.pages.waiting:
            waiting.stop()

    def follow_back(self, asked: Remembered | None) -> None:
        """Go to where a value comes from, or to what was last asked."""
        self.pages.origin.come_from(self._inspected, asked)
        self.inspect(ORIGIN)
        self.screen.set_focus(self.pages.origin.view)

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

    @property
    def is_function(self) -> bool:
        """Whether a function of the program is inspected, which has calls in place of rows."""
        return self.questions.is_function(self._inspected)

    def inspect(self, name: str) -> None:
        """Show `ROBOTS` or the rows of a predicate."""
        self._inspected = name
        if name != WHY:
            self.post_message(Sighted(None, self._session.frame))
        self._give_up()
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
        if not self._session.running and self._following is not self._session.frame:
            self._give_up()
        if self.display and (self._follower is None or self._follower.is_finished):
            self._follower = in_background(self, self._catch_up, "inspect")

    def _give_up(self) -> None:
        """Cancel what is under way: it may be waiting for what nobody wants any more."""
        if self._follower is not None:
            self._follower.cancel()
            self._follower = None

    async def _catch_up(self) -> None:
        # The tick comes to the screen before what there is to say about it.
        await self.wait_for_refresh()
        while self._stale and self.display:
            self._stale = False
            frame = self._following = self._session.frame
            if self._inspected == ROBOTS:
                self._show_robots(frame)
            elif self._inspected in (DECISION, WHY, ASK, WATCH, DIAGNOSIS, ORIGIN):
                await self._show_page(self._inspected, frame)
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

    async def _show_page(self, page: str, frame: Frame) -> None:
        if page == WHY and self._session.game is None:
            self._say("Why", frame.tick, NO_PROGRAM)
            return
        title, view = self.pages.shown(page, self.robot)
        told = partial(self._say_subject, title, frame.tick)
        if not view.display:
            told("")
            self._show_only(view)
        await self.pages.follow(page, self.robot, frame, self._survey, told)

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
                await self._show_page(DECISION, frame)
            table = survey.tables.get(self._inspected)
            if isinstance(table, Table) and self.pages.table.display:
                self._show_table(self._inspected, frame, table)

    async def _show_rows(self, name: str, frame: Frame) -> None:
        try:
            table = await self.questions.rows(name, self.robot, frame)
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
        is_function = self.is_function
        what = counted(table, "call", f" of {self.robot}") if is_function else counted(table)
        more = self.pages.table.how.words
        self._say_subject(name, frame.tick, ", ".join(filter(None, (what, more))))
        self._show_only(self.pages.table)
        columns, rows = shown_rows(table)
        survey = self._survey if self._survey and self._survey.frame is frame else None
        known = survey.before.get(name) if survey is not None else None
        before = shown_rows(known)[1] if isinstance(known, Table) else None
        self.pages.table.show(columns, rows, before, are_all=not table.truncated)

    def _say(self, name: str, tick: int, message: str) -> None:
        self._say_subject(name, tick, "")
        self._said.update(Content(one_line(message)))
        self._show_only(self._said)

    def _say_subject(self, name: str, tick: int, more: str) -> None:
        title = Content.styled(one_line(name), f"bold {INK.title}")
        parts = [title, Content(f"tick {tick}"), *([Content(more)] if more else [])]
        if self._inspected != ROBOTS and self.questions.is_by_another_program(tick):
            parts.append(Content.styled("by the present program", INK.warn))
        self._subject.update(Content(" · ").join(parts), layout=False)

    def _go_to_page(self, page: str) -> None:
        self._choice.go_to(page)
        self.inspect(page)

    def _enter_page(self, page: str) -> None:
        self._go_to_page(page)
        self.screen.set_focus(self.pages.view_of(page))

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
            if place := definition(self._session.program, event.option_id):
                self.post_message(place)

    @on(OptionList.OptionSelected)
    def _choice_made(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        view = self.robots if self._inspected == ROBOTS else self.pages.view_of(self._inspected)
        if view.display:
            view.focus()

    # Messages of the pages go by the names of methods: to name the classes would load them.
    def on_reasons_page_asked(self, event: Message) -> None:
        """Answer."""
        event.stop()
        self._give_up()
        self.follow()

    on_ask_view_asked = on_watch_view_changed = on_reasons_page_asked

    def on_watch_view_opened(self, event: WatchView.Opened) -> None:
        """Go to the rows of a predicate that is pinned, or ask the question that is."""
        event.stop()
        (self.open if event.predicate.isidentifier() else self.ask)(event.predicate)

    def on_origin_page_opened(self, event: Message) -> None:
        """Say why the robot did what it did at the tick to which the page has gone."""
        event.stop()
        self.why()

    def on_origin_page_left(self, event: OriginPage.Left) -> None:
        """Go back to where an origin was asked."""
        event.stop()
        self._go_to_page(event.page if event.page in self._choice.names else ROBOTS)
        self.enter()

    def on_value_table_pointed(self, event: Message) -> None:
        """Tell the value under the cursor."""
        event.stop()
        self.pages.tell_value()
