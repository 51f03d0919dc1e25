"""What each command of editing does."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from logical_robots_tui.tui.commands.table import editing_commands, with_keys
from logical_robots_tui.tui.level_editor.tools import Tool

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from logical_robots_tui.tui.level_editor.mode import EditMode

__all__ = ["EditActions"]


class EditActions:
    """One method for each command, called as the command is.

    Args:
        mode: What edits.
    """

    def __init__(self, mode: EditMode) -> None:
        self._mode = mode
        self._editor = mode.editor

    def settle(self, **values: Any) -> None:
        """Set how tools work; a stroke under way ends."""
        self._editor.finish()
        self._editor.settings = replace(self._editor.settings, **values)

    # -- tools ---------------------------------------------------------------------------------

    def hand(self) -> None:
        """Take things."""
        self.settle(tool=Tool.HAND)

    def brush(self) -> None:
        """Paint walls."""
        self.settle(tool=Tool.BRUSH)

    def line(self) -> None:
        """Draw lines."""
        self.settle(tool=Tool.LINE)

    def rectangle(self) -> None:
        """Draw rectangles."""
        self.settle(tool=Tool.RECTANGLE)

    def fill(self) -> None:
        """Fill regions."""
        self.settle(tool=Tool.FILL)

    def eraser(self) -> None:
        """Wipe walls away."""
        self.settle(tool=Tool.ERASER)

    def robot(self) -> None:
        """Place robots."""
        self.settle(tool=Tool.ROBOT)

    def beacon(self) -> None:
        """Place beacons."""
        self.settle(tool=Tool.BEACON)

    def area(self) -> None:
        """Place areas."""
        self.settle(tool=Tool.AREA)

    def thinner(self) -> None:
        """Make brush and border narrower."""
        self._editor.settings = self._editor.settings.wider(-1)

    def thicker(self) -> None:
        """Make brush and border wider."""
        self._editor.settings = self._editor.settings.wider(1)

    def ink(self) -> None:
        """Draw in wall or in floor."""
        self.settle(is_wall=not self._editor.settings.is_wall)

    def outline(self) -> None:
        """Draw rectangles filled, or their border."""
        self.settle(is_filled=not self._editor.settings.is_filled)

    def grid(self) -> None:
        """Show the grid, or hide it."""
        settings = self._editor.settings
        self._editor.settings = replace(settings, is_grid_shown=not settings.is_grid_shown)

    def grid_size(self) -> None:
        """Choose the next size of squares."""
        self._editor.settings = self._editor.settings.next_grid()

    def use(self) -> None:
        """Use the tool at the cursor."""
        self._mode.pointer.use()

    # -- changes -------------------------------------------------------------------------------

    def undo(self) -> None:
        """Undo a step, or the stroke under way."""
        if not self._editor.cancel():
            what = self._editor.undo()
            self._mode.screen.tell(f"Undone: {what}." if what else "There is nothing to undo.")

    def redo(self) -> None:
        """Do again what was undone."""
        what = self._editor.redo()
        self._mode.screen.tell(f"Done again: {what}." if what else "There is nothing to do again.")

    def next_thing(self) -> None:
        """Select the next thing."""
        self._select(1)

    def previous_thing(self) -> None:
        """Select the thing before."""
        self._select(-1)

    def turn_left(self) -> None:
        """Turn the robot to its left."""
        self._editor.turn(-1)

    def turn_right(self) -> None:
        """Turn the robot to its right."""
        self._editor.turn(1)

    def duplicate(self) -> None:
        """Place another one."""
        self._editor.duplicate()

    def delete(self) -> None:
        """Take the selected thing away."""
        self._editor.delete()

    # -- dialogs -------------------------------------------------------------------------------

    def properties(self) -> None:
        """Change the properties of the selected thing."""
        from logical_robots_tui.tui.level_editor.forms import ThingForm

        ref = self._editor.selected
        if ref is None or self._editor.thing is None:
            what = with_keys("Select a thing first: click it, or press {next_thing}.")
            self._mode.screen.warn(what)
        else:
            self._mode.screen.app.push_screen(ThingForm(self._mode.editor, ref), self._closed)

    def level_properties(self) -> None:
        """Change the properties of the level."""
        from logical_robots_tui.tui.level_editor.level_form import LevelForm

        self._mode.screen.app.push_screen(LevelForm(self._mode.editor), self._closed)

    def findings(self) -> None:
        """List what looks wrong."""
        self._spawn(self._choose_finding)

    def save_level(self) -> None:
        """Save the level in its file, or ask for a name."""
        from logical_robots_tui.tui.level_editor.saving import save

        self._editor.finish()
        self._spawn(partial(save, self._mode))

    def save_level_as(self) -> None:
        """Save the level under another name."""
        from logical_robots_tui.tui.level_editor.saving import save_as

        self._editor.finish()
        self._spawn(partial(save_as, self._mode))

    def throw_away(self) -> None:
        """Go back to the level as it was."""
        from logical_robots_tui.tui.level_editor.saving import ask_to_throw_away

        self._spawn(partial(ask_to_throw_away, self._mode))

    def stop_editing(self) -> None:
        """End the stroke under way, or go back to playing."""
        if self._editor.cancel():
            return
        if not self._mode.is_saved:
            from logical_robots_tui.tui.level_editor.saving import ask_what_to_keep

            self._spawn(partial(ask_what_to_keep, self._mode))
        else:
            self._mode.leave()

    # -- playing -------------------------------------------------------------------------------

    def test(self) -> None:
        """Play the level from its start."""
        mode = self._mode
        mode.leave()
        mode.is_testing = True
        mode.screen.labyrinth.note(f"test: {editing_commands()['test'].key_name} ends it")
        mode.screen.celebration.forget()
        mode.screen.session.restart()
        mode.screen.session.run()

    def end_test(self) -> None:
        """Come back from playing."""
        self._mode.screen.session.restart()
        self._mode.screen.celebration.forget()
        self._mode.enter()

    # -- inside --------------------------------------------------------------------------------

    def _select(self, steps: int) -> None:
        self._editor.select_next(steps)
        self._mode.pointer.go_to(self._editor.cursor)

    def _closed(self, _: object) -> None:
        self._mode.redraw()

    def _spawn(self, work: Callable[[], Coroutine[Any, Any, object]]) -> None:
        async def done() -> None:
            await work()

        self._mode.screen.spawn(done, "library", exclusive=True)

    async def _choose_finding(self) -> None:
        from logical_robots_tui.tui.level_editor.finding_list import FindingList

        mode = self._mode
        if mode.findings is None:
            mode.screen.tell("The level is being looked through.")
            return
        if not mode.findings:
            mode.screen.tell("Nothing looks wrong.")
            return
        finding = await mode.screen.app.push_screen_wait(FindingList(mode.findings))
        if finding is not None and finding.x is not None and finding.y is not None:
            mode.pointer.go_to((finding.x, finding.y))
        mode.redraw()
