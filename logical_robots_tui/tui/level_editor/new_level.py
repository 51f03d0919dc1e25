"""Creating a new level: an empty room, a random labyrinth, or a copy."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from functools import partial
from random import randrange
from typing import TYPE_CHECKING

from textual import on
from textual.widgets import Select

from logical_robots_tui.editing.properties import set_words
from logical_robots_tui.tui.level_editor.form import Form, number, text
from logical_robots_tui.tui.library.level_screen import own_levels
from logical_robots_tui.world import Level, list_levels, load_level
from logical_robots_tui.world.levels.labyrinths import empty_room, labyrinth

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from textual.widget import Widget

    from logical_robots_tui.tui.app.ui import Ui

__all__ = ["NewLevelForm", "ask_for_level"]

_KINDS = {"room": "an empty room", "labyrinth": "a random labyrinth", "copy": "a copy"}
_OF = {
    "room": ("width", "height", "wall"),
    "labyrinth": ("columns", "rows", "corridor", "wall", "loops", "seed"),
    "copy": ("original",),
}


class NewLevelForm(Form):
    """Asks for a new level, which is in `made` afterwards.

    Args:
        names: Names of all levels that can be copied.
        here: Name of the current level.
        own: Folder of the player's levels.
    """

    def __init__(self, names: list[str], here: str, own: Path) -> None:
        super().__init__("New level")
        self._names = names
        self._here = here
        self._own = own
        self.made: Level | None = None

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """Yield the fields."""
        kinds = [(label, kind) for kind, label in _KINDS.items()]
        yield "Make", Select(kinds, value="room", allow_blank=False, id="kind", compact=True)
        yield "Title", text("title", "")
        yield "Width", number("width", 600)
        yield "Height", number("height", 400)
        yield "Columns", number("columns", 8)
        yield "Rows", number("rows", 6)
        yield "Corridor width", number("corridor", 60)
        yield "Wall thickness", number("wall", 10)
        yield "Loops, 0 to 1", number("loops", 0.1)
        yield "Seed", number("seed", randrange(1000))  # noqa: S311 - no secret is made of it
        names = [(name, name) for name in self._names]
        here = self._here if self._here in self._names else self._names[0]
        yield "Of", Select(names, value=here, allow_blank=False, id="original", compact=True)

    def on_mount(self) -> None:
        """Start with a room."""
        super().on_mount()
        self._arrange()

    @on(Select.Changed, "#kind")
    def _arrange(self) -> None:
        """Show only the fields of the chosen kind."""
        wanted = _OF[self.choice_of("kind")]
        for name in {each for names in _OF.values() for each in names}:
            row = self.query_one(f"#{name}").parent
            assert row is not None
            row.display = name in wanted

    def take(self) -> None:
        """Create the level."""
        kind = self.choice_of("kind")
        if kind == "room":
            width = self.whole_of("width", "The width")
            height = self.whole_of("height", "The height")
            made = empty_room(width, height, wall=self.whole_of("wall", "The wall"))
        elif kind == "labyrinth":
            made = labyrinth(
                self.whole_of("columns", "The number of columns"),
                self.whole_of("rows", "The number of rows"),
                seed=self.whole_of("seed", "The seed"),
                loops=self.number_of("loops", "The share of loops"),
                corridor=self.whole_of("corridor", "The corridor"),
                wall=self.whole_of("wall", "The wall"),
            )
        else:
            made = _copy(self.choice_of("original"), self._own)
        title = self.text_of("title")
        self.made = set_words(made, title=title) if title else made


def _copy(name: str, own: Path) -> Level:
    level = load_level(own_levels(own).get(name, name))
    return replace(level, name=f"{name}-copy", title=f"{level.title} (copy)", source="")


async def ask_for_level(ui: Ui, here: str, own: Path) -> Level | None:
    """Ask for a new level and return it, or None.

    Args:
        ui: The user interface.
        here: Name of the current level.
        own: Folder of the player's levels.
    """
    own_names = await asyncio.to_thread(partial(own_levels, own))
    names = list(dict.fromkeys([*await asyncio.to_thread(list_levels), *own_names]))
    form = NewLevelForm(names, here, own)
    return form.made if await ui.ask(form) else None
