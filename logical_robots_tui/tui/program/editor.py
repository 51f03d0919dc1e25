"""The editor: a text area with completion for Logica and marked errors."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual import events, on
from textual.binding import Binding
from textual.geometry import Offset
from textual.message import Message
from textual.strip import Strip
from textual.theme import Theme
from textual.widgets import TextArea
from textual.widgets.text_area import Edit, EditResult, Selection, TextAreaTheme
from wcwidth import iter_graphemes

from logical_robots_tui.language.services.completion import word_around, word_before, words_for
from logical_robots_tui.language.services.editing import (
    WIDTH,
    indentation_after,
    shift_lines,
    toggle_comments,
)
from logical_robots_tui.language.services.lexer import LineStates, pieces
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.tui.layout.command_bar import CommandChosen
from logical_robots_tui.tui.program.completion import Completion
from logical_robots_tui.tui.program.mistakes import Underline, sign
from logical_robots_tui.tui.terminal.textual_internals import HangingDocument, hang_wrapped_lines
from logical_robots_tui.tui.theme.themes import INK, SYNTAX, rich_style
from logical_robots_tui.wording import visible

_A_PASTE = 0.005  # keys that follow each other faster, in seconds, were not typed
_A_PAUSE = 0.05  # seconds after the last key of a burst
_LOOKED_BACK = 200  # characters before the cursor that may begin the list of words
_LONGEST_CLUSTER = 64  # code points of what is seen as one character
_OPENING = re.compile(r"[A-Za-z_]\w*\.$|(?<![\w.])[A-Z]$")
"""What opens the list of words when it is typed."""
_WORD_END = re.compile(r"(?:(?<=\w)|(?<=\w\.))(?!\w)")
_FIRST_RULE = re.compile(r"(?:[ \t]*(?:#.*)?\n)*(?=.)")
"""Comments and empty lines at the start of a program, if anything follows."""


hang_wrapped_lines()


class Editor(TextArea):
    DEFAULT_CSS = """
    Editor { border: none; padding: 0; background: $surface; }
    Editor:focus { border: none; }
    """

    BINDINGS = [
        ("ctrl+underscore,ctrl+slash", "toggle_comment"),
        ("ctrl+@,ctrl+space", "complete"),
        ("tab", "indent"),
        ("shift+tab", "dedent"),
        ("ctrl+home", "go_to('start')"),
        ("ctrl+end", "go_to('end')"),
        ("ctrl+a", "select_all"),
        ("alt+up", "move_lines(-1)"),
        ("alt+down", "move_lines(1)"),
        ("ctrl+d", "duplicate_lines"),
    ]

    @dataclass
    class Copied(Message):
        text: str

    def __init__(self) -> None:
        super().__init__(
            id="text", show_line_numbers=True, soft_wrap=True, compact=True, max_checkpoints=500
        )
        self.cursor_blink = False
        self.indent_width = WIDTH
        bindings = Binding.make_bindings([*TextArea.BINDINGS, *self.BINDINGS])
        self._actions = {binding.key: binding.action for binding in bindings}
        self._states = LineStates()
        self._last_key_at = float("-inf")
        self._syntax: dict[str, Style] = {}
        self._underlines: Mapping[int, Sequence[Underline]] = {}
        self._pointed_out: Selection | None = None
        self.completion = Completion()
        self.completes = True
        self._opens_list = False
        self._burst: asyncio.TimerHandle | None = None

    def on_mount(self) -> None:
        self._apply_theme(self.app.current_theme)
        self.app.theme_changed_signal.subscribe(self, self._apply_theme)

    def _apply_theme(self, theme: Theme) -> None:
        self._syntax = {kind: rich_style(text) for kind, text in SYNTAX.items()}
        colours = TextAreaTheme(
            name=f"logica-{theme.name}",
            cursor_line_style=rich_style("on $row"),
            cursor_line_gutter_style=rich_style(f"{INK.title} on $row"),
            gutter_style=rich_style(INK.faint),
            selection_style=rich_style("on $selection"),
            bracket_matching_style=rich_style("bold on $bracket"),
        )
        self.register_theme(colours)
        self.theme = colours.name

    def put(self, text: str) -> None:
        """Replace the whole text as one undo step; the cursor stays in its line."""
        place = self.cursor_location
        if text != self.text:
            self.replace(text, self.document.start, self.document.end)
        self.move_cursor(place)

    def load_text(self, text: str) -> None:
        """Load another text without undo history; the cursor goes to its first rule."""
        self._states.forget()
        super().load_text(text)
        if (rule := _FIRST_RULE.match(text)) is not None:
            self.move_cursor((rule.group().count("\n"), 0))

    def edit(self, edit: Edit) -> EditResult:
        """Make a change, unless a paste makes the program too long to compile."""
        replaced = len(self.get_text_range(edit.top, edit.bottom))
        length = len(self.text) - replaced + len(edit.text)
        if len(edit.text) > 1 and length > (limit := Limits().program_characters):
            self.notify(f"A program may have {limit:,} characters, not {length:,}.")
            return EditResult(self.cursor_location, "")
        self._states.forget(edit.top[0])
        return super().edit(edit)

    def undo(self) -> None:
        self._states.forget()
        super().undo()

    def redo(self) -> None:
        self._states.forget()
        super().redo()

    def underline(self, underlines: Mapping[int, Sequence[Underline]]) -> None:
        """Underline places, and put signs beside their lines, numbered from 0."""
        if underlines != self._underlines:
            self._underlines = underlines
            self.notify_style_update()
            self.refresh()

    async def on_key(self, event: events.Key) -> None:
        """Handle move and delete keys: bindings would run after letters that arrive with them."""
        hurried = event.time - self._last_key_at < _A_PASTE
        self._last_key_at = event.time
        typed = event.character or ""
        if self._burst is not None:
            self._burst.cancel()
        self._opens_list = self.completes and (typed == "." or typed.isupper())
        if self._opens_list and hurried:  # of a paste, or of a slow line: the last key decides
            self._opens_list = False
            loop = asyncio.get_running_loop()
            self._burst = loop.call_later(_A_PAUSE, self._open_list)
        if hurried and event.key in ("enter", "tab"):  # of a paste: they choose no word
            self.completion.close()
        if self.completion.display and self._takes(event.key):
            event.stop()
            event.prevent_default()
            return
        action = self._actions.get(event.key)
        if action is None and event.key.startswith("alt+"):
            event.stop()
            event.prevent_default()  # Alt types no letter
            return
        if action == "indent" and not hurried and self.selection.is_empty:
            row, column = self.cursor_location
            if _WORD_END.match(self.document.get_line(row), column):
                action = "complete_or_take"
        if event.key not in ("escape", "enter", "ctrl+j") and action is None:
            return
        if action == "copy" and not self.selected_text:
            return  # nothing to copy: the key keeps its other meaning
        event.stop()
        event.prevent_default()
        if event.key == "escape" and not self.selection.is_empty:
            self.selection = Selection.cursor(self.cursor_location)
        elif event.key == "escape":
            self.post_message(CommandChosen("leave"))
        elif action is not None:
            await self.run_action(action)
        else:
            self._end_line(as_it_is=hurried or event.key == "ctrl+j")

    def _end_line(self, *, as_it_is: bool) -> None:
        """Start a line with matching indentation; unmarked pastes, as keys, bring their own."""
        start, end = sorted(self.selection)
        line = self.document.get_line(start[0])[: start[1]]
        indentation = "" if as_it_is else indentation_after(line)
        self.replace(f"\n{indentation}", start, end, maintain_selection_offset=False)

    @property
    def before_cursor(self) -> str:
        row, column = self.cursor_location
        return self.document.get_line(row)[:column]

    @property
    def word(self) -> str:
        row, column = self.cursor_location
        return word_around(self.document.get_line(row), column)

    def action_complete_or_take(self) -> None:
        """Offer words for what is begun; take the only one, and indent if there is none."""
        self.action_complete()
        if not self.completion.names:
            self.action_indent()
        elif len(self.completion.names) == 1:
            self._complete()

    def action_complete(self) -> None:
        words = words_for(self.text, self.cursor_location)
        self.completion.offer(words, self.cursor_screen_offset)

    def on_text_area_changed(self) -> None:
        opens, self._opens_list = self._opens_list, False
        if self.completion.display or opens:
            self._open_list()

    def _open_list(self) -> None:
        if not self.is_attached:
            return  # the game has ended meanwhile
        if self.completion.display or _OPENING.search(self.before_cursor[-_LOOKED_BACK:]):
            self.action_complete()
            if self.completion.names[:1] == [self.word]:
                self.completion.close()

    def point_out(self, start: tuple[int, int], stop: tuple[int, int]) -> None:
        """Highlight text from 0-based positions, as a selection that typing does not replace."""
        self.selection = self._pointed_out = Selection(stop, start)
        self.scroll_cursor_visible(center=True)

    @on(events.Focus)
    def unpoint(self) -> None:
        """Clear a selection that was only a highlight."""
        if self.selection == self._pointed_out:
            self.selection = Selection.cursor(self.cursor_location)
        self._pointed_out = None

    def on_blur(self) -> None:
        self.completion.close()

    def _takes(self, key: str) -> bool:
        """Use a key for the list of words; return whether it was used."""
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
        index = self.completion.highlighted
        self.completion.close()
        if index is not None:
            row, column = self.cursor_location
            start = row, column - len(word_before(self.before_cursor)[1])
            name = self.completion.names[index]
            self.replace(name, start, (row, column), maintain_selection_offset=False)

    def action_copy(self) -> None:
        super().action_copy()
        self.post_message(self.Copied(self.app.clipboard))

    def action_cut(self) -> None:
        super().action_cut()
        self.post_message(self.Copied(self.app.clipboard))

    def action_toggle_comment(self) -> None:
        self._change_lines(toggle_comments(self._selected_lines()))

    def get_cursor_left_location(self) -> tuple[int, int]:
        row, column = self.cursor_location
        text = self.document.get_line(row)[max(0, column - _LONGEST_CLUSTER) : column]
        *_, last = ["", *iter_graphemes(text)]
        return (row, column - len(last)) if last else super().get_cursor_left_location()

    def get_cursor_right_location(self) -> tuple[int, int]:
        row, column = self.cursor_location
        text = self.document.get_line(row)[column : column + _LONGEST_CLUSTER]
        first = next(iter_graphemes(text), "")
        return (row, column + len(first)) if first else super().get_cursor_right_location()

    def action_indent(self) -> None:
        start, end = self.selection
        if start[0] != end[0]:
            self._change_lines(shift_lines(self._selected_lines(), back=False))
        else:
            spaces = " " * (WIDTH - min(start, end)[1] % WIDTH)
            self.replace(spaces, start, end, maintain_selection_offset=False)

    def action_dedent(self) -> None:
        self._change_lines(shift_lines(self._selected_lines(), back=True))

    def action_cursor_line_end(self, select: bool = False) -> None:
        """Move to the end of the row, and from there to that of the line."""
        row, column = self.cursor_location
        place = self.get_cursor_line_end_location()
        if place == (row, column):
            place = row, len(self.document.get_line(row))
        self.move_cursor(place, select=select)

    def action_cursor_line_start(self, select: bool = False) -> None:
        """Move to the start of the row; from there to the line's first letter, or its start."""
        row, column = self.cursor_location
        row_start: int = self.navigator.get_location_home((row, column))[1]
        line = self.document.get_line(row)
        first = len(line) - len(line.lstrip())
        if not row_start or column == row_start:
            row_start = 0 if column == first else first
        self.move_cursor((row, row_start), select=select)

    def action_move_lines(self, rows: int) -> None:
        """Move the selected lines up or down by one."""
        first, last = self._selected_rows()
        neighbour = first - 1 if rows < 0 else last + 1
        if not 0 <= neighbour < self.document.line_count:
            return
        lines, passed = self._selected_lines(), self.document.get_line(neighbour)
        lines = [*lines, passed] if rows < 0 else [passed, *lines]
        bottom = max(last, neighbour)
        stop = (bottom, len(self.document.get_line(bottom)))
        self._replace_lines(lines, (min(first, neighbour), 0), stop, rows)

    def action_duplicate_lines(self) -> None:
        """Insert the selected lines once more, below; the cursor goes with them."""
        last, lines = self._selected_rows()[1], self._selected_lines()
        stop = (last, len(self.document.get_line(last)))
        self._replace_lines(["", *lines], stop, stop, len(lines))

    def _replace_lines(
        self, lines: list[str], start: tuple[int, int], stop: tuple[int, int], rows: int
    ) -> None:
        """Replace a range by lines; the selection goes some rows down."""
        places = [(row + rows, column) for row, column in self.selection]
        self.replace("\n".join(lines), start, stop)
        self.selection = Selection(*places)

    def action_go_to(self, place: Literal["start", "end"]) -> None:
        self.move_cursor(getattr(self.document, place))

    def _selected_rows(self) -> tuple[int, int]:
        (first, _), (last, column) = sorted(self.selection)
        return first, last - (last > first and column == 0)

    def _selected_lines(self) -> list[str]:
        first, last = self._selected_rows()
        return [self.document.get_line(number) for number in range(first, last + 1)]

    def _change_lines(self, changed: list[str]) -> None:
        first, last = self._selected_rows()
        lines, selection = self._selected_lines(), self.selection
        if changed == lines:
            return
        self.replace("\n".join(changed), (first, 0), (last, len(lines[-1])))

        def moved(place: tuple[int, int]) -> tuple[int, int]:
            row, column = place
            if not first <= row <= last:
                return place
            growth = len(changed[row - first]) - len(lines[row - first])
            return row, max(column + growth, 0) if column else 0

        self.selection = Selection(moved(selection.start), moved(selection.end))

    def scroll_cursor_visible(self, center: bool = False, animate: bool = False) -> Offset:
        """Scroll the cursor into view; without room, wait until there is some.

        During undo the cursor may be beyond the end of the text, which is corrected later.
        """
        if not self.content_size.area or self.cursor_location[0] >= self.document.line_count:
            return Offset()
        return super().scroll_cursor_visible(center, animate)

    def on_resize(self) -> None:
        self.scroll_cursor_visible()

    def get_line(self, line_index: int) -> Text:
        """Return a line with its colours, and with visible control characters."""
        line = self.document.get_line(line_index)
        text = Text(visible(line, tabs=True), end="", no_wrap=True)
        state = self._states.at(line_index, self.document.lines.__getitem__)
        for start, end, kind in pieces(line, state):
            text.stylize(self._syntax[kind], start, end)
        for start, end, is_wrong in self._underlines.get(line_index, ()):
            text.stylize(self._syntax["mistake" if is_wrong else "odd"], start, end)
        return text

    def render_line(self, y: int) -> Strip:
        strip = super().render_line(y)
        place, document = self.scroll_offset.y + y, self.wrapped_document
        if place >= document.height:
            return strip
        assert isinstance(document, HangingDocument)
        row, section = document.row_at(place)
        if section and self.soft_wrap and (hang := document.hang(row, section)):
            *_, last = strip
            room = Strip([Segment(" " * hang, last.style)])
            gutter, stop = self.gutter_width, strip.cell_length - hang
            strip = Strip.join([strip.crop(0, gutter), room, strip.crop(gutter, stop)])
        if row not in self._underlines:
            return strip
        number = None if section else row
        is_wrong = any(underline.is_wrong for underline in self._underlines[row])
        return sign(strip, number, self.gutter_width, self._syntax, is_wrong=is_wrong)
