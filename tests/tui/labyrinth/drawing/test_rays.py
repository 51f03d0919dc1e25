import math
from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, Look, Palette, Viewport
from logical_robots_tui.tui.labyrinth.drawing.picture import draw_senses, tiles
from logical_robots_tui.world import Beacon, Level, Robot
from tests.tui.labyrinth.drawing import scenes
from tests.tui.labyrinth.drawing.scenes import (
    BARE,
    Drawn,
    apart,
    contrast,
    room,
    run,
    seeing,
    start,
)

RAYS, MARKS = replace(BARE, rays=True), replace(BARE, marks=True)
SCENE = room(800, 400, 20, robots=(Robot("Ann", 300.5, 200.5, 0.0, "#ff4040"),))


def hits(*ends: tuple[float, str], degrees: float = 4) -> tuple[Level, Frame]:
    middle = (len(ends) - 1) / 2
    rays = [
        (math.radians(degrees) * (middle - i), distance, kind)
        for i, (distance, kind) in enumerate(ends)
    ]
    return SCENE, replace(start(SCENE), sensors=(seeing("Ann", rays),))


FAN = hits(*[(120.0, "none")] * 15)


def test_the_end_of_a_ray_shows_what_was_hit_from_near_with_a_cross() -> None:
    for kind, glyph, colour, plain in (
        ("wall", "·", DARK.hit_wall, "x"),
        ("beacon", "◇", DARK.hit_beacon, "+"),
        ("robot", "•", DARK.hit_robot, "o"),
    ):
        drawn = Drawn(*hits((100, "none"), (120, kind), (100, "none")), MARKS)
        assert (drawn.text(420.5, 200.5), drawn.ink(420.5, 200.5)) == (glyph, colour)
        assert sum(line.count(glyph) for line in drawn.lines) == 1
        drawn = Drawn(*hits((120, kind), (120, kind)), replace(MARKS, drawing=Drawing.ASCII))
        assert drawn.text(420.5, 200.5) == plain
    view = Viewport.fit(800, 400, 80, 20).zoomed(6).centred(310, 200)
    drawn = Drawn(*hits((100, "none"), (30, "wall"), (100, "none")), MARKS, view=view)
    assert drawn.text(330.5, 200.5) == "\N{MULTIPLICATION SIGN}"


@pytest.mark.parametrize("order", [1, -1])
def test_where_several_rays_end_a_robot_goes_before_a_beacon_before_a_wall(order: int) -> None:
    kinds = ["wall", "beacon", "robot", "wall"][::order]
    for left, glyph in ((kinds, "•"), ([kind for kind in kinds if kind != "robot"], "◇")):
        drawn = Drawn(*hits(*((100.0, kind) for kind in left), degrees=0.1), MARKS)
        assert drawn.text(400.5, 200.5) == glyph


@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_light_reaches_as_far_as_the_rays_and_no_farther(palette: Palette) -> None:
    level, frame = hits(*[(120.0, "wall")] * 15)
    look = replace(RAYS, palette=palette)
    lit, dark = Drawn(level, frame, look), Drawn(level, frame, replace(look, rays=False))
    for x in (345, 380, 410):
        assert apart(lit.tone(x, 203), dark.tone(x, 203)) > 20
        assert contrast(lit.tone(x, 203), palette) > contrast(dark.tone(x, 203), palette)
    for x, y in ((450, 203), (250, 203), (320, 260), (320, 140)):
        assert lit.tone(x, y) == dark.tone(x, y)


def test_light_has_the_colour_of_the_robot_which_shines_brighter_when_it_is_selected() -> None:
    red, green, blue = Drawn(*FAN, RAYS).tone(360, 203)
    assert red > 2 * max(green, blue)
    chosen, other = (
        Drawn(*FAN, replace(RAYS, selected=name)).tone(360, 203)[0] for name in ("Ann", "Bob")
    )
    assert chosen > red > other


def test_each_ray_lights_its_own_direction_and_the_rim_of_the_wall_that_it_hits() -> None:
    scene = hits(*[(150.0, "none")] * 8, *[(30.0, "wall")] * 8)
    lit, dark = Drawn(*scene, RAYS), Drawn(*scene, BARE)
    left, right = (400, 170), (400, 231)  # Of the robot: y grows downwards.
    assert lit.tone(*left) != dark.tone(*left)
    assert lit.tone(*right) == dark.tone(*right)
    level = room(800, 400, 60, robots=(Robot("Ann", 640, 200, 0.0, "#ff4040"),))
    lit, dark = Drawn(level, look=RAYS), Drawn(level)
    assert lit.tone(743, 200)[0] > dark.tone(743, 200)[0] + 20
    assert lit.tone(785, 200) == dark.tone(785, 200)


def test_rays_start_where_the_robot_sensed() -> None:
    level, frame = FAN
    moved = scenes.with_robot(frame, x=100.0, y=60.0, angle=2.0)
    lit, dark = Drawn(level, moved, RAYS), Drawn(level, moved, BARE)
    assert apart(lit.tone(360, 203), dark.tone(360, 203)) > 20
    assert lit.tone(100, 100) == dark.tone(100, 100)


def test_a_switch_hides_the_rays_and_another_the_marks() -> None:
    level = room(robots=(Robot("Ann", 50, 100),), beacons=(Beacon("b", 120, 100),))
    look = Look(names=False)
    both, no_marks, no_rays = (
        Drawn(level, look=shown)
        for shown in (look, replace(look, marks=False), replace(look, rays=False))
    )
    assert "◇" in "".join(both.lines)
    assert "◇" not in "".join(no_marks.lines)
    assert no_rays.tone(80, 103) == Drawn(level).tone(80, 103) != both.tone(80, 103)


def test_plain_characters_dot_the_floor_that_rays_reach() -> None:
    drawn = Drawn(*FAN, replace(RAYS, drawing=Drawing.ASCII))
    assert (drawn.text(360, 203), drawn.text(250, 203)) == (".", " ")


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
