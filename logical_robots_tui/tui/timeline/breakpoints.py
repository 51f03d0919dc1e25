"""The list of breakpoints."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.binding import Binding
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.form import BreakpointForm

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from logical_robots_tui.game import Breakpoint
    from logical_robots_tui.tui.app.session import Session

__all__ = ["BreakpointList"]

_NONE = "No breakpoints yet. A run stops at a breakpoint; press a to add one."


class BreakpointList(Dialog[None]):
    """Lists breakpoints; adds, toggles and deletes them.

    Args:
        session: The session.
    """

    DEFAULT_CSS = """
    BreakpointList > #box { max-width: 80; padding: 1 2 0 2; }
    BreakpointList OptionList { height: auto; max-height: 16; }
    BreakpointList #none { color: $ink-dim; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("a,plus", "add", show=False),
        Binding("space", "switch", show=False),
        Binding("d,delete,backspace", "delete", show=False),
        Binding("q,B", "leave", show=False),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._shown: tuple[Breakpoint, ...] = ()

    def compose(self) -> ComposeResult:
        """Yield the list above its keys."""
        with Vertical(id="box") as box:
            box.border_title = "Breakpoints"
            yield Listing(id="breakpoints", markup=False, compact=True)
            yield Static(_NONE, id="none", markup=False)
            keys = "a add   space switch off or on   d delete   esc close"
            yield Static(keys, id="keys", markup=False)

    def on_mount(self) -> None:
        """Start at the first one."""
        self.query_one(OptionList).focus()
        self._list(0)

    @property
    def _pointed(self) -> int | None:
        return self.query_one(OptionList).highlighted

    def _list(self, at: int) -> None:
        """List all, with the cursor at a place."""
        self._shown = tuple(self._session.breakpoints)
        entries = self.query_one(OptionList)
        entries.clear_options()
        entries.add_options([Option(self._entry(each)) for each in self._shown])
        entries.display = bool(self._shown)
        self.query_one("#none").display = not self._shown
        if self._shown:
            entries.highlighted = min(at, len(self._shown) - 1)

    def _entry(self, each: Breakpoint) -> Content:
        is_on = self._session.breakpoints.is_on(each)
        sign = ("◉ ", f"bold {INK.bad}") if is_on else ("○ ", INK.dim)
        line = Content.assemble(sign, (one_line(each.words), INK.text if is_on else INK.dim))
        trouble = one_line(self._session.problem_with(each))
        if not trouble:
            return line
        return line.append(Content.assemble(("\n  ! ", f"bold {INK.warn}"), (trouble, INK.warn)))

    def action_add(self) -> None:
        """Add a breakpoint."""

        def added(breakpoint_: Breakpoint | None) -> None:
            if breakpoint_ is not None:
                self._session.breakpoints.add(breakpoint_)
                self._list(len(self._session.breakpoints))

        level, program = self._session.level, self._session.program
        self.app.push_screen(BreakpointForm(level, program), added)

    def action_switch(self) -> None:
        """Toggle the breakpoint under the cursor."""
        if self._pointed is not None:
            self._session.breakpoints.switch(self._shown[self._pointed])
            self._list(self._pointed)

    def action_delete(self) -> None:
        """Delete the breakpoint under the cursor."""
        if self._pointed is not None:
            self._session.breakpoints.remove(self._shown[self._pointed])
            self._list(self._pointed)

    @on(OptionList.OptionSelected)
    def _selected(self) -> None:
        self.action_switch()
