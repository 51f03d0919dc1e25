"""The list of breakpoints, and the form for a new one."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from textual import on
from textual.content import Content
from textual.suggester import SuggestFromList
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.game import (
    EVENTS,
    Breakpoint,
    Event,
    mistake_in,
    mistake_in_question,
    subjects,
)
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing, Prompt, keys_in_style
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session


_READING = "Checking the query…"


def _check(
    dialog: Dialog[Any], program: Program | None, query: str, good: Callable[[], object]
) -> None:
    """Compile a query in the background; call `good` if it is valid, or show its error."""
    if program is None:
        good()
        return

    async def look() -> None:
        mistake = await mistake_in_question(program, query)
        if mistake:
            dialog.complain(mistake)
        else:
            good()

    dialog.complain(_READING)
    in_background(dialog, look, "question", exclusive=True)


def _forget(dialog: Dialog[Any]) -> None:
    dialog.workers.cancel_group(dialog, "question")
    dialog.complain("")


class QuestionPrompt(Prompt[str]):
    """Asks for a query, and returns it if it is valid."""

    DEFAULT_CSS = "QuestionPrompt > #box { max-width: 76; }"

    keys = "enter search   esc close"

    def __init__(self, title: str, text: str, program: Program) -> None:
        super().__init__(title, text, "such as Near(robot_name:, d:), d < 20")
        self._program = program

    def take(self, text: str) -> None:
        query = text.strip()
        _check(self, self._program, query, lambda: self.dismiss(query))

    def forget(self) -> None:
        _forget(self)


class TickPrompt(Prompt[int]):
    """Asks for a tick; ``+50`` and ``-50`` are relative to `current_tick`.

    `problem` returns why a tick is invalid, or "".
    """

    keys = "enter go   esc close"

    def __init__(self, title: str, current_tick: int, problem: Callable[[int], str]) -> None:
        super().__init__(title, "", "such as 120, +50 or -50")
        self._current_tick, self._problem = current_tick, problem

    def take(self, text: str) -> None:
        tick = tick_of(text, self._current_tick)
        if tick is None:
            self.complain("A tick is a number, such as 120.")
        elif problem := self._problem(tick):
            self.complain(problem)
        else:
            self.dismiss(tick)


def tick_of(text: str, current_tick: int) -> int | None:
    """Return the typed tick, or None if it is invalid; a sign makes it relative."""
    match = re.fullmatch(r"([+-]?)([0-9]{1,12})", text.replace(" ", "").replace(",", ""))
    if match is None:
        return None
    number = int(match[1] + match[2])
    return current_tick + number if match[1] else number


_NONE = "No breakpoints yet. A run stops at a breakpoint; press a to add one."


class BreakpointList(Dialog[None]):
    DEFAULT_CSS = """
    BreakpointList > #box { max-width: 80; padding: 1 2 0 2; }
    BreakpointList OptionList { height: auto; max-height: 16; }
    BreakpointList #none { color: $ink-dim; }
    """

    BINDINGS = [
        ("a,plus", "add"),
        ("space", "switch"),
        ("d,delete,backspace", "delete"),
        ("q,B", "leave"),
    ]

    heading = "Breakpoints"
    keys = "a add   space switch off or on   d delete   esc close"

    def __init__(self, session: Session) -> None:
        self._entries = Listing(id="breakpoints", markup=False, compact=True)
        self._none = Static(_NONE, id="none", markup=False)
        super().__init__("", self._entries, self._none)
        self._session = session
        self._shown: tuple[Breakpoint, ...] = ()

    def on_mount(self) -> None:
        self._entries.focus()
        self._list(0)

    def _list(self, index: int) -> None:
        self._shown = tuple(self._session.breakpoints)
        self._entries.clear_options()
        for breakpoint_ in self._shown:
            is_on = self._session.breakpoints.is_on(breakpoint_)
            sign = ("◉ ", f"bold {INK.bad}") if is_on else ("○ ", INK.dim)
            words = one_line(breakpoint_.words), INK.text if is_on else INK.dim
            line = Content.assemble(sign, words)
            if trouble := one_line(self._session.problem_with(breakpoint_)):
                parts = ("\n  ! ", f"bold {INK.warn}"), (trouble, INK.warn)
                line = line.append(Content.assemble(*parts))
            self._entries.add_option(Option(line))
        self._entries.display, self._none.display = bool(self._shown), not self._shown
        if self._shown:
            self._entries.highlighted = min(index, len(self._shown) - 1)

    def action_add(self) -> None:
        def added(breakpoint_: Breakpoint | None) -> None:
            if breakpoint_ is not None:
                self._session.breakpoints.add(breakpoint_)
                self._list(len(self._session.breakpoints))

        level, program = self._session.level, self._session.program
        self.app.push_screen(BreakpointForm(level, program), added)

    @on(OptionList.OptionSelected)
    def action_switch(self) -> None:
        self._change(self._session.breakpoints.switch)

    def action_delete(self) -> None:
        self._change(self._session.breakpoints.remove)

    def _change(self, change: Callable[[Breakpoint], object]) -> None:
        index = self._entries.highlighted
        if index is not None:
            change(self._shown[index])
            self._list(index)


_SUBJECTS: dict[Event, str] = {
    "rows": "predicate or query",
    "no rows": "predicate or query",
    "change": "predicate or query",
    "enters": "area, or nothing for any",
    "leaves": "area, or nothing for any",
    "loses sight": "of what, or nothing for anything",
    "notice": "kind of notice, or nothing for any",
}


_KEYS = {
    True: "↑↓ choose   enter go on   esc close",
    False: "tab next   → complete   enter set   esc close",
}
"""The keys, by whether an event is being chosen."""


class BreakpointForm(Dialog[Breakpoint]):
    """Asks for a breakpoint, with completion of names."""

    DEFAULT_CSS = """
    BreakpointForm > #box { max-width: 72; padding: 1 2 0 2; }
    BreakpointForm OptionList { height: 8; margin-bottom: 1; }
    BreakpointForm Input { margin-bottom: 0; }
    BreakpointForm .names {
        color: $ink-dim; height: 1; text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    BINDINGS = [("down", "app.focus_next"), ("up", "app.focus_previous")]

    heading = "Stop when…"
    keys = _KEYS[True]

    def __init__(self, level: Level, program: Program | None) -> None:
        self._level, self._program = level, program
        self._robots = tuple(robot.name for robot in level.robots)
        options = (Option(words, id=event) for event, words in EVENTS.items())
        self._events = Listing(*options, id="events", markup=False, compact=True)
        self._subject = Input(id="subject")
        self._robot = Input(
            placeholder="robot, or nothing for any",
            id="robot",
            suggester=SuggestFromList(self._robots, case_sensitive=False),
        )
        self._column = Input(placeholder="column, or nothing for the whole row", id="column")
        self._names = subjects_line, robots_line = [
            Static(classes="names", markup=False) for _ in range(2)
        ]
        fields = self._subject, subjects_line, self._robot, robots_line, self._column
        super().__init__("", self._events, *fields)

    def on_mount(self) -> None:
        self._arrange()

    def on_descendant_focus(self) -> None:
        self.query_one("#keys", Static).update(
            keys_in_style(_KEYS[isinstance(self.focused, OptionList)])
        )

    @property
    def _event(self) -> Event:
        return list(EVENTS)[self._events.highlighted or 0]

    @on(OptionList.OptionHighlighted)
    def _arrange(self) -> None:
        event = self._event
        self._subject.display = event in _SUBJECTS
        self._subject.placeholder = _SUBJECTS.get(event, "")
        names = subjects(event, self._level, self._program)
        self._subject.suggester = SuggestFromList(names, case_sensitive=False)
        self._column.display = event == "change"
        self._list_names()

    @on(OptionList.OptionSelected)
    def _chosen(self) -> None:
        (self._subject if self._event in _SUBJECTS else self._robot).focus()

    @on(Input.Changed)
    def _list_names(self) -> None:
        _forget(self)
        candidates = subjects(self._event, self._level, self._program), self._robots
        fields = self._subject, self._robot
        for field, names, listing in zip(fields, candidates, self._names, strict=True):
            typed = _value(field).casefold()
            fitting = [name for name in names if name.casefold().startswith(typed)]
            listing.update(Content(one_line(" ".join(fitting))))
            listing.display = field.display

    @on(Input.Submitted)
    def _submitted(self) -> None:
        values = map(_value, (self._subject, self._robot, self._column))
        breakpoint_ = Breakpoint(self._event, *values)
        mistake = mistake_in(breakpoint_, self._level, self._program)
        if mistake:
            self.complain(mistake)
        elif breakpoint_.is_named:
            self.dismiss(breakpoint_)
        else:
            _check(self, self._program, breakpoint_.subject, lambda: self.dismiss(breakpoint_))


def _value(field: Input) -> str:
    return field.value.strip() if field.display else ""
