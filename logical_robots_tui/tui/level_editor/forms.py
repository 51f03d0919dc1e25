"""The forms of the level editor: an object, the whole level, and the list of findings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.suggester import SuggestFromList
from textual.widgets import OptionList, Select, Static, TextArea
from textual.widgets.option_list import Option

from logical_robots_tui.editing.checks import Finding
from logical_robots_tui.editing.properties import resize, set_words
from logical_robots_tui.editing.things import Ref
from logical_robots_tui.editing.things import thing as thing_of
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.level_editor.form import Form, choice, flag, number, several, text
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import Area, Beacon, Robot, Visibility

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from textual.app import ComposeResult
    from textual.widget import Widget
    from textual.widgets import Input

    from logical_robots_tui.tui.level_editor.editor import LevelEditor

__all__ = ["FindingList", "LevelForm", "ThingForm"]

_COLOURS = (
    *("red", "orange", "gold", "yellow", "lime", "green", "teal", "cyan", "skyblue", "royalblue"),
    *("purple", "violet", "magenta", "pink", "brown", "white", "gray", "black"),
)
_TITLES = {"robots": "Robot", "beacons": "Beacon", "areas": "Area"}


class ThingForm(Form):
    """Edits the properties of one thing.

    Args:
        editor: The level editor.
        ref: The thing.
    """

    def __init__(self, editor: LevelEditor, ref: Ref) -> None:
        super().__init__(_TITLES[ref.kind])
        self._editor = editor
        self._ref = ref
        self._thing = thing_of(editor.level, ref)

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """Yield the fields for this kind of thing."""
        thing = self._thing
        yield "Name", text("name", thing.name)
        yield "x", number("x", thing.x)
        yield "y", number("y", thing.y)
        if isinstance(thing, Robot):
            yield from self._of_robot(thing)
        elif isinstance(thing, Beacon):
            station = thing.charging_station
            yield "Charging", flag("charging", "charges robots nearby", value=station)
        else:
            yield from self._of_area(thing)

    def take(self) -> None:
        """Apply the properties."""
        thing = self._thing
        values: dict[str, Any] = {
            "name": self.text_of("name"),
            "x": self.number_of("x", "x"),
            "y": self.number_of("y", "y"),
        }
        if isinstance(thing, Robot):
            heading = self.number_of("heading", "The heading")
            if f"{heading:.10g}" != f"{math.degrees(thing.angle):.10g}":
                values["angle"] = math.radians(heading)
            values |= {
                "color": self.text_of("color"),
                "has_battery": self.flag_of("battery"),
                "battery_capacity": self.number_of("capacity", "The capacity"),
                "battery_consumption_rate": self.number_of("consumption", "The consumption"),
                "can_charge": self.flag_of("charges"),
            }
        elif isinstance(thing, Beacon):
            values["charging_station"] = self.flag_of("charging")
        else:
            values |= {
                "radius": self.number_of("radius", "The radius"),
                "color": self.text_of("color"),
                "impenetrable": self.flag_of("solid"),
                "on_beacon": self.choice_of("on"),
                "off_beacon": self.choice_of("off"),
                "sticky_switch": self.flag_of("sticky"),
                "victory_robots": self.several_of("goal"),
            }
        self._editor.set_values(self._ref, values)

    def _of_robot(self, robot: Robot) -> Iterable[tuple[str, Widget]]:
        yield "Heading", number("heading", math.degrees(robot.angle))
        yield "Colour", _colour(robot.color)
        yield "Battery", flag("battery", "its engines need charge", value=robot.has_battery)
        yield "Capacity", number("capacity", robot.battery_capacity)
        yield "Consumption", number("consumption", robot.battery_consumption_rate)
        yield "Charging", flag("charges", "charges other robots", value=robot.can_charge)

    def _of_area(self, area: Area) -> Iterable[tuple[str, Widget]]:
        level = self._editor.level
        beacons = [beacon.name for beacon in level.beacons]
        yield "Radius", number("radius", area.radius)
        yield "Colour", _colour(area.color)
        yield "Solid", flag("solid", "robots can't drive into it", value=area.impenetrable)
        yield "Switched on by", choice("on", beacons, area.on_beacon, "no beacon: on from start")
        yield "Switched off by", choice("off", beacons, area.off_beacon, "no beacon")
        yield "Sticky", flag("sticky", "stays as it was switched", value=area.sticky_switch)
        robots = [robot.name for robot in level.robots]
        yield "Goal for", several("goal", robots, area.victory_robots)


def _colour(value: str) -> Input:
    line = text("color", value)
    line.suggester = SuggestFromList(_COLOURS, case_sensitive=False)
    return line


_PLACES = {"0": "right and below", "1": "on all sides", "2": "left and above"}
_MEMORIES: dict[Literal["own", "seen", "all"], str] = {
    "own": "its own",
    "seen": "also of robots on its radar",
    "all": "of all robots",
}
_SENSORS: dict[Literal["own", "all"], str] = {"own": "its own", "all": "of all robots"}
_VISIBILITIES: dict[tuple[str, str], Visibility] = {
    (memory, sensor): Visibility(memory, sensor) for memory in _MEMORIES for sensor in _SENSORS
}


class LevelForm(Form):
    """Edits size, texts, visibility and shared names.

    Args:
        editor: The level editor.
    """

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__("Level")
        self._editor = editor
        self._level = editor.level

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """Yield the fields of a level."""
        level = self._level
        yield "Title", text("title", level.title)
        yield "Idea", text("idea", level.idea)
        yield "Width", number("width", level.width)
        yield "Height", number("height", level.height)
        yield "Add or cut at", _select("place", _PLACES, "0")
        yield "New room", flag("wall", "is wall", value=False)
        yield "Robot sees", _select("sensor", _SENSORS, level.visibility.sensor)
        yield "Robot knows", _select("memory", _MEMORIES, level.visibility.memory)
        yield "Shared names", text("shared_names", ", ".join(level.shared_names))
        yield "Briefing", TextArea(level.briefing, id="briefing", tab_behavior="focus")
        hints = "\n\n".join(level.hints)
        yield "Hints", TextArea(hints, id="hints", tab_behavior="focus")

    def take(self) -> None:
        """Apply the properties as one step."""
        level = self._level
        width = self.whole_of("width", "The width")
        height = self.whole_of("height", "The height")
        share = int(self.choice_of("place")) / 2
        left = int((width - level.width) * share)
        top = int((height - level.height) * share)
        wall = self.flag_of("wall")
        changed = resize(level, width, height, left=left, top=top, wall=wall)
        visibility = _VISIBILITIES[self.choice_of("memory"), self.choice_of("sensor")]
        words = {
            "title": self.text_of("title"),
            "idea": self.text_of("idea"),
            "briefing": self._kept("briefing", level.briefing),
            "hints": self._hints(),
            "visibility": visibility,
            "shared_names": self._shared_names(),
        }
        changed = set_words(changed, **words)
        self._editor.change_level("level", changed)

    def _kept(self, name: str, before: str) -> str:
        typed = self.lines_of(name)
        return before if typed == before.strip() else typed

    def _shared_names(self) -> tuple[str, ...]:
        typed = self.text_of("shared_names")
        if typed == ", ".join(self._level.shared_names):
            return self._level.shared_names
        return tuple(name.strip() for name in typed.split(",") if name.strip())

    def _hints(self) -> tuple[str, ...]:
        typed = self.lines_of("hints")
        if typed == "\n\n".join(self._level.hints).strip():
            return self._level.hints
        return tuple(hint.strip() for hint in typed.split("\n\n") if hint.strip())


def _select(name: str, options: Mapping[Any, str], value: str) -> Select[str]:
    pairs = [(label, each) for each, label in options.items()]
    return Select(pairs, value=value, allow_blank=False, id=name, compact=True)


class FindingList(Dialog[Finding]):
    """Lists findings; returns the one to go to.

    Args:
        findings: At least one.
    """

    DEFAULT_CSS = """
    FindingList > #box { max-width: 90; padding: 1 2 0 2; }
    FindingList OptionList { height: auto; max-height: 16; }
    """

    def __init__(self, findings: Sequence[Finding]) -> None:
        super().__init__()
        self._findings = findings

    def compose(self) -> ComposeResult:
        """Yield one line for each."""
        with Vertical(id="box") as box:
            box.border_title = "Findings"
            yield Listing(
                *(Option(_told(finding)) for finding in self._findings), markup=False, compact=True
            )
            yield Static("enter go there   ↑↓ choose   esc close", id="keys", markup=False)

    @on(OptionList.OptionSelected)
    def _chosen(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(self._findings[event.option_index])


def _told(finding: Finding) -> Content:
    style = INK.bad if finding.forbids else INK.warn
    place = ""
    if finding.x is not None and finding.y is not None:
        place = f"   {finding.x:.0f}, {finding.y:.0f}"
    return Content.assemble(("! ", style), (one_line(finding.text), INK.text), (place, INK.dim))
