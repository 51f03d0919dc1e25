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
RADAR = FRAME.sensors[0]["sensor"]["radar"]
LOOK = Look()


def drawn(highlight: Highlight | None, look: Look = LOOK) -> Cells:
    return PICTURE.draw(LEVEL, FRAME, VIEW, replace(look, highlight=highlight)).copy()


def differing(one: Cells, other: Cells) -> list[tuple[int, int]]:
    cells = np.argwhere((one.text != other.text) | (one.style != other.style))
    return [(int(row), int(column)) for row, column in cells]


def changed(highlight: Highlight, look: Look = LOOK) -> list[tuple[int, int]]:
    return differing(drawn(None, look), drawn(highlight, look))


def test_a_ray_goes_from_its_robot_to_where_it_ended() -> None:
    for ray in (RADAR[number] for number in (0, 7, 15, 30)):
        cells = changed(Highlight("Ann", ray["angle"]))
        assert len(cells) >= 5
        cos, sin = math.cos(ray["angle"]), math.sin(ray["angle"])
        for cell in cells:
            x, y = VIEW.position(*cell)
            ahead, aside = (x - 60) * cos - (y - 100) * sin, (x - 60) * sin + (y - 100) * cos
            assert abs(aside) < 2 * VIEW.units, "every cell lies on the ray"
            assert 0 < ahead < ray["distance"] + 2 * VIEW.units
        end = 60 + ray["distance"] * cos
        assert any(abs(VIEW.position(*cell)[0] - end) < 2 * VIEW.units for cell in cells)


def test_a_ring_is_drawn_around_a_robot() -> None:
    cells = changed(Highlight("Bob"))
    assert len(cells) > 5
    for x, y in (VIEW.position(*cell) for cell in cells):
        assert 5 < math.hypot(x - 300, y - 150) < 50


def test_it_can_be_seen_in_every_way_of_drawing() -> None:
    for drawing, is_lit, ray in product(Drawing, (True, False), (None, RADAR[3]["angle"])):
        look = Look(drawing=drawing, rays=is_lit, marks=is_lit)
        assert len(changed(Highlight("Ann", ray), look)) > 5, (drawing, is_lit, ray)
        if drawing is Drawing.ASCII:
            assert "".join(drawn(Highlight("Ann", ray), look).plain()).isascii()


def test_what_is_not_there_is_not_drawn_and_the_next_picture_is_as_it_was() -> None:
    assert changed(Highlight("Eve", 0.0)) == changed(Highlight("Eve")) == []
    before = drawn(None)
    drawn(Highlight("Ann", RADAR[0]["angle"]))
    assert drawn(None).changes(before) == []


def test_it_is_brought_out_of_what_its_robot_senses_alone() -> None:
    one = draw_senses(LEVEL, FRAME, 100, 30, Look())
    for ray in (None, RADAR[3]["angle"]):
        other = draw_senses(LEVEL, FRAME, 100, 30, Look(highlight=Highlight("Ann", ray)))
        columns = [column for _, column in differing(one, other)]
        assert len(columns) > 5
        assert max(columns) < 50, "Bob is on the right"
