"""The inspector: the robots, or the rows of any predicate, at the tick on the screen."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.background import in_background
from logical_robots_tui.tui.inspector.cells import written
from logical_robots_tui.tui.inspector.robots import RobotsView
from logical_robots_tui.tui.inspector.table import ValueTable
from logical_robots_tui.tui.pane import Pane
from logical_robots_tui.tui.plain import one_line
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from textual.worker import Worker

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Predicate
    from logical_robots_tui.tui.session import Session

__all__ = ["ROBOTS", "InspectorPane"]

ROBOTS = "(robots)"
"""The first choice of the inspector; no predicate can have this name."""

_ROBOTS_PAUSE, _ROWS_PAUSE = 0.1, 0.25  # seconds between two pictures while the game runs
_MARKS = {"input": ("◂", INK.robot), "program": ("•", INK.key), "prelude": ("◦", INK.dim)}


class InspectorPane(Pane):
    """Follows the tick on the screen, a few times a second while the game runs.

    Args:
        session: Whom to ask.
    """

    command_id: ClassVar[str] = "inspector"

    DEFAULT_CSS = """
    InspectorPane #choice {
        width: 24; height: 1fr; border: none; padding: 0; background: $surface;
        border-right: solid $faint;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    InspectorPane #subject { height: 1; padding: 0 1; color: $dim; text-wrap: nowrap; }
    InspectorPane #views { width: 1fr; }
    InspectorPane #said { padding: 1 2; }
    InspectorPane ValueTable, InspectorPane RobotsView { margin: 0 1; }
    InspectorPane #value {
        height: auto; max-height: 40%; border-top: solid $faint; padding: 0 1;
    }
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._choice = OptionList(id="choice", markup=False, compact=True)
        self._subject = Static(id="subject")
        self.robots = RobotsView()
        self.table = ValueTable()
        self._value = Static(id="value-text")
        self._value_box = VerticalScroll(self._value, id="value", can_focus=False)
        self._said = Static(id="said")
        views = Vertical(
            self._subject, self.robots, self.table, self._said, self._value_box, id="views"
        )
        super().__init__(Horizontal(self._choice, views), title="Inspector")
        self._predicates: tuple[Predicate, ...] | None = None
        self._inspected = ROBOTS
        self._told = Content("")
        self._stale = False
        self._follower: Worker[None] | None = None

    @property
    def inspected(self) -> str:
        """What is being inspected: `ROBOTS` or the name of a predicate."""
        return self._inspected

    def on_mount(self) -> None:
        """Begin with the robots."""
        self._list_predicates()
        self._show_only(self.robots)
        self.follow()

    def on_show(self) -> None:
        """Catch up after having been hidden."""
        self.follow()

    def enter(self) -> None:
        """Put the focus on the list of predicates."""
        self.screen.set_focus(self._choice)

    def inspect(self, name: str) -> None:
        """Show `ROBOTS` or the rows of a predicate."""
        self._inspected = name
        if self._follower is not None:
            self._follower.cancel()  # it may be waiting for rows that nobody wants any more
            self._follower = None
        self.follow()

    def follow(self) -> None:
        """Show the present tick, at once or, while the game runs, within a moment."""
        if self._predicates != self._session.predicates:
            self._list_predicates()
        self._stale = True
        if self.display and (self._follower is None or self._follower.is_finished):
            self._follower = in_background(self, self._catch_up, "inspect")

    async def _catch_up(self) -> None:
        while self._stale and self.display:
            self._stale = False
            if self._inspected == ROBOTS:
                self._show_robots(self._session.frame)
            else:
                await self._show_rows(self._inspected, self._session.frame)
            if self._session.running:
                await asyncio.sleep(_ROBOTS_PAUSE if self._inspected == ROBOTS else _ROWS_PAUSE)

    def _show_robots(self, frame: Frame) -> None:
        self._say_subject("Robots", frame.tick, "")
        self._show_only(self.robots)
        self.robots.show(self._session.level, frame)

    async def _show_rows(self, name: str, frame: Frame) -> None:
        try:
            columns, rows, truncated = await self._session.query(name, frame)
        except Superseded:
            if self._session.game is None:
                self._say(name, frame.tick, "There is no program yet that could be asked.")
            return
        except QueryError as error:
            if name == self._inspected:
                self._say(name, frame.tick, str(error))
            return
        if name != self._inspected:
            return
        more = " and more" if truncated else ""
        self._say_subject(name, frame.tick, f"{len(rows)}{more} {_rows_word(len(rows))}")
        self._show_only(self.table)
        self.table.show(columns, rows)

    def _say(self, name: str, tick: int, message: str) -> None:
        self._say_subject(name, tick, "")
        self._said.update(Content(one_line(message)))
        self._show_only(self._said)

    def _say_subject(self, name: str, tick: int, more: str) -> None:
        parts = [Content.styled(one_line(name), f"bold {INK.title}"), Content(f"tick {tick}")]
        if more:
            parts.append(Content(more))
        self._subject.update(Content(" · ").join(parts), layout=False)

    def _show_only(self, view: RobotsView | ValueTable | Static) -> None:
        for each in (self.robots, self.table, self._said):
            each.display = each is view
        self._value_box.display = view is self.table and self.table.pointed is not None

    def _list_predicates(self) -> None:
        self._predicates = self._session.predicates
        # The prelude's functions have nothing to show in any tick; the program's own may surprise.
        listed = [each for each in self._predicates if each.has_rows or each.kind != "prelude"]
        names = [ROBOTS, *(predicate.name for predicate in listed)]
        self._choice.clear_options()
        self._choice.add_options(
            [Option(Content.styled("Robots", f"bold {INK.title}"), id=ROBOTS)]
            + [Option(_entry(predicate), id=predicate.name) for predicate in listed]
        )
        self._choice.highlighted = (
            names.index(self._inspected) if self._inspected in names else None
        )

    @on(OptionList.OptionHighlighted)
    def _choice_moved(self, event: OptionList.OptionHighlighted) -> None:
        event.stop()
        if event.option_id is not None and event.option_id != self._inspected:
            self.inspect(event.option_id)

    @on(OptionList.OptionSelected)
    def _choice_made(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        view = self.robots if self._inspected == ROBOTS else self.table
        if view.display:
            view.focus()

    @on(ValueTable.Pointed)
    def _value_pointed(self, event: ValueTable.Pointed) -> None:
        event.stop()
        pointed = self.table.pointed
        self._value_box.display = self.table.display and pointed is not None
        if pointed is not None:
            told = Content.assemble((f"{one_line(pointed[0])} = ", INK.dim), written(pointed[1]))
            if told != self._told:
                self._told = told
                self._value.update(told)


def _entry(predicate: Predicate) -> Content:
    mark, colour = _MARKS[predicate.kind]
    name = INK.text if predicate.has_rows else INK.dim
    entry = Content.assemble((f"{mark} ", colour), (one_line(predicate.name), name))
    if not predicate.has_rows:
        entry = entry.append(Content.styled(" ƒ", INK.dim))
    if predicate.line is not None:
        entry = entry.append(Content.styled(f" :{predicate.line}", INK.faint))
    return entry


def _rows_word(count: int) -> str:
    return "row" if count == 1 else "rows"
