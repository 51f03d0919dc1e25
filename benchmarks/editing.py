"""Editing the largest level: from a stroke of the brush to the new level and its picture."""

from __future__ import annotations

import asyncio
import tempfile
from functools import partial
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING

from benchmarks.halls import halls
from benchmarks.measure import Effort, Measurement, at_most, best_of, summed_up
from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.editing.strokes import paint
from logical_robots_tui.game import Frame, load_program
from logical_robots_tui.player.opening import Opening
from logical_robots_tui.tui.app.app import LogicalRobotsApp
from logical_robots_tui.tui.labyrinth.drawing import Look, Picture, Viewport
from logical_robots_tui.world import AreaState, RobotState, WorldState

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.world import Level

__all__ = ["editing"]

SIDE = 4000
COLUMNS, ROWS = 120, 40
VIEWS = {
    "whole": Viewport.fit(SIDE, SIDE, COLUMNS, ROWS),
    "near": Viewport(COLUMNS, ROWS, 1000, 1000, 2.0),
}
COUNT = 1000  # robots, beacons and areas
STROKES = 20  # in one measurement


def editing(effort: Effort) -> Iterator[Measurement]:
    """Measure the processor time in milliseconds from a stroke to its picture."""
    level = halls(SIDE, SIDE, robots=COUNT, beacons=COUNT, areas=COUNT)
    subject = f"{SIDE:,}x{SIDE:,}, {COUNT} of each"
    for name, view in VIEWS.items():
        once, here = partial(_stroke_milliseconds, level, view), f"{subject}, {name} view"
        yield best_of("brush stroke", here, "ms", effort.repeats, once, target=at_most(50))
    strokes = asyncio.run(_in_the_app(level))
    yield summed_up(
        "brush stroke in the game", subject, "ms", strokes, target=at_most(50), value=min
    )


async def _in_the_app(level: Level) -> list[float]:
    """Return the processor times in ms from a mouse move to the lines to send."""
    with tempfile.TemporaryDirectory() as folder:
        sources = {"": load_program("first-steps-starter")}
        app = LogicalRobotsApp(Opening(level=level, sources=sources, data_dir=Path(folder)))
        async with app.run_test(size=(COLUMNS, ROWS)) as pilot:
            main = app.main
            while main.session.game is None:
                await pilot.pause(0.02)
            main.editing.open()
            main.editing.take("brush")
            view, found = main.labyrinth.view, []
            assert view.overlay is not None
            view.overlay.press(1000, 1000)
            for i in range(STROKES):
                await pilot.pause(0)
                began = process_time()
                view.overlay.hover(1000 + 40 * i, 1000 + 10 * i, is_held=True)
                for row in range(view.size.height):
                    view.render_line(row)
                found.append(1000 * (process_time() - began))
            view.overlay.release()
    return found


def _stroke_milliseconds(level: Level, view: Viewport) -> float:
    frame, look, picture, edits = _start(level), Look(), Picture(), Edits(level)
    picture.draw(level, frame, view, look)
    began = process_time()
    for i in range(STROKES):
        points = [(1000.0 + 9 * i, 1010.0 + 3 * i), (1020.0 + 9 * i, 1015.0 + 3 * i)]
        edits.do(f"stroke {i}", paint(edits.level, points, width=8, wall=i % 2 == 0))
        picture.draw(edits.level, frame, view, look)
    return 1000 * (process_time() - began) / STROKES


def _start(level: Level) -> Frame:
    """Return the frame before the first tick; a world would sense first, which isn't measured."""
    robots = tuple(RobotState(r.name, r.x, r.y, r.angle, r.battery_capacity) for r in level.robots)
    state = WorldState(0, robots, tuple(AreaState(area.name, True) for area in level.areas))
    return Frame(0, state, state, (), {}, (), {}, 0.0)
