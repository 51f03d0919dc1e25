"""The briefing over the labyrinth, where it hides the least."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from textual import events
from textual.content import Content
from textual.geometry import Region
from textual.widgets import Static

from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Viewport
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import one_line, visible
from logical_robots_tui.world import Level
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.view import LabyrinthView


class Overlay(Static):
    """Text over the picture; a click closes it. It never takes the focus."""

    DEFAULT_CSS = """
    Overlay { layer: over; display: none; background: $panel 92%; width: 100%; height: auto; }
    """

    def on_click(self, event: events.Click) -> None:
        event.stop()
        self.close()

    def close(self) -> None:
        """Hide, and repaint what was below: Textual's layout alone may leave remnants."""
        if self.display:
            self.display = False
            self.call_after_refresh(self.screen.refresh)


class Briefing(Overlay):
    """The briefing, placed to hide the fewest robots and goals, until the game runs."""

    DEFAULT_CSS = """
    Briefing { position: absolute; padding: 0 1; border: round $frame; }
    """

    def __init__(self, view: LabyrinthView) -> None:
        super().__init__(id="briefing")
        self._view = view
        self._level: Level | None = None
        self._as_written = self._flowing = Content("")
        self._place: tuple[Level, Viewport] | None = None

    def tell(self, level: Level) -> None:
        text = "\n".join(visible(line) for line in level.briefing.strip().splitlines())
        title = (one_line(level.title), f"bold {INK.title}")
        goals = "".join(f"   ☐ {goal.words}" for goal in level.second_goals)
        offers = {"run": "runs", "briefing": "hides this"}
        if level.hints:
            offers["hint"] = "gives a hint"
        if level.lesson:
            offers["lesson"] = "lesson"
        keys = [f"{command(name).key_name} {said}" for name, said in offers.items()]
        halves = "\n".join("  ".join(keys[i : i + 2]) for i in range(0, len(keys), 2))
        self._as_written, self._flowing = (
            Content.assemble(title, (f"{goals}\n{words}\n", INK.text), (said, INK.dim))
            for words, said in ((text, "   ".join(keys)), (_FOLDED.sub(" ", text), halves))
        )
        self._level, self._place = level if text else None, None
        self.display = bool(text)
        self.place()

    def toggle(self) -> bool:
        if self.display:
            self.close()
        elif self._level is not None:
            self.display = True
            self.place()
        return self._level is not None

    def place(self) -> None:
        if self._level is None or not self.display or not self._view.size.area:
            return
        viewport = self._view.camera.viewport(self._level, *self._view.size)
        if self._place is None or self._place != (self._level, viewport):
            self._place = self._level, viewport
            content, spot = least_covering(self._level, viewport, self._as_written, self._flowing)
            self.update(content)
            self.styles.width, self.styles.height = spot.size
            self.styles.offset = spot.offset


_EDGES = 4  # columns of the border and the padding
_FOLDED = re.compile(r"(?<=[^.:!?\n])\n(?=\S)")  # line ends within a sentence


def least_covering(
    level: Level, viewport: Viewport, as_written: Content, flowing: Content
) -> tuple[Content, Region]:
    """Return text, preferably `as_written`, and cells that hide few robots and goals."""
    needed = as_written.get_optimal_width({}, viewport.columns)
    spots = []
    for width in range(needed, needed // 3, -max(needed // 12, 1)):
        content = as_written if width == needed <= viewport.columns - _EDGES else flowing
        inner = max(min(width, viewport.columns - _EDGES), 1)
        height = content.get_height({}, inner) + 2
        most = min(height, viewport.rows)
        right = max(viewport.columns - inner - _EDGES, 0)
        bottom = max(viewport.rows - most, 0)
        spots += [
            (height - most, content, Region(x, y, inner + _EDGES, most))
            for y in dict.fromkeys((bottom, 0, *range(bottom, 0, -1)))
            for x in (0, right, right // 2)
        ]
    goals = [(a.x, a.y, a.radius) for a in level.areas if a.victory_robots]
    near = ROBOT_RADIUS + 2 * viewport.units
    important = [*goals, *((robot.x, robot.y, near) for robot in level.robots)]
    others = [(area.x, area.y, area.radius) for area in level.areas]
    others += [(beacon.x, beacon.y, BEACON_RADIUS) for beacon in level.beacons]

    def cost(spot: tuple[int, Content, Region]) -> tuple[int, int, int]:
        cut, _, region = spot
        return cut, _hidden(region, viewport, important), _hidden(region, viewport, others)

    return min(spots, key=cost)[1:]


def _hidden(
    region: Region, viewport: Viewport, circles: Iterable[tuple[float, float, float]]
) -> int:
    """Return how many circles (x, y, radius in map units) touch a region of cells."""
    left, top = viewport.left + region.x * viewport.units, viewport.top
    top += region.y * viewport.units * CELL_ASPECT
    right = left + region.width * viewport.units
    bottom = top + region.height * viewport.units * CELL_ASPECT
    return sum(
        math.hypot(max(left - x, x - right, 0), max(top - y, y - bottom, 0)) <= radius
        for x, y, radius in circles
    )
