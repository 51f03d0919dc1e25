"""Robots of another run: faint, beneath the others, in every way of drawing."""

from itertools import product

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing import DARK, Cells, Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, PAPER, rgb_number
from logical_robots_tui.world import Robot
from tests.tui.labyrinth.drawing.scenes import room, start

FAR, NEAR = Viewport(60, 20, 0, 0, 6), Viewport(60, 20, 60, 30, 1)
LEVEL = room(300, 200, 10, robots=(Robot("Ann", 80, 50, 0.0, "red"),))
FRAME = start(LEVEL)


def drawn(look: Look, view: Viewport, *ghost: float) -> Cells:
    poses = np.array([(*ghost, 0.0)], np.float32) if ghost else None
    return Picture().draw(LEVEL, FRAME, view, look, ghosts=poses)


def test_a_ghost_is_one_faint_sign_where_the_robot_was() -> None:
    for drawing, view in product(Drawing, (FAR, NEAR)):
        look = Look(drawing=drawing, rays=False, marks=False)
        plain, cells = drawn(look, view), drawn(look, view, 100, 60)
        cell = view.cell(100, 60)
        assert cell is not None
        assert cells.plain()[cell[0]][cell[1]] == drawing.glyphs.ghost(0.0)
        ink = int(cells.style[cell]) >> 24 & PAPER
        assert ink == rgb_number(DARK.faint(DARK.legible((255, 0, 0))))
        assert not cells.style[cell] & BOLD
        assert cells.style[view.cell(80, 50)] & BOLD or view is NEAR
        around = [row for row, _, _ in cells.changes(plain)]
        assert around
        assert max(around) - min(around) <= (14 if view is NEAR else 0)


def test_a_ghost_under_a_robot_out_of_sight_or_nowhere_is_not_drawn() -> None:
    for look in (Look(drawing=drawing) for drawing in Drawing):
        assert not drawn(look, FAR, 83, 51).changes(drawn(look, FAR)), look.drawing
    plain = drawn(Look(), NEAR)
    for x in (290.0, float("nan"), float("inf")):
        assert not drawn(Look(), NEAR, x, 150).changes(plain)
