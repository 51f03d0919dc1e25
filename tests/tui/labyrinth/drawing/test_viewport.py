import pytest

from logical_robots_tui.tui.labyrinth.drawing import Viewport
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, apart, room


def test_a_square_map_takes_twice_as_many_columns_as_rows() -> None:
    view = Viewport.fit(100, 100, 90, 20)
    left, right = view.cell(0.1, 50), view.cell(99.9, 50)
    top, bottom = view.cell(50, 0.1), view.cell(50, 99.9)
    assert left is not None
    assert right is not None
    assert top is not None
    assert bottom is not None
    assert right[1] - left[1] + 1 == 40
    assert bottom[0] - top[0] + 1 == 20


def test_a_square_room_is_drawn_twice_as_many_columns_wide_as_rows_high() -> None:
    drawn = Drawn(room(200, 200, 20), look=BARE, columns=100, rows=30)
    void = drawn.picture.cells.tone[15, 0]
    on_map = drawn.picture.cells.tone != void
    assert on_map.any(axis=0).sum() == 2 * on_map.any(axis=1).sum() == 60


def test_the_fit_is_in_the_middle_and_as_large_as_it_goes() -> None:
    view = Viewport.fit(400, 100, 80, 30)
    assert view.units == 5
    assert view.left == 0
    assert view.top == -100
    assert Viewport.fit(100, 400, 80, 30).height == 400


@pytest.mark.parametrize("cell", [(0, 0), (7, 3), (29, 79)])
def test_a_cell_maps_to_its_middle_and_back(cell: tuple[int, int]) -> None:
    view = Viewport.fit(333, 217, 80, 30).zoomed(2.7)
    assert view.cell(*view.position(*cell)) == cell


def test_outside_of_the_view_there_is_no_cell() -> None:
    view = Viewport.fit(100, 100, 40, 20)
    assert view.cell(-0.1, 50) is None
    assert view.cell(50, 100.1) is None
    assert view.cell(float("nan"), 50) is None
    assert view.cell(float("inf"), 50) is None


def test_zooming_keeps_the_middle_and_centring_keeps_the_length() -> None:
    view = Viewport.fit(300, 200, 90, 30)
    near = view.zoomed(3)
    assert near.units == pytest.approx(view.units / 3)
    assert near.position(14.5, 44.5) == pytest.approx(view.position(14.5, 44.5))
    moved = near.centred(10, 20)
    assert moved.position(14.5, 44.5) == pytest.approx((10, 20))
    assert moved.units == near.units


def test_the_picture_moves_with_the_view() -> None:
    level = room()
    whole = Drawn(level)
    near = Drawn(level, view=whole.view.zoomed(4).centred(5, 100))
    assert apart(near.tone(4, 100), whole.tone(4, 100)) < 30
    assert near.tone(30, 85) == near.tone(45, 95)
