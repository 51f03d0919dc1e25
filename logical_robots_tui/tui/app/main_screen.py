"""The main screen: panes around a session."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from textual import on
from textual.binding import BindingsMap
from textual.screen import Screen
from textual.widgets import Input, Static, TextArea

from logical_robots_tui.garbage import collect_seldom
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.app.permissions import Freedoms
from logical_robots_tui.tui.app.redrawing import Redrawing
from logical_robots_tui.tui.app.session import Session
from logical_robots_tui.tui.commands.actions import Actions
from logical_robots_tui.tui.commands.table import EDITING, bindings, command
from logical_robots_tui.tui.inspector.highlights import Placed, Sighted
from logical_robots_tui.tui.inspector.pages.robots import RobotsView
from logical_robots_tui.tui.inspector.pane import InspectorPane
from logical_robots_tui.tui.inspector.predicate_list import DECISION, ROBOTS, WATCH, WHY
from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane
from logical_robots_tui.tui.labyrinth.victory import Celebration
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.arrangement import Arrangement
from logical_robots_tui.tui.layout.command_bar import CommandBar, CommandChosen, PaneTabs
from logical_robots_tui.tui.layout.layout import LEAST_HEIGHT, LEAST_WIDTH, Layout
from logical_robots_tui.tui.layout.pane import Pane
from logical_robots_tui.tui.layout.status_line import StatusLine, status_of
from logical_robots_tui.tui.learning.controller import Guide
from logical_robots_tui.tui.learning.tour_controller import TourGuide
from logical_robots_tui.tui.level_editor.controller import EditingDoor
from logical_robots_tui.tui.library.controller import Library
from logical_robots_tui.tui.program.controller import Scribe
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.program.file_watch import FileWatch
from logical_robots_tui.tui.program.pane import ProgramPane
from logical_robots_tui.tui.recovery.bookmark import Bookmark
from logical_robots_tui.tui.recovery.offers import Offers
from logical_robots_tui.tui.recovery.program_drafts import Keeper
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.timeline.controller import Travel
from logical_robots_tui.tui.timeline.widget import Timeline

if TYPE_CHECKING:
    from pathlib import Path

    from textual import events
    from textual.app import ComposeResult
    from textual.geometry import Size
    from textual.widget import Widget

    from logical_robots_tui.game import Breakpoint, Frame, Source
    from logical_robots_tui.mind import Engine
    from logical_robots_tui.tui.app.background import Work
    from logical_robots_tui.tui.app.settings import Settings
    from logical_robots_tui.tui.library.journal import Journal
    from logical_robots_tui.world import Level

__all__ = ["MainScreen"]

_COMPLAINTS = 3  # of the configuration that are told; `logical-robots config` tells all
_EDITING_IDS = {entry.id for entry in EDITING}
_HEARTBEAT = 0.25  # seconds between two looks at a clock that runs
_READABLE = 0.2  # seconds that a number is to stand while robots run


class MainScreen(Screen[None]):
    """Everything that a player sees outside of dialogs.

    Args:
        level: Where to begin.
        source: The program to begin with.
        data_dir: Where drafts and the player's programs are.
        journal: Where progress is kept.
        text: What the player made of the program, or None.
        welcome: Whether to begin with the tour.
        engine: What the robots think with.

    Attributes:
        data_dir: Where drafts and the player's programs are.
        freedoms: What the player may do with the machine.
        redrawing: When the game is drawn again.
    """

    def __init__(
        self,
        level: Level,
        source: Source,
        data_dir: Path,
        journal: Journal,
        *,
        text: str | None = None,
        welcome: bool = False,
        engine: Engine = "sqlite",
    ) -> None:
        super().__init__(id="main")
        # As a class variable they would be the same for every player; a keymap can't take one away.
        self._bindings = BindingsMap.merge([self._bindings, BindingsMap(bindings())])
        self.freedoms = Freedoms()
        self.data_dir = data_dir
        self.redrawing = Redrawing(self, self._draw)
        self.journal = journal
        self.session = Session(
            level,
            source,
            spawn=self.spawn,
            changed=self.redrawing.soon,
            used=journal.used,
            stopped=lambda hits: self.travel.tell_hits(hits),
            engine=engine,
        )
        self.keeper = Keeper(
            data_dir / "drafts",
            text=lambda: self.program.text,
            source=lambda: self.session.source,
            failed=self.warn,
        )
        self.library = Library(self, data_dir / "programs")
        self.editing = EditingDoor(self, data_dir)
        self.bookmark = Bookmark(self, data_dir / "places")
        self.offers = Offers(self)
        self.guide = Guide(self)
        self.scribe = Scribe(self, data_dir / "copied.txt")
        self._text_to_begin_with = source.text if text is None else text
        self._watch = FileWatch(lambda: self.session.source, self.library.take_from_disk)
        self._is_new_here = welcome
        self.tours = TourGuide(self)
        self.travel = Travel(self)
        self.celebration = Celebration(self)
        self._actions = Actions(self)
        self._status = StatusLine()
        self._tabs = PaneTabs()
        self._too_small = Static(id="too-small", markup=False)
        self.labyrinth = LabyrinthPane()
        self.program = ProgramPane()
        self.inspector = InspectorPane(self.session)
        self.timeline = Timeline()
        self._bar = CommandBar()
        self.arrangement = Arrangement((self.labyrinth, self.program, self.inspector))
        self._focus_before: Widget | None = None
        self._drawn: tuple[Level, Frame, bool] | None = None
        self._lines_drawn_at = float("-inf")

    def compose(self) -> ComposeResult:
        """Status line, tabs, panes, timeline, command bar."""
        self._fit(self.app.size)
        yield from (self._status, self._tabs, self.arrangement.container)
        yield from (self._too_small, self.timeline, self._bar)

    def on_mount(self) -> None:
        """Paint at once; compile and look for drafts after that."""
        self.program.editor.load_text(self._text_to_begin_with)
        self.journal.attach(
            spawn=self.spawn,
            changed=self.redrawing.soon,
            warn=self.warn,
            measured=self.celebration.measured,
        )
        self.set_focus(self.labyrinth)
        self.set_interval(_HEARTBEAT, self._beat)
        self.begin_level()
        self._draw()
        self.call_after_refresh(self._start)

    def on_screen_resume(self, event: events.ScreenResume) -> None:
        """Take the styles as they are the first time: they have just been worked out."""
        event.refresh_styles = bool(self.stack_updates)
        self.offers.resumed()

    def _start(self) -> None:
        collect_seldom()
        self.session.apply(self.text)
        self.journal.open(self.session.level)
        self.spawn(self.offers.make, "drafts", exclusive=False)
        self.spawn(self._watch.follow, "watch", exclusive=False)
        if self._is_new_here:
            self.tours.begin()

    async def on_unmount(self) -> None:
        """Bring the text to safety and stop all work."""
        self.keeper.close()
        self.editing.close()
        self.bookmark.close()
        await self.session.close()
        await self.journal.close()

    def follow(self, settings: Settings) -> None:
        """Do as the player has set once for all, and tell what of it can't be used."""
        self.redrawing.tempo.frames = settings.frames
        view = self.labyrinth.view
        view.rays, view.trails = settings.cones, settings.trails
        for complaint in settings.complaints[:_COMPLAINTS]:
            self.warn(complaint)

    # -- for the parts -------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """What stands in the editor."""
        return self.program.text

    def put_text(self, text: str) -> None:
        """Put another program's text into the editor."""
        self.program.editor.load_text(text)

    def replace_text(self, text: str) -> None:
        """Put another text of the same program into the editor; undo brings the former back."""
        self.program.editor.put(text)

    def tell(self, message: str) -> None:
        """Say something in passing."""
        self.notify(message, markup=False, timeout=4)

    def warn(self, message: str) -> None:
        """Say what went wrong."""
        self.notify(one_line(message), markup=False, severity="warning", timeout=8)

    def begin_level(self) -> None:
        """Show what the level asks for."""
        self.editing.level_left()
        self.labyrinth.select(None)
        self.labyrinth.briefing.tell(self.session.level)
        self.celebration.forget()
        self.redrawing.soon()

    def add_breakpoint(self, breakpoint_: Breakpoint) -> None:
        """Let the robots stop at something from now on, and say so."""
        self.travel.add_breakpoint(breakpoint_)

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Work in the background."""
        in_background(self, work, group, exclusive=exclusive)

    # -- drawing -------------------------------------------------------------------------------

    def _draw(self) -> None:
        session = self.session
        now = (session.level, session.frame, session.running)
        if not self.arrangement.is_tiny and self._drawn != now:
            self._drawn = now
            level = self.editing.shown(session.level)
            self.labyrinth.show(level, session.frame, hurried=session.running)
        saved = self.text == session.source.text
        self.program.show(session.state, session.source.name, saved=saved)
        is_read = session.running and not self.redrawing.tempo.is_hurried
        if not is_read or monotonic() - self._lines_drawn_at > _READABLE:
            self.redraw_lines()
        if session.frame.tick:
            self.journal.moved()
        self.celebration.follow()
        self.inspector.follow()
        session.pace.spacing = self.redrawing.tempo.spacing

    @property
    def _edits(self) -> bool:
        """Whether keys edit the level."""
        return self.editing.is_on and self.labyrinth.has_focus

    def redraw_lines(self) -> None:
        """Show what has changed around the panes."""
        self._lines_drawn_at = monotonic()
        self._status.show(status_of(self.session))
        self.timeline.show(self.session, self.labyrinth.view.selected)
        typing = isinstance(self.focused, (TextArea, Input))
        self._bar.show(typing=typing, running=self.session.busy, editing=self._edits)
        tabs = tuple((pane.command_id, pane.label) for pane in self.arrangement.panes)
        self._tabs.show(tabs, self.arrangement.active.command_id)

    def _beat(self) -> None:
        if self.session.busy and self.redrawing.tempo.rested > _HEARTBEAT:
            self.redraw_lines()

    # -- layout --------------------------------------------------------------------------------

    def on_resize(self, event: events.Resize) -> None:
        """Arrange the panes for the new size."""
        before = self.arrangement.layout
        self._fit(event.size)
        if self.arrangement.layout is before:
            return
        if self.arrangement.is_tiny:
            self._focus_before = self.focused
        elif before is Layout.TINY and self._focus_before is not None:
            self.set_focus(self._focus_before)
            self._focus_before = None
        self.call_after_refresh(self.tours.place)
        self._drawn = None
        self.redrawing.soon()

    def _fit(self, size: Size) -> None:
        self.arrangement.fit(size)
        self._too_small.update(f"{LEAST_WIDTH}x{LEAST_HEIGHT} needed,\nthis is {size[0]}x{size[1]}")
        self.set_classes(self.arrangement.layout.value)

    def point_at(self, pane: Pane) -> None:
        """Bring a pane to sight without going there."""
        self.arrangement.active = pane
        self.arrangement.show()
        self.redrawing.soon()

    def go_to(self, pane: Pane) -> None:
        """Go to a pane; in a narrow terminal it takes the place of the one there."""
        self.point_at(pane)
        pane.enter()

    def goes_there(self, key: str) -> bool:
        """Go to the pane that a key is for; whether there is one, and nobody is typing.

        As a binding the key would be obeyed after keys that arrive in the same moment, and a
        letter for the editor would be a command.
        """
        if isinstance(self.focused, TextArea | Input):
            return False
        if self.editing.obeys(key):
            return True
        for pane in self.arrangement.panes:
            if key in command(pane.command_id).keys:
                self.go_to(pane)
                return True
        return False

    def on_descendant_focus(self) -> None:
        """Remember which pane is worked in, and offer the commands that fit."""
        if self.arrangement.focused():
            self.tours.end()
        self.redraw_lines()

    # -- messages ------------------------------------------------------------------------------

    @on(TextArea.Changed)
    def _text_changed(self) -> None:
        self.keeper.edited()
        self.redrawing.soon()

    @on(Editor.Leave)
    def _editor_left(self) -> None:
        self._actions.leave()

    @on(Editor.Copied)
    def _text_copied(self, event: Editor.Copied) -> None:
        self.scribe.keep_copy(event.text)

    @on(Timeline.Pointed)
    def _tick_pointed(self, event: Timeline.Pointed) -> None:
        self.travel.go_to(event.tick)

    @on(Pane.Pulled)
    def _side_pulled(self, event: Pane.Pulled) -> None:
        self.arrangement.pull(event.pane, event.side, *event.moved)
        self.arrangement.show()

    @on(Pane.Retitled)
    def _pane_retitled(self) -> None:
        self.redraw_lines()

    @on(CommandChosen)
    def _command_chosen(self, event: CommandChosen) -> None:
        self.action_command(event.command_id)

    @on(LabyrinthView.RobotPicked)
    def _robot_picked(self, event: LabyrinthView.RobotPicked) -> None:
        self._select(event.name)
        if self.inspector.inspected not in (DECISION, WHY, WATCH):
            self.inspector.inspect(ROBOTS)

    @on(Sighted)
    def _sight_pointed(self, event: Sighted) -> None:
        self.labyrinth.view.bring_out(event.highlight, event.frame)

    @on(Placed)
    def _place_pointed(self, event: Placed) -> None:
        if event.program == self.text and not self.program.has_focus_within:
            self.program.show_place(*event.place)

    def on_value_table_opened(self) -> None:
        """Look into the value under the cursor; by its name, because to name the class loads it."""
        self._actions.open_value()

    on_decision_view_opened = on_why_view_opened = on_value_table_opened

    @on(RobotsView.Chosen)
    def _robot_chosen(self, event: RobotsView.Chosen) -> None:
        self._select(event.robot_name)

    def _select(self, robot_name: str) -> None:
        self.labyrinth.select(robot_name)
        self.inspector.choose(robot_name)

    def action_command(self, command_id: str) -> None:
        """Do what a command says."""
        if command_id in _EDITING_IDS:
            self.editing.do(command_id)
        else:
            getattr(self._actions, command_id)()
