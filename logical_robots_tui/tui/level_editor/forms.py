"""The form for a robot, a beacon or an area."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from textual.suggester import SuggestFromList

from logical_robots_tui.editing.things import Ref
from logical_robots_tui.editing.things import thing as thing_of
from logical_robots_tui.tui.level_editor.form import Form, choice, flag, number, several, text
from logical_robots_tui.world import Area, Beacon, Robot

if TYPE_CHECKING:
    from collections.abc import Iterable

    from textual.widget import Widget
    from textual.widgets import Input

    from logical_robots_tui.tui.level_editor.editor import LevelEditor

__all__ = ["ThingForm"]

_COLOURS = (
    *("red", "orange", "gold", "yellow", "lime", "green", "teal", "cyan", "skyblue", "royalblue"),
    *("purple", "violet", "magenta", "pink", "brown", "white", "gray", "black"),
)
_TITLES = {"robots": "Robot", "beacons": "Beacon", "areas": "Area"}


class ThingForm(Form):
    """Asks for the properties of one thing.

    Args:
        editor: What edits.
        ref: The thing.
    """

    def __init__(self, editor: LevelEditor, ref: Ref) -> None:
        super().__init__(_TITLES[ref.kind])
        self._editor = editor
        self._ref = ref
        self._thing = thing_of(editor.level, ref)

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """What such a thing has."""
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
        """Give the thing its properties."""
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
