"""The inspector: a list of pages and predicates, and what the selected one says about a tick."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Horizontal
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets.option_list import Option
from textual.worker import Worker

from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.language.services.completion import definitions
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.page import (
    Page,
    Placed,
    Sighted,
    Traced,
    row_call,
    traced_pin,
)
from logical_robots_tui.tui.inspector.questions import NO_PROGRAM, InspectorQuestions, Survey
from logical_robots_tui.tui.inspector.register import PAGES
from logical_robots_tui.tui.layout.arrangement import HIGHEST_TABLE, Pane
from logical_robots_tui.tui.layout.command_bar import RobotChosen
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.game import Pin
    from logical_robots_tui.mind import Predicate
    from logical_robots_tui.player.session import Session

_INTERVAL = 0.25  # seconds between two updates while the game runs
_LOADING_DELAY = 0.2  # seconds after the start until the other pages are loaded
_ROOMY = 150  # columns of the inspector from which a page and the robot stand side by side

_OF_PREDICATES = next(entry.id for entry in PAGES if entry.scope == "predicate")

_NO_PIN = (
    "Choose a predicate, type a query, or put the cursor on a value of it in a row that another "
    "column tells from the rest; then pin it."
)
_NO_REASON = (
    "Why explains rows of the program's own predicates, unless {transpose} has transposed them: "
    "choose one in the list, or ask for it by its name alone. {open_value} opens the value."
)
_NOT_TRACED = (
    "Put the cursor on a value of the program: in a table, in a proof, on a pin, or in the tree "
    "that {open_value} opens."
)


MARKS = {"input": ("◂", INK.robot), "program": ("•", INK.key), "prelude": ("◦", INK.dim)}
"""The sign and colour of each kind of predicate."""

_IN_EVERY_LEVEL = ("Sensor", "Memory", "Robot")
_ALWAYS_LISTED = 8  # entries to make room for; a number, so that a new page rescales no map
_LISTED = 14  # entries, at most, that the list makes room for
_AROUND_ROBOTS = 4  # lines of their page that are about no robot or about one
_CHANGED = "•"
_NARROWEST = 12  # columns of an entry


class InspectorPane(Pane):
    """Follows the current tick a few times a second, with the decision alongside if it fits."""

    command_id = "inspector"

    BINDINGS = [("escape", "stop")]

    DEFAULT_CSS = """
    InspectorPane #pages { width: 1fr; height: 1fr; }
    InspectorPane.-roomy Page { width: 3fr; }
    InspectorPane.-roomy DecisionPage { width: 2fr; border-left: solid $ink-faint; }
    """

    def __init__(self, session: Session, reveal: Callable[[], None], briefing: Widget) -> None:
        """`reveal` brings the pane into view, which `briefing` may cover."""
        self._session, self._reveal = session, reveal
        self.questions = InspectorQuestions(session)
        self._list = PredicateList()
        first = PAGES[0]
        self._pages = {first.id: first.load()(first, self.questions)}
        self._row = Horizontal(*self._pages.values(), id="pages")
        super().__init__(Horizontal(self._list, self._row), briefing, title="Inspector")
        self._is_roomy = self._is_unmeasured = False
        self._selected = first.id
        self._survey: Survey | None = None
        self._levels = session.levels
        self._following: Frame | None = None
        self._stale = self._has_traced = False
        self._follower: Worker[None] | None = None

    @property
    def page(self) -> Page:
        """The selected page, which may not be visible yet."""
        return self._page(self._selected)

    @property
    def beside(self) -> Page | None:
        are_loaded = len(self._pages) == len(PAGES)
        return self._page(self.page.beside) if self._is_roomy and are_loaded else None

    @property
    def active(self) -> Page:
        """The page that commands are about: the one beside the selected one if it has the focus."""
        beside = self.beside
        return beside if beside is not None and beside.has_focus_within else self.page

    @property
    def inspected(self) -> str:
        """The predicate of the active page, or its id."""
        return self.active.predicate or self.active.entry.id

    @property
    def robot(self) -> str:
        return self.questions.robot

    def on_mount(self) -> None:
        in_background(self, self._load_pages, "pages")
        self.follow()

    async def _load_pages(self) -> None:
        await asyncio.sleep(_LOADING_DELAY)
        await asyncio.to_thread(lambda: [entry.load() for entry in PAGES])
        if self._row.is_attached:  # the player may have quit meanwhile
            self._load()
            self.follow()

    def _load(self) -> None:
        """Make the pages that are missing, all at once, because mounting takes a layout."""
        missing = [entry for entry in PAGES if entry.id not in self._pages]
        if missing:
            pages = [entry.load()(entry, self.questions) for entry in missing]
            for page in pages:
                page.display = False
                self._pages[page.entry.id] = page
            self._row.mount(*sorted(pages, key=lambda page: page.entry.id == Page.beside))

    def _page(self, name: str) -> Page:
        if name not in self._pages:
            self._load()
        return self._pages.get(name) or self._pages[_OF_PREDICATES]

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
        self.questions.chosen = robot_name
        if any(page.depends_on_robot for page in self._visible_pages):
            self._cancel()
        self.follow()

    def show_robot(self) -> None:
        """Go to the robots, unless the visible pages are about the selected one."""
        if self.beside is None and self.page.entry.scope != "robot":
            self.inspect(PAGES[0].id)

    def inspect(self, name: str) -> None:
        """Show the page with an id, or of a predicate."""
        self._selected = name
        if self.page.entry.scope == "predicate":
            self.page.predicate = name
        self._is_unmeasured = True
        if self.page.fills:
            self.post_message(self.Filled(HIGHEST_TABLE - 2))
        self.post_message(Sighted(None, self._session.frame))
        self._cancel()
        self.follow()

    def open(self, name: str) -> None:
        if name in self._list.names:
            self._select(name)
            self.enter()
        else:
            self.notify(f"The program has no predicate {name}.", markup=False)

    def go_to(self, page_id: str, subject: object = None) -> None:
        """Show a page and focus its view, after it has begun with a subject."""
        self._reveal()
        if subject is not None:
            self._page(page_id).begin(subject)
        self._select(page_id)
        self.screen.set_focus(self.page.view)

    # -- what commands do ----------------------------------------------------------------------

    def why(self) -> None:
        """Explain the row under the cursor, or else the first row of the selected predicate."""
        from logical_robots_tui.explain import Ask

        page, table = self.active, self.active.table_here
        program_names = {p.name for p in self._session.predicates if p.kind == "program"}
        if table is None or not table.has_focus:
            self.go_to("why", Ask(self._selected if self._selected in program_names else "Robot"))
        elif (row := page.row_here()) is None or page.predicate not in program_names:
            self.notify(with_keys(_NO_REASON), markup=False)
        else:
            robot, call = row_call(page.predicate, row[0], self.robot)
            self.post_message(RobotChosen(robot))
            self.go_to("why", call)

    def pin(self) -> None:
        pin = self.active.pin_here()
        if pin is None:
            self.notify(_NO_PIN, markup=False)
        else:
            self._page("watch").begin(pin)

    def open_value(self) -> None:
        from logical_robots_tui.tui.inspector.value_tree import ValueTree

        title, branches = self.active.values_here()
        if branches:
            title = f"{title} · tick {self._session.frame.tick}"
            toggle_pin = self._page("watch").begin
            self.app.push_screen(ValueTree(title, branches, toggle_pin, self._trace_pin))
        else:
            self.notify("Put the cursor on a value, or choose Decision.", markup=False)

    def _trace_pin(self, pin: Pin) -> bool:
        target = traced_pin(pin, self.robot, self._session.frame.tick)
        if target is not None:
            self.trace(target)
        return target is not None

    def origin(self) -> None:
        """Trace the value under the cursor, or return to the last one."""
        target = self.active.traced_here()
        if self._session.game is None:
            self.notify(NO_PROGRAM, markup=False)
        elif target is not None:
            self.trace(target)
        elif self._has_traced:
            self.go_to("origin")
        else:
            self.notify(with_keys(_NOT_TRACED), markup=False)

    def trace(self, target: Traced) -> None:
        self._has_traced = True
        self.go_to("origin", (target, self._selected))

    # -- following the tick --------------------------------------------------------------------

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Handle escape only while a query is running."""
        return action != "stop" or self.page.pending.is_long

    def action_stop(self) -> None:
        """Cancel the running query; don't restart it at the same tick."""
        self.page.pending.cancel()
        self._stale = False

    def follow(self) -> None:
        """Show the current tick: at once, or shortly after while the game runs."""
        if self._levels is not self._session.levels:
            self._levels = self._session.levels
            for page in self._pages.values():
                page.forget()
            if not self.page.entry.is_listed and self._selected not in _IN_EVERY_LEVEL:
                self._select(PAGES[0].id)
        if self._list.predicates != self._session.predicates:
            self._survey = None
            self._list.list(self._session.predicates, self._selected)
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
            pages = self._visible_pages  # which may have to be loaded
            for page in pages:
                await page.show(frame)
            if self._session.running:
                self._is_unmeasured = True
                if self._survey is not None:
                    self._survey = None
                    self._list.count(None)
                await asyncio.sleep(_INTERVAL)
            else:
                await self._count_rows(frame)
                if self._is_unmeasured:
                    self._is_unmeasured = False
                    self.screen.call_after_refresh(self._measure)

    @staticmethod
    def rows_of(level: Level, text: str) -> int:
        """Return how many rows a level and a program will fill at first."""
        listed = min(_ALWAYS_LISTED + len(definitions(text)), _LISTED)
        return max(listed, len(level.robots) + _AROUND_ROBOTS)

    def _measure(self) -> None:
        rows = [min(self._list.virtual_size.height, _LISTED)]
        for page in self._visible_pages:
            view = page.table_here or page.view
            if page.display and view.display:
                rows.append(page.size.height - view.size.height + view.virtual_size.height)
        self.post_message(self.Filled(max(rows)))

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
            for page in self._visible_pages:
                page.show_survey(survey)

    @property
    def _visible_pages(self) -> tuple[Page, ...]:
        """The pages to show, the one that may be slow last."""
        return (self.page,) if self.beside is None else (self.beside, self.page)

    def _show_pages(self) -> None:
        """Hide unwanted pages once all others have something to show."""
        if all(page.display for page in self._visible_pages):
            for page in self._row.query_children(Page):
                page.display = page in self._visible_pages
        self.screen.refresh(layout=True)
        for page in self._visible_pages:
            self.screen.call_after_refresh(page.redraw)

    def _select(self, name: str) -> None:
        if name in self._list.names:
            self._list.highlighted = self._list.get_option_index(name)
        self.inspect(name)

    @on(OptionList.OptionHighlighted)
    def _choice_moved(self, event: OptionList.OptionHighlighted) -> None:
        event.stop()
        if event.option_id is not None and event.option_id != self._selected:
            self.inspect(event.option_id)
            program = self._session.program
            predicate = program.predicate(event.option_id) if program is not None else None
            if program is not None and predicate is not None and predicate.line is not None:
                lines = program.text.split("\n")[: predicate.line - 1]
                start = sum(len(line) + 1 for line in lines)
                self.post_message(Placed(program.text, (start, start + len(predicate.name))))

    @on(OptionList.OptionSelected)
    def _choice_made(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        if self.page.display and self.page.view.display:
            self.page.view.focus()

    @on(Page.Ready)
    def _page_ready(self, event: Page.Ready) -> None:
        if event.page in self._visible_pages:
            event.page.display = True
            self._show_pages()

    @on(Page.Changed)
    def _page_changed(self) -> None:
        self._cancel()
        self.follow()

    @on(Page.LinkOpened)
    def _page_opened(self, event: Page.LinkOpened) -> None:
        if event.name.isidentifier():
            self.open(event.name)
        else:
            self.go_to("ask", event.name)

    @on(Page.Left)
    def _page_left(self, event: Page.Left) -> None:
        self._select(event.name if event.name in self._list.names else PAGES[0].id)
        self.enter()


class PredicateList(Listing):
    DEFAULT_CSS = """
    PredicateList {
        width: 24; height: 1fr; border: none; padding: 0; background: $surface;
        border-right: solid $ink-faint;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    bar_keys = (
        *(("enter", "Inspect"), ("break_here", "Break"), ("pin", "Pin"), ("ask", "Ask")),
        *(("graph", "Graph"), ("sql", "SQL")),
    )

    def __init__(self) -> None:
        super().__init__(id="choice", markup=False, compact=True)
        self.predicates: tuple[Predicate, ...] | None = None
        self.names: Sequence[str] = ()
        self._survey: Survey | None = None
        self._counted: dict[str, tuple[str, bool, int]] = {}

    def list(self, predicates: tuple[Predicate, ...], inspected: str) -> None:
        self.predicates, self._survey = predicates, None
        self._counted.clear()
        listed = [predicate for predicate in predicates if predicate.is_listed]
        pages = [page for page in PAGES if page.is_listed]
        self.names = [page.id for page in pages] + [predicate.name for predicate in listed]
        self.clear_options()
        self.add_options(
            [Option(Content.styled(page.title, f"bold {INK.entry}"), id=page.id) for page in pages]
            + [Option(_entry(predicate), id=predicate.name) for predicate in listed]
        )
        self.highlighted = self.names.index(inspected) if inspected in self.names else None

    def count(self, survey: Survey | None) -> None:
        """Show how many rows each predicate has; without a survey the numbers go."""
        if survey is None or survey.program.predicates == self.predicates:
            self._survey = survey
            self.on_resize()

    def on_resize(self) -> None:
        survey, width = self._survey, max(self.scrollable_content_region.width, _NARROWEST)
        for predicate in self.predicates or ():
            name = predicate.name
            rows, differs = (survey.count(name), survey.differs(name)) if survey else ("", False)
            old_count = self._counted.get(name, ("", False, width))
            if not predicate.has_rows or old_count == (rows, differs, width):
                continue
            self._counted[name] = rows, differs, width
            entry, count = _entry(predicate), f"{rows}{_CHANGED if differs else ' '}"
            room = width - len(count)
            text = " " * max(1, room - entry.cell_length) + count
            entry = entry.truncate(room - 1, ellipsis=True)
            ink = INK.key if differs else INK.dim
            self.replace_option_prompt(name, entry.append(Content.styled(text, ink)))


def _entry(predicate: Predicate) -> Content:
    mark, colour = MARKS[predicate.kind]
    name = INK.text if predicate.has_rows else INK.dim
    entry = Content.assemble((f"{mark} ", colour), (one_line(predicate.name), name))
    if not predicate.has_rows:
        entry = entry.append(Content.styled(" ƒ", INK.dim))
    if predicate.line is not None:
        entry = entry.append(Content.styled(f" :{predicate.line}", INK.faint))
    return entry
