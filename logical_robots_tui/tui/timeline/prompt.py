"""Asking for a tick."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.tui.layout.dialog import Dialog
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.app import ComposeResult

__all__ = ["TickPrompt", "tick_of"]


class TickPrompt(Dialog[int]):
    """Asks for a number of a tick, and gives it.

    Args:
        title: What for.
        here: The tick on the screen, to count from with ``+50`` or ``-50``.
        complaint: Says why a tick won't do, or "".
    """

    DEFAULT_CSS = """
    TickPrompt > #box { max-width: 60; padding: 1 2 0 2; }
    """

    def __init__(self, title: str, here: int, complaint: Callable[[int], str]) -> None:
        super().__init__()
        self._title_text = title
        self._here = here
        self._complaint = complaint

    def compose(self) -> ComposeResult:
        """A line to type in, and what is wrong with it."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            yield Input(placeholder="such as 120, +50 or -50", id="tick")
            yield Static(id="complaint")
            yield Static("enter go   esc close", id="keys", markup=False)

    @on(Input.Changed)
    def _changed(self) -> None:
        self.query_one("#complaint").display = False

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        tick = tick_of(event.value, self._here)
        complaint = "A tick is a number, such as 120." if tick is None else self._complaint(tick)
        if tick is not None and not complaint:
            self.dismiss(tick)
            return
        shown = self.query_one("#complaint", Static)
        shown.update(Content(one_line(complaint)))
        shown.display = True


def tick_of(text: str, here: int) -> int | None:
    """The tick that was typed, or None if it is none; a sign counts from the tick `here`."""
    found = re.fullmatch(r"([+-]?)([0-9]{1,12})", text.replace(" ", "").replace(",", ""))
    if found is None:
        return None
    sign, number = found[1], int(found[2])
    return {"": number, "+": here + number, "-": here - number}[sign]
