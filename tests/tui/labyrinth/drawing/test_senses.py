"""What a robot senses, drawn from its sensors alone."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.picture import draw_senses, tiles
from logical_robots_tui.world import Beacon, Robot
from tests.tui.labyrinth.drawing.scenes import room, run, start

ROBOTS = (Robot("Ann", 100, 100, 0.3, "red"), Robot("Bob", 200, 100, 2.0))
LEVEL = room(robots=ROBOTS, beacons=(Beacon("lamp", 160, 130),))


@given(st.integers(1, 200), st.integers(1, 300), st.integers(1, 100))
def test_tiles_fit(count: int, columns: int, rows: int) -> None:
    across, down = tiles(count, columns, rows)
    assert 1 <= across <= max(columns // 24, 1)
    assert 1 <= down <= max(rows // 10, 1)
    assert across * down < count + max(across, down)


@pytest.mark.parametrize("drawing", Drawing)
def test_any_size_is_filled(drawing: Drawing) -> None:
    frame = run(LEVEL, 3)[-1]
    for palette, size in (
        *((DARK, size) for size in ((0, 0), (2, 2), (10, 4), (64, 25), (300, 40))),
        (LIGHT, (64, 25)),
    ):
        cells = draw_senses(LEVEL, frame, *size, Look(drawing=drawing, palette=palette))
        assert cells.text.shape == (size[1], size[0])
        assert drawing is not Drawing.ASCII or "".join(cells.plain()).isascii()


def test_each_robot_has_its_name_and_sees_others_by_theirs() -> None:
    shown = "\n".join(draw_senses(LEVEL, start(LEVEL), 100, 30, Look()).plain())
    assert shown.count("Ann") == 1
    assert shown.count("Bob") == 2
    assert shown.count("lamp") == 2


def test_what_stands_to_the_right_is_drawn_to_the_right() -> None:
    lone = room(robots=(Robot("Ann", 200, 100, 0.0),), beacons=(Beacon("lamp", 230, 130),))
    lines = draw_senses(lone, start(lone), 60, 30, Look()).plain()
    row = next(line for line in lines if "◆" in line)
    arrow = next(line for line in lines if "↑" in line)
    assert row.index("◆") > arrow.index("↑")
    assert lines.index(row) < lines.index(arrow)


def test_a_turned_robot_sees_the_same_picture() -> None:
    pictures = []
    for quarter in range(4):
        angle = quarter * math.pi / 2
        x, y = 200 + 60 * math.cos(angle), 200 + 60 * math.sin(angle)
        square = room(
            400, 400, robots=(Robot("Ann", 200, 200, angle),), beacons=(Beacon("b", x, y),)
        )
        pictures.append(draw_senses(square, start(square), 60, 24, Look()).plain())
    assert all("◆" in "".join(picture) for picture in pictures)
    places = {next(i for i, line in enumerate(p) if "◆" in line) for p in pictures}
    assert len(places) == 1


def test_the_selected_robot_is_on_the_page() -> None:
    many = room(robots=tuple(Robot(f"R{i:02}", 20 + 3 * i, 100) for i in range(60)))
    lines = draw_senses(many, start(many), 60, 24, Look(selected="R57", names=False)).plain()
    assert any("R57" in line for line in lines)
