from dataclasses import replace

import numpy as np
import pytest

from logical_robots_tui.tui.labyrinth.drawing import DARK, LIGHT, Drawing, Palette, Viewport
from logical_robots_tui.tui.labyrinth.drawing.ground import WallTable
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster
from logical_robots_tui.world import Area, Beacon
from tests.tui.labyrinth.drawing import scenes
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, apart, contrast, room, start

ASCII = replace(BARE, drawing=Drawing.ASCII)


@pytest.mark.parametrize("zoom", [0.3, 1, 2.3, 9])
def test_coverage_is_the_exact_share_of_wall(zoom: float) -> None:
    walls = np.random.default_rng(7).random((37, 61)) < 0.4
    raster = Raster(Viewport.fit(61, 37, 30, 9).zoomed(zoom), 2, 2)
    coverage = WallTable(walls).coverage(raster)

    def overlap(edges: Floats, size: int) -> Floats:
        low, high = edges[:-1, None], edges[1:, None]
        unit = np.arange(size)
        length: Floats = np.minimum(high, unit + 1) - np.maximum(low, unit)
        return length.clip(0, None)

    share = overlap(raster.y_edges, 37) @ walls @ overlap(raster.x_edges, 61).T
    dot = np.outer(np.diff(raster.y_edges), np.diff(raster.x_edges))
    assert np.allclose(coverage, share / dot)


@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_walls_stand_out_from_the_floor_and_the_rim_from_the_rock(palette: Palette) -> None:
    drawn = Drawn(room(400, 200, 60), look=replace(BARE, palette=palette))
    floor, rim, rock = (
        contrast(drawn.tone(x, y), palette) for x, y in ((203, 93), (200, 58), (200, 5))
    )
    assert rim > rock + 0.1
    assert rock > floor + 0.03


def test_a_wall_thinner_than_a_dot_is_seen() -> None:
    level = room(400, 200)
    walls = level.walls.copy()
    walls[60:140, 200] = True
    drawn = Drawn(replace(level, walls=walls))
    assert apart(drawn.tone(200.5, 100), drawn.tone(230, 105)) > 20


def test_an_area_has_its_colour_and_a_brighter_rim() -> None:
    area = Area("", 200, 100, 50, "#ff0000")
    drawn = Drawn(room(areas=(area,)))
    inside, rim, floor = drawn.tone(222, 112), drawn.tone(248.5, 100), drawn.tone(300, 112)
    assert inside[0] - floor[0] > 30
    assert inside[0] - inside[1] > 25
    assert rim[0] - inside[0] > 30


@pytest.mark.parametrize("palette", [DARK, LIGHT])
@pytest.mark.parametrize("solid", [True, False])
def test_an_area_that_is_off_is_fainter(palette: Palette, solid: bool) -> None:
    look = replace(BARE, palette=palette)
    level = room(areas=(Area("", 200, 100, 50, "#ff2020", impenetrable=solid),))
    places = [(160.0 + 8 * i, 100.0 + 8 * j) for i in range(10) for j in range(-2, 3)]
    faint, strong = (
        sum(apart(drawn.tone(x, y), palette.floor) for x, y in places)
        for is_on in (False, True)
        for drawn in (Drawn(level, scenes.with_active(start(level), is_on), look),)
    )
    assert faint < 0.5 * strong


def test_the_rim_of_an_area_that_is_off_is_dotted() -> None:
    level = room(areas=(Area("", 200, 100, 80, "#ff2020"),))
    around = [(200 + 79 * np.cos(a), 100 + 79 * np.sin(a)) for a in np.linspace(0, 6.28, 80)]

    def reds(active: bool) -> Floats:
        drawn = Drawn(level, scenes.with_active(start(level), active), columns=120, rows=40)
        return np.array([float(drawn.tone(x, y)[0]) for x, y in around])

    share = reds(active=False) / reds(active=True)
    assert (share < 0.35).sum() > 15
    assert (share > 0.45).sum() > 15


def test_a_solid_area_is_denser_and_striped() -> None:
    areas = (Area("", 200, 100, 60, "#ff2020", impenetrable=hard) for hard in (False, True))
    soft, solid = (
        [drawn.tone(180.0 + 3 * i, 105.0)[0] for i in range(14)]
        for drawn in (Drawn(room(areas=(area,))) for area in areas)
    )
    assert sum(solid) > 1.3 * sum(soft)
    assert max(solid) - min(solid) > 20 + max(soft) - min(soft)


def test_plain_characters_show_walls_and_tell_areas_apart() -> None:
    off = Area("", 320, 100, 40, on_beacon="x")
    areas = (Area("", 80, 100, 40), Area("", 200, 100, 40, impenetrable=True), off)
    drawn = Drawn(room(400, 200, 20, areas=areas), look=ASCII)
    places = ((10, 100), (390, 5), (200, 30), (80, 100), (200, 100))
    assert [drawn.text(x, y) for x, y in places] == [*"## :%"]
    assert "," in "".join(drawn.lines)


def test_beacons_glow_and_chargers_look_different() -> None:
    level = room(beacons=(Beacon("", 100, 100), Beacon("", 300, 100, charging_station=True)))
    drawn = Drawn(level)
    assert (drawn.text(100, 100), drawn.text(300, 100)) == ("◆", "↯")
    assert drawn.ink(100, 100) != drawn.ink(300, 100)
    assert apart(drawn.tone(104, 100), drawn.tone(200, 100)) > 40


def test_a_beacon_named_after_a_colour_has_it() -> None:
    names = ("Red", "Bell of green", "blue lamp")
    drawn = Drawn(
        room(beacons=tuple(Beacon(name, 100 * i, 100) for i, name in enumerate(names, 1)))
    )
    inks = [drawn.ink(100 * i, 100) for i in (1, 2, 3)]
    assert [ink.index(max(ink)) for ink in inks] == [0, 1, 2]


def test_a_square_room_is_drawn_twice_as_many_columns_wide_as_rows_high() -> None:
    tone = Drawn(room(200, 200, 20), columns=100, rows=30).picture.cells.tone
    on_map = tone != tone[15, 0]
    assert on_map.any(axis=0).sum() == 2 * on_map.any(axis=1).sum() == 60


def test_the_picture_moves_with_the_view() -> None:
    whole = Drawn(room())
    near = Drawn(room(), view=whole.view.zoomed(4).centred(5, 100))
    assert apart(near.tone(4, 100), whole.tone(4, 100)) < 30
    assert near.tone(30, 85) == near.tone(45, 95)
