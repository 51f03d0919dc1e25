"""What the commands for writing do: what their keys do in the editor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.screen_actions import ScreenActions

if TYPE_CHECKING:
    from logical_robots_tui.tui.program.editor import Editor

__all__ = ["WritingActions"]


class WritingActions(ScreenActions):
    """One method for each command of the editor."""

    def _enter(self) -> Editor:
        self._screen.go_to(self._screen.program)
        return self._screen.program.editor

    def complete(self) -> None:
        """Offer what could stand at the cursor."""
        # Where the cursor is on the screen is known once the pane is there.
        self._screen.call_after_refresh(self._enter().action_complete)

    def take_back(self) -> None:
        """Take back the last edit."""
        self._enter().action_undo()

    def do_again(self) -> None:
        """Do an edit again that was taken back."""
        self._enter().action_redo()

    def comment(self) -> None:
        """Make lines comments, or text again."""
        self._enter().action_toggle_comment()

    def indent(self) -> None:
        """Indent the selected lines."""
        self._enter().action_indent()

    def dedent(self) -> None:
        """Take a step of indentation back."""
        self._enter().action_dedent()

    def cut(self) -> None:
        """Cut what is selected, or the line."""
        self._enter().action_cut()

    def copy(self) -> None:
        """Copy what is selected."""
        editor = self._enter()
        if editor.selected_text:
            editor.action_copy()
        else:
            self._screen.tell("Select something to copy first.")

    def paste(self) -> None:
        """Put in what was cut or copied last."""
        self._enter().action_paste()

    def select_line(self) -> None:
        """Select the line of the cursor."""
        self._enter().action_select_line()

    def text_start(self) -> None:
        """Go to the start of the text."""
        self._enter().action_go_to_start()

    def text_end(self) -> None:
        """Go to the end of the text."""
        self._enter().action_go_to_end()

    def delete_to_end(self) -> None:
        """Delete to the end of the line."""
        delete = self._enter().action_delete_to_end_of_line_or_delete_line
        self._screen.spawn(delete, "writing", exclusive=False)

    def delete_to_start(self) -> None:
        """Delete to the start of the line."""
        self._enter().action_delete_to_start_of_line()

    def delete_word(self) -> None:
        """Delete the word before the cursor."""
        self._enter().action_delete_word_left()
