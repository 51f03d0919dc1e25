"""The app: theme, the main screen, and an orderly end."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from textual import constants, events
from textual.binding import Binding
from textual.geometry import Region
from textual.widgets import Input, TextArea

from logical_robots_tui.errors import InputError
from logical_robots_tui.mind.compilation import stop_compiling, stop_idle_compiling
from logical_robots_tui.player.opening import open_game
from logical_robots_tui.player.recorder import THEME, ProgressRecorder
from logical_robots_tui.player.settings import (
    Settings,
    read_settings,
    rows,
    settings_path,
    write_setting,
)
from logical_robots_tui.processes import lifeline
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.app.main_screen import MainScreen
from logical_robots_tui.tui.app.ui import widget_at
from logical_robots_tui.tui.commands.command import Need
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap, with_keys
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.terminal.capabilities import (
    NOT_UTF_8,
    drawing_for,
    may_use_mouse,
    screen_encoding,
    writes_utf_8,
)
from logical_robots_tui.tui.terminal.crash_report import end_on_hangup
from logical_robots_tui.tui.terminal.diff_app import DiffApp
from logical_robots_tui.tui.terminal.driver import LARGEST, Uploaded
from logical_robots_tui.tui.terminal.stylesheet import SharedStylesheet
from logical_robots_tui.tui.terminal.textual_internals import KeyQueue
from logical_robots_tui.tui.theme.themes import NIGHT, colours_in, use_theme

if TYPE_CHECKING:
    from textual.pilot import Pilot

    from logical_robots_tui.player.opening import Opening

_COMPLAINTS = 3  # of the configuration that are told; `logical-robots config` tells all
_LOOK_FOR_WISHES = 1.0  # seconds between looks whether another game wants this one to end
_LOOK_FOR_IDLENESS = 10.0  # seconds between looks whether the compile process has had no work
_REHEARSED = ("question_mark", "ctrl+p", "l")  # keys of dialogs that take long for the first time
_LOOK_FOR_WORK = 0.05  # seconds between looks whether what was started is done
_TWICE = 2.0  # seconds between two presses that are meant as one wish

_INPUT = (events.InputEvent, events.Paste)


class LogicalRobotsApp(DiffApp, inherit_bindings=False):
    """The game in a terminal; `theme` applies where the settings name none."""

    _event_loop: asyncio.AbstractEventLoop | None = None

    TITLE = "Logical Robots"
    CSS_PATH = "main_screen.tcss"
    ENABLE_COMMAND_PALETTE = False
    BINDINGS = [
        Binding("ctrl+c", "interrupt", "Leave", show=False, system=True),
        Binding("ctrl+z", "suspend_process", "Suspend", show=False, system=True),
        # Lines go to their beginning otherwise.
        Binding("ctrl+a", "select_all", "Select all", show=False, system=True, priority=True),
    ]

    def __init__(
        self,
        opening: Opening,
        *,
        recorder: ProgressRecorder | None = None,
        settings: Settings | None = None,
        theme: str = "",
    ) -> None:
        super().__init__(opening.clock)
        self.stylesheet = SharedStylesheet(variables=self.get_css_variables())
        if self.no_color:
            # The terminal's own colours would stand among greys; they become greys, too.
            self.set_reactive(LogicalRobotsApp.ansi_color, False)
        self._settings = settings or Settings()
        self._chosen_theme = theme
        there_is: dict[Need, bool] = {
            "browser": constants.DRIVER is not None,
            "board": opening.board is not None,
            "class": opening.is_class,
        }
        has = [name for name, is_there in there_is.items() if is_there]
        KEY_MAP.set(KeyMap(COMMANDS, self._settings.keys, has=has))
        recorder = recorder or ProgressRecorder(opening.data_dir / FILE_NAME)
        self.main = MainScreen(opening, recorder)
        self._games = opening.games
        self.animation_level = "none"
        self._key_queue = KeyQueue(self)
        self._interrupted_at = float("-inf")
        self._writing = asyncio.Lock()
        self._was_cut = False
        self._clip_text = ""

    def get_theme_variable_defaults(self) -> dict[str, str]:
        """Return our style sheets' variables; empty until the first theme is set."""
        return {} if self._event_loop is None else colours_in(self.current_theme)

    def get_default_screen(self) -> MainScreen:
        return self.main

    def on_load(self) -> None:
        self._event_loop = asyncio.get_running_loop()
        lifeline.beat(self._event_loop)
        use_theme(self, self._settings.theme or self._chosen_theme)

    def refresh_css(self, animate: bool = True) -> None:
        """Recompute all styles; before the first screen, only load the theme's colours."""
        if self.screen_stack:
            super().refresh_css(animate)
        else:
            self.stylesheet.set_variables(self.get_css_variables())

    def on_mount(self) -> None:
        self.title = self.main.session.level.title
        if not self.main.permissions.programs:
            signal.signal(signal.SIGTSTP, signal.SIG_IGN)
            if not self.is_web:  # whose server ends the game
                self.watch_terminal()
        if self._games is not None:
            self.set_interval(_LOOK_FOR_WISHES, self._end_if_asked)
        self.set_interval(_LOOK_FOR_IDLENESS, stop_idle_compiling)
        for row in rows():
            if row.name != "theme":  # it was there before the first picture
                self._follow(row.name, getattr(self._settings, row.name))
        for complaint in self._settings.complaints[:_COMPLAINTS]:
            self.main.warn(complaint)
        if not writes_utf_8(screen_encoding()):
            self.main.warn(NOT_UTF_8)

    def _end_if_asked(self) -> None:
        if self._games is not None and self._games.is_to_end:
            os.kill(os.getpid(), signal.SIGHUP)

    def _follow(self, name: str, value: Any) -> None:
        """Do as a setting says; None leaves everything as it is."""
        view, editor = self.main.labyrinth.view, self.main.program.editor
        match name:
            case "theme" if value:
                self.theme = value
            case "drawing" if value:
                view.drawing = Drawing(value)
            case "frames":
                self.main.scheduler.rate.frames = value
            case "cones":
                view.rays = value
            case "trails":
                view.trails = value
            case "drag_robots":
                view.drags_robots = value
            case "completion":
                editor.completes = value
            case "wrap":
                editor.soft_wrap = value

    def change_setting(self, name: str, value: Any) -> None:
        """Follow a changed setting at once, and keep it in the player's file."""
        self._settings = self._settings._replace(**{name: value})
        defaults = {
            "theme": self._chosen_theme or NIGHT.name,
            "drawing": self._suited_drawing.value,
        }
        self._follow(name, defaults.get(name) if value is None else value)
        if self.main.permissions.programs:
            self.main.ui.spawn(partial(self._write, name), "settings", exclusive=False)

    async def _write(self, name: str) -> None:
        async with self._writing:  # the whole file is read and written
            value = getattr(self._settings, name)
            try:
                await asyncio.to_thread(write_setting, settings_path(), name, value)
            except InputError as error:
                self.main.warn(str(error))

    def choose_theme(self, name: str | None) -> None:
        """Keep a theme: in the settings if one is set there, else with the progress."""
        if name is None:
            return
        if self._settings.theme:
            self.change_setting("theme", name)
        else:
            self.theme = self._chosen_theme = name
            self.main.recorder.set_fact(THEME, name)

    async def on_event(self, event: events.Event) -> None:
        """Handle an event; keys and mouse buttons take priority over all other work."""
        typed = None
        if isinstance(event, _INPUT) and not self.screen_stack:
            return  # the game is about to end
        if isinstance(event, events.MouseDown | events.MouseMove) and self.mouse_captured is None:
            widget = widget_at(self.screen, event.x, event.y)
            if widget is not None and widget.parent is None:
                return  # what is removed, but not yet painted over: Textual would select it
        if isinstance(event, events.Key | events.Paste) and not event.is_forwarded:
            if self._key_queue.must_wait(event) or self.main.offers.ignores(event):
                return
            typed = event
        if isinstance(event, events.Key | events.MouseDown | events.Paste):
            self.main.session.pace.give_way()
            self.main.scheduler.hasten()
        await super().on_event(event)
        if typed is not None:
            self._key_queue.begin(typed)

    def post_display_hook(self) -> None:
        # Not before so much is drawn, which may take longer than a message stays.
        (columns, lines), size, was_cut = LARGEST, self.screen.size, self._was_cut
        self._was_cut = size.width >= columns or size.height >= lines
        if self._was_cut and not was_cut:
            self.main.warn(f"Only {columns} columns and {lines} lines of this terminal are drawn.")

    @property
    def backlog(self) -> int:
        """The number of unhandled keys and other events; safe to read on any thread."""
        focused = self.focused if self.screen_stack else None
        queues = [node.message_queue_size for node in (self, focused) if node is not None]
        return self._key_queue.waiting + sum(queues)

    def drop_typed(self) -> None:
        self._key_queue.forget()

    def moving_picture(self) -> Region | None:
        return self.main.labyrinth.view.region if self.screen is self.main else None

    def suit_terminal(self) -> None:
        self.main.labyrinth.view.drawing = self._suited_drawing

    @property
    def _suited_drawing(self) -> Drawing:
        return drawing_for(
            os.environ, self.console.color_system, screen_encoding(), colourless=self.no_color
        )

    def save_unsaved(self) -> None:
        """Write the drafts of all unsaved work, and a bookmark of the game's position."""
        self.main.player.autosave.flush()
        self.main.editing.flush()
        self.main.player.bookmark.flush()

    def leave_soon(self) -> None:
        """Ask the app to exit; safe on any thread and in a signal handler."""
        if self._event_loop is not None:
            self._event_loop.call_soon_threadsafe(self.exit)

    @contextmanager
    def suspend(self) -> Iterator[None]:
        with lifeline.away(), super().suspend():
            yield

    def action_suspend_process(self) -> None:
        if self.is_web:
            self.main.warn(with_keys("A browser has no shell to go to; {quit} leaves the game."))
        elif self.main.permissions.programs:
            super().action_suspend_process()
        else:
            self.main.warn(with_keys("There is no shell to go to here; {quit} leaves the game."))

    @property
    def clipboard(self) -> str:
        return self._clip_text

    def copy_to_clipboard(self, text: str) -> None:
        """Keep a text for pasting; copy it to the terminal's clipboard only if permitted."""
        self._clip_text = text
        if self.main.permissions.clipboard:
            super().copy_to_clipboard(text)

    def action_upload(self) -> None:
        """Let the page ask for a file, which comes as a message; it also takes dropped ones."""
        if not self.tell_page("upload"):
            self.main.warn("Only the page of logical-robots serve can send files.")

    def on_uploaded(self, message: Uploaded) -> None:
        from logical_robots_tui.tui.library.uploads import Uploads

        main = self.main
        uploads = Uploads(main.data_dir, main.ui, main.library, main.replays, main.offers.free)
        work = partial(uploads.receive, message.name, message.content)
        main.ui.spawn(work, "upload", exclusive=False)

    def action_settings(self) -> None:
        from logical_robots_tui.tui.app.settings_screen import SettingsScreen

        self.main.ui.show(SettingsScreen(lambda: self._settings, self.change_setting))

    def action_themes(self) -> None:
        from logical_robots_tui.tui.app.settings_screen import ThemeList

        self.main.ui.show(ThemeList(sorted(self.available_themes), self.theme), self.choose_theme)

    def action_select_all(self) -> None:
        if isinstance(text := self.focused, Input | TextArea):
            text.select_all()

    def action_interrupt(self) -> None:
        time = self.clock.now()
        if time - self._interrupted_at < _TWICE:
            self.main.quit()
        self._interrupted_at = time
        message = with_keys("Press ^C again to quit, or {quit} outside the editor.")
        self.notify(message, markup=False, timeout=_TWICE)


def play(opening: Opening, recorder: ProgressRecorder) -> int:
    """Open the game and return the exit status when the player leaves.

    The terminal is also restored after a bug.
    """
    settings = read_settings(settings_path(), KeyMap(COMMANDS).read)
    theme = recorder.progress.fact(THEME) or ""
    app = LogicalRobotsApp(opening, recorder=recorder, settings=settings, theme=theme)
    app.suit_terminal()
    put_back = end_on_hangup(app.save_unsaved, app.leave_soon)
    try:
        app.run(mouse=may_use_mouse(os.environ))
    except Exception:
        if app.mistake is None:
            app.save_unsaved()
            raise
    finally:
        put_back()
    if app.mistake is not None:
        raise app.mistake
    return app.return_code or 0


def rehearse() -> None:
    """Open the game without a terminal and leave it, before it is forked for players.

    What Python, Textual and the compiler have done once is then done for all of them.
    """

    async def look_around(pilot: Pilot[object]) -> None:
        while app.main.session.state.phase in ("fresh", "compiling"):
            await pilot.pause(_LOOK_FOR_WORK)
        for key in _REHEARSED:
            await pilot.press(key)
            while any(worker.node is app.screen for worker in app.workers):
                await pilot.pause(_LOOK_FOR_WORK)
            await pilot.press("escape")
        app.exit()

    with TemporaryDirectory() as folder:
        recorder = ProgressRecorder(Path(folder) / FILE_NAME)
        opening = open_game(recorder.progress, Path(folder))
        app = LogicalRobotsApp(opening, recorder=recorder)
        app.run(headless=True, auto_pilot=look_around)
    stop_compiling()
    if app.mistake is not None:
        raise app.mistake
