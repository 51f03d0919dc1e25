"""The editor: a text area that knows Logica's words and shows where a mistake is."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual.binding import Binding
from textual.geometry import Offset
from textual.message import Message
from textual.widgets import TextArea
from textual.widgets.text_area import Selection, TextAreaTheme

from logical_robots_tui.tui.program.completion import Completion, word_around, words_for
from logical_robots_tui.tui.program.lexer import LONGEST_LINE, LineStates, pieces
from logical_robots_tui.tui.program.mistakes import marked
from logical_robots_tui.tui.program.text_operations import WIDTH, indentation_after, shifted
from logical_robots_tui.tui.theme.safe_text import visible
from logical_robots_tui.tui.theme.themes import INK, SYNTAX, rich_style

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.style import Style
    from textual import events
    from textual.strip import Strip
    from textual.theme import Theme
    from textual.widgets.text_area import Edit, EditResult

    from logical_robots_tui.tui.program.mistakes import Mark

__all__ = ["Editor"]

_A_PASTE = 0.005
"""Seconds between two keys below which nobody has typed them."""


class Editor(TextArea):
    """Edits the text of a program. Escape leaves it."""

    DEFAULT_CSS = """
    Editor { border: none; padding: 0; background: $surface; }
    Editor:focus { border: none; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("ctrl+underscore,ctrl+slash", "toggle_comment", show=False),
        Binding("ctrl+@,ctrl+space", "complete", show=False),
        Binding("tab", "indent", show=False),
        Binding("shift+tab", "dedent", show=False),
        Binding("ctrl+home", "go_to_start", show=False),
        Binding("ctrl+end", "go_to_end", show=False),
    ]

    class Leave(Message):
        """The player wants to go elsewhere."""

    class Copied(Message):
        """A text was copied or cut.

        Attributes:
            text: Which one.
        """

        def __init__(self, text: str) -> None:
            super().__init__()
            self.text = text

    def __init__(self) -> None:
        super().__init__(
            id="text",
            show_line_numbers=True,
            soft_wrap=False,
            compact=True,
            max_checkpoints=500,
        )
        self.cursor_blink = False
        self.indent_width = WIDTH
        own = Binding.make_bindings([*TextArea.BINDINGS, *self.BINDINGS])
        self._actions = {binding.key: binding.action for binding in own}
        self._states = LineStates()
        self._last_key_at = float("-inf")
        self._syntax: dict[str, Style] = {}
        self._marks: Mapping[int, Mark] = {}
        self._pointed_out: Selection | None = None
        self.completion = Completion()

    def on_mount(self) -> None:
        """Dress as the theme says, and again when it changes."""
        self._dress(self.app.current_theme)
        self.app.theme_changed_signal.subscribe(self, self._dress)

    def _dress(self, theme: Theme) -> None:
        self._syntax = {kind: rich_style(text) for kind, text in SYNTAX.items()}
        dress = TextAreaTheme(
            name=f"logica-{theme.name}",
            cursor_line_style=rich_style("on $row"),
            cursor_line_gutter_style=rich_style(f"{INK.title} on $row"),
            gutter_style=rich_style(INK.faint),
            selection_style=rich_style("on $selection"),
            bracket_matching_style=rich_style("bold on $bracket"),
        )
        self.register_theme(dress)
        self.theme = dress.name

    # -- content -------------------------------------------------------------------------------

    def put(self, text: str) -> None:
        """Replace the whole text as one edit that can be undone; the cursor stays in its line."""
        place = self.cursor_location
        if text != self.text:
            self.replace(text, self.document.start, self.document.end)
        self.move_cursor(place)

    def load_text(self, text: str) -> None:
        """Begin with another text; there is nothing to undo then."""
        self._states.forget()
        super().load_text(text)

    def edit(self, edit: Edit) -> EditResult:
        """Change the text."""
        self._states.forget(edit.top[0])
        return super().edit(edit)

    def undo(self) -> None:
        """Take back the last edit."""
        self._states.forget()
        super().undo()

    def redo(self) -> None:
        """Do an edit again that was taken back."""
        self._states.forget()
        super().redo()

    def mark(self, marks: Mapping[int, Mark]) -> None:
        """Mark lines that hold a mistake or look odd, by their numbers from 0."""
        if marks != self._marks:
            self._marks = marks
            self.notify_style_update()
            self.refresh()

    # -- keys ----------------------------------------------------------------------------------

    async def on_key(self, event: events.Key) -> None:
        """Take keys before the text area does.

        Escape leaves. Keys that move or delete are obeyed here, because as bindings they would
        come too late, after letters that arrive in the same moment.
        """
        hurried = event.time - self._last_key_at < _A_PASTE
        self._last_key_at = event.time
        if self.completion.display and self._takes(event.key):
            event.stop()
            event.prevent_default()
            return
        action = self._actions.get(event.key)
        if event.key not in ("escape", "enter", "ctrl+j") and action is None:
            return
        if action == "copy" and not self.selected_text:
            return  # there is nothing to copy: the key means what it means elsewhere
        event.stop()
        event.prevent_default()
        if event.key == "escape":
            self.post_message(self.Leave())
        elif action is not None:
            await self.run_action(action)
        else:
            self._end_line(as_it_is=hurried or event.key == "ctrl+j")

    def _end_line(self, *, as_it_is: bool) -> None:
        """Begin a new line, indented as fits.

        A terminal that does not mark pastes sends them as keys, with control-J or enter for the
        ends of lines; those bring their own indentation.
        """
        start, end = sorted(self.selection)
        before = self.document.get_line(start[0])[: start[1]]
        indentation = "" if as_it_is else indentation_after(before)
        self.replace(f"\n{indentation}", start, end, maintain_selection_offset=False)

    # -- help while typing ---------------------------------------------------------------------

    @property
    def before_cursor(self) -> str:
        """The line of the cursor up to it."""
        row, column = self.cursor_location
        return self.document.get_line(row)[:column]

    @property
    def word(self) -> str:
        """The word that the cursor touches, or ""."""
        row, column = self.cursor_location
        return word_around(self.document.get_line(row), column)

    def action_complete(self) -> None:
        """Offer what could stand at the cursor."""
        _, words = words_for(self.text, self.before_cursor)
        self.completion.offer(words, self.cursor_screen_offset)

    def on_text_area_changed(self) -> None:
        """Offer what fits what is typed by now; a word that is complete needs no list."""
        if self.completion.display:
            self.action_complete()
            if self.completion.names == [self.word]:
                self.completion.close()

    def point_out(self, start: tuple[int, int], stop: tuple[int, int]) -> None:
        """Select a piece of the text to be seen, from elsewhere; typing does not replace it.

        Args:
            start: Line and column from 0 where it begins; the cursor goes there.
            stop: Where it ends.
        """
        self.selection = self._pointed_out = Selection(stop, start)
        self.scroll_cursor_visible(center=True)

    def on_focus(self) -> None:
        """What was only pointed out is not selected for whoever begins to write."""
        if self.selection == self._pointed_out:
            self.selection = Selection.cursor(self.cursor_location)
        self._pointed_out = None

    def on_blur(self) -> None:
        """Offer nothing to somebody who is elsewhere."""
        self.completion.close()

    def _takes(self, key: str) -> bool:
        """Use a key for the list of words; whether it is one for that."""
        if key in ("up", "down"):
            move = self.completion.action_cursor_up, self.completion.action_cursor_down
            move[key == "down"]()
        elif key in ("enter", "tab"):
            self._complete()
        elif key == "escape":
            self.completion.close()
        else:
            if len(key) > 1 and key not in ("backspace", "underscore", "full_stop"):
                self.completion.close()
            return False
        return True

    def _complete(self) -> None:
        chosen = self.completion.chosen
        self.completion.close()
        if chosen is not None:
            begun, _ = words_for("", self.before_cursor)
            row, column = self.cursor_location
            self.replace(
                chosen.name, (row, column - begun), (row, column), maintain_selection_offset=False
            )

    def action_copy(self) -> None:
        """Copy what is selected, and say so."""
        super().action_copy()
        self.post_message(self.Copied(self.app.clipboard))

    def action_cut(self) -> None:
        """Cut what is selected, or the line, and say so."""
        super().action_cut()
        self.post_message(self.Copied(self.app.clipboard))

    def action_toggle_comment(self) -> None:
        """Make the selected lines comments, or make them text again, as one edit."""
        lines = self._chosen_lines()
        written = [line for line in lines if line.strip()]
        if not written:
            return
        if all(line.lstrip().startswith("#") for line in written):
            changed = [_without_comment(line) for line in lines]
        else:
            changed = [f"# {line}" if line.strip() else line for line in lines]
        self._change_lines(changed)

    def action_indent(self) -> None:
        """Indent the selected lines, or go to the next step within a line."""
        start, end = self.selection
        if start[0] != end[0]:
            self._change_lines(shifted(self._chosen_lines(), back=False))
        else:
            spaces = " " * (WIDTH - min(start, end)[1] % WIDTH)
            self.replace(spaces, start, end, maintain_selection_offset=False)

    def action_dedent(self) -> None:
        """Take a step of indentation from the selected lines, or from the line of the cursor."""
        self._change_lines(shifted(self._chosen_lines(), back=True))

    def action_go_to_start(self) -> None:
        """Go to the start of the text."""
        self.move_cursor(self.document.start)

    def action_go_to_end(self) -> None:
        """Go to the end of the text."""
        self.move_cursor(self.document.end)

    def _chosen_rows(self) -> tuple[int, int]:
        """The first and the last line of the selection."""
        (first, _), (last, column) = sorted(self.selection)
        return first, last - (last > first and column == 0)

    def _chosen_lines(self) -> list[str]:
        first, last = self._chosen_rows()
        return [self.document.get_line(number) for number in range(first, last + 1)]

    def _change_lines(self, changed: list[str]) -> None:
        """Put other lines in place of the selected ones, as one edit; they stay selected."""
        first, last = self._chosen_rows()
        before, selection = self._chosen_lines(), self.selection
        if changed == before:
            return
        self.replace("\n".join(changed), (first, 0), (last, len(before[-1])))

        def moved(place: tuple[int, int]) -> tuple[int, int]:
            row, column = place
            if not first <= row <= last:
                return place
            longer = len(changed[row - first]) - len(before[row - first])
            return row, max(column + longer, 0) if column else 0

        self.selection = Selection(moved(selection.start), moved(selection.end))

    def scroll_cursor_visible(self, center: bool = False, animate: bool = False) -> Offset:
        """Scroll so that the cursor is seen; a text area without room waits until it has some.

        In the middle of undoing the cursor may stand behind the end of a text that has shrunk;
        it is put right, and looked for again, before undoing ends.
        """
        if not self.content_size.area or self.cursor_location[0] >= self.document.line_count:
            return Offset()
        return super().scroll_cursor_visible(center, animate)

    def on_resize(self) -> None:
        """Keep the cursor in sight."""
        self.scroll_cursor_visible()

    # -- drawing -------------------------------------------------------------------------------

    def get_line(self, line_index: int) -> Text:
        """A line with its colours. Control characters are shown, not sent to the terminal."""
        line = self.document.get_line(line_index)
        text = Text(visible(line, tabs=True), end="", no_wrap=True)
        if len(line) <= LONGEST_LINE:
            state = self._states.at(line_index, self.document.get_line)
            for start, end, kind in pieces(line, state):
                text.stylize(self._syntax[kind], start, end)
        if line_index in self._marks and self._marks[line_index].is_wrong:
            text.stylize(self._syntax["mistake"])
        return text

    def render_line(self, y: int) -> Strip:
        """A line of the widget, with what is to be said about it."""
        strip = super().render_line(y)
        number = self.scroll_offset.y + y
        mark = self._marks.get(number)
        if mark is None or number >= self.document.line_count:
            return strip
        return marked(strip, mark, number, self.gutter_width, self._syntax)


def _without_comment(line: str) -> str:
    before, _, after = line.partition("#")
    return before + after.removeprefix(" ")
