"""The labyrinth pane: the picture, and over it the briefing and the banner of victory."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.binding import Binding
from textual.content import Content

from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.labyrinth.banner import Overlay, VictoryBanner
from logical_robots_tui.tui.labyrinth.camera import Sight
from logical_robots_tui.tui.labyrinth.robot_card import RobotCard
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.pane import Pane
from logical_robots_tui.tui.theme.safe_text import clip, one_line, visible
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.world import Level

__all__ = ["LabyrinthPane"]


class LabyrinthPane(Pane, can_focus=True):
    """Shows the world at the tick on the screen."""

    command_id: ClassVar[str] = "labyrinth"

    DEFAULT_CSS = """
    LabyrinthPane { layers: picture over; }
    LabyrinthPane LabyrinthView { layer: picture; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("left", "pan(-1, 0)", show=False),
        Binding("right", "pan(1, 0)", show=False),
        Binding("up", "pan(0, -1)", show=False),
        Binding("down", "pan(0, 1)", show=False),
    ]

    def __init__(self) -> None:
        self.view = LabyrinthView(id="picture")
        self.card = RobotCard()
        self.briefing = Briefing()
        self.banner = VictoryBanner()
        self._shown: tuple[Level, Frame] | None = None
        super().__init__(self.view, self.card, self.briefing, self.banner, title="Labyrinth")

    def on_mount(self) -> None:
        """Update the card when the theme changes."""
        self.app.theme_changed_signal.subscribe(self, lambda _: self.select(self.view.selected))

    def show(self, level: Level, frame: Frame, *, hurried: bool = False) -> None:
        """Show a tick; hurried if the next one follows at once."""
        self._shown = (level, frame)
        self.view.show(level, frame, hurried=hurried)
        self.select(self.view.selected)

    def select(self, robot_name: str | None) -> None:
        """Highlight a robot and show its card; None for no robot."""
        self.view.selected = robot_name
        if self._shown is None:
            return
        level, frame = self._shown
        robots = {robot.name: robot for robot in frame.after.robots}
        robot, view = robots.get(robot_name or ""), self.view.view
        middle = view.left + view.width / 2 if view else 0.0
        on_the_left = robot is not None and robot.x < middle
        shown = None if self.view.camera.sight is Sight.SENSES else robot_name
        self.card.show(level, frame, shown, on_the_left=on_the_left)

    @on(LabyrinthView.Looked)
    def _looked(self) -> None:
        camera = self.view.camera
        times = f"{camera.zoom:g}\N{MULTIPLICATION SIGN}"
        words = {
            Sight.WHOLE: "",
            Sight.SENSES: "senses",
            Sight.FREE: times,
            Sight.FOLLOW: f"{clip(one_line(self.view.selected or ''), 12)} {times}",
        }
        note = words[camera.sight]
        self.note(note if self.view.overlay is None else f"editing {note}".rstrip())
        self.select(self.view.selected)

    def close_briefing(self) -> None:
        """Hide the briefing."""
        self.briefing.display = False

    def action_pan(self, across: int, down: int) -> None:
        """Pan the view by an eighth."""
        columns, rows = self.view.size
        self.view.pan(across * columns / 8, down * rows / 8)

    def enter(self) -> None:
        """Focus the view, so that single letters are commands."""
        self.screen.set_focus(self)


class Briefing(Overlay):
    """The briefing, until the game runs or the player closes it."""

    DEFAULT_CSS = """
    Briefing {
        layer: picture; dock: bottom; padding: 0 1; max-height: 50%; border-top: solid $ink-faint;
    }
    """

    def __init__(self) -> None:
        super().__init__(id="briefing")
        self._has_text = False

    def tell(self, level: Level) -> None:
        """Show the briefing of a level, if it has one."""
        self._has_text = bool(level.briefing.strip())
        text = "\n".join(visible(line) for line in level.briefing.strip().splitlines())
        offers = {"run": "runs", "briefing": "hides this"}
        if level.hints:
            offers["hint"] = "gives a hint"
        if level.lesson:
            offers["lesson"] = "lesson"
        keys = "   ".join(f"{command(c).key_name} {said}" for c, said in offers.items())
        self.update(
            Content.assemble(
                (f"{one_line(level.title)}\n", f"bold {INK.title}"),
                (f"{text}\n", INK.text),
                (keys, INK.dim),
            )
        )
        self.display = self._has_text

    def toggle(self) -> bool:
        """Show or hide it; return False if there is nothing to show."""
        self.display = self._has_text and not self.display
        return self._has_text
