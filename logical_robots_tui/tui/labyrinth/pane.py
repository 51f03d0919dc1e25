"""The labyrinth pane: the picture, and over it the briefing and the card of a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.inspector.plots import format_value
from logical_robots_tui.tui.labyrinth.briefing import Briefing
from logical_robots_tui.tui.labyrinth.drawing.viewport import Sight
from logical_robots_tui.tui.labyrinth.view import LabyrinthView, RobotPointed
from logical_robots_tui.tui.layout.arrangement import Pane
from logical_robots_tui.tui.terminal.textual_internals import WidgetBindings
from logical_robots_tui.tui.theme.themes import INK, palette_of, robot_ink
from logical_robots_tui.wording import clip, count_of, one_line
from logical_robots_tui.world import Level, Robot, RobotState

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Decision


class LabyrinthPane(Pane, can_focus=True):
    command_id = "map"

    DEFAULT_CSS = """
    LabyrinthPane { layers: picture over; }
    LabyrinthPane LabyrinthView { layer: picture; }
    LabyrinthPane > .note { layer: over; }
    """

    BINDINGS = [
        ("left", "pan(-1, 0)"),
        ("right", "pan(1, 0)"),
        ("up", "pan(0, -1)"),
        ("down", "pan(0, 1)"),
        ("shift+left", "pan(-1, 0, True)"),
        ("shift+right", "pan(1, 0, True)"),
        ("shift+up", "pan(0, -1, True)"),
        ("shift+down", "pan(0, 1, True)"),
    ]

    def __init__(self, briefing: Briefing, clock: Clock = CLOCK) -> None:
        self.view = LabyrinthView(clock)
        self.card = RobotCard()
        self.briefing = briefing
        self._shown: tuple[Level, Frame] | None = None
        super().__init__(self.view, self.card, briefing.beside, title="Map")
        self.keys = WidgetBindings(self)

    def on_mount(self) -> None:
        self.app.theme_changed_signal.subscribe(self, lambda _: self.show_card())

    def on_resize(self) -> None:
        self.call_after_refresh(self.briefing.place)

    def show(self, level: Level, frame: Frame, *, hurried: bool = False) -> None:
        """Show a tick; hurried if the next one follows at once."""
        self._shown = (level, frame)
        self.view.show(level, frame, hurried=hurried)
        self.show_card()

    def select(self, robot_name: str | None) -> None:
        self.view.selected = robot_name
        self.show_card()

    @on(RobotPointed)
    def show_card(self) -> None:
        """Show the card of the robot at the pointer, or else of the selected one."""
        if self._shown is None:
            return
        level, frame = self._shown
        pointed = None if self.view.overlay is not None else self.view.pointed
        name = self.view.selected if pointed is None else pointed
        card_name = None if self.view.camera.sight is Sight.SENSES else name
        self.card.show(level, frame, card_name, self.view.view.middle[0] if self.view.view else 0.0)

    @on(LabyrinthView.Looked)
    def _looked(self) -> None:
        camera = self.view.camera
        times = f"{camera.zoom:g}\N{MULTIPLICATION SIGN}"
        words = {
            Sight.WHOLE: "",
            Sight.SENSES: "senses",
            Sight.FREE: f"{times}, moved" if camera.zoom == 1 else times,
            Sight.FOLLOW: f"{clip(one_line(self.view.selected or ''), 12)} {times}",
        }
        note, ghost = words[camera.sight], self.view.ghost
        if camera.sight is Sight.FREE and (key := command("view").key_name):
            note += f" · {key} shows all"
        if ghost is not None:
            ghost_note = f"ghost: {count_of(ghost.last, 'tick')}"
            note = f"{note} · {ghost_note}" if note else ghost_note
        self.note(note if self.view.overlay is None else f"editing {note}".rstrip())
        self.show_card()

    def action_pan(self, across: int, down: int, far: bool = False) -> None:
        if self.view.overlay is not None:
            self.view.overlay.step(across, down, far=far)
            return
        columns, rows = self.view.size
        self.view.pan(across * columns / 8, down * rows / 8)

    def enter(self) -> None:
        """Focus the view, so that single letters are commands."""
        self.screen.set_focus(self)


_WIDTH = 28
_MOST_REMEMBERED = 2 * _WIDTH - 8
_GAUGE = 8


class RobotCard(Static):
    """Name, battery, engines and memory of a robot. It moves out of the robot's way."""

    DEFAULT_CSS = f"""
    RobotCard {{
        layer: over; dock: left; display: none; width: {_WIDTH + 2}; height: auto;
        max-height: 8; padding: 0 1; background: $panel; overflow: hidden hidden;
    }}
    RobotCard.-right {{ dock: right; }}
    """

    def __init__(self) -> None:
        super().__init__(id="robot-card")
        self._content = Content("")

    def show(self, level: Level, frame: Frame, name: str | None, middle: float) -> None:
        """Show a robot, or hide; robots to the left of the `middle` get the card on the right."""
        robots = zip(level.robots, frame.after.robots, strict=True)
        selection = next((pair for pair in robots if pair[0].name == name), None)
        self.display = selection is not None
        if selection is None:
            return
        robot, state = selection
        self.set_class(state.x < middle, "-right")
        colour = robot_ink(robot.color, palette_of(self.app.current_theme))
        decision = frame.decision_of(robot.name)
        engines = f"{state.left_engine:+.2f}  {state.right_engine:+.2f}", INK.number
        rows: dict[str, tuple[str, str] | Content] = {
            "engines": engines if decision and decision.desire else ("off", INK.dim),
            "battery": _battery(robot, state),
            "memory": (format_value(frame.memories.get(robot.name), _MOST_REMEMBERED), INK.text),
        }
        title = clip(one_line(robot.name), _WIDTH - 14), f"bold {colour}"
        lines = [Content.assemble(("● ", colour), title, "  ", _trouble(robot, state, decision))]
        for label, value in rows.items():
            lines.append(Content.assemble((f"{label:<8}", INK.dim), value))
        content = Content("\n").join(lines)
        if not content.is_same(self._content):
            self._content = content
            self.update(content)

    def on_click(self) -> None:
        self.display = False


def _trouble(robot: Robot, state: RobotState, decision: Decision | None) -> tuple[str, str]:
    if state.dead and not robot.is_immobile:
        return "battery empty", INK.bad
    if decision is not None and decision.desire is None:
        return "undecided", INK.warn
    if state.blocked:
        return "blocked", INK.warn
    return clip(one_line(robot.team), 13), INK.dim


def _battery(robot: Robot, state: RobotState) -> Content:
    if not robot.has_battery or robot.battery_capacity <= 0:
        return Content.styled("needs none", INK.dim)
    share = min(max(state.battery_level / robot.battery_capacity, 0.0), 1.0)
    full = round(share * _GAUGE)
    ink = INK.good if share > 0.25 else INK.bad
    return Content.assemble(
        ("█" * full, ink), ("░" * (_GAUGE - full), INK.faint), (f" {share:.0%}", ink)
    )
