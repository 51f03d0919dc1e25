import math
from dataclasses import replace

from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import luminance
from logical_robots_tui.world import Level, Robot
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, apart, room, start, with_robot

FAR = 1200, 600
"""Map units of a level in which a robot is about a cell."""


def far() -> Level:
    return room(*FAR, 20, robots=(Robot("Ann", 603, 303, 0.0, "#4a9eff"),))


def test_from_afar_an_arrow_shows_the_heading() -> None:
    level, picture = far(), Picture()
    frame = start(level)
    for eighth, arrow in enumerate("→↘↓↙←↖↑↗"):
        for off in (-0.35, 0, 0.35):
            turned = with_robot(frame, angle=eighth * math.pi / 4 + off)
            drawn = Drawn(level, turned, picture=picture)
            assert drawn.text(603, 303) == arrow
            assert drawn.bold(603, 303)
    for quarter, glyph in enumerate(">v<^"):
        turned = with_robot(frame, angle=quarter * math.pi / 2)
        look = replace(BARE, drawing=Drawing.ASCII)
        assert Drawn(level, turned, look, picture=picture).text(603, 303) == glyph


def test_the_arrow_is_on_the_colour_of_the_robot_and_readable() -> None:
    level, picture = far(), Picture()
    for color in ("#ff0000", "#ffff00", "black", "white", "#123456"):
        painted = replace(level, robots=(replace(level.robots[0], color=color),))
        drawn = Drawn(painted, picture=picture)
        ink, paper = drawn.ink(603, 303), drawn.paper(603, 303)
        assert abs(luminance(ink) - luminance(paper)) > 0.3
        assert abs(luminance(paper) - luminance(DARK.floor)) > 0.2
        assert color != "#ff0000" or paper[0] > 200


def test_from_near_the_body_is_a_disc_with_a_nose_ahead() -> None:
    level = far()
    view, picture = Viewport.fit(*FAR, 80, 20).zoomed(20).centred(603, 303), Picture()
    for heading in (0.0, math.pi / 2, math.pi, -math.pi / 2):
        drawn = Drawn(level, with_robot(start(level), angle=heading), view=view, picture=picture)
        cos, sin = math.cos(heading), math.sin(heading)
        nose, tail = (drawn.tone(603 + d * cos, 303 + d * sin) for d in (4.5, -6))
        assert luminance(nose) > luminance(tail) + 0.15
        assert apart(tail, (74, 158, 255)) < 60
        assert "→" not in "".join(drawn.lines)


def test_a_dead_robot_is_a_grey_cross() -> None:
    level = far()
    for zoom in (1, 20):
        view = Viewport.fit(*FAR, 80, 20).zoomed(zoom).centred(603, 303)
        drawn = Drawn(level, with_robot(start(level), dead=True), view=view)
        assert drawn.text(603, 303) == "✕"
        assert drawn.paper(603, 303) == DARK.dead


def test_a_blocked_robot_is_reversed_from_afar_and_marked_from_near() -> None:
    level = far()
    blocked = with_robot(start(level), blocked=True)
    free, stopped = Drawn(level), Drawn(level, blocked)
    assert stopped.text(603, 303) == "→"
    assert stopped.ink(603, 303) == free.paper(603, 303)
    near = Viewport.fit(*FAR, 80, 20).zoomed(20).centred(603, 303)
    assert Drawn(level, blocked, view=near).text(603, 303) == "!"


def test_a_robot_out_of_sight_is_not_drawn() -> None:
    level = far()
    for x, y in ((-5000.0, 10.0), (math.nan, 5.0), (math.inf, -math.inf)):
        drawn = Drawn(level, with_robot(start(level), x=x, y=y))
        assert "→" not in "".join(drawn.lines)


def test_a_robot_beside_the_map_is_drawn_if_there_is_room() -> None:
    level = room(400, 400, robots=(Robot("Ann", 200, 200),))
    drawn = Drawn(level, with_robot(start(level), x=-50.0), columns=80, rows=20)
    assert drawn.text(-50, 200) == "→"
