"""The main screen: panes around a session."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from textual import events, on
from textual.app import ComposeResult
from textual.geometry import Size
from textual.message import Message
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Input, Static, TextArea

from logical_robots_tui.game import Frame
from logical_robots_tui.player.drafts import leave
from logical_robots_tui.player.opening import LocalPlayer, Opening
from logical_robots_tui.player.recorder import TOUR
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.processes.helper import collect_seldom, give_back_memory
from logical_robots_tui.tui.app.frame_scheduler import FrameScheduler
from logical_robots_tui.tui.app.ui import ScreenOffers, ScreenUi
from logical_robots_tui.tui.commands.keymap import (
    command,
    commands,
    key_bindings,
    key_of,
    with_keys,
)
from logical_robots_tui.tui.inspector.page import Placed, Sighted
from logical_robots_tui.tui.inspector.pane import InspectorPane
from logical_robots_tui.tui.labyrinth.briefing import Briefing, BriefingCard
from logical_robots_tui.tui.labyrinth.ghost import GhostController
from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane
from logical_robots_tui.tui.labyrinth.victory import VictoryAnnouncer
from logical_robots_tui.tui.labyrinth.view import LabyrinthView, RobotPut
from logical_robots_tui.tui.layout.arrangement import (
    LEAST_HEIGHT,
    LEAST_WIDTH,
    Arrangement,
    Needs,
    Pane,
    ScreenLayout,
)
from logical_robots_tui.tui.layout.command_bar import (
    CommandBar,
    CommandChosen,
    PaneTabs,
    RobotChosen,
)
from logical_robots_tui.tui.layout.dialogs import drop_stale_size
from logical_robots_tui.tui.layout.status_line import StatusLine, status_of
from logical_robots_tui.tui.learning.controller import LearningController
from logical_robots_tui.tui.learning.tour import TourController
from logical_robots_tui.tui.level_editor.controller import LevelController
from logical_robots_tui.tui.library.controller import BoardController, LibraryController
from logical_robots_tui.tui.program.controller import FileWatch, ProgramController
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.program.pane import ProgramPane, TeamChoice
from logical_robots_tui.tui.terminal.textual_internals import WidgetBindings
from logical_robots_tui.tui.theme.themes import palette_of
from logical_robots_tui.tui.timeline.controller import Replays, TickSearch, TimelineController
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.recovery import Offers
    from logical_robots_tui.tui.labyrinth.drawing.cells import Palette
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
    from logical_robots_tui.tui.level_editor.panel import EditPanel

_HEARTBEAT = 0.25  # seconds between updates of the clock while it runs
_ROOMY = 36  # lines with room for a picture in a dialog
_SETTLED = 1.0  # seconds after which what a level held is no longer used
_READABLE = 0.2  # seconds that a number stays while robots run


class MainScreen(Screen[None], SessionListener):
    """Everything that a player sees outside of dialogs."""

    AUTO_FOCUS = ""

    def __init__(self, opening: Opening, recorder: ProgressRecorder) -> None:
        super().__init__(id="main")
        clock = opening.clock
        self._keys = WidgetBindings(self, key_bindings(*commands("screen")))
        self._opening, self.permissions = opening, opening.permissions
        self.data_dir, self.recorder = opening.data_dir, recorder
        self.ui = ScreenUi(self)
        self.tell, self.warn = self.ui.tell, self.ui.warn
        self.scheduler = FrameScheduler(self, self._draw, clock)
        self.program = ProgramPane()
        self.player = LocalPlayer(
            opening, recorder, self.ui, self.program, self.scheduler.soon, with_keys
        )
        self.session, self.library = self.player.session, self.player.library
        self.scheduler.pace = self.session.pace
        self._status, self._tabs, self._bar = StatusLine(), PaneTabs(), CommandBar()
        self._too_small = Static(id="too-small", markup=False)
        self.briefing = Briefing(
            lambda: self.arrangement.layout.is_roomy and self.inspector.display
        )
        self.labyrinth, self.timeline = LabyrinthPane(self.briefing, clock), Timeline()
        self.inspector = InspectorPane(
            self.session, lambda: self.point_at(self.inspector), self.briefing.over
        )
        self.arrangement = Arrangement((self.labyrinth, self.program, self.inspector))
        self._edit_panel: EditPanel | None = None
        self._make_controllers()
        self._focus_before: Widget | None = None
        self._drawn: tuple[Level, Frame, bool] | None = None
        self._lines_drawn_at = float("-inf")
        self._suited = ""

    def _make_controllers(self) -> None:
        session, ui, recorder, data_dir = self.session, self.ui, self.recorder, self.data_dir
        program, view = self.program, self.labyrinth.view
        library, drafts = self.library, self.player.drafts
        self.editing = LevelController(
            session, ui, data_dir / "levels", drafts, library.open_level, self._show_editing
        )
        self.library_controller = LibraryController(
            library,
            session,
            ui,
            recorder,
            program,
            data_dir / "levels",
            drawing=lambda: view.drawing,
            make_level=self.editing.make_level,
            board=self.player.board,
        )
        self.offers = ScreenOffers(ui)
        self.learning = LearningController(self.player.learning, session, ui, program)
        self.program_controller = ProgramController(
            program,
            session,
            ui,
            data_dir / "copied.txt",
            self.permissions,
            enter=partial(self.go_to, program),
        )
        self.team_choice = TeamChoice(session, library.look_at, self.tell)
        self._watch = FileWatch(lambda: session.source, library.take_from_disk)
        tour_seen = partial(recorder.set_fact, TOUR, "seen")
        self.tour = TourController(self.mount, self.arrangement, self.point_at, tour_seen)
        self.timeline_controller = TimelineController(session, ui, view)
        self.replays = Replays(
            session, ui, data_dir / "replays", library.programs, library.open_with
        )
        self.ghost = GhostController(session, ui, view, self.player.best_runs, data_dir / "replays")
        self.board = BoardController(
            self.player.board,
            session,
            ui,
            program,
            self.replays.open_with_level,
            self.ghost.race,
            drawing=lambda: view.drawing,
        )
        self.search = TickSearch(
            session,
            ui,
            self.timeline_controller.go_to,
            lambda: self.inspector.active.breakpoint_here(),
        )
        self.announcer = VictoryAnnouncer(
            session,
            self.briefing,
            recorder,
            ui,
            self.offers,
            pause=lambda: self.scheduler.rate.calm if self.is_typing else math.inf,
            is_test=lambda: self.editing.is_testing,
            look=self._look_of_pictures,
            following=library.next_name,
            run=self.action_command,
            board=self.board,
        )
        session.listeners += [self.editing, recorder, self.announcer]
        session.listeners += [self.timeline_controller, self.ghost, self]

    def _look_of_pictures(self) -> tuple[Drawing, Palette] | None:
        """How miniatures are drawn, where there is room for one beside a table."""
        if self.app.size.height < _ROOMY:
            return None
        return self.labyrinth.view.drawing, palette_of(self.app.current_theme)

    def _show_editing(self) -> None:
        if self._edit_panel is None:
            from logical_robots_tui.tui.level_editor.panel import EditPanel

            self._edit_panel = EditPanel(
                self.editing,
                self.labyrinth,
                run=self.action_command,
                enter=partial(self.go_to, self.labyrinth),
                switched=self._editing_switched,
                changed=self.redraw_lines,
            )
        self._edit_panel.follow()

    def _editing_switched(self, is_on: bool) -> None:
        self.announcer.hold(is_on)
        ends = ("test", "stop_editing", "edit_level") if self.editing.is_testing else ()
        ending = key_bindings(*map(command, ends), does="test")
        self._keys.put_first(ending)

    def _suit(self, level: Level, text: str) -> None:
        self._suited = self.session.source.draft
        rows = self.inspector.rows_of(level, text)
        self.arrangement.suit(Needs.of(level.width / level.height, text, rows))

    def compose(self) -> ComposeResult:
        self._fit(self.app.size)
        self._suit(self.session.level, self.player.first_text)
        yield from (self._status, self._tabs, self.arrangement.container)
        yield from (self._too_small, self.timeline, self._bar)

    def on_mount(self) -> None:
        """Paint at once; compile and look for drafts afterwards."""
        self.program.editor.load_text(self.player.first_text)
        self.recorder.attach(
            self.ui, on_change=self.scheduler.soon, on_measured=self.announcer.measured
        )
        self.set_focus(self.labyrinth)
        self.screen_layout_refresh_signal.subscribe(self, self._laid_out)
        self.set_interval(_HEARTBEAT, self._beat)
        self.announcer.level_opened(self.session.level)
        self._draw()
        self.call_after_refresh(self._start)

    def on_screen_resume(self, event: events.ScreenResume) -> None:
        """Keep the styles on the first call, because they were just computed."""
        event.refresh_styles = event.refresh_styles and self.stack_updates > 0
        self.offers.resumed.set()

    def _start(self) -> None:
        collect_seldom()
        self.player.start()
        if (replay := self._opening.replay) is not None:
            self.ui.spawn(partial(self.replays.open, replay), "replay", exclusive=False)
        else:
            offered = self.player.offerings(self.editing.offer)
            if self._opening.welcome and self._opening.is_class:  # after what is seen was told
                offered.append(self._offer_tour)
            self.ui.spawn(partial(self.offers.make, *offered), "drafts", exclusive=False)
        self.ui.spawn(self._watch.follow, "watch", exclusive=False)
        if self._opening.welcome and not self._opening.is_class:
            self.tour.begin()

    async def _offer_tour(self, _offers: Offers) -> None:
        self.tour.begin()

    async def on_unmount(self) -> None:
        self.editing.close()
        await self.player.close()

    # -- for the parts -------------------------------------------------------------------------

    def level_opened(self, level: Level) -> None:
        self.app.title = level.title
        self._suit(level, self.program.text)
        self.labyrinth.select(None)
        self.scheduler.soon()
        self.set_timer(_SETTLED, give_back_memory)

    def program_used(self, program: Program) -> None:
        self.arrangement.note("")
        if self.session.source.draft != self._suited:
            self._suit(self.session.level, self.program.text)

    def program_rejected(self) -> None:
        self.arrangement.note(self.program_controller.complaint())

    def quit(self) -> None:
        player = self.player
        leave(self.ui, self.app.exit, player.drafts, player.autosave.flush, self.editing.flush)

    # -- drawing -------------------------------------------------------------------------------

    def _draw(self) -> None:
        session = self.session
        state = (session.level, session.frame, session.running)
        if not self.arrangement.is_tiny and self._drawn != state:
            self._drawn = state
            self.labyrinth.show(self.editing.level, session.frame, hurried=session.running)
        source, team = session.source, session.source.team
        name = f"{team}: {source.name}" if team else source.name
        self.program.show(session.state, name, saved=self.program.text == source.text)
        self.program.teams.show(session.level, session.sources.team)
        if (news := self.program_controller.news()) and self.arrangement.covers(self.program):
            self.arrangement.note(news)
        is_read = session.running and not self.scheduler.rate.is_hurried
        if not is_read or session.clock.now() - self._lines_drawn_at > _READABLE:
            self.redraw_lines()
        self.announcer.follow()
        self.inspector.follow()

    @property
    def focus_chain(self) -> list[Widget]:
        """Tab skips the program, where it indents and so would not lead out again."""
        return [widget for widget in super().focus_chain if widget is not self.program.editor]

    @property
    def is_typing(self) -> bool:
        return isinstance(self.focused, TextArea | Input)

    def redraw_lines(self) -> None:
        self._lines_drawn_at = self.session.clock.now()
        typing = self.is_typing
        self._status.show(status_of(self.session, typing=typing))
        self.timeline.show(self.session, self.labyrinth.view.selected)
        is_covered = self.briefing.over.display and self.inspector.has_focus_within
        source = self.briefing if is_covered else self.focused
        focus_keys = [(key_of(key), does) for key, does in getattr(source, "bar_keys", ())]
        busy = self.session.busy
        edits = self.editing.is_on and self.labyrinth.has_focus
        self._bar.show(typing=typing, running=busy, editing=edits, focus_keys=focus_keys)
        tabs = tuple((pane.command_id, pane.label) for pane in self.arrangement.panes)
        racks = self.query_children("ToastRack")
        messages = (toast.region for rack in racks for toast in rack.query("Toast"))
        covered = [region.x for region in messages if region.overlaps(self._tabs.region)]
        free = min(covered, default=self.size.width)
        self._tabs.show(tabs, self.arrangement.active.command_id, free)

    def _beat(self) -> None:
        if self.session.busy and self.scheduler.rate.idle_seconds > _HEARTBEAT:
            self.redraw_lines()

    # -- layout --------------------------------------------------------------------------------

    def on_resize(self, event: events.Resize) -> None:
        if drop_stale_size(event, self):
            return
        previous_layout = self.arrangement.layout
        self._fit(event.size)
        if self.arrangement.layout is previous_layout:
            return
        if self.arrangement.is_tiny:
            self._focus_before = self.focused
        elif previous_layout is ScreenLayout.TINY and self._focus_before is not None:
            self.set_focus(self._focus_before)
            self._focus_before = None
        self.call_after_refresh(self.tour.place)
        self._drawn = None
        self.scheduler.soon()

    def _fit(self, size: Size) -> None:
        self.arrangement.fit(size)
        self._too_small.update(f"{LEAST_WIDTH}x{LEAST_HEIGHT} needed,\nthis is {size[0]}x{size[1]}")
        self.set_classes(self.arrangement.layout.value)

    def _laid_out(self, _screen: Screen[object]) -> None:
        """Show messages over the lower left of the map, if it is not the only pane."""
        region = self.labyrinth.region
        is_over_map = self.arrangement.layout.is_roomy and self.labyrinth.display
        for rack in self.query_children("ToastRack"):  # none while the screen closes
            rack.set_class(is_over_map, "-over-map")
            if is_over_map:
                rack.styles.width = region.width - 2
                rack.styles.margin = (0, 0, self.size.height - region.bottom + 1, 1)
            elif rack.styles.inline.has_rule("margin"):  # to clear a rule lays out everything again
                rack.styles.width = rack.styles.margin = None
        self.redraw_lines()

    def point_at(self, pane: Pane) -> None:
        """Bring a pane into view without focusing it."""
        self.arrangement.active = pane
        self.arrangement.show()
        self.scheduler.soon()

    def go_to(self, pane: Pane) -> None:
        """Focus a pane; in a narrow terminal it replaces the visible one."""
        self.point_at(pane)
        pane.enter()

    def on_descendant_focus(self) -> None:
        if self.arrangement.focused():
            self.tour.end()
        if self.inspector.has_focus_within:
            self.briefing.close()
        self.redraw_lines()

    # -- messages ------------------------------------------------------------------------------

    @on(TextArea.Changed)
    def _text_changed(self) -> None:
        self.player.autosave.edited()
        self.program_controller.edited()
        self.arrangement.note("")
        self.scheduler.soon()

    @on(BriefingCard.Closed)
    @on(CommandChosen)
    @on(Editor.Copied)
    @on(LabyrinthView.RobotPicked)
    @on(Pane.Filled)
    @on(Pane.Pulled)
    @on(Pane.Retitled)
    @on(Placed)
    @on(RobotChosen)
    @on(RobotPut)
    @on(Sighted)
    @on(Timeline.TickPointed)
    def _obey(self, message: Message) -> None:
        match message:
            case BriefingCard.Closed():
                self.briefing.close()
            case CommandChosen():
                self.action_command(message.command_id)
            case Editor.Copied():
                self.program_controller.keep_copy(message.text)
            case LabyrinthView.RobotPicked():
                self.select(message.name)
                self.inspector.show_robot()
            case Pane.Filled():
                self.arrangement.grow(message.rows)
            case Pane.Pulled():
                self.arrangement.pull(message.pane, message.side, *message.moved)
            case Pane.Retitled():
                self.redraw_lines()
            case Placed():
                pane = self.program
                if message.program == pane.text and not pane.has_focus_within:
                    pane.show_place(*message.place)
            case RobotChosen():
                self.select(message.robot_name)
            case RobotPut():
                self.session.place_robot(message.name, message.pose)
            case Sighted():
                self.labyrinth.view.highlight(message.highlight, message.frame)
                if message.highlight is None and not self.program.has_focus_within:
                    self.program.editor.unpoint()
            case Timeline.TickPointed():
                self.timeline_controller.go_to(message.tick)

    def select(self, robot_name: str) -> None:
        if self.team_choice.follow(robot_name):
            self.labyrinth.select(robot_name)
            self.inspector.choose(robot_name)

    def action_command(self, command_id: str) -> None:
        entry = command(command_id)
        if entry.scope != "level":
            entry.run(self, self.ui.spawn)
        elif self.editing.is_on or self.editing.is_testing:
            entry.run(self.editing, self.ui.spawn)
            self.editing.changed()
