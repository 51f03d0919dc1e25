"""What a robot senses, drawn from its sensors alone."""

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, Look
from logical_robots_tui.tui.labyrinth.drawing.picture import draw_senses, tiles
from logical_robots_tui.world import Beacon, Level, Robot
from tests.tui.labyrinth.drawing.scenes import room, run, start

ROBOTS = (Robot("Ann", 100, 100, 0.3, "red"), Robot("Bob", 200, 100, 2.0))
LEVEL = room(robots=ROBOTS, beacons=(Beacon("lamp", 160, 130),))
PLAIN = Look()


@given(st.integers(1, 200), st.integers(1, 300), st.integers(1, 100))
def test_tiles_fit(count: int, columns: int, rows: int) -> None:
    across, down = tiles(count, columns, rows)
    assert 1 <= across <= max(columns // 24, 1)
    assert 1 <= down <= max(rows // 10, 1)
    assert across * down < count + max(across, down)


@pytest.mark.parametrize("drawing", Drawing)
def test_any_size_is_filled(drawing: Drawing) -> None:
    frame = run(LEVEL, 3)[-1]
    sizes = ((0, 0), (2, 2), (10, 4), (64, 25), (300, 40))
    for palette, size in (*((DARK, size) for size in sizes), (LIGHT, (64, 25))):
        cells = draw_senses(LEVEL, frame, *size, Look(drawing=drawing, palette=palette))
        assert cells.text.shape == (size[1], size[0])
        assert drawing is not Drawing.ASCII or "".join(cells.plain()).isascii()


def lines(level: Level, columns: int, rows: int, look: Look = PLAIN) -> Sequence[str]:
    return draw_senses(level, start(level), columns, rows, look).plain()


def row_of(sign: str, shown: Sequence[str]) -> int:
    return next(row for row, line in enumerate(shown) if sign in line)


def test_each_robot_has_its_name_and_sees_others_by_theirs() -> None:
    shown = "".join(lines(LEVEL, 100, 30))
    assert [shown.count(name) for name in ("Ann", "Bob", "lamp")] == [1, 2, 2]
    # What stands to the right is drawn to the right.
    lone = room(robots=(Robot("Ann", 200, 100, 0.0),), beacons=(Beacon("lamp", 230, 130),))
    scene = lines(lone, 60, 30)
    lamp, arrow = row_of("◆", scene), row_of("↑", scene)
    assert scene[lamp].index("◆") > scene[arrow].index("↑")
    assert lamp < arrow


def test_a_turned_robot_sees_the_same_picture() -> None:
    rows = set()
    for angle in (quarter * math.pi / 2 for quarter in range(4)):
        lamp = Beacon("b", 200 + 60 * math.cos(angle), 200 + 60 * math.sin(angle))
        square = room(400, 400, robots=(Robot("Ann", 200, 200, angle),), beacons=(lamp,))
        rows.add(row_of("◆", lines(square, 60, 24)))
    assert len(rows) == 1


def test_the_selected_robot_is_on_the_page() -> None:
    many = room(robots=tuple(Robot(f"R{i:02}", 20 + 3 * i, 100) for i in range(60)))
    assert row_of("R57", lines(many, 60, 24, look=Look(selected="R57", names=False))) >= 0
