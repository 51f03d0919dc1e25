"""What each command does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.drawing.glyphs import Drawing
from logical_robots_tui.tui.plain import one_line
from logical_robots_tui.tui.sparing import SparingApp
from logical_robots_tui.tui.timeline.travel import TEN

if TYPE_CHECKING:
    from logical_robots_tui.tui.screen import MainScreen

__all__ = ["Actions"]


class Actions:
    """One method for each command, called as the command is.

    Args:
        screen: What to act on.
    """

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen

    def run(self) -> None:
        """Run or pause."""
        self._screen.labyrinth.briefing.display = False
        state = self._screen.session.state
        if self._screen.session.game is None and state.phase == "mistake":
            self._screen.warn(f"The program has a mistake in line {state.mistakes[0].line}.")
        self._screen.session.toggle_run()

    def step(self) -> None:
        """Compute one tick."""
        self._screen.labyrinth.briefing.display = False
        self._screen.session.step()

    def back(self) -> None:
        """Return to the tick before."""
        self._screen.session.back()

    def step_ten(self) -> None:
        """Go ten ticks on."""
        self._screen.labyrinth.briefing.display = False
        self._screen.session.step(TEN)

    def back_ten(self) -> None:
        """Return by ten ticks."""
        self._screen.session.back(TEN)

    def first(self) -> None:
        """Go to the earliest tick in history."""
        self._screen.travel.first()

    def last(self) -> None:
        """Go to the latest tick that is known."""
        self._screen.travel.last()

    def go_to(self) -> None:
        """Go to any tick of history."""
        self._screen.spawn(self._screen.travel.ask_for_tick, "library", exclusive=True)

    def previous_mark(self) -> None:
        """Go to where something happened before."""
        self._screen.travel.to_mark(-1)

    def next_mark(self) -> None:
        """Go to where something happened next."""
        self._screen.travel.to_mark(1)

    def run_until(self) -> None:
        """Run until a tick."""
        self._screen.labyrinth.briefing.display = False
        self._screen.spawn(self._screen.travel.ask_how_far, "library", exclusive=True)

    def breakpoints(self) -> None:
        """Show the breakpoints."""
        self._screen.travel.breakpoints()

    def other_future(self) -> None:
        """Go over to the other future."""
        self._screen.travel.change_course()

    def compare(self) -> None:
        """Go to where the two futures part."""
        self._screen.travel.compare()

    def timeline(self) -> None:
        """Go to the timeline."""
        self._screen.set_focus(self._screen.timeline)

    def restart(self) -> None:
        """Begin the level again."""
        self._screen.session.restart()
        self._screen.celebration.forget()

    def faster(self) -> None:
        """Choose the next higher speed."""
        self._screen.session.faster()

    def slower(self) -> None:
        """Choose the next lower speed."""
        self._screen.session.slower()

    def apply(self) -> None:
        """Compile the text in the editor and use it."""
        self._screen.session.apply(self._screen.text)

    def mistake(self) -> None:
        """Go to the mistake."""
        self._screen.go_to(self._screen.program)
        self._screen.program.go_to_mistake()

    def definition(self) -> None:
        """Go to the definition of the predicate under the cursor."""
        self._screen.go_to(self._screen.program)
        word = self._screen.program.go_to_definition()
        if word:
            self._screen.tell(f"{one_line(word)} is not defined in this program.")

    def find(self) -> None:
        """Find or replace a text in the program."""
        self._screen.spawn(self._screen.scribe.find, "library", exclusive=True)

    def find_next(self) -> None:
        """Go to the next place."""
        self._screen.scribe.find_next()

    def external(self) -> None:
        """Edit the text in another program."""
        self._screen.scribe.edit_elsewhere()

    def rename(self) -> None:
        """Rename the predicate under the cursor."""
        self._screen.spawn(self._screen.scribe.rename, "library", exclusive=True)

    def level(self) -> None:
        """Choose a level."""
        self._screen.spawn(self._screen.library.choose_level, "library", exclusive=True)

    def next_level(self) -> None:
        """Go on to the next level."""
        self._screen.spawn(self._screen.library.next_level, "library", exclusive=True)

    def program(self) -> None:
        """Choose a program."""
        self._screen.spawn(self._screen.library.choose_program, "library", exclusive=True)

    def save(self) -> None:
        """Save the text as a program of the player's own."""
        self._screen.spawn(self._screen.library.save, "library", exclusive=True)

    def revert(self) -> None:
        """Put the text of the file into the editor again."""
        self._screen.replace_text(self._screen.session.source.text)

    def versions(self) -> None:
        """Bring an earlier version of the program back."""
        self._screen.spawn(self._screen.guide.choose_version, "library", exclusive=True)

    def reset(self) -> None:
        """Put the level's starter program back."""
        self._screen.spawn(self._screen.guide.reset, "library", exclusive=True)

    def hint(self) -> None:
        """Show the hints revealed so far, and offer the next one."""
        self._screen.guide.hints()

    def lesson(self) -> None:
        """Read the lesson."""
        self._screen.guide.lesson()

    def results(self) -> None:
        """Show or hide the best results."""
        self._screen.labyrinth.banner.toggle(self._screen.journal)
        self._screen.go_to(self._screen.labyrinth)

    def solution(self) -> None:
        """Read the reference program."""
        self._screen.spawn(self._screen.guide.solution, "library", exclusive=True)

    def stop_measuring(self) -> None:
        """End the trials from shifted starts."""
        if not self._screen.journal.stop_measuring():
            self._screen.tell("Nothing is being tried.")

    def tour(self) -> None:
        """Walk round the screen."""
        self._screen.tours.begin()

    def labyrinth(self) -> None:
        """Go to the labyrinth."""
        self._screen.go_to(self._screen.labyrinth)

    def editor(self) -> None:
        """Go to the program's text."""
        self._screen.go_to(self._screen.program)

    def inspector(self) -> None:
        """Go to the inspector."""
        self._screen.go_to(self._screen.inspector)

    def why(self) -> None:
        """Say why."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.why()

    def ask(self) -> None:
        """Type a query."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.ask()

    def watch(self) -> None:
        """Show what is pinned."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.go_to_pins()

    def pin(self) -> None:
        """Pin what the cursor is on."""
        self._screen.rows.pin()

    def open_value(self) -> None:
        """Open a value as a tree."""
        self._screen.rows.open_value()

    def machinery(self) -> None:
        """Show how predicates are computed."""
        self._screen.spawn(self._screen.rows.machinery, "machinery", exclusive=True)

    def only_robot(self) -> None:
        """Show the rows of one robot."""
        self._screen.rows.only_robot()

    def sort(self) -> None:
        """Sort by the column under the cursor."""
        self._screen.rows.sort()

    def search_rows(self) -> None:
        """Show only rows with a text."""
        self._screen.spawn(self._screen.rows.search, "library", exclusive=True)

    def turn(self) -> None:
        """Turn the table on its side."""
        self._screen.rows.turn()

    def copy_rows(self) -> None:
        """Copy the rows."""
        self._screen.rows.copy()

    def save_rows(self) -> None:
        """Save the rows."""
        self._screen.rows.save()

    def stop_here(self) -> None:
        """Stop when what is inspected changes."""
        self._screen.rows.stop_here()

    def leave(self) -> None:
        """Go to the labyrinth and close what lies over it."""
        if self._screen.arrangement.active is self._screen.labyrinth:
            self._screen.labyrinth.select(None)
            self._screen.labyrinth.banner.display = False
            self._screen.labyrinth.briefing.display = False
        self._screen.go_to(self._screen.labyrinth)

    def next_pane(self) -> None:
        """Go to the next pane."""
        self._screen.go_to(self._screen.arrangement.beside_active(1))

    def previous_pane(self) -> None:
        """Go to the pane before."""
        self._screen.go_to(self._screen.arrangement.beside_active(-1))

    def maximise(self) -> None:
        """Give the pane that is worked in all the room, or no longer."""
        self._screen.arrangement.toggle_large()
        self._screen.arrangement.show()

    def hide(self) -> None:
        """Hide the pane that is worked in, or show all again."""
        self._screen.go_to(self._screen.arrangement.hide(self._screen.arrangement.active))

    def wider(self) -> None:
        """Give the program more columns."""
        self._resize(columns=4)

    def narrower(self) -> None:
        """Give the labyrinth more columns."""
        self._resize(columns=-4)

    def higher(self) -> None:
        """Give the inspector more rows."""
        self._resize(rows=2)

    def lower(self) -> None:
        """Give the labyrinth more rows."""
        self._resize(rows=-2)

    def _resize(self, columns: int = 0, rows: int = 0) -> None:
        self._screen.arrangement.change(columns, rows)
        self._screen.arrangement.show()

    def view(self) -> None:
        """Look at the next thing."""
        self._screen.labyrinth.view.look_at_next()

    def zoom_in(self) -> None:
        """Show less, larger."""
        self._screen.labyrinth.view.zoom(1)

    def zoom_out(self) -> None:
        """Show more."""
        self._screen.labyrinth.view.zoom(-1)

    def next_robot(self) -> None:
        """Select the next robot."""
        self._screen.labyrinth.view.select_next()

    def rays(self) -> None:
        """Show or hide what the radars reach."""
        self._screen.labyrinth.view.rays = not self._screen.labyrinth.view.rays

    def ray_lines(self) -> None:
        """Draw each ray of the selected robot, or none."""
        view = self._screen.labyrinth.view
        view.lines = not view.lines
        if view.lines and view.selected is None:
            view.select_next()

    def trails(self) -> None:
        """Show or hide where the robots came from."""
        self._screen.labyrinth.view.trails = not self._screen.labyrinth.view.trails

    def drawing(self) -> None:
        """Draw in the next way."""
        ways = list(Drawing)
        view = self._screen.labyrinth.view
        view.drawing = ways[(ways.index(view.drawing) + 1) % len(ways)]
        self._screen.tell(f"Drawn in {view.drawing.value}.")

    def briefing(self) -> None:
        """Show or hide what the level asks for."""
        if not self._screen.labyrinth.briefing.toggle():
            self._screen.tell("This level says nothing about itself.")

    def help(self) -> None:
        """Show the help."""
        from logical_robots_tui.tui.dialogs.help import Help

        self._screen.app.push_screen(
            Help(self._screen.labyrinth.view.drawing, self._screen.worked_in)
        )

    def palette(self) -> None:
        """Find a command by its name."""
        from textual.command import CommandPalette

        from logical_robots_tui.tui.palette import CommandProvider

        self._screen.app.push_screen(
            CommandPalette([CommandProvider], placeholder="Find a command…")
        )

    def theme(self) -> None:
        """Choose a theme."""
        from textual.command import CommandPalette
        from textual.theme import ThemeProvider

        self._screen.app.push_screen(CommandPalette([ThemeProvider], placeholder="Find a theme…"))

    def screenshot(self) -> None:
        """Save what is shown, once the palette is gone."""
        self._screen.call_after_refresh(self._screen.capture.picture)

    def record(self) -> None:
        """Begin to record the screen, or end it."""
        self._screen.capture.toggle_recording()

    def redraw(self) -> None:
        """Paint the whole screen again."""
        if isinstance(self._screen.app, SparingApp):
            self._screen.app.forget_terminal()
        self._screen.refresh(layout=True, repaint=True)

    def quit(self) -> None:
        """Leave the game."""
        self._screen.app.exit()
