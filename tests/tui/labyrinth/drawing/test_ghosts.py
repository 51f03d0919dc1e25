"""Robots of another run: faint, beneath the others, in every way of drawing."""

from itertools import product

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, PAPER, rgb_number
from logical_robots_tui.world import Level, Robot
from tests.tui.labyrinth.drawing.scenes import room, start

FAR, NEAR = Viewport(60, 20, 0, 0, 6), Viewport(60, 20, 60, 30, 1)


def scene() -> Level:
    return room(300, 200, 10, robots=(Robot("Ann", 80, 50, 0.0, "red"),))


def poses(
    x: float, y: float, angle: float = 0.0
) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    return np.array([(x, y, angle)], np.float32)


def test_a_ghost_is_one_faint_sign_where_the_robot_was() -> None:
    for drawing, view in product(Drawing, (FAR, NEAR)):
        is_one_faint_sign(drawing, view)


def is_one_faint_sign(drawing: Drawing, view: Viewport) -> None:
    level, look = scene(), Look(drawing=drawing, rays=False, marks=False)
    frame = start(level)
    plain = Picture().draw(level, frame, view, look)
    cells = Picture().draw(level, frame, view, look, ghosts=poses(100, 60))
    cell = view.cell(100, 60)
    assert cell is not None
    assert cells.plain()[cell[0]][cell[1]] == drawing.glyphs.ghost(0.0)
    ink = int(cells.style[cell]) >> 24 & PAPER
    robot = view.cell(80, 50)
    assert ink == rgb_number(DARK.faint(DARK.legible((255, 0, 0))))
    assert not cells.style[cell] & BOLD
    assert cells.style[robot] & BOLD or view is NEAR
    around = [row for row, _, _ in cells.changes(plain)]
    assert around
    assert max(around) - min(around) <= (14 if view is NEAR else 0)


def test_a_robot_covers_its_ghost() -> None:
    level = scene()
    frame = start(level)
    for drawing in Drawing:
        plain = Picture().draw(level, frame, FAR, Look(drawing=drawing))
        cells = Picture().draw(level, frame, FAR, Look(drawing=drawing), ghosts=poses(83, 51))
        assert not cells.changes(plain), drawing


def test_a_ghost_out_of_sight_or_nowhere_is_not_drawn() -> None:
    level, look = scene(), Look()
    frame = start(level)
    plain = Picture().draw(level, frame, NEAR, look)
    for x in (290.0, float("nan"), float("inf")):
        assert not Picture().draw(level, frame, NEAR, look, ghosts=poses(x, 150)).changes(plain)
