"""The program pane: the editor, what became of the text, and what is wrong with it."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.widgets.text_area import Selection

from logical_robots_tui.tui.pane import Pane
from logical_robots_tui.tui.plain import clip, one_line
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.program.mistakes import MistakeStrip

if TYPE_CHECKING:
    from logical_robots_tui.tui.program.state import ProgramState

__all__ = ["ProgramPane"]


class ProgramPane(Pane):
    """Shows and edits the text of the program at hand."""

    command_id: ClassVar[str] = "editor"

    def __init__(self) -> None:
        self.editor = Editor()
        self._strip = MistakeStrip()
        self._state: ProgramState | None = None
        super().__init__(self.editor, self._strip, title="Program")

    @property
    def text(self) -> str:
        """What stands in the editor."""
        return self.editor.text

    def show(self, state: ProgramState, name: str, *, saved: bool) -> None:
        """Show what became of the text.

        Args:
            state: How far the program is.
            name: The program's name.
            saved: Whether the text is that of the program's file.
        """
        star = "" if saved else "*"
        self.note(f"{clip(one_line(name), 24)}{star} · {self._verdict(state)}")
        if state is not self._state:
            self._state = state
            self._strip.show(state.mistakes)
            wrong = (m for m in state.mistakes if m.severity == "error")
            self.editor.mark(frozenset(mistake.line - 1 for mistake in wrong))

    def go_to_mistake(self) -> None:
        """Put the cursor on the first mistake, if there is one."""
        if self._state is not None and self._state.mistakes:
            mistake = self._state.mistakes[0]
            self.editor.move_cursor((mistake.line - 1, mistake.column - 1), center=True)
        self.enter()

    def show_place(self, start: int, stop: int) -> None:
        """Select a piece of the text, given by its offsets, and bring it into sight."""
        places = []
        for offset in (start, stop):
            before = self.text[:offset]
            places.append((before.count("\n"), offset - before.rfind("\n") - 1))
        self.editor.selection = Selection(places[1], places[0])
        self.editor.scroll_cursor_visible(center=True)

    def enter(self) -> None:
        """Put the focus into the text."""
        self.screen.set_focus(self.editor)

    @on(MistakeStrip.Chosen)
    def _mistake_chosen(self) -> None:
        self.go_to_mistake()

    def _verdict(self, state: ProgramState) -> str:
        if state.phase == "compiling":
            done, of_all = state.compiled
            return f"compiling… {done} of {of_all}" if of_all else "compiling…"
        text = self.text
        if state.phase == "mistake" and text == state.tried:
            count = len(state.mistakes)
            return "1 mistake" if count == 1 else f"{count} mistakes"
        if text != state.applied:
            return "edited, not applied"
        count = len(state.mistakes)
        return "applied" + (f", {count} warning{'s' * (count > 1)}" if count else "")
