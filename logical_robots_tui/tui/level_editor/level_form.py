"""The form for the level as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from textual.widgets import Select, TextArea

from logical_robots_tui.editing.properties import resize, set_words
from logical_robots_tui.tui.level_editor.form import Form, flag, number, text
from logical_robots_tui.world import Visibility

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from textual.widget import Widget

    from logical_robots_tui.tui.level_editor.editor import LevelEditor

__all__ = ["LevelForm"]

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
    """Asks for size, texts and visibility.

    Args:
        editor: What edits.
    """

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__("Level")
        self._editor = editor
        self._level = editor.level

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """What a level has."""
        level = self._level
        yield "Title", text("title", level.title)
        yield "Idea", text("idea", level.idea)
        yield "Width", number("width", level.width)
        yield "Height", number("height", level.height)
        yield "Put in or cut", _select("place", _PLACES, "0")
        yield "New room", flag("wall", "is wall", value=False)
        yield "Robot sees", _select("sensor", _SENSORS, level.visibility.sensor)
        yield "Robot knows", _select("memory", _MEMORIES, level.visibility.memory)
        yield "Briefing", TextArea(level.briefing, id="briefing", tab_behavior="focus")
        hints = "\n\n".join(level.hints)
        yield "Hints", TextArea(hints, id="hints", tab_behavior="focus")

    def take(self) -> None:
        """Give the level its properties, in one step."""
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
        }
        changed = set_words(changed, **words)
        self._editor.change_level("level", changed)

    def _kept(self, name: str, before: str) -> str:
        typed = self.lines_of(name)
        return before if typed == before.strip() else typed

    def _hints(self) -> tuple[str, ...]:
        typed = self.lines_of("hints")
        if typed == "\n\n".join(self._level.hints).strip():
            return self._level.hints
        return tuple(hint.strip() for hint in typed.split("\n\n") if hint.strip())


def _select(name: str, options: Mapping[Any, str], value: str) -> Select[str]:
    pairs = [(label, each) for each, label in options.items()]
    return Select(pairs, value=value, allow_blank=False, id=name, compact=True)
