"""A ray or a robot that is brought out of the picture."""

import math
from dataclasses import replace
from itertools import product

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing import Cells, Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.tui.labyrinth.drawing.picture import draw_senses
from logical_robots_tui.world import Robot
from tests.tui.labyrinth.drawing.scenes import room, start

LEVEL = room(robots=(Robot("Ann", 60, 100, 0.0, "red"), Robot("Bob", 300, 150, 2.0)))
FRAME = start(LEVEL)
VIEW = Viewport.fit(400, 200, 80, 20)
PICTURE = Picture()
ANGLES = [ray["angle"] for ray in FRAME.sensors[0]["sensor"]["radar"]]


def drawn(highlight: Highlight | None, look: Look | None = None) -> Cells:
    look = replace(look or Look(), highlight=highlight)
    return PICTURE.draw(LEVEL, FRAME, VIEW, look).copy()


def changed(highlight: Highlight, look: Look | None = None) -> list[tuple[int, int]]:
    """The cells that look different with a highlight, (row, column)."""
    one, other = drawn(None, look), drawn(highlight, look)
    differs = (one.text != other.text) | (one.style != other.style)
    return [(int(row), int(column)) for row, column in np.argwhere(differs)]


def test_a_ray_goes_from_its_robot_to_where_it_ended() -> None:
    for number in (0, 7, 15, 30):
        ray = FRAME.sensors[0]["sensor"]["radar"][number]
        cells = changed(Highlight("Ann", ray["angle"]))
        assert len(cells) >= 5
        for row, column in cells:
            x, y = VIEW.position(row, column)
            ahead = (x - 60) * math.cos(ray["angle"]) - (y - 100) * math.sin(ray["angle"])
            aside = (x - 60) * math.sin(ray["angle"]) + (y - 100) * math.cos(ray["angle"])
            assert abs(aside) < 2 * VIEW.units, "every cell lies on the ray"
            assert 0 < ahead < ray["distance"] + 2 * VIEW.units
        end = 60 + ray["distance"] * math.cos(ray["angle"])
        assert any(abs(VIEW.position(*cell)[0] - end) < 2 * VIEW.units for cell in cells)


def test_a_ring_is_drawn_around_a_robot() -> None:
    cells = changed(Highlight("Bob"))
    assert len(cells) > 5
    for row, column in cells:
        x, y = VIEW.position(row, column)
        assert 5 < math.hypot(x - 300, y - 150) < 50


def test_it_can_be_seen_in_every_way_of_drawing() -> None:
    for drawing, is_lit, ray in product(Drawing, (True, False), (None, ANGLES[3])):
        look = Look(drawing=drawing, rays=is_lit, marks=is_lit)
        assert len(changed(Highlight("Ann", ray), look)) > 5, (drawing, is_lit, ray)
        if drawing is Drawing.ASCII:
            assert "".join(drawn(Highlight("Ann", ray), look).plain()).isascii()


def test_what_is_not_there_is_not_drawn() -> None:
    assert changed(Highlight("Eve", 0.0)) == []
    assert changed(Highlight("Eve")) == []


def test_it_leaves_the_next_picture_as_it_was() -> None:
    picture = Picture()
    before = picture.draw(LEVEL, FRAME, VIEW, Look()).copy()
    picture.draw(LEVEL, FRAME, VIEW, Look(highlight=Highlight("Ann", ANGLES[0])))
    assert picture.draw(LEVEL, FRAME, VIEW, Look()).changes(before) == []


def test_it_is_brought_out_of_what_its_robot_senses_alone() -> None:
    one = draw_senses(LEVEL, FRAME, 100, 30, Look())
    for ray in (None, ANGLES[3]):
        other = draw_senses(LEVEL, FRAME, 100, 30, Look(highlight=Highlight("Ann", ray)))
        columns = np.argwhere((one.text != other.text) | (one.style != other.style))[:, 1]
        assert len(columns) > 5
        assert columns.max() < 50, "Bob is on the right"
