"""Where a value comes from, in the game: asked of any memory, told in the background, followed."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.explain.why.sourcing import Read
from logical_robots_tui.game import Pin
from logical_robots_tui.game.debugging.origin import Link, Origin
from logical_robots_tui.tui.inspector.pages.origin import LinksView, link_lines
from logical_robots_tui.tui.inspector.predicate_list import DECISION, ORIGIN, ROBOTS, WHY
from logical_robots_tui.tui.inspector.under_cursor import MemoryPart, memory_of
from logical_robots_tui.tui.inspector.widgets.value_tree import ValueTree
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

PHASES = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {plan:, seen:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  plan = (if sensor.clock == 4 then {phase: "fetch", since: sensor.clock}
          else if sensor.clock < 4 then {phase: "look", since: 0}
          else memory.plan),
  seen = (if sensor.clock in [2, 6] then Coalesce(memory.seen, 0) + 1 else memory.seen);
"""


def links(game: Opened) -> LinksView:
    return game.main.query_one(LinksView)


def pointed(game: Opened) -> Link:
    link = links(game).pointed
    assert link is not None
    return link


async def at_tick(game: Opened, tick: int) -> None:
    await game.ready()
    for number in range(1, tick + 1):
        await game.press("n")
        await game.until(partial(lambda wanted: game.tick == wanted, number))


async def followed(game: Opened, *keys: str) -> None:
    """Open the tree of what the decision came from, and follow the part that the keys go to."""
    await game.press("X")
    await game.until(lambda: isinstance(game.app.screen, ValueTree))
    await game.press(*keys, "less_than_sign")
    await game.until(
        lambda: game.app.screen is game.main and links(game).plain and links(game).pointed
    )


TO_SEEN = ("end",)
"""Keys to the last line of the tree, which is the field `seen` of the memory afterwards."""


async def test_a_field_is_followed_to_the_ticks_that_made_it(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        game.inspector.open(DECISION)
        await followed(game, *TO_SEEN)
        assert game.inspector.inspected == ORIGIN
        plain = links(game).plain.splitlines()
        robot = game.inspector.robot
        assert plain[:4] == [
            f"1. {robot}'s memory.seen = 2",
            "    set in tick 6 by the rule in line 1, kept until tick 9",
            "    line 6: Coalesce(memory.seen, 0) + 1",
            f"    from {robot}'s memory.seen = 1",
        ]
        assert f"2. {robot}'s memory.seen = 1" in plain
        await game.sees(f"{robot}'s memory.seen after tick 9 comes from")


async def test_the_cursor_shows_the_expression_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        await followed(game, *TO_SEEN)
        await game.press("down")
        await game.until(lambda: pointed(game).tick == 2)
        await game.until(lambda: game.editor.selected_text == "Coalesce(memory.seen, 0) + 1")


async def test_enter_goes_to_the_tick_and_says_why_and_the_key_comes_back(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        await followed(game, *TO_SEEN)
        await game.press("down", "enter")
        await game.until(lambda: game.tick == 2 and game.inspector.inspected == WHY)
        await game.sees("Why · tick 2")
        await game.press("less_than_sign")
        await game.until(lambda: game.inspector.inspected == ORIGIN)
        assert links(game).has_focus
        await game.press("escape")
        await game.until(lambda: game.inspector.inspected == ROBOTS and game.tick == 9)


async def test_escape_returns_to_the_page_and_the_tick_of_the_question(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        game.inspector.open("Memory")
        await game.sees("Memory · tick 9")
        await game.press("enter")
        await game.until(lambda: game.inspector.pages.table.has_focus)
        await game.press("right", "less_than_sign")
        await game.until(lambda: links(game).pointed)
        await game.sees("memory after tick 8 comes from")
        await game.press("p")
        await game.until(lambda: game.tick == 8)
        assert game.inspector.inspected == ORIGIN
        await game.press("backspace")
        await game.until(lambda: game.inspector.inspected == "Memory" and game.tick == 9)


async def test_what_is_pinned_and_what_a_proof_read_can_be_followed(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 70)) as game:
        await at_tick(game, 5)
        robot = game.inspector.robot
        pin = Pin("Robot", "memory", (("robot_name", robot),), ("plan", "phase"))
        game.inspector.pages.pins.toggle(pin)
        await game.press("V", "less_than_sign")
        await game.until(lambda: links(game).pointed)
        await game.sees("set in tick 4")
        assert pointed(game).value == "fetch"
        await game.press("w")
        view = game.inspector.pages.why.view
        await game.until(lambda: any(line.node.text == "memory.plan" for line in view.lines))
        place = next(
            n
            for n, line in enumerate(view.lines)
            if line.node.text == "memory.plan" and line.node.kind == "read"
        )
        view.action_move(place - view.lines.index(view.line))
        await game.press("less_than_sign")
        await game.sees("memory.plan after tick 4 comes from")


async def test_where_there_is_no_memory_under_the_cursor_that_is_said(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES) as game:
        await at_tick(game, 1)
        game.inspector.open("Sensor")
        await game.press("less_than_sign")
        await game.sees("Put the cursor on a memory")


async def test_a_question_of_ticks_that_were_left_says_so(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 5)
        await followed(game, *TO_SEEN)
        await game.press("r")
        await game.until(lambda: game.tick == 0)
        assert links(game).pointed is not None
        assert game.session.game is not None
        game.session.game.forget_future()
        game.inspector.follow()
        await game.sees("another future since then")
        assert links(game).pointed is None


async def test_it_has_room_in_a_small_terminal(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(80, 24)) as game:
        await at_tick(game, 9)
        await followed(game, *TO_SEEN)
        await game.sees("set in tick 6 by the rule in line 1")
        await game.press("down")
        await game.until(lambda: pointed(game).tick == 2)
        await game.sees("set in tick 2")
        links(game).show(Origin((pointed(game),), complete=False))
        await game.sees("This is not all of it")


@pytest.mark.parametrize(
    ("pin", "found"),
    [
        (Pin("Memory", "memory", (("robot_name", "Ada"),), ("n",)), MemoryPart("Ada", ("n",), 6)),
        (Pin("Robot", "memory", (("robot_name", "Ada"),)), MemoryPart("Ada", (), 7)),
        (Pin("Robot", "desire", (("robot_name", "Ada"),)), None),
        (Pin("Memory"), None),
        (None, None),
    ],
)
def test_memory_is_from_the_tick_before_and_robot_from_this_one(
    pin: Pin | None, found: MemoryPart | None
) -> None:
    assert memory_of(pin, 7) == found


def test_a_link_tells_the_ray_and_how_much_more_was_read() -> None:
    span = Span(0, 5, 31, "ray.distance")
    reads = tuple(Read("sensor", "Ada", ("radar", n, "distance"), 43) for n in range(7))
    link = Link("Ada", ("d",), 43, 12, 12, span, span, reads, (1, 2))
    told = [line.plain for line in link_lines(0, link, 80)]
    assert told[1] == "    set in tick 12 by the rule in line 31"
    assert told[3] == "    from Ada's ray 0.distance = 43"
    assert told[-2:] == ["    and from 2 more", "    goes on with 2., 3."]
    start = Link("Ada", (), "", 0, 5, None, None, ())
    assert [line.plain for line in link_lines(1, start, 80)][1:] == [
        "    there since the start, kept until tick 5"
    ]


KEPT = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {first:, n:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  first = (if sensor.clock == 1 then "here" else memory.first), n = sensor.clock;
"""


@pytest.mark.slow
async def test_it_says_how_far_back_it_is_and_can_be_stopped(data_dir: Path) -> None:
    async with opened(data_dir, text=KEPT, size=(120, 40)) as game:
        await game.ready()
        assert game.session.game is not None
        await game.session.game.run_until(tick=1_500)
        await game.until(lambda: game.tick == 1_500)
        robot = game.inspector.robot
        game.inspector.follow_back(MemoryPart(robot, ("first",), 1_500))
        await game.until(lambda: re.search(r"at tick [\d,]+, [\d,]+ ticks? back", game.screen()))
        await game.press("escape")
        await game.sees("Stopped at tick")
        assert links(game).pointed is None
        game.inspector.follow_back(MemoryPart(robot, ("first",), 20))
        await game.until(lambda: links(game).pointed)
        assert (pointed(game).tick, pointed(game).until) == (1, 20)
