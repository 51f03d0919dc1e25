"""The Robots page: where each robot is, what it senses, wants and remembers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from typing import Any, NamedTuple

from textual import events
from textual.content import Content

from logical_robots_tui.game import Frame
from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.page import PageEntry, RobotPage
from logical_robots_tui.tui.inspector.plots import BARS, OBJECT_INKS, format_value
from logical_robots_tui.tui.inspector.questions import InspectorQuestions
from logical_robots_tui.tui.labyrinth.drawing.cells import Palette
from logical_robots_tui.tui.layout.command_bar import RobotChosen
from logical_robots_tui.tui.theme.themes import INK, palette_of, robot_ink
from logical_robots_tui.values import Desire
from logical_robots_tui.wording import clip, one_line
from logical_robots_tui.world import Level, RobotState

_CHOSEN = "on $row"


class RobotsView(LinesView):
    """A line for each robot, notes below; up, down or a click selects a robot."""

    BINDINGS = [("up", "choose(-1)"), ("down", "choose(1)")]

    def __init__(self) -> None:
        super().__init__(id="robots")
        self._names: list[str] = []
        self._robot_name: str | None = None

    def show(self, level: Level, frame: Frame, name: str | None) -> None:
        def lines_for(width: int) -> list[Content]:
            columns, hidden_columns = _columns(level, width)
            robots = _robots(level, frame, palette_of(self.app.current_theme))
            titles = [
                column.title if column.right else clip(column.title, column.width)
                for column in columns
            ]
            lines = [_line(columns, [Content.styled(title, INK.dim) for title in titles])]
            for robot in robots:
                line = _line(columns, [column.cell(robot) for column in columns])
                lines.append(line.stylize_before(_CHOSEN) if robot.name == name else line)
            notes = _notes(frame, robots, hidden_columns, name)
            return [*lines, Content(""), *(line for note in notes for line in note.wrap(width))]

        self._names, self._robot_name = [robot.name for robot in level.robots], name
        self.show_lines(lines_for)

    def on_mount(self) -> None:
        self.app.theme_changed_signal.subscribe(self, lambda _: self.redraw())

    def on_click(self, event: events.Click) -> None:
        self._post_chosen(event.y + self.scroll_offset.y - 1)

    def action_choose(self, down: int) -> None:
        names, name = self._names, self._robot_name
        index = names.index(name) if name in names else -(down > 0)
        if names:
            self._post_chosen((index + down) % len(names))

    def _post_chosen(self, number: int) -> None:
        if 0 <= number < len(self._names):
            self.post_message(RobotChosen(self._names[number]))


class RobotsPage(RobotPage):
    replays = False
    view: RobotsView

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        super().__init__(entry, questions, RobotsView())

    async def show(self, frame: Frame) -> None:
        self.head(frame.tick)
        self.view.show(self._session.level, frame, self._questions.chosen)


class _RobotRow(NamedTuple):
    name: str
    colour: str
    state: RobotState
    sensor: Mapping[str, Any]
    memory: Any
    desire: Desire | None


class _RobotColumn(NamedTuple):
    """A column; if there is little room, those with the highest rank come first."""

    title: str
    width: int
    rank: int
    cell: Callable[[_RobotRow], Content]
    right: bool = False


def _robots(level: Level, frame: Frame, palette: Palette) -> list[_RobotRow]:
    sensors = {row["robot_name"]: row["sensor"] for row in frame.sensors}
    desires = {decision.robot_name: decision.desire for decision in frame.decisions}
    return [
        _RobotRow(
            start.name,
            robot_ink(start.color, palette),
            replace(state, dead=False) if start.is_immobile else state,
            sensors[start.name],
            frame.memories.get(start.name),
            desires.get(start.name),
        )
        for start, state in zip(level.robots, frame.after.robots, strict=True)
    ]


def _line(columns: Sequence[_RobotColumn], cells: Sequence[Content]) -> Content:
    parts = []
    for column, cell in zip(columns, cells, strict=True):
        missing = max(column.width - cell.cell_length, 0)
        padded = cell.pad_left(missing) if column.right else cell.pad_right(missing)
        parts.append(padded.truncate(column.width).append(" "))
    return Content("").join(parts)


def _notes(
    frame: Frame, robots: Sequence[_RobotRow], hidden: Sequence[_RobotColumn], name: str | None
) -> Iterator[Content]:
    """Yield notices, and of the selected or only robot its memory and the `hidden` cells."""
    robot = next((robot for robot in robots if robot.name == name or len(robots) == 1), None)
    if robot is not None and hidden:
        yield Content("   ").join(
            Content.styled(f"{column.title} ", INK.dim).append(column.cell(robot))
            for column in hidden
        )
    for decision in frame.decisions:
        for notice in decision.notices:
            yield Content.assemble(
                ("! ", f"bold {INK.warn}"),
                (f"{one_line(decision.robot_name)}: ", INK.warn),
                (clip(one_line(notice.message), 400), INK.text),
            )
    if robot is not None:
        who = f"{one_line(robot.name)} remembers "
        words = format_value(robot.memory, 4000)
        yield Content.assemble((who, INK.dim), (words, INK.text))


def radar_strip(radar: Sequence[Mapping[str, Any]]) -> Content:
    """Draw the rays from left to right as bars: height by distance, colour by object."""
    parts = []
    for kind, rays in groupby(radar, itemgetter("object")):
        # The root, so that more of the bar is for what is near.
        shares = (math.sqrt(ray["distance"] / SENSOR_RANGE) for ray in rays)
        bars = (BARS[min(int(share * len(BARS)), len(BARS) - 1)] for share in shares)
        parts.append(("".join(bars), OBJECT_INKS.get(kind, INK.nothing)))
    return Content.assemble(*parts)


def _columns(level: Level, width: int) -> tuple[list[_RobotColumn], list[_RobotColumn]]:
    longest = max(len(one_line(robot.name)) for robot in level.robots)
    columns = [
        _RobotColumn("robot", min(max(longest, 5), 12) + 3, 0, _name),
        _RobotColumn("x", 5, 6, lambda row: _number(row.state.x), right=True),
        _RobotColumn("y", 5, 6, lambda row: _number(row.state.y), right=True),
        _RobotColumn("head", 5, 4, _heading, right=True),
        _RobotColumn("front", 16, 3, _front),
        _RobotColumn("radar, left to right", 31, 1, lambda row: radar_strip(row.sensor["radar"])),
        _RobotColumn("left", 6, 2, lambda row: _engine(row, "left_engine"), right=True),
        _RobotColumn("right", 6, 2, lambda row: _engine(row, "right_engine"), right=True),
    ]
    if any(robot.has_battery and robot.battery_capacity for robot in level.robots):
        columns.append(_RobotColumn("charge", 6, 5, _charge, right=True))
    all_columns = columns
    while (room := width - sum(column.width + 1 for column in columns)) < 0 and len(columns) > 1:
        last = max(column.rank for column in columns)
        columns = [column for column in columns if column.rank != last]
    if room >= 16:

        def memory(robot: _RobotRow) -> Content:
            return Content.styled(f" {format_value(robot.memory, room - 3)}", INK.dim)

        columns.append(_RobotColumn(" memory", room - 2, 7, memory))
    return columns, [column for column in all_columns if column not in columns]


def _name(robot: _RobotRow) -> Content:
    mark = "✕" if robot.state.dead else "!" if robot.state.blocked else " "
    mark_style = INK.bad if robot.state.dead else INK.warn
    return Content.assemble(
        ("● ", robot.colour),
        (clip(one_line(robot.name), 12), f"bold {robot.colour}"),
        (mark, mark_style),
    )


def _heading(robot: _RobotRow) -> Content:
    angle = robot.state.angle
    text = f"{round(math.degrees(angle)) % 360}°" if math.isfinite(angle) else "?"
    return Content.styled(text, INK.text)


def _front(robot: _RobotRow) -> Content:
    kind, label = robot.sensor["forward_object"], robot.sensor["forward_label"]
    if kind == "none":
        return Content.styled("nothing", INK.dim)
    name = "wall" if kind == "wall" and label == "wall" else one_line(str(label))
    distance = f"{robot.sensor['forward_distance']:g}"
    text = f"{clip(name, 15 - len(distance))} {distance}"
    return Content.styled(text, OBJECT_INKS.get(kind, INK.text))


def _engine(robot: _RobotRow, side: str) -> Content:
    value: float | None = getattr(robot.desire, side, None)
    if value is None:
        return Content.styled("-", INK.dim)
    text = f"{value:.2f}" if abs(value) < 100 else f"{value:.0e}"
    return Content.styled(text, INK.number if -1 <= value <= 1 else INK.warn)


def _charge(robot: _RobotRow) -> Content:
    capacity = robot.sensor["self"]["battery_capacity"]
    if not robot.sensor["self"]["has_battery"] or not capacity:
        return Content.styled("-", INK.dim)
    share = robot.state.battery_level / capacity
    return Content.styled(f"{share:.0%}", INK.good if share > 0.25 else INK.bad)


def _number(value: float) -> Content:
    return Content.styled(f"{value:.0f}", INK.text)
