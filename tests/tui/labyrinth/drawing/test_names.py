import math
from dataclasses import replace
from itertools import product
from typing import Any

from rich.cells import cell_len

from logical_robots_tui.game.frame import events_between
from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing, Look, Picture, Viewport
from logical_robots_tui.tui.labyrinth.drawing.cells import luminance
from logical_robots_tui.tui.labyrinth.drawing.lettering import fit_name
from logical_robots_tui.world import Area, Beacon, Robot, load_level
from tests.tui.labyrinth.drawing.scenes import BARE, Drawn, apart, room, run, start, with_robot

NAMES = replace(BARE, names=True)
LONE = room(1000, 500, robots=(Robot("Ann", 500, 250, color="#ff8040"),))


def test_a_name_is_shown_as_far_as_it_can_be() -> None:
    names = {
        "Juliet": "Juliet",
        "a name that is long": "a name that…",
        "[red]x[/red]": "[red]x[/red]",
        "a\x1b[31m\nb": "a□[31m□b",
        "\u202eevil\u200b": "evil",
        "機械人形": "機械人形",
        "機械人形機械人形": "機械人形機…",
        "cafe\u0301": "café",
        "\u0301\u0301x": "x",
        "": "",
    }
    assert {name: "".join(fit_name(name, 12, "…", "□")) for name in names} == names
    assert "".join(fit_name("Ω spot é", 9, "~", "?", ascii_only=True)) == "? spot ?"


def test_a_name_takes_as_many_cells_as_its_text_is_wide() -> None:
    wide = ("ab機", "機械人形", "👩\u200d🚀👍🏽🇩🇪☎\ufe0f", "क्षि", "a" * 40)
    for name, width in product(wide, (0, 1, 2, 3, 5)):
        cells = fit_name(name, width, "…", "□")
        assert len(cells) <= width
        assert cell_len("".join(cells)) == len(cells), name


def text(drawn: Drawn) -> str:
    return "\n".join(drawn.lines)


def test_robots_beacons_and_areas_have_name_plates() -> None:
    level = room(
        robots=(Robot("Ann", 60, 60),),
        beacons=(Beacon("lamp", 200, 60), Beacon("pool", 110, 150)),
        areas=(Area("pool", 100, 140, 30), Area("home", 300, 140, 30, victory_robots=("Ann",))),
    )
    shown = text(Drawn(level, look=NAMES))
    assert all(shown.count(name) == 1 for name in ("Ann", "lamp", "pool", "⚑ home"))
    assert "Ann" not in text(Drawn(level, look=BARE))
    assert "Ann" not in text(Drawn(level, look=NAMES, columns=12, rows=5)), "it is too small"


def test_names_avoid_each_other_and_the_robots() -> None:
    robots = [Robot(f"robot {i}", 180 + 9 * i, 90 + 9 * (i % 3)) for i in range(6)]
    beacons = [Beacon(f"lamp {i}", 60 + 50 * i, 150) for i in range(6)]
    level = room(1000, 500, robots=robots, beacons=tuple(beacons))
    drawn = Drawn(level, look=NAMES, columns=100, rows=25)
    things: list[Robot | Beacon] = [*robots, *beacons]
    for thing in things:
        assert text(drawn).count(thing.name) == 1
        assert drawn.text(thing.x, thing.y) == ("→" if isinstance(thing, Robot) else "◆")


def test_names_leave_a_small_gate_in_sight() -> None:
    gates = tuple(
        Area(f"gate {i}", 300 + 25 * i, 300, 31, color="red", impenetrable=True) for i in range(4)
    )
    for areas in (gates, gates[:1]):
        drawn = Drawn(room(1000, 600, areas=areas), look=NAMES, columns=60, rows=24)
        assert not any(drawn.text(area.x, area.y).isalnum() for area in areas)
        assert all(area.name in text(drawn) for area in areas)


def test_a_name_makes_way_for_a_robot_and_a_blocked_one_has_a_mark_behind_it() -> None:
    level = room(1000, 500, robots=(Robot("Ann", 100, 100),), beacons=(Beacon("lamp", 500, 250),))
    before = Drawn(level, look=NAMES, columns=100, rows=25)
    row = next(i for i, line in enumerate(before.lines) if "lamp" in line)
    x, y = before.view.position(row, before.lines[row].index("lamp") + 1)
    during = Drawn(level, with_robot(start(level), x=x, y=y), NAMES, columns=100, rows=25)
    assert during.text(x, y) == "→"
    assert "lamp" in text(during)
    assert "lamp" not in during.lines[row]
    assert "Ann!" in text(Drawn(LONE, with_robot(start(LONE), blocked=True), NAMES))


def test_the_plate_of_a_selected_robot_is_in_its_colour() -> None:
    def paper(look: Look) -> int:
        drawn = Drawn(LONE, look=look)
        row = next(i for i, line in enumerate(drawn.lines) if "Ann" in line)
        return int(drawn.picture.cells.style[row, drawn.lines[row].index("Ann")]) & 0xFFFFFF

    assert paper(replace(NAMES, selected="Ann")) == 0xFF8040
    assert paper(NAMES) != 0xFF8040


def test_of_a_crowd_only_the_selected_robot_has_a_name() -> None:
    robots = tuple(Robot(f"Bee {i}", 50 + 9 * i, 50 + 4 * i) for i in range(99))
    level = room(1000, 500, robots=robots)
    drawn = Drawn(level, look=replace(NAMES, selected="Bee 7"), columns=80, rows=20)
    assert text(drawn).count("Bee") == 1


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


def test_a_dead_robot_is_a_grey_cross_unless_it_can_hold_no_charge() -> None:
    for view in (AFAR.centred(603, 303), NEAR):
        dead = drawn(view=view, dead=True)
        assert (dead.text(603, 303), dead.paper(603, 303)) == ("✕", DARK.dead)
    doors = load_level("09-doors")
    past, now = run(doors, 1)
    assert any(robot.dead for robot in now.after.robots)
    assert "✕" not in text(Drawn(doors, now, NAMES))
    assert not [event for event in events_between(doors, past, now) if "battery" in event]


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
