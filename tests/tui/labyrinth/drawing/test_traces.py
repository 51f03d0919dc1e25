"""What the screen remembers of the past, and how it draws that."""

from dataclasses import replace

import pytest

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.mind.decision import Decision
from logical_robots_tui.tui.labyrinth.drawing import Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import BLOCKS
from logical_robots_tui.tui.labyrinth.drawing.rays import Traces
from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Beacon, Robot
from tests.tui.labyrinth.drawing.scenes import Drawn, room, run, start, with_active

LEVEL = room(robots=(Robot("Ann", 60, 100, 0.0, "red"),))
VIEW = Viewport.fit(400, 200, 80, 20)
BARE = Look(rays=False, marks=False, names=False)


def braille(picture: Picture) -> int:
    return sum("\u2801" <= char <= "\u28ff" for line in picture.cells.plain() for char in line)


def after(frames: list[Frame]) -> Traces:
    traces = Traces()
    for frame in frames:
        traces.record(frame)
    return traces


def test_a_trail_shows_where_a_robot_came_from() -> None:
    frames = run(LEVEL, 100, {"Ann": Desire(1, 1)})
    traces = after(frames)
    picture = Picture()
    picture.draw(LEVEL, frames[-1], VIEW, BARE, traces)
    with_trail = braille(picture)
    assert with_trail > 10
    picture.draw(LEVEL, frames[50], VIEW, BARE, traces)
    assert 0 < braille(picture) < with_trail
    picture.draw(LEVEL, frames[-1], VIEW, replace(BARE, trails=False), traces)
    assert braille(picture) == 0


@pytest.mark.parametrize(("drawing", "sign"), [(Drawing.HALVES, "·"), (Drawing.ASCII, "'")])
def test_where_there_is_no_braille_a_trail_is_made_of_points(drawing: Drawing, sign: str) -> None:
    frames = run(LEVEL, 100, {"Ann": Desire(1, 1)})
    picture = Picture()
    picture.draw(LEVEL, frames[-1], VIEW, replace(BARE, drawing=drawing), after(frames))
    assert "".join(picture.cells.plain()).count(sign) > 10


def test_another_past_replaces_the_former() -> None:
    straight, bent = run(LEVEL, 30, {"Ann": Desire(1, 1)}), run(LEVEL, 30, {"Ann": Desire(1, 0)})
    traces = after([*straight, *bent[10:]])
    places, ages = traces.trails(30)
    assert len(places) == len(ages) == 30
    assert places[-1, 0, 1] == bent[29].after.robots[0].y


def test_a_trail_ends_somewhere() -> None:
    still = start(LEVEL)
    traces = after([replace(still, tick=tick) for tick in range(2000)])
    assert len(traces.trails(1999)[0]) == 159


def test_an_area_flashes_when_it_is_switched_and_only_then() -> None:
    level = room(areas=(Area("pool", 200, 100, 40),))
    frame = start(level)
    frames = [replace(with_active(frame, active=tick >= 20), tick=tick) for tick in range(60)]
    traces = after(frames)
    assert not traces.switched(19)
    assert traces.switched(20) == traces.switched(30) == {0}
    assert not traces.switched(40)
    one, other = Picture(), Picture()
    one.draw(level, frames[21], VIEW, BARE, traces)
    other.draw(level, frames[50], VIEW, BARE, traces)
    assert (one.cells.style != other.cells.style).sum() > 20


def test_a_robot_without_a_decision_shows_it() -> None:
    frame = replace(start(LEVEL), decisions=(Decision("Ann", None, None),))
    assert "?" in "".join(Drawn(LEVEL, frame, replace(BARE, names=True)).lines)
    near = Drawn(LEVEL, frame, BARE, view=VIEW.zoomed(6).centred(60, 100))
    assert near.text(60, 100) == "?"


def test_a_beacon_pulses() -> None:
    level = room(beacons=(Beacon("lamp", 200, 100),))
    inks = {Drawn(level, look=replace(BARE, pulse=pulse)).ink(200, 100) for pulse in range(4)}
    assert len(inks) == 3


def test_the_rays_of_the_selected_robot_alone_are_drawn_one_by_one() -> None:
    level = room(robots=(Robot("Ann", 60, 100), Robot("Bob", 300, 100)))
    picture = Picture()
    picture.draw(level, start(level), VIEW, replace(BARE, lines=True))
    assert braille(picture) == 0
    picture.draw(level, start(level), VIEW, replace(BARE, lines=True, selected="Ann"))
    assert braille(picture) > 30
    right = [line[60:] for line in picture.cells.plain()]
    assert not any("\u2801" <= char <= "\u28ff" for line in right for char in line)


def test_sextants_are_sixty_four_shapes() -> None:
    assert len(set(BLOCKS[6])) == 64
    assert BLOCKS[6][0b000011] == "\N{BLOCK SEXTANT-12}"
    assert BLOCKS[6][0b111110] == "\N{BLOCK SEXTANT-23456}"
    assert BLOCKS[6][0b010101] == "▌"
    assert BLOCKS[6][0b010110] == "\N{BLOCK SEXTANT-235}"
