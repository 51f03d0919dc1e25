"""A card over the picture with details of one robot at the current tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.inspector.widgets.cells import written
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK, palette_of, robot_ink

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Decision
    from logical_robots_tui.world import Level, Robot, RobotState

__all__ = ["RobotCard"]

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

    def show(self, level: Level, frame: Frame, name: str | None, *, on_the_left: bool) -> None:
        """Show a robot, or hide.

        Args:
            level: The level.
            frame: The tick.
            name: The robot's name, or None to hide.
            on_the_left: Whether the robot is in the left half of the picture, so that the card
                goes to the right.
        """
        robots = zip(level.robots, frame.after.robots, strict=True)
        found = next((pair for pair in robots if pair[0].name == name), None)
        self.display = found is not None
        if found is None:
            return
        self.set_class(on_the_left, "-right")
        decisions = {decision.robot_name: decision for decision in frame.decisions}
        ink = robot_ink(found[0].color, palette_of(self.app.current_theme))
        content = _content(*found, decisions.get(found[0].name), frame, ink)
        if not content.is_same(self._content):
            self._content = content
            self.update(content)

    def on_click(self) -> None:
        """Hide until another robot is selected."""
        self.display = False


def _content(
    robot: Robot, state: RobotState, decision: Decision | None, frame: Frame, colour: str
) -> Content:
    lines = [
        Content.assemble(
            ("● ", colour), (clip(one_line(robot.name), _WIDTH - 14), f"bold {colour}"), "  "
        ).append(_trouble(state, decision)),
        _labelled("engines", _engines(state, decision)),
        _labelled("battery", _battery(robot, state)),
        _labelled(
            "memory",
            Content.styled(written(frame.memories.get(robot.name), _MOST_REMEMBERED), INK.text),
        ),
    ]
    return Content("\n").join(lines)


def _labelled(label: str, content: Content) -> Content:
    return Content.styled(f"{label:<8}", INK.dim).append(content)


def _trouble(state: RobotState, decision: Decision | None) -> Content:
    if state.dead:
        return Content.styled("battery empty", INK.bad)
    if decision is not None and decision.desire is None:
        return Content.styled("undecided", INK.warn)
    return Content.styled("blocked", INK.warn) if state.blocked else Content("")


def _engines(state: RobotState, decision: Decision | None) -> Content:
    if decision is None or decision.desire is None:
        return Content.styled("off", INK.dim)
    powers = f"{state.left_engine:+.2f}  {state.right_engine:+.2f}"
    return Content.styled(powers, INK.number)


def _battery(robot: Robot, state: RobotState) -> Content:
    if not robot.has_battery or robot.battery_capacity <= 0:
        return Content.styled("needs none", INK.dim)
    share = min(max(state.battery_level / robot.battery_capacity, 0.0), 1.0)
    full = round(share * _GAUGE)
    ink = INK.good if share > 0.25 else INK.bad
    return Content.assemble(
        ("█" * full, ink), ("░" * (_GAUGE - full), INK.faint), (f" {share:.0%}", ink)
    )
