import math
from dataclasses import replace
from typing import Any

from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import luminance
from logical_robots_tui.world import Robot
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, apart, room, start, with_robot

# A robot is about a cell.
LEVEL = room(1200, 600, 20, robots=(Robot("Ann", 603, 303, 0.0, "#4a9eff"),))
FRAME = start(LEVEL)
AFAR = Viewport.fit(1200, 600, 80, 20)
NEAR = AFAR.zoomed(20).centred(603, 303)
PICTURE = Picture()


def drawn(look: Look = BARE, view: Viewport = AFAR, **robot: Any) -> Drawn:
    return Drawn(LEVEL, with_robot(FRAME, **robot), look, view=view, picture=PICTURE)


def test_from_afar_an_arrow_shows_the_heading() -> None:
    for eighth, arrow in enumerate("→↘↓↙←↖↑↗"):
        for off in (-0.35, 0, 0.35):
            turned = drawn(angle=eighth * math.pi / 4 + off)
            assert turned.text(603, 303) == arrow
            assert turned.bold(603, 303)
    for quarter, glyph in enumerate(">v<^"):
        turned = drawn(replace(BARE, drawing=Drawing.ASCII), angle=quarter * math.pi / 2)
        assert turned.text(603, 303) == glyph


def test_the_arrow_is_on_the_colour_of_the_robot_and_readable() -> None:
    for color in ("#ff0000", "#ffff00", "black", "white", "#123456"):
        painted = replace(LEVEL, robots=(replace(LEVEL.robots[0], color=color),))
        shown = Drawn(painted, picture=PICTURE)
        ink, paper = shown.ink(603, 303), shown.paper(603, 303)
        assert abs(luminance(ink) - luminance(paper)) > 0.3
        assert abs(luminance(paper) - luminance(DARK.floor)) > 0.2
        assert color != "#ff0000" or paper[0] > 200


def test_from_near_the_body_is_a_disc_with_a_nose_ahead() -> None:
    for heading in (0.0, math.pi / 2, math.pi, -math.pi / 2):
        near = drawn(view=NEAR, angle=heading)
        cos, sin = math.cos(heading), math.sin(heading)
        nose, tail = (near.tone(603 + d * cos, 303 + d * sin) for d in (4.5, -6))
        assert luminance(nose) > luminance(tail) + 0.15
        assert apart(tail, (74, 158, 255)) < 60
        assert "→" not in "".join(near.lines)


def test_a_dead_robot_is_a_grey_cross() -> None:
    for view in (AFAR.centred(603, 303), NEAR):
        dead = drawn(view=view, dead=True)
        assert (dead.text(603, 303), dead.paper(603, 303)) == ("✕", DARK.dead)


def test_a_blocked_robot_is_reversed_from_afar_and_marked_from_near() -> None:
    paper = drawn().paper(603, 303)
    blocked = drawn(blocked=True)
    assert (blocked.text(603, 303), blocked.ink(603, 303)) == ("→", paper)
    assert drawn(view=NEAR, blocked=True).text(603, 303) == "!"


def test_a_robot_out_of_sight_is_not_drawn_and_one_beside_the_map_if_there_is_room() -> None:
    for x, y in ((-5000.0, 10.0), (math.nan, 5.0), (math.inf, -math.inf)):
        assert "→" not in "".join(drawn(x=x, y=y).lines)
    level = room(400, 400, robots=(Robot("Ann", 200, 200),))
    beside = Drawn(level, with_robot(start(level), x=-50.0), columns=80, rows=20)
    assert beside.text(-50, 200) == "→"
