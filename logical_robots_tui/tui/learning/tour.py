"""The guided tour: a box that points at one part of the screen after another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual import events
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.tui.layout.arrangement import Arrangement, Pane


@dataclass(frozen=True, slots=True)
class TourStop:
    """One stop of the tour; commands in braces in its text stand for their keys."""

    place: str
    title: str
    text: str


STOPS = (
    TourStop(
        "map",
        "The map",
        "Your robots from above, and the rays that they sense with. "
        "Bring them into the green area. The briefing explains the task.",
    ),
    TourStop(
        "editor",
        "The program",
        "Every robot runs this program in every tick. {editor} goes there; edit it, "
        "{apply} applies it, and esc leaves it.",
    ),
    TourStop(
        "inspector",
        "The inspector",
        "What the robots sense, want and remember at the current tick: "
        "everything that the program knows, row by row.",
    ),
    TourStop(
        "commands",
        "The commands",
        "{run} runs the robots, {restart} restarts, {hint} gives a hint. "
        "{help} shows all keys, and you can click everything. Good luck!",
    ),
)

_WIDTH = 46


class Tour(Static, can_focus=True):
    """Explains the parts of the screen; other keys work as usual."""

    DEFAULT_CSS = """
    Tour {
        layer: tour; position: absolute; width: 46; height: auto; padding: 0 1;
        border: heavy $warning; border-title-color: $ink-warn; background: $panel;
    }
    """
    BINDINGS = [("enter,right", "move(1)"), ("left", "move(-1)"), ("escape", "end")]

    def __init__(self, *, moved: Callable[[], None], ended: Callable[[], None]) -> None:
        super().__init__(id="tour", markup=False)
        self._at = 0
        self._moved = moved
        self._ended = ended

    @property
    def stop(self) -> TourStop:
        return STOPS[self._at]

    def on_mount(self) -> None:
        self.focus()
        self.action_move(0)

    def place(self) -> None:
        """Place the box where there is room: above the labyrinth, at the bottom of other parts."""
        part, room = self.screen.query_one(f"#{self.stop.place}").region, self.screen.region
        height = self.size.height + self.gutter.height
        if part.height <= height:
            x, y = part.x + 2, part.y - height
        elif self._at == 0:
            x, y = part.x + 2, part.y + 1
        else:
            x, y = part.right - _WIDTH - 2, part.bottom - height - 1
        self.styles.offset = (
            min(max(x, 0), max(room.width - _WIDTH, 0)),
            min(max(y, 0), max(room.height - height, 0)),
        )

    def action_move(self, steps: int) -> None:
        if self._at + steps >= len(STOPS):
            self.action_end()
            return
        self._at = max(self._at + steps, 0)
        stop = self.stop
        self.border_title = Content(f"{stop.title} · {self._at + 1} of {len(STOPS)}")
        last = self._at == len(STOPS) - 1
        self.update(
            Content.assemble(
                (f"{with_keys(stop.text)}\n", INK.text),
                ("enter ", f"bold {INK.key}"),
                ("start   " if last else "next   ", INK.dim),
                ("esc ", f"bold {INK.key}"),
                ("skip the tour", INK.dim),
            )
        )
        self._moved()

    def action_end(self) -> None:
        self._ended()

    def on_click(self, event: events.Click) -> None:
        event.stop()
        self.action_move(1)


class TourController:
    def __init__(
        self,
        mount: Callable[[Tour], object],
        arrangement: Arrangement,
        point_at: Callable[[Pane], None],
        ended: Callable[[], None],
    ) -> None:
        self._mount, self._arrangement = mount, arrangement
        self._point_at, self._ended = point_at, ended
        self._tour: Tour | None = None

    def begin(self) -> None:
        self._remove()
        if not self._arrangement.is_tiny:
            self._tour = Tour(moved=self._show, ended=self._come_home)
            self._mount(self._tour)

    def place(self) -> None:
        if self._tour is None:
            return
        if self._arrangement.is_tiny:
            self._come_home()
        else:
            self._tour.place()

    def end(self) -> None:
        """End the tour without moving the focus, because the player has moved on."""
        if self._tour is not None:
            self._remove()
            self._ended()

    def _come_home(self) -> None:
        self.end()
        home = self._arrangement.panes[0]
        self._point_at(home)
        home.enter()

    def _show(self) -> None:
        if self._tour is None:
            return  # it ended before it was mounted
        self._point_at(self._arrangement.panes[0])
        for pane in self._arrangement.panes:
            is_it = pane.command_id == self._tour.stop.place
            pane.set_class(is_it, "-pointed")
            if is_it:
                self._point_at(pane)
        self._tour.call_after_refresh(self.place)

    def _remove(self) -> None:
        tour, self._tour = self._tour, None
        for pane in self._arrangement.panes:
            pane.remove_class("-pointed")
        if tour is not None:
            tour.remove()
