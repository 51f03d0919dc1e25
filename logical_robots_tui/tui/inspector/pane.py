"""The inspector: a list of pages and predicates, and what the selected one says about a tick."""

from __future__ import annotations

import asyncio
from importlib import import_module
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Horizontal
from textual.widgets import OptionList
from textual.worker import Worker

from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.page import Page, Questions, Sighted, Survey, definition
from logical_robots_tui.tui.inspector.pages.robots import RobotsPage
from logical_robots_tui.tui.inspector.predicate_list import (
    ASK,
    DECISION,
    DIAGNOSIS,
    ORIGIN,
    ROBOTS,
    WATCH,
    WHY,
    PredicateList,
)
from logical_robots_tui.tui.layout.arrangement import Pane

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.inspector.page_loader import Pages
    from logical_robots_tui.tui.inspector.under_cursor import Traced
    from logical_robots_tui.tui.inspector.widgets.table import RowOrder, ValueTable

_INTERVAL = 0.25  # seconds between two updates while the game runs
_LOADING_DELAY = 0.2  # seconds after the start until the other pages are loaded
_ROOMY = 150  # columns of the inspector from which a page and the robot stand side by side


class InspectorPane(Pane):
    """Follows the current tick a few times a second, with the decision alongside if it fits."""

    command_id = "inspector"

    BINDINGS = [("escape", "stop")]

    DEFAULT_CSS = """
    InspectorPane #pages { width: 1fr; height: 1fr; }
    InspectorPane.-roomy Page { width: 3fr; }
    InspectorPane.-roomy DecisionPage { width: 2fr; border-left: solid $ink-faint; }
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.questions = Questions(session)
        self._list = PredicateList()
        self._robots = RobotsPage(session, self.questions)
        self._row = Horizontal(self._robots, id="pages")
        super().__init__(Horizontal(self._list, self._row), title="Inspector")
        self._is_roomy = False
        self._pages: Pages | None = None
        self._inspected = ROBOTS
        self._robot: str | None = None
        self._survey: Survey | None = None
        self._following: Frame | None = None
        self._stale = False
        self._follower: Worker[None] | None = None

    @property
    def pages(self) -> Pages:
        if self._pages is None:
            from logical_robots_tui.tui.inspector.page_loader import Pages

            self._pages = Pages(self._session, self.questions)
            others = (self._pages.predicate, *self._pages.by_name.values())
            for page in others:
                page.display = False
            self._row.mount(*others)
        return self._pages

    @property
    def page(self) -> Page:
        """The selected page, which may not be visible yet."""
        if self._inspected == ROBOTS:
            return self._robots
        return self.pages.by_name.get(self._inspected, self.pages.predicate)

    @property
    def beside(self) -> Page | None:
        if not self._is_roomy or self._pages is None:
            return None
        return self._robots if self._inspected == DECISION else self._pages.decision

    @property
    def inspected(self) -> str:
        """The selected page or predicate, or the page beside it if that has the focus."""
        if self.beside is None or not self.beside.has_focus_within:
            return self._inspected
        return ROBOTS if self._inspected == DECISION else DECISION

    @property
    def shows_robot(self) -> bool:
        return self.beside is not None or self._inspected in (DECISION, WHY, WATCH)

    @property
    def shown_table(self) -> ValueTable | None:
        page = self.page
        if self.inspected != self._inspected or not page.display:
            return None
        return page.table if page.table and page.table.display else None

    @property
    def robot(self) -> str:
        names = [robot.name for robot in self._session.level.robots]
        return self._robot if self._robot in names else names[0]

    @property
    def is_function(self) -> bool:
        return self.questions.is_function(self._inspected)

    def on_mount(self) -> None:
        in_background(self, self._load_pages, "pages")
        self._list_predicates()
        self.follow()

    async def _load_pages(self) -> None:
        await asyncio.sleep(_LOADING_DELAY)
        await asyncio.to_thread(import_module, "logical_robots_tui.tui.inspector.page_loader")
        if self._row.is_attached and self.pages:  # the player may have quit meanwhile
            self.follow()

    def on_show(self) -> None:
        self.follow()

    def on_resize(self) -> None:
        is_roomy = self.content_size.width >= _ROOMY
        if is_roomy is not self._is_roomy:
            if self.beside is not None and self.beside.has_focus_within:
                self.enter()
            self._is_roomy = is_roomy
            self.set_class(is_roomy, "-roomy")
            self._show_pages()
            self.follow()

    async def on_unmount(self) -> None:
        await self.questions.close()

    def enter(self) -> None:
        self.screen.set_focus(self._list)

    def choose(self, robot_name: str) -> None:
        self._robot = robot_name
        self._robots.view.choose(robot_name)
        if any(page.depends_on_robot for page in self._wanted):
            self._cancel()
        self.follow()

    def inspect(self, name: str) -> None:
        self._inspected = name
        if name != WHY:
            self.post_message(Sighted(None, self._session.frame))
        self._cancel()
        self.follow()

    def open(self, name: str) -> None:
        if name in self._list.names:
            self._select(name)
            self.enter()
        else:
            self.notify(f"The program has no predicate {name}.", markup=False)

    def why(self) -> None:
        own = {p.name for p in self._session.predicates if p.kind == "program"}
        self.pages.why.begin(self._inspected if self._inspected in own else "Robot")
        self._enter_page(WHY)

    def ask(self, query: str = "") -> None:
        self._enter_page(ASK)
        self.pages.ask.put(query)

    def go_to_pins(self) -> None:
        self._enter_page(WATCH)

    def diagnose(self) -> None:
        self._enter_page(DIAGNOSIS)

    def traced_here(self, tick: int) -> Traced | None:
        """Return the value under the cursor; the robot's memory if only robots are shown."""
        from logical_robots_tui.explain.why.sources import Subject
        from logical_robots_tui.tui.inspector.under_cursor import (
            Traced,
            traced_cell,
            traced_in_proof,
            traced_pin,
        )

        robot = self.robot
        if self.inspected == WHY:
            why = self.pages.why
            return traced_in_proof(why.view, why.asked, robot, tick)
        if self.inspected == WATCH:
            return traced_pin(self.pages.pins.pointed, robot, tick)
        if self.inspected in (ROBOTS, DECISION):
            return Traced(robot, Subject(), tick)
        return traced_cell(self.inspected, self.shown_table, robot, tick)

    def trace(self, asked: Traced | None) -> None:
        self.pages.origin.come_from(self._inspected, asked)
        self.inspect(ORIGIN)
        self.screen.set_focus(self.page.view)

    def rearrange(self, how: RowOrder) -> None:
        if (table := self.shown_table) is not None:
            table.rearrange(how)
            self.follow()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Handle escape only while a query is running."""
        del parameters
        return action != "stop" or self.page.pending.is_long

    def action_stop(self) -> None:
        """Cancel the running query; don't restart it at the same tick."""
        self.page.pending.cancel()
        self._stale = False

    def follow(self) -> None:
        """Show the current tick: at once, or shortly after while the game runs."""
        if self._list.predicates != self._session.predicates:
            self._list_predicates()
        self._stale = True
        if not self._session.running and self._following is not self._session.frame:
            self._cancel()
        if self.display and (self._follower is None or self._follower.is_finished):
            self._follower = in_background(self, self._catch_up, "inspect")

    def _cancel(self) -> None:
        """Stop the page's work: it may be waiting for an answer that is no longer needed."""
        if self._follower is not None:
            self._follower.cancel()
            self._follower = None

    async def _catch_up(self) -> None:
        await self.wait_for_refresh()  # the labyrinth shows the tick first
        while self._stale and self.display:
            self._stale = False
            frame = self._following = self._session.frame
            wanted = self._wanted  # which may have to be loaded
            if self._pages is not None:
                self._pages.predicate.predicate = self._inspected
            for page in wanted:
                page.robot = self.robot
                await page.show(frame)
            if self._session.running:
                await asyncio.sleep(_INTERVAL)
            else:
                await self._count_rows(frame)

    async def _count_rows(self, frame: Frame) -> None:
        if not self.display:
            return
        try:
            survey = await self.questions.survey(frame)
        except Superseded:
            return
        if survey is not self._survey and survey.frame is self._session.frame:
            self._survey = survey
            self._list.count(survey)
            for page in self._wanted:
                page.show_survey(survey)

    @property
    def _wanted(self) -> tuple[Page, ...]:
        """The pages to show, the one that may be slow last."""
        return (self.page,) if self.beside is None else (self.beside, self.page)

    def _show_pages(self) -> None:
        """Hide unwanted pages once all others have something to show."""
        if all(page.display for page in self._wanted):
            for page in self._row.query_children(Page):
                page.display = page in self._wanted
        self.screen.refresh(layout=True)
        for page in self._wanted:
            self.screen.call_after_refresh(page.redraw)

    def _list_predicates(self) -> None:
        self._survey = None
        self._list.list(self._session.predicates, self._inspected)

    def _select(self, name: str) -> None:
        self._list.go_to(name)
        self.inspect(name)

    def _enter_page(self, name: str) -> None:
        self._select(name)
        self.screen.set_focus(self.page.view)

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
        if self.page.display and self.page.view.display:
            self.page.view.focus()

    @on(Page.Ready)
    def _page_ready(self, event: Page.Ready) -> None:
        event.stop()
        if event.page in self._wanted:
            event.page.display = True
            self._show_pages()

    @on(Page.Changed)
    def _page_changed(self, event: Page.Changed) -> None:
        event.stop()
        self._cancel()
        self.follow()

    @on(Page.Opened)
    def _page_opened(self, event: Page.Opened) -> None:
        event.stop()
        if event.name == WHY:
            self.why()
        else:
            (self.open if event.name.isidentifier() else self.ask)(event.name)

    @on(Page.Left)
    def _page_left(self, event: Page.Left) -> None:
        event.stop()
        self._select(event.name if event.name in self._list.names else ROBOTS)
        self.enter()
