"""Undoing and redoing without limit."""

import tracemalloc
from dataclasses import replace

from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.edits import Delta, Edits
from logical_robots_tui.editing.strokes import paint
from logical_robots_tui.editing.things import resize
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.walls import difference_box
from tests.editing.making import EDITS, Edit, room


@settings(deadline=None)
@given(st.lists(EDITS, max_size=12))
def test_every_edit_is_undone_and_redone_exactly(steps: list[Edit]) -> None:
    edits = Edits(room())
    steps_taken = sum(edits.do("edit", step(edits.level)) for step in steps)
    last = edits.level
    undone = [edits.level]
    while edits.undo():
        undone.append(edits.level)
    # A step may change a level to one that is the same in all but identity; it leaves no trace.
    assert len(undone) <= 1 + steps_taken
    assert alike(undone[-1], room())
    for level in reversed(undone[:-1]):
        assert edits.redo()
        assert alike(edits.level, level)
    assert alike(edits.level, last)
    assert not edits.redo()


@settings(deadline=None)
@given(st.lists(EDITS, min_size=1, max_size=5))
def test_a_delta_leads_from_one_level_to_another_that_is_not_alike_and_back(
    steps: list[Edit],
) -> None:
    before = after = room()
    for step in steps:
        after = step(after)
    delta = Delta.between(before, after)
    assert alike(delta.apply(before), after)
    assert alike(delta.apply(after, forward=False), before)
    walls = [(level.walls.shape, level.walls.tobytes()) for level in (before, after)]
    rest = [vars(level) | {"walls": None} for level in (before, after)]
    is_same = walls[0] == walls[1] and rest[0] == rest[1]
    assert delta.empty == alike(before, after) == is_same
    assert alike(after, replace(after, name="other", source="other.toml"))


def test_what_is_undone_is_called_by_its_name() -> None:
    edits = Edits(room())
    assert (edits.undo(), edits.redo(), edits.can_undo, edits.can_redo) == ("", "", "", "")
    edits.do("paint", paint(edits.level, [(5, 5)]))
    edits.do("erase", paint(edits.level, [(5, 5)], wall=False))
    assert edits.can_undo == "erase"
    assert edits.undo() == "erase"
    assert (edits.can_undo, edits.can_redo) == ("paint", "erase")
    assert edits.redo() == "erase"
    edits.undo()
    edits.do("paint", paint(edits.level, [(9, 9)]))  # something new ends what could be redone
    assert edits.redo() == ""


def test_a_stroke_that_goes_on_is_one_step_unless_it_was_saved_under_way() -> None:
    edits = Edits(room())
    for x in range(5, 50):
        edits.do("paint", paint(edits.level, [(x, 5)]), goes_on=x > 5)
    edits.do("paint", paint(edits.level, [(5, 40)]))
    for count in (45, 0):
        edits.undo()
        assert edits.level.walls.sum() == count
    assert not edits.changed
    edits.do("paint", paint(edits.level, [(5, 5)]))
    assert edits.changed
    edits.saved()
    assert not edits.changed
    edits.do("paint", paint(edits.level, [(6, 5)]), goes_on=True)
    assert edits.changed
    for is_changed in (False, True):
        edits.undo()
        assert edits.changed == is_changed
    edits.do("paint", paint(edits.level, [(9, 9)]))
    assert edits.changed


def test_the_box_of_a_change_is_the_smallest() -> None:
    for width in (120, 121):
        level = room(width)
        after = paint(paint(level, [(30, 20)]), [(50, 60)])
        assert difference_box(level.walls, after.walls) == (slice(20, 61), slice(30, 51))
        assert difference_box(level.walls, level.walls.copy()) is None


def test_many_strokes_on_the_largest_level_take_little_memory() -> None:
    level = resize(room(), 4000, 4000)
    edits = Edits(level)
    tracemalloc.start()
    try:
        start = tracemalloc.get_traced_memory()[0]
        for x, y in zip(range(0, 3000, 75), range(0, 1000, 25), strict=True):
            edits.do("paint", paint(edits.level, [(x, y), (x + 200, y + 90)], width=12))
        assert tracemalloc.get_traced_memory()[0] - start < 2 * level.walls.nbytes + 500_000
    finally:
        tracemalloc.stop()
