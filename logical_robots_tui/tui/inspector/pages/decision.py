"""The Decision page: what a robot sensed, remembered and computed, and what it did."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.game import Frame
from logical_robots_tui.mind import ResultTable
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.page import PageEntry, RobotPage
from logical_robots_tui.tui.inspector.plots import format_value, ink_value, radar_plot
from logical_robots_tui.tui.inspector.questions import InspectorQuestions, Survey
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import Value
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program

_RADAR_ROWS = 8
_ROOM_FOR_RADAR = 90  # columns from which on the radar is drawn
_LONGEST = 400


class DecisionPage(RobotPage):
    BINDINGS = [("enter", "screen.command('open_value')")]

    beside = "robots"
    view: LinesView

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        super().__init__(entry, questions, LinesView(id="decision"))

    async def show(self, frame: Frame) -> None:
        self.head(frame.tick, title=f"Decision of {self.robot}")
        self._show(frame, self._questions.stored_survey(frame))

    def show_survey(self, survey: Survey) -> None:
        self._show(survey.frame, survey)

    def _show(self, frame: Frame, survey: Survey | None) -> None:
        program, robot = self._session.program, self.robot
        self.view.show_lines(partial(decision_lines, program, frame, robot, survey))


def decision_lines(
    program: Program | None, frame: Frame, robot: str, survey: Survey | None, width: int
) -> list[Content]:
    index = next(i for i, row in enumerate(frame.sensors) if row["robot_name"] == robot)
    sensor = frame.sensors[index]["sensor"]
    picture = radar_plot(sensor["radar"], _RADAR_ROWS) if width >= _ROOM_FOR_RADAR else []
    room = width - (4 * _RADAR_ROWS + 2 if picture else 0)
    lines = [line for part in _parts(program, frame, index, survey) for line in part.wrap(room)]
    lines += [Content("")] * (len(picture) - len(lines))
    for number, drawn in enumerate(picture):
        gap = max(0, room + 2 - lines[number].cell_length)
        lines[number] = lines[number].pad_right(gap).append(drawn)
    return lines


def _parts(
    program: Program | None, frame: Frame, number: int, survey: Survey | None
) -> Iterator[Content]:
    row = frame.sensors[number]
    robot, sensor = row["robot_name"], row["sensor"]
    yield _heading("sensor in")
    body = sensor["self"]
    front_object = sensor["forward_object"]
    label = "" if front_object in ("wall", "none") else f" {one_line(sensor['forward_label'])}"
    yield _field("front", f"{sensor['forward_distance']}, {front_object}{label}")
    if body["has_battery"]:
        yield _field("battery", f"{body['battery_level']:.1f} of {body['battery_capacity']:g}")
    yield _field("clock", str(sensor["clock"]))
    yield _heading("memory before")
    memory_before, memory_after = frame.memories_before.get(robot), frame.memories.get(robot)
    yield _field("memory", format_value(memory_before, _LONGEST), INK.record)
    yield from _on_the_way(program, robot, survey)
    decision = frame.decision_of(robot)
    if decision is None:
        yield Content.styled("No decision yet: press space.", INK.dim)
        return
    yield _heading("desire")
    if decision.desire is not None:
        desire = decision.desire
        yield _field("as given", f"left {desire.left_engine:.6g}, right {desire.right_engine:.6g}")
    state = frame.after.robots[number]
    yield _field("as driven", f"left {state.left_engine:.6g}, right {state.right_engine:.6g}")
    yield _heading("memory after")
    yield from _difference(memory_before, memory_after)
    for notice in decision.notices:
        yield Content.assemble(
            ("! ", f"bold {INK.warn}"), (clip(one_line(notice.message), _LONGEST), INK.warn)
        )


def _on_the_way(program: Program | None, robot: str, survey: Survey | None) -> Iterator[Content]:
    """Yield the predicates that `Robot` depends on, with one robot's rows."""
    if program is None or survey is None or survey.program is not program:
        return
    yield _heading("on the way")
    for name in program.needed:
        table = survey.tables.get(name)
        if not isinstance(table, ResultTable):
            yield _field(name, "failed" if table is not None else "not known")
            continue
        place = table.columns.index("robot_name") if "robot_name" in table.columns else None
        minds_rows = table.in_mind_of(robot).rows
        rows = [row for row in minds_rows if place is None or row[place] == robot]
        plus = "+" if table.truncated else ""
        words = f"{len(rows):,}{plus} {'rows' if plus or len(rows) != 1 else 'row'}"
        text = Content.styled(words, INK.dim)
        if len(rows) == 1 and not plus:
            cells = [
                ((f"{one_line(column)} ", INK.dim), ink_value(value, 60))
                for column, value in zip(table.columns, rows[0], strict=True)
                if column != "robot_name"
            ]
            text = Content("  ").join(Content.assemble(*pair) for pair in cells) if cells else text
        yield Content.assemble("  ", (f"{one_line(name)}  ", INK.title)).append(text)


def _difference(old_memory: Value, new_memory: Value) -> Iterator[Content]:
    """Compare two memories, field by field if they are records; mark what changed."""
    if not (isinstance(new_memory, Mapping) and isinstance(old_memory, Mapping)):
        old_memory, new_memory = {"memory": old_memory}, {"memory": new_memory}
    for name, value in new_memory.items():
        is_changed = name not in old_memory or old_memory[name] != value
        yield _field(name, format_value(value, _LONGEST), INK.record, changed=is_changed)
    for name in old_memory:
        if name not in new_memory:
            yield Content.assemble("  ", (f"{one_line(name)} is gone", INK.key))


def _heading(title: str) -> Content:
    return Content.styled(title, f"bold {INK.title}")


def _field(name: str, text: str, ink: str = INK.text, *, changed: bool = False) -> Content:
    mark = ("• ", INK.key) if changed else ("  ", INK.dim)
    return Content.assemble(mark, (f"{one_line(name)}  ", INK.dim), (text, ink))
