"""The robots in the inspector: where each is, what it sees, wants and remembers."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.content import Content
from textual.message import Message

from logical_robots_tui.tui.inspector.pages.overview import head, notes, robot_lines
from logical_robots_tui.tui.inspector.widgets.lines import LinesView
from logical_robots_tui.tui.theme.themes import palette_of

if TYPE_CHECKING:
    from textual import events

    from logical_robots_tui.game import Frame
    from logical_robots_tui.world import Level

__all__ = ["RobotsView"]


class RobotsView(LinesView):
    """One line for each robot, and notes under them; up, down or a click chooses a robot."""

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("up", "choose(-1)", show=False),
        Binding("down", "choose(1)", show=False),
    ]

    class Chosen(Message):
        """A robot was chosen.

        Attributes:
            robot_name: Its name.
        """

        def __init__(self, robot_name: str) -> None:
            super().__init__()
            self.robot_name = robot_name

    def __init__(self) -> None:
        super().__init__(id="robots")
        self._shown: tuple[Level, Frame] | None = None
        self._chosen: str | None = None

    def show(self, level: Level, frame: Frame) -> None:
        """Show the robots of a tick."""
        self._shown = (level, frame)
        self._draw()

    def choose(self, robot_name: str | None) -> None:
        """Highlight a robot."""
        if robot_name != self._chosen:
            self._chosen = robot_name
            self._draw()

    def on_mount(self) -> None:
        """Follow the theme."""
        self.app.theme_changed_signal.subscribe(self, lambda _: self._draw())

    def on_resize(self) -> None:
        """Use the width there is now."""
        self._draw()

    def on_click(self, event: events.Click) -> None:
        """Choose the robot under the pointer."""
        self._tell(event.y + self.scroll_offset.y - 1)

    def action_choose(self, down: int) -> None:
        """Choose the robot some lines further down."""
        if self._shown is not None:
            names = [robot.name for robot in self._shown[0].robots]
            at = names.index(self._chosen) if self._chosen in names else -1 if down > 0 else 0
            self._tell((at + down) % len(names))

    def _tell(self, number: int) -> None:
        if self._shown is not None and 0 <= number < len(self._shown[0].robots):
            self.post_message(self.Chosen(self._shown[0].robots[number].name))

    def _draw(self) -> None:
        width = self.columns
        if self._shown is None or width <= 0:
            return
        level, frame = self._shown
        palette = palette_of(self.app.current_theme)
        robots = robot_lines(level, frame, width, self._chosen, palette)
        lines = [head(level, width), *robots, Content("")]
        for note in notes(level, frame, self._chosen):
            lines += note.wrap(width)
        self.paint(lines)
