"""Levels, frames and pictures for tests of the drawing."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.tui.labyrinth.drawing import DARK, Look, Palette, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, RGB, luminance
from logical_robots_tui.values import Desire, SensorRow
from logical_robots_tui.world import Level, Robot, RobotState, World

BARE = Look(rays=False, marks=False, names=False)  # nothing but what stands there


def room(
    width: int = 400, height: int = 200, thick: int = 10, robots: Iterable[Robot] = (), **more: Any
) -> Level:
    walls = np.ones((height, width), dtype=np.bool_)
    walls[thick : height - thick, thick : width - thick] = False
    return Level("room", "Room", width, height, walls, tuple(robots), **more)


def start(level: Level) -> Frame:
    world = World(level)
    state = world.save()
    return Frame(0, state, state, tuple(world.look()), {}, (), {}, 0.0)


def run(level: Level, ticks: int, desires: Mapping[str, Desire] | None = None) -> list[Frame]:
    world = World(level)
    frames = [start(level)]
    for tick in range(1, ticks + 1):
        before, rows = world.save(), world.sense()
        world.act(desires or {robot.name: Desire(0.9, 0.6) for robot in level.robots})
        frames.append(Frame(tick, before, world.save(), tuple(rows), {}, (), {}, 0.0))
    return frames


def with_robot(frame: Frame, **changes: Any) -> Frame:
    first, *others = frame.after.robots
    robots: tuple[RobotState, ...] = (replace(first, **changes), *others)
    return replace(frame, after=replace(frame.after, robots=robots))


def with_active(frame: Frame, active: bool) -> Frame:
    areas = tuple(replace(area, active=active) for area in frame.after.areas)
    return replace(frame, after=replace(frame.after, areas=areas))


def seeing(name: str, rays: Iterable[tuple[float, float, str]]) -> SensorRow:
    """Return a sensor row with (angle, distance, object) for each ray."""
    radar = [
        {"angle": angle, "distance": distance, "object": kind, "label": "?"}
        for angle, distance, kind in rays
    ]
    return {"robot_name": name, "sensor": {"radar": radar}}


class Drawn:
    def __init__(
        self,
        level: Level,
        frame: Frame | None = None,
        look: Look = BARE,
        columns: int = 80,
        rows: int = 20,
        view: Viewport | None = None,
        picture: Picture | None = None,
    ) -> None:
        self.view = view or Viewport.fit(level.width, level.height, columns, rows)
        self.picture = picture or Picture()
        self.picture.draw(level, frame or start(level), self.view, look)
        self.lines = self.picture.cells.plain()

    def cell(self, x: float, y: float) -> tuple[int, int]:
        cell = self.view.cell(x, y)
        assert cell is not None
        return cell

    def text(self, x: float, y: float) -> str:
        """The character there; lines must hold no wide ones."""
        row, column = self.cell(x, y)
        return self.lines[row][column]

    def ink(self, x: float, y: float) -> RGB:
        return _colour(int(self.picture.cells.style[self.cell(x, y)]) >> 24)

    def paper(self, x: float, y: float) -> RGB:
        return _colour(int(self.picture.cells.style[self.cell(x, y)]))

    def bold(self, x: float, y: float) -> bool:
        return bool(self.picture.cells.style[self.cell(x, y)] & BOLD)

    def tone(self, x: float, y: float) -> RGB:
        return _colour(int(self.picture.cells.tone[self.cell(x, y)]))


def _colour(packed: int) -> RGB:
    return packed >> 16 & 0xFF, packed >> 8 & 0xFF, packed & 0xFF


def apart(one: RGB, other: RGB) -> int:
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


def contrast(colour: RGB, palette: Palette = DARK) -> float:
    return abs(luminance(colour) - luminance(palette.floor))


def draws_as_anew(picture: Picture, level: Level, frame: Frame, view: Viewport, look: Look) -> bool:
    """Draw a frame, and return whether that looks as it would in a picture of its own."""
    picture.draw(level, frame, view, look)
    anew = Picture().draw(level, frame, view, look)
    same = (picture.cells.text == anew.text) & (picture.cells.style == anew.style)
    return bool(same.all())
