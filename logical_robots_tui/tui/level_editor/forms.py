"""The forms of the level editor: fields that read their own values, and what is made of them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from random import randrange
from typing import TYPE_CHECKING, Any, TypeAlias

from textual import on
from textual.binding import Binding
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.suggester import SuggestFromList
from textual.widgets import Button, Checkbox, Input, OptionList, Select, Static, TextArea

from logical_robots_tui.editing.checks import LevelFinding
from logical_robots_tui.editing.entities import Ref, change, entity_of, resize, set_words
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.library.level_screen import own_levels
from logical_robots_tui.tui.library.picker import Picker
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import (
    Beacon,
    Level,
    LevelError,
    Robot,
    Visibility,
    load_level,
)
from logical_robots_tui.world.level import Cycle
from logical_robots_tui.world.levels.labyrinths import empty_room, labyrinth
from logical_robots_tui.world.world import Pose

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from logical_robots_tui.editing.editor import LevelEditor


class TextField(Input):
    def __init__(self, name: str, value: str) -> None:
        super().__init__(value, id=name)

    def read(self) -> str:
        return self.value.strip()


class NumberField(Input):
    def __init__(self, name: str, value: float, subject: str, *, whole: bool = False) -> None:
        super().__init__(f"{value:.10g}", id=name)
        self._subject, self._whole = subject, whole

    def read(self) -> float:
        typed = self.value.strip()
        try:
            number = float(typed)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise LevelError(f"{self._subject} must be a number, not “{typed}”.")
        if self._whole and not number.is_integer():
            raise LevelError(f"{self._subject} must be an integer, not {number:g}.")
        return int(number) if self._whole else number


class CycleField(Input):
    def __init__(self, name: str, value: Cycle | None) -> None:
        text = value.words.removeprefix("ticks ") if value else ""
        super().__init__(text, placeholder="such as 301 to 600 of every 600", id=name)

    def read(self) -> Cycle | None:
        match = re.fullmatch(r"(\d{1,9}) to (\d{1,9}) of every (\d{1,9})", self.value.strip())
        if not match and self.value.strip():
            raise LevelError("The ticks must be like “301 to 600 of every 600”.")
        return Cycle(int(match[3]), int(match[1]), int(match[2])) if match else None


class Lines(TextArea):
    def __init__(self, name: str, value: str) -> None:
        super().__init__(value, id=name, tab_behavior="focus")

    def read(self) -> str:
        return self.text.strip()


class ChoiceField(Select[str]):
    """One of several names, even a missing one; space and down list them.

    `nothing` is the label for no name, or "" if one must be chosen.
    """

    BINDINGS = [("enter", "screen.enter")]

    def __init__(self, name: str, labels: Mapping[str, str], value: str, nothing: str = "") -> None:
        options = [(Content(one_line(label)), option_name) for option_name, label in labels.items()]
        if value and value not in labels:
            options.append((Content(f"{one_line(value)} (missing)"), value))
        super().__init__(
            options,
            prompt=nothing,
            allow_blank=bool(nothing),
            value=value or Select.NULL,
            id=name,
            compact=True,
        )

    def read(self) -> str:
        return "" if self.value is Select.NULL else str(self.value)


def _box(is_on: bool) -> str:
    return "[X] " if is_on else "[ ] "


class Flag(Checkbox):
    """A checkbox that is readable without colours."""

    def __init__(self, name: str, label: str, value: bool) -> None:
        super().__init__(Content(label), value, id=name, compact=True)
        self._words = label

    def render(self) -> Content:
        return Content.assemble((_box(self.value), INK.key), self._words)

    def read(self) -> bool:
        return self.value


class Ticks(Listing):
    """Any number of names, with checkboxes; ticked ones are listed even if missing."""

    def __init__(self, name: str, choices: Sequence[str], ticked: Sequence[str]) -> None:
        self._names = list(dict.fromkeys([*choices, *ticked]))
        self._choices, self._ticked = set(choices), set(ticked)
        super().__init__(*map(self._line, self._names), id=name, markup=False, compact=True)

    def read(self) -> tuple[str, ...]:
        return tuple(name for name in self._names if name in self._ticked)

    def toggle(self, name: str) -> None:
        self._ticked ^= {name}
        self.replace_option_prompt_at_index(self._names.index(name), self._line(name))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        self.toggle(self._names[event.option_index])

    def _line(self, name: str) -> Content:
        suffix = "" if name in self._choices else " (missing)"
        return Content.assemble(
            (_box(name in self._ticked), INK.key), one_line(name), (suffix, INK.dim)
        )


Field: TypeAlias = TextField | NumberField | CycleField | Lines | ChoiceField | Flag | Ticks
"""A widget whose id names a value, which `read` returns; an invalid one raises `LevelError`."""


class Form(Dialog[bool]):
    """Fields with labels; returns True once `take` has applied them."""

    DEFAULT_CSS = """
    Form > #box { max-width: 76; padding: 0 1 0 2; }
    Form VerticalScroll { height: auto; max-height: 80vh; scrollbar-gutter: stable; }
    Form .row { height: auto; }
    Form .label { width: 17; height: 1; color: $ink-dim; }
    Form Input { width: 1fr; margin: 0; }
    Form Checkbox, Form Select, Form Ticks, Form TextArea {
        width: 1fr; border: none; padding: 0; }
    Form Checkbox { background: $surface; }
    Form Checkbox:focus { background: $block-cursor-background; }
    Form Ticks, Form TextArea { height: auto; max-height: 6; background: $panel; }
    Form TextArea { min-height: 3; padding: 0 1; }
    Form #buttons { height: 1; margin-top: 1; }
    Form Button { height: 1; min-width: 8; border: none; margin-right: 2; padding: 0 1;
        background: $panel; color: $foreground; text-style: none; }
    Form Button:focus { background: $block-cursor-background; text-style: bold; border: none; }
    Form #keys { margin: 0; }
    """

    BINDINGS = [Binding("f2", "take", priority=True)]

    keys = "tab next   F2 or enter apply   esc cancel"
    verb = "Apply"
    enter_goes_on = False  # to the next field

    def __init__(self, title: str) -> None:
        super().__init__(title)
        self._fields: dict[str, Field] = {}
        self.rows: dict[str, Horizontal] = {}
        self._before: dict[str, Any] = {}

    def fields(self) -> Iterable[tuple[str, Field]]:
        raise NotImplementedError

    def take(self) -> None:
        """Apply the fields, or raise LevelError."""
        raise NotImplementedError

    def content_widgets(self) -> ComposeResult:
        with VerticalScroll(can_focus=False):
            for label, field in self.fields():
                self._fields[field.id or ""] = field
                with Horizontal(classes="row") as self.rows[field.id or ""]:
                    yield Static(label, classes="label", markup=False)
                    yield field
        with Horizontal(id="buttons"):
            yield Button(self.verb, id="take", compact=True, action="screen.take")
            yield Button("Cancel", compact=True, action="screen.leave")

    def on_mount(self) -> None:
        self._before = self.values()
        for line in self.query(Input):
            line.cursor_blink = False

    @on(Input.Submitted)
    def action_enter(self) -> None:
        if not self.enter_goes_on or isinstance(self.focus_next(), Button):
            self.action_take()

    def action_take(self) -> None:
        try:
            self.take()
        except LevelError as error:
            self.complain(error.message)
        else:
            self.dismiss(True)

    def values(self, *names: str) -> dict[str, Any]:
        """Return values of some fields, or all, by name, or raise LevelError."""
        return {name: self._fields[name].read() for name in names or self._fields}

    def changed_values(self) -> dict[str, Any]:
        """Return the values of changed fields by name, like `values`."""
        return {name: v for name, v in self.values().items() if v != self._before[name]}


_COLOURS = (
    *("red", "orange", "gold", "yellow", "lime", "green", "teal", "cyan", "skyblue", "royalblue"),
    *("purple", "violet", "magenta", "pink", "brown", "white", "gray", "black"),
)
_POSE = ("x", "y", "angle")


class ThingForm(Form):
    """Edits one thing's attributes; a robot under way has extra fields for its start."""

    def __init__(
        self, editor: LevelEditor, ref: Ref, place_robot: Callable[[str, Pose], None]
    ) -> None:
        self._editor, self._ref, self._place_robot = editor, ref, place_robot
        self._thing = entity_of(editor.level, ref)
        super().__init__(type(self._thing).__name__)
        self._is_moving = ref.kind == "robots" and editor.is_under_way

    def fields(self) -> Iterator[tuple[str, Field]]:
        thing = self._thing
        yield "Name", TextField("name", thing.name)
        standing = entity_of(self._editor.standing, self._ref)
        yield "x", _measure("x", standing.x, "x")
        yield "y", _measure("y", standing.y, "y")
        if isinstance(thing, Robot):
            assert isinstance(standing, Robot)
            yield "Heading", _measure("angle", math.degrees(standing.angle), "The heading")
            if self._is_moving:
                yield "Start x", _measure("start_x", thing.x, "The start")
                yield "Start y", _measure("start_y", thing.y, "The start")
                heading = math.degrees(thing.angle)
                yield "Start heading", _measure("start_angle", heading, "The heading at the start")
            yield "Colour", _colour(thing.color)
            if teams := {team.name: team.name for team in self._editor.level.teams}:
                yield "Team", ChoiceField("team", teams, thing.team)
            yield "Battery", Flag("has_battery", "its engines need charge", thing.has_battery)
            yield (
                "Capacity",
                NumberField("battery_capacity", thing.battery_capacity, "The capacity"),
            )
            rate = thing.battery_consumption_rate
            yield "Consumption", NumberField("battery_consumption_rate", rate, "The consumption")
            yield "Charging", Flag("can_charge", "charges other robots", thing.can_charge)
        elif isinstance(thing, Beacon):
            station = thing.charging_station
            yield "Charging", Flag("charging_station", "charges robots nearby", station)
        else:
            yield "Radius", _measure("radius", thing.radius, "The radius")
            yield "Colour", _colour(thing.color)
            solid = thing.impenetrable
            yield "Solid", Flag("impenetrable", "robots can't drive into it", solid)
            names = {beacon.name: beacon.name for beacon in self._editor.level.beacons}
            always = "no beacon: on from start"
            yield "Switched on by", ChoiceField("on_beacon", names, thing.on_beacon, always)
            yield "Switched off by", ChoiceField("off_beacon", names, thing.off_beacon, "no beacon")
            yield "Sticky", Flag("sticky_switch", "stays as it was switched", thing.sticky_switch)
            yield "On in ticks", CycleField("cycle", thing.cycle)
            robots = [robot.name for robot in self._editor.level.robots]
            yield "Goal for", Ticks("victory_robots", robots, thing.victory_robots)

    def take(self) -> None:
        editor, ref, values = self._editor, self._ref, self.changed_values()
        for name in ("angle", "start_angle"):
            if name in values:
                values[name] = math.radians(values[name])
        moved = {}
        if self._is_moving:
            moved = {name: values.pop(name) for name in _POSE if name in values}
            values = {name.removeprefix("start_"): value for name, value in values.items()}
            change(editor.level, ref, **moved)  # refuses what is out of range
        editor.set_values(ref, values)
        if moved:
            robot = entity_of(editor.standing, ref)
            assert isinstance(robot, Robot)
            x, y, angle = (moved.get(name, getattr(robot, name)) for name in _POSE)
            self._place_robot(robot.name, (x, y, angle))


def _measure(name: str, value: float, subject: str) -> NumberField:
    """A field with as many digits as matter; the value stays exact unless it is changed."""
    return NumberField(name, round(value, 2), subject)


def _colour(value: str) -> TextField:
    line = TextField("color", value)
    line.suggester = SuggestFromList(_COLOURS, case_sensitive=False)
    return line


_TEXTS = ("title", "idea", "briefing", "hints", "shared_names")
_PLACES = {"0": "right and below", "1": "on all sides", "2": "left and above"}
_MEMORIES = {"own": "its own", "seen": "also of robots on its radar", "all": "of all robots"}
_SENSORS = {"own": "its own", "all": "of all robots"}


class LevelForm(Form):
    def __init__(self, editor: LevelEditor) -> None:
        super().__init__("Level")
        self._editor, self._level = editor, editor.level

    def fields(self) -> Iterator[tuple[str, Field]]:
        level = self._level
        yield "Title", TextField("title", level.title)
        yield "Idea", TextField("idea", level.idea)
        yield "Width", NumberField("width", level.width, "The width", whole=True)
        yield "Height", NumberField("height", level.height, "The height", whole=True)
        yield "Add or cut at", ChoiceField("place", _PLACES, "0")
        yield "New space", Flag("wall", "is wall", False)
        yield "Robot sees", ChoiceField("sensor", _SENSORS, level.visibility.sensor)
        yield "Robot knows", ChoiceField("memory", _MEMORIES, level.visibility.memory)
        yield "Shared names", TextField("shared_names", ", ".join(level.shared_names))
        yield "Briefing", Lines("briefing", level.briefing)
        yield "Hints", Lines("hints", "\n\n".join(level.hints))

    def take(self) -> None:
        level, values = self._level, self.values()
        width, height, share = values["width"], values["height"], int(values["place"]) / 2
        left = int((width - level.width) * share)
        top = int((height - level.height) * share)
        resized = resize(level, width, height, left=left, top=top, wall=values["wall"])
        changes = self.changed_values()
        for name, separator in (("shared_names", ","), ("hints", "\n\n")):
            if name in changes:
                parts = (part.strip() for part in changes[name].split(separator))
                changes[name] = tuple(part for part in parts if part)
        words = {name: changes[name] for name in _TEXTS if name in changes}
        words["visibility"] = Visibility(values["memory"], values["sensor"])
        self._editor.change_level("level", set_words(resized, **words))


_KINDS = {"room": "an empty room", "labyrinth": "a random labyrinth", "copy": "a copy"}
_OF = {
    "room": ("width", "height", "wall"),
    "labyrinth": ("columns", "rows", "corridor", "wall", "loops", "seed"),
    "copy": ("original",),
}


class NewLevelForm(Form):
    """Asks for a new level, which is then in `level`."""

    keys = "tab or enter next   F2 create   esc cancel"
    verb = "Create"
    enter_goes_on = True

    def __init__(self, names: list[str], current_name: str, folder: Path) -> None:
        super().__init__("New level")
        self._names, self._folder = names, folder
        self._current_name = current_name if current_name in names else names[0]
        self.level: Level | None = None

    def fields(self) -> Iterator[tuple[str, Field]]:
        yield "Kind", ChoiceField("kind", _KINDS, "room")
        yield "Title", TextField("title", "")
        yield "Width", NumberField("width", 600, "The width", whole=True)
        yield "Height", NumberField("height", 400, "The height", whole=True)
        yield "Columns", NumberField("columns", 8, "The number of columns", whole=True)
        yield "Rows", NumberField("rows", 6, "The number of rows", whole=True)
        yield "Corridor width", NumberField("corridor", 60, "The corridor", whole=True)
        yield "Wall thickness", NumberField("wall", 10, "The wall", whole=True)
        yield "Loops, 0 to 1", NumberField("loops", 0.1, "The share of loops")
        seed = randrange(1000)  # noqa: S311 - no secret is made of it
        yield "Seed", NumberField("seed", seed, "The seed", whole=True)
        yield (
            "Copy of",
            ChoiceField("original", {name: name for name in self._names}, self._current_name),
        )

    def on_mount(self) -> None:
        self._arrange()

    @on(Select.Changed, "#kind")
    def _arrange(self) -> None:
        field_names = _OF[self.values("kind")["kind"]]
        for name in {field_name for names in _OF.values() for field_name in names}:
            self.rows[name].display = name in field_names

    def take(self) -> None:
        kind, title = self.values("kind", "title").values()
        values = self.values(*_OF[kind])
        if kind == "room":
            level = empty_room(**values)
        elif kind == "labyrinth":
            level = labyrinth(**values)
        else:
            name = values["original"]
            original = load_level(own_levels(self._folder).get(name, name))
            copy_title = f"{original.title} (copy)"
            level = replace(original, name=f"{name}-copy", title=copy_title, source="")
        self.level = set_words(level, title=title) if title else level


class FindingList(Picker[LevelFinding, LevelFinding]):
    DEFAULT_CSS = "FindingList > #box { max-width: 90; }"

    heading = "Findings"
    keys = "enter go there   ↑↓ choose   esc close"

    def line(self, entry: LevelFinding) -> Content:
        style, text = INK.bad if entry.forbids else INK.warn, one_line(entry.text)
        has_place = entry.x is not None and entry.y is not None
        place = f"   {entry.x:.0f}, {entry.y:.0f}" if has_place else ""
        return Content.assemble(("! ", style), (text, INK.text), (place, INK.dim))
