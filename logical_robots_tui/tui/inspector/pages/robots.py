"""The Robots page: where each robot is, what it senses, wants and remembers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from operator import itemgetter
from typing import Any, NamedTuple

from textual import events
from textual.content import Content

from logical_robots_tui.game import Frame
from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.page import Page, PageEntry
from logical_robots_tui.tui.inspector.plots import BARS, OBJECT_INKS, format_value
from logical_robots_tui.tui.inspector.questions import Questions
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
        self._chosen: str | None = None

    def show(self, level: Level, frame: Frame, chosen: str | None) -> None:
        def lines(width: int) -> list[Content]:
            palette = palette_of(self.app.current_theme)
            shown, others = _columns(level, width)
            robots = _robots(level, frame, palette)
            found = [*_left_out(robots, others, chosen), *_notes(level, frame, chosen)]
            notes = [line for note in found for line in note.wrap(width)]
            return [*_table(shown, robots, chosen), Content(""), *notes]

        self._names, self._chosen = [robot.name for robot in level.robots], chosen
        self.show_lines(lines)

    def on_mount(self) -> None:
        self.app.theme_changed_signal.subscribe(self, lambda _: self.redraw())

    def on_click(self, event: events.Click) -> None:
        self._post_chosen(event.y + self.scroll_offset.y - 1)

    def action_choose(self, down: int) -> None:
        at = (
            self._names.index(self._chosen)
            if self._chosen in self._names
            else -1
            if down > 0
            else 0
        )
        if self._names:
            self._post_chosen((at + down) % len(self._names))

    def _post_chosen(self, number: int) -> None:
        if 0 <= number < len(self._names):
            self.post_message(RobotChosen(self._names[number]))


class RobotsPage(Page):
    replays = False
    view: RobotsView

    def __init__(self, entry: PageEntry, questions: Questions) -> None:
        super().__init__(entry, questions, RobotsView())

    async def show(self, frame: Frame) -> None:
        self.head(frame.tick)
        self.view.show(self._session.level, frame, self._questions.chosen)


class _Robot(NamedTuple):
    name: str
    colour: str
    state: RobotState
    sensor: Mapping[str, Any]
    memory: Any
    desire: Desire | None


class _Column(NamedTuple):
    """A column; if there is little room, those with the highest rank come first."""

    title: str
    width: int
    rank: int
    cell: Callable[[_Robot], Content]
    right: bool = False


def _robots(level: Level, frame: Frame, palette: Palette) -> list[_Robot]:
    sensors = {row["robot_name"]: row["sensor"] for row in frame.sensors}
    desires = {decision.robot_name: decision.desire for decision in frame.decisions}
    return [
        _Robot(
            start.name,
            robot_ink(start.color, palette),
            state,
            sensors[start.name],
            frame.memories.get(start.name),
            desires.get(start.name),
        )
        for start, state in zip(level.robots, frame.after.robots, strict=True)
    ]


def _table(
    columns: Sequence[_Column], robots: Sequence[_Robot], chosen: str | None
) -> Iterator[Content]:
    """Yield the titles of the columns, then a line for each robot."""
    titles = [each.title if each.right else clip(each.title, each.width) for each in columns]
    yield _line(columns, [Content.styled(title, INK.dim) for title in titles])
    for robot in robots:
        line = _line(columns, [column.cell(robot) for column in columns])
        yield line.stylize_before(_CHOSEN) if robot.name == chosen else line


def _left_out(
    robots: Sequence[_Robot], columns: Sequence[_Column], chosen: str | None
) -> Iterator[Content]:
    """Yield what the table has no room for, of the robot that is chosen or the only one."""
    for robot in robots:
        if columns and (robot.name == chosen or len(robots) == 1):
            parts = [
                Content.styled(f"{each.title} ", INK.dim).append(each.cell(robot))
                for each in columns
            ]
            yield Content("   ").join(parts)


def _line(columns: Sequence[_Column], cells: Sequence[Content]) -> Content:
    parts = []
    for column, cell in zip(columns, cells, strict=True):
        missing = max(column.width - cell.cell_length, 0)
        padded = cell.pad_left(missing) if column.right else cell.pad_right(missing)
        parts.append(padded.truncate(column.width).append(" "))
    return Content("").join(parts)


def _notes(level: Level, frame: Frame, chosen: str | None) -> list[Content]:
    found = [
        Content.assemble(
            ("! ", f"bold {INK.warn}"),
            (f"{one_line(decision.robot_name)}: ", INK.warn),
            (clip(one_line(notice.message), 400), INK.text),
        )
        for decision in frame.decisions
        for notice in decision.notices
    ]
    names = [robot.name for robot in level.robots]
    if chosen is None and len(names) == 1:
        chosen = names[0]
    if chosen is not None and chosen in names:
        words = format_value(frame.memories.get(chosen), 4000)
        who = f"{one_line(chosen)} remembers "
        found.append(Content.assemble((who, INK.dim), (words, INK.text)))
    return found


def radar_strip(radar: Sequence[Mapping[str, Any]]) -> Content:
    """Draw the rays from left to right as bars: height by distance, colour by object."""
    return Content.assemble(
        *(
            ("".join(map(_bar, rays)), OBJECT_INKS.get(what, INK.nothing))
            for what, rays in groupby(radar, itemgetter("object"))
        )
    )


def _bar(ray: Mapping[str, Any]) -> str:
    free = math.sqrt(ray["distance"] / SENSOR_RANGE)  # more of the bar for what is near
    return BARS[min(int(free * len(BARS)), len(BARS) - 1)]


def _columns(level: Level, width: int) -> tuple[list[_Column], list[_Column]]:
    """Return the columns that fit, and the others."""
    longest = max(len(one_line(robot.name)) for robot in level.robots)
    columns = [
        _Column("robot", min(max(longest, 5), 12) + 3, 0, _name),
        _Column("x", 5, 6, lambda robot: _number(robot.state.x), right=True),
        _Column("y", 5, 6, lambda robot: _number(robot.state.y), right=True),
        _Column("head", 5, 4, _heading, right=True),
        _Column("front", 16, 3, _front),
        _Column("radar, left to right", 31, 1, lambda robot: radar_strip(robot.sensor["radar"])),
        _Column("left", 6, 2, lambda robot: _engine(robot, "left_engine"), right=True),
        _Column("right", 6, 2, lambda robot: _engine(robot, "right_engine"), right=True),
    ]
    if any(robot.has_battery for robot in level.robots):
        columns.append(_Column("charge", 6, 5, _charge, right=True))
    known = columns
    while (room := width - sum(each.width + 1 for each in columns)) < 0 and len(columns) > 1:
        last = max(column.rank for column in columns)
        columns = [column for column in columns if column.rank != last]
    if room >= 16:
        columns.append(_Column(" memory", room - 2, 7, lambda robot: _memory(robot, room - 3)))
    return columns, [column for column in known if column not in columns]


def _name(robot: _Robot) -> Content:
    mark = "✕" if robot.state.dead else "!" if robot.state.blocked else " "
    mark_style = INK.bad if robot.state.dead else INK.warn
    return Content.assemble(
        ("● ", robot.colour),
        (clip(one_line(robot.name), 12), f"bold {robot.colour}"),
        (mark, mark_style),
    )


def _heading(robot: _Robot) -> Content:
    angle = robot.state.angle
    text = f"{round(math.degrees(angle)) % 360}°" if math.isfinite(angle) else "?"
    return Content.styled(text, INK.text)


def _front(robot: _Robot) -> Content:
    what, label = robot.sensor["forward_object"], robot.sensor["forward_label"]
    if what == "none":
        return Content.styled("nothing", INK.dim)
    name = "wall" if what == "wall" and label == "wall" else one_line(str(label))
    distance = f"{robot.sensor['forward_distance']:g}"
    text = f"{clip(name, 15 - len(distance))} {distance}"
    return Content.styled(text, OBJECT_INKS.get(what, INK.text))


def _engine(robot: _Robot, side: str) -> Content:
    value: float | None = getattr(robot.desire, side, None)
    if value is None:
        return Content.styled("-", INK.dim)
    text = f"{value:.2f}" if abs(value) < 100 else f"{value:.0e}"
    return Content.styled(text, INK.number if -1 <= value <= 1 else INK.warn)


def _charge(robot: _Robot) -> Content:
    capacity = robot.sensor["self"]["battery_capacity"]
    if not robot.sensor["self"]["has_battery"] or not capacity:
        return Content.styled("-", INK.dim)
    share = robot.state.battery_level / capacity
    return Content.styled(f"{share:.0%}", INK.good if share > 0.25 else INK.bad)


def _memory(robot: _Robot, width: int) -> Content:
    return Content.styled(f" {format_value(robot.memory, width)}", INK.dim)


def _number(value: float) -> Content:
    return Content.styled(f"{value:.0f}", INK.text)
