"""Completion: words for the cursor's place, and the list to choose from."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from textual.content import Content
from textual.geometry import Offset
from textual.widgets.option_list import Option

from logical_robots_tui.mind.reference import REFERENCE
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.theme.safe_text import clip
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = [
    "NAMES",
    "Completion",
    "Place",
    "Word",
    "call_before",
    "definitions",
    "help_on",
    "word_around",
    "words_for",
]


class Word(NamedTuple):
    """A word to insert.

    Attributes:
        name: The inserted text.
        shape: How it is used, such as ``Least(x, y, ...)``.
        told: A description, one line.
    """

    name: str
    shape: str
    told: str


class Place(NamedTuple):
    """A place in a text: line and column, from 0."""

    line: int
    column: int


_FIELDS = (
    Word("radar", "sensor.radar", "31 rays from left to right"),
    Word("forward_distance", "sensor.forward_distance", "map units to what is straight ahead"),
    Word("forward_object", "sensor.forward_object", '"wall", "robot", "beacon" or "none"'),
    Word("forward_label", "sensor.forward_label", "name of what is straight ahead"),
    Word("clock", "sensor.clock", "number of the tick"),
    Word("self", "sensor.self", "the robot's own battery"),
    Word("angle", "ray.angle", "radians from straight ahead, below 0 to the right"),
    Word("distance", "ray.distance", "map units to what the ray hit"),
    Word("object", "ray.object", '"wall", "robot", "beacon" or "none"'),
    Word("label", "ray.label", "name of what the ray hit"),
    Word("has_battery", "sensor.self.has_battery", "whether the engines need charge"),
    Word("battery_level", "sensor.self.battery_level", "charge that is left"),
    Word("battery_capacity", "sensor.self.battery_capacity", "charge at most"),
    Word("left_engine", "desire.left_engine", "power of the left engine, -1 to 1"),
    Word("right_engine", "desire.right_engine", "power of the right engine, -1 to 1"),
)
_GIVEN = (
    Word("Sensor", "Sensor(robot_name:, sensor:)", "what robots sense in this tick"),
    Word("Memory", "Memory(robot_name:, memory:)", "what robots wrote in the tick before"),
    Word("Robot", "Robot(robot_name:, desire:, memory:)", "what robots are to do: yours to define"),
)
_BUILT_IN = tuple(
    Word(entry.name, entry.signature, entry.summary)
    for entry in REFERENCE
    if entry.kind != "operator"
)
NAMES = tuple(word.name for word in (*_BUILT_IN, *_GIVEN, *_FIELDS))
"""Words without a definition in the program: functions, inputs, fields."""

_HEAD = re.compile(r"^(?P<name>[A-Z]\w*)\s*(?:(?P<arguments>\([^)]*\)?)|:=)", re.MULTILINE)
_BEFORE = re.compile(r"(?P<dot>(?P<owner>\w*)\.)?(?P<begun>\w*)$")


def definitions(text: str) -> Mapping[str, tuple[Place, str]]:
    """Return where each predicate is first defined, and the text of its head."""
    found: dict[str, tuple[Place, str]] = {}
    line = counted = 0
    for match in _HEAD.finditer(text):
        name = match["name"]
        if name not in found:
            line += text.count("\n", counted, match.start())
            counted = match.start()
            arguments = match["arguments"] or "(...)"
            found[name] = Place(line, 0), name + " ".join(arguments.split())
    return found


def words_for(text: str, before: str) -> tuple[int, list[Word]]:
    """Return the words that could be inserted at a place.

    Args:
        text: The program.
        before: The line up to that place.

    Returns:
        The number of characters already typed, and the words, sorted.
    """
    match = _BEFORE.search(before)
    begun, after_dot = (match["begun"], bool(match["dot"])) if match else ("", False)
    if match and after_dot:
        of_owner = [word for word in _FIELDS if word.shape.split(".")[-2] == match["owner"]]
        words = {word.name: word for word in of_owner or _FIELDS}
        text = "" if of_owner else text
        for name in re.findall(r"\.([a-z_]\w*)", text) + re.findall(
            r"\b([a-z_]\w*)\s*:(?!-)", text
        ):
            words.setdefault(name, Word(name, f".{name}", "a field of this program"))
        words.pop(begun, None)
    else:
        words = {word.name: word for word in (*_BUILT_IN, *_GIVEN)}
        for name, (place, shape) in definitions(text).items():
            words[name] = Word(name, shape, f"defined in line {place.line + 1}")
    fitting = [word for word in words.values() if word.name.lower().startswith(begun.lower())]
    return len(begun), sorted(fitting, key=lambda word: word.name.lower())


def help_on(text: str, name: str) -> Word | None:
    """Return the help on a predicate or function, or None."""
    own = definitions(text).get(name)
    if own is not None:
        return Word(name, own[1], f"defined in line {own[0].line + 1}")
    return next((word for word in (*_BUILT_IN, *_GIVEN) if word.name == name), None)


def call_before(before: str) -> str:
    """Return the name of the call whose arguments are being typed, or ""."""
    depth = 0
    for at in range(len(before) - 1, -1, -1):
        char = before[at]
        if char in ")}]":
            depth += 1
        elif char in "({[":
            depth -= 1
            if depth < 0:
                match = re.search(r"([A-Z]\w*)\s*$", before[:at])
                if match:
                    return match[1]
                depth = 0
    return ""


def word_around(line: str, column: int) -> str:
    """Return the word at a column of a line, or ""."""
    for match in re.finditer(r"\w+", line):
        if match.start() <= column <= match.end():
            return match.group()
    return ""


_MOST = 60
_WIDTH = 58


class Completion(Listing, can_focus=False):
    """Offers words; the editor keeps the focus and forwards keys."""

    DEFAULT_CSS = f"""
    Completion {{
        overlay: screen; display: none; width: {_WIDTH}; height: auto; max-height: 10;
        constrain: inside inside; border: none; padding: 0; background: $panel;
    }}
    Completion > .option-list--option-highlighted {{ background: $here; color: $here-ink; }}
    """

    def __init__(self) -> None:
        super().__init__(id="completion")
        self._words: list[Word] = []

    def offer(self, words: list[Word], at: Offset) -> None:
        """Show words below a place of the screen; hide if there are none."""
        self._words = words[:_MOST]
        self.display = bool(words)
        if not words:
            return
        self.clear_options()
        self.add_options([Option(_line(word)) for word in self._words])
        self.highlighted = 0
        self.absolute_offset = at + Offset(0, 1)

    def close(self) -> None:
        """Hide."""
        self.display = False

    @property
    def names(self) -> list[str]:
        """The offered words."""
        return [word.name for word in self._words]

    @property
    def chosen(self) -> Word | None:
        """The highlighted word."""
        number = self.highlighted
        return self._words[number] if number is not None and number < len(self._words) else None


def _line(word: Word) -> Content:
    shape = clip(word.shape, 30)
    told = clip(word.told, _WIDTH - 34)
    return Content.assemble((f"{shape:<31}", INK.text), (told, INK.dim))
