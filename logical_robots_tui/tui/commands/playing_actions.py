"""What the commands for playing do."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.screen_actions import ScreenActions
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.timeline.controller import TEN
from logical_robots_tui.tui.timeline.search import Search

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["PlayingActions"]


class PlayingActions(ScreenActions):
    """One method for each command of time, programs, levels and learning."""

    def __init__(self, screen: MainScreen) -> None:
        super().__init__(screen)
        self._search = Search(screen)

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

    def seek(self) -> None:
        """Ask for a question, and go to the next tick in which it holds."""
        self._screen.spawn(self._search.ask, "seek", exclusive=True)

    def seek_next(self) -> None:
        """Go to the next tick in which the question holds."""
        self._screen.spawn(partial(self._search.go, 1), "seek", exclusive=True)

    def seek_previous(self) -> None:
        """Go to the last tick before in which the question holds."""
        self._screen.spawn(partial(self._search.go, -1), "seek", exclusive=True)

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

    def select_all(self) -> None:
        """Select the whole text of the program."""
        self._screen.go_to(self._screen.program)
        self._screen.program.editor.select_all()

    def external(self) -> None:
        """Edit the text in another program."""
        self._screen.scribe.edit_elsewhere()

    def rename(self) -> None:
        """Rename the predicate under the cursor."""
        self._screen.spawn(self._screen.scribe.rename, "library", exclusive=True)

    def level(self) -> None:
        """Choose a level."""
        self._screen.spawn(self._screen.library.choose_level, "library", exclusive=True)

    def edit_level(self) -> None:
        """Edit the level at hand."""
        self._screen.editing.open()

    def new_level(self) -> None:
        """Make a level."""
        from logical_robots_tui.tui.level_editor.new_level import make_level

        screen = self._screen
        work = partial(make_level, screen, screen.editing.own)
        screen.spawn(work, "library", exclusive=True)

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
