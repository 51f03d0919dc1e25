"""What the screen remembers of the past, and how it draws that."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.mind.decision import Decision
from logical_robots_tui.tui.labyrinth.drawing import Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.rays import Traces
from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Beacon, Robot
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, room, run, start, with_active

LEVEL = room(robots=(Robot("Ann", 60, 100, 0.0, "red"),))
VIEW = Viewport.fit(400, 200, 80, 20)
STRAIGHT = {"Ann": Desire(1, 1)}


def lines(frame: Frame, look: Look, traces: Traces) -> Sequence[str]:
    return Picture().draw(LEVEL, frame, VIEW, look, traces).plain()


def braille(shown: Sequence[str]) -> int:
    return sum("\u2801" <= char <= "\u28ff" for line in shown for char in line)


def after(frames: list[Frame]) -> Traces:
    traces = Traces()
    for frame in frames:
        traces.record(frame)
    return traces


def test_a_trail_shows_where_a_robot_came_from() -> None:
    frames = run(LEVEL, 100, STRAIGHT)
    traces = after(frames)
    with_trail = braille(lines(frames[-1], BARE, traces))
    assert with_trail > 10
    assert 0 < braille(lines(frames[50], BARE, traces)) < with_trail
    assert braille(lines(frames[-1], replace(BARE, trails=False), traces)) == 0
    # In a crowd only the selected robot has a trail.
    crowd = room(robots=[Robot(f"{i}", 20 + 10 * i, 20 + 5 * (i % 8)) for i in range(31)])
    traces = after(frames := run(crowd, 60, {"9": Desire(1, 1)}))
    looks = [BARE, replace(BARE, selected="9")]
    drawn = [Picture().draw(crowd, frames[-1], VIEW, look, traces).plain() for look in looks]
    assert braille(drawn[0]) == 0 < braille(drawn[1])


@pytest.mark.parametrize(("drawing", "sign"), [(Drawing.HALVES, "·"), (Drawing.ASCII, "'")])
def test_where_there_is_no_braille_a_trail_is_made_of_points(drawing: Drawing, sign: str) -> None:
    frames = run(LEVEL, 100, STRAIGHT)
    shown = lines(frames[-1], replace(BARE, drawing=drawing), after(frames))
    assert "".join(shown).count(sign) > 10


def test_another_past_replaces_the_former_and_a_trail_ends_somewhere() -> None:
    straight, bent = run(LEVEL, 30, STRAIGHT), run(LEVEL, 30, {"Ann": Desire(1, 0)})
    places, ages = after([*straight, *bent[10:]]).trails(30)
    assert len(places) == len(ages) == 30
    assert places[-1, 0, 1] == bent[29].after.robots[0].y
    still = start(LEVEL)
    traces = after([replace(still, tick=tick) for tick in range(2000)])
    assert len(traces.trails(1999)[0]) == 159


def test_an_area_flashes_when_it_is_switched_and_only_then() -> None:
    level = room(areas=(Area("pool", 200, 100, 40),))
    frame = start(level)
    frames = [replace(with_active(frame, active=tick >= 20), tick=tick) for tick in range(60)]
    traces = after(frames)
    assert [traces.switched_areas(tick) for tick in (19, 20, 30, 40)] == [set(), {0}, {0}, set()]
    one, other = (Picture().draw(level, frames[tick], VIEW, BARE, traces) for tick in (21, 50))
    assert (one.style != other.style).sum() > 20


def test_a_robot_without_a_decision_shows_it_and_a_beacon_pulses() -> None:
    frame = replace(start(LEVEL), decisions=(Decision("Ann", None, None),))
    assert "?" in "".join(Drawn(LEVEL, frame, replace(BARE, names=True)).lines)
    assert Drawn(LEVEL, frame, BARE, view=VIEW.zoomed(6).centred(60, 100)).text(60, 100) == "?"
    level = room(beacons=(Beacon("lamp", 200, 100),))
    inks = {Drawn(level, look=replace(BARE, pulse=pulse)).ink(200, 100) for pulse in range(4)}
    assert len(inks) == 3


def test_the_rays_of_the_selected_robot_alone_are_drawn_one_by_one() -> None:
    level = room(robots=(Robot("Ann", 60, 100), Robot("Bob", 300, 100)))
    look = replace(BARE, lines=True)
    assert braille(Drawn(level, look=look).lines) == 0
    shown = Drawn(level, look=replace(look, selected="Ann")).lines
    assert braille(shown) > 30
    assert braille([line[60:] for line in shown]) == 0
