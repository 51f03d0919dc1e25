"""Where a value comes from, in the game: asked of any memory, told in the background, followed."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.explain.why.explainer import Explainer
from logical_robots_tui.explain.why.explanation import Ask, Read, Source, Subject
from logical_robots_tui.explain.why.explanation import Path as Parts
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.game import Link, Origin, Pin
from logical_robots_tui.tui.inspector.page import Traced, traced_pin
from logical_robots_tui.tui.inspector.pages.origin import LinksView, lines_of
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.value_tree import ValueTree
from tests.tui.conftest import opened
from tests.virtual_time import Hold

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.values import Value
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


async def pointed_at(game: Opened, text: str, kind: str = "") -> None:
    """Put the cursor of the proof on a line."""
    view = game.main.query_one(WhyView)

    def places() -> list[int]:
        nodes = [line.node for line in view.lines]
        return [n for n, each in enumerate(nodes) if each.text == text and kind in ("", each.kind)]

    await game.until(places)
    assert view.line is not None
    view.action_move(places()[0] - view.lines.index(view.line))


TO_SEEN = ("end",)
"""Keys to the last line of the tree, which is the field `seen` of the memory afterwards."""


async def test_a_field_is_followed_to_the_ticks_that_made_it(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        game.inspector.open("decision")
        await followed(game, *TO_SEEN)
        assert game.inspector.inspected == "origin"
        plain = links(game).plain.splitlines()
        robot = game.inspector.robot
        assert plain[:4] == [
            f"1. {robot}'s memory.seen = 2",
            "    the same since tick 6, set then by the rule in line 1",
            "    line 6: Coalesce(memory.seen, 0) + 1",
            "    as in line 6 holds: sensor.clock in [2, 6]",
        ]
        assert f"    from {robot}'s memory.seen = 1 (2.)" in plain
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
        await game.until(lambda: game.tick == 2 and game.inspector.inspected == "why")
        await game.sees("Why · tick 2")
        await game.press("less_than_sign")
        await game.until(lambda: game.inspector.inspected == "origin")
        assert links(game).has_focus
        await game.press("escape")
        await game.until(lambda: game.inspector.inspected == "robots" and game.tick == 9)


async def test_escape_returns_to_the_page_and_the_tick_of_the_question(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 40)) as game:
        await at_tick(game, 9)
        game.inspector.open("Memory")
        await game.sees("Memory · tick 9")
        await game.press("enter")
        await game.until(lambda: game.main.query_one("#rows").has_focus)
        await game.press("right", "less_than_sign")
        await game.until(lambda: links(game).pointed)
        await game.sees("memory after tick 8 comes from")
        await game.press("p")
        await game.until(lambda: game.tick == 8)
        assert game.inspector.inspected == "origin"
        await game.press("backspace")
        await game.until(lambda: game.inspector.inspected == "Memory" and game.tick == 9)


async def test_what_is_pinned_and_what_a_proof_read_can_be_followed(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(120, 70)) as game:
        await at_tick(game, 5)
        robot = game.inspector.robot
        pin = Pin("Robot", "memory", (("robot_name", robot),), ("plan", "phase"))
        game.main.query_one(WatchView).toggle(pin)
        await game.press("V", "less_than_sign")
        await game.until(lambda: links(game).pointed)
        await game.sees("the same since tick 4")
        assert pointed(game).value == "fetch"
        await game.press("w")
        await pointed_at(game, "memory.plan", "read")
        await game.press("less_than_sign")
        await game.sees("memory.plan after tick 4 comes from")


SIGHT = """\
Near(robot_name:, ray? ArgMin= ray -> ray.distance) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar;
Speed(way) = way / 1000;
Robot(robot_name:, desire: {left_engine: Speed(ray.distance), right_engine: 0}, memory: {far:}) :-
  Near(robot_name:, ray:), Memory(robot_name:, memory:), far = ray.distance + 1;
"""


async def test_any_value_of_a_table_is_traced_to_its_rays(data_dir: Path) -> None:
    async with opened(data_dir, text=SIGHT, size=(120, 40)) as game:
        await at_tick(game, 2)
        game.inspector.open("Near")
        await game.sees("Near · tick 2")
        await game.press("enter")
        await game.until(lambda: game.main.query_one("#rows").has_focus)
        await game.press("right", "less_than_sign")
        await game.until(lambda: links(game).plain and links(game).pointed)
        await game.sees("Near.ray in tick 2 comes from")
        assert "read from" in links(game).plain
        assert " wall, distance " in links(game).plain


async def test_every_value_of_a_proof_is_traced(data_dir: Path) -> None:
    async with opened(data_dir, text=SIGHT, size=(120, 70)) as game:
        await at_tick(game, 2)
        robot = game.inspector.robot
        wanted = {
            "desire: {left_engine: Speed(ray.distance), right_engine: 0}": "desire",
            "left_engine: Speed(ray.distance)": "Speed(ray.distance)",
            "far = ray.distance + 1": "far = ray.distance + 1",
            "far": "far",
        }
        for text, name in wanted.items():
            await game.press("w")
            await pointed_at(game, text)
            await game.press("less_than_sign")
            await game.until(lambda: links(game).plain and links(game).pointed)
            assert name in pointed(game).name
            assert f"{robot}'s ray " in links(game).plain
            await game.press("escape")
            await game.until(lambda: game.inspector.inspected == "why")


async def test_where_there_is_no_value_under_the_cursor_that_is_said(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES) as game:
        await at_tick(game, 1)
        game.inspector.open("Sensor")
        await game.press("less_than_sign")
        await game.sees("Put the cursor on a value")


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
        await game.sees("went on in another branch")
        assert links(game).pointed is None


async def test_it_has_room_in_a_small_terminal(data_dir: Path) -> None:
    async with opened(data_dir, text=PHASES, size=(80, 24)) as game:
        await at_tick(game, 9)
        await followed(game, *TO_SEEN)
        await game.sees("the same since tick 6")
        await game.press("down")
        await game.until(lambda: pointed(game).tick == 2)
        await game.sees("the same since tick 2")
        links(game).show(Origin((pointed(game),), complete=False))
        await game.sees("This is incomplete")


OF_ADA = (("robot_name", "Ada"),)


def memory(*path: str) -> Subject:
    parts: Parts = path
    return Subject(path=parts)


@pytest.mark.parametrize(
    ("pin", "found"),
    [
        (Pin("Memory", "memory", OF_ADA, ("n",)), Traced("Ada", memory("n"), 6)),
        (Pin("Robot", "memory", OF_ADA), Traced("Ada", memory(), 7)),
        (
            Pin("Robot", "desire", OF_ADA, ("left_engine",)),
            Traced("Ada", Subject(Ask("Robot", dict(OF_ADA)), "desire", ("left_engine",)), 7),
        ),
        (Pin("Near", "far"), Traced("Bo", Subject(Ask("Near", {}), "far"), 7)),
        (Pin("Sensor", "sensor", OF_ADA), None),
        (Pin("Memory"), None),
        (None, None),
    ],
)
def test_memory_is_from_the_tick_before_and_all_else_from_this_one(
    pin: Pin | None, found: Traced | None
) -> None:
    assert traced_pin(pin, "Bo", 7) == found


def test_a_link_tells_the_rays_and_how_much_more_was_read() -> None:
    span = Span(0, 5, 31, "Avg{ray.distance}")
    rays: list[Value] = [
        {"angle": 0.0, "object": "beacon", "label": "Key", "distance": n} for n in range(7)
    ]
    inputs = tuple(
        Source("", ray, read=Read("sensor", "Ada", ("radar", n), ray)) for n, ray in enumerate(rays)
    )
    source = Source("d", 43, span, span, inputs=inputs)
    link = Link("Ada", "Ada's memory.d", 43, 12, 12, source, ("d",), before=(None,) * 7)
    told = [line.plain for line in lines_of(0, link, 80)]
    assert told[:4] == [
        "1. Ada's memory.d = 43",
        "    set in tick 12 by the rule in line 31",
        "    line 31: Avg{ray.distance}",
        '    from Ada\'s ray 0 at 0°: beacon "Key", distance 0',
    ]
    assert told[-1] == "    and from 2 more"


KEPT = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {first:, n:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  first = (if sensor.clock == 1 then "here" else memory.first), n = sensor.clock;
"""


async def test_it_says_how_far_back_it_is_and_can_be_stopped(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(data_dir, text=KEPT, size=(120, 40)) as game:
        await at_tick(game, 9)
        source, hold = Explainer.source, Hold()

        def slow(explainer: Explainer, subject: Subject) -> Source:
            hold.here()
            return source(explainer, subject)

        monkeypatch.setattr(Explainer, "source", slow)
        robot = game.inspector.robot
        game.inspector.trace(Traced(robot, memory("first"), 9))
        await game.until(lambda: hold.has_begun)
        await game.sees("at tick 1, 8 ticks back")
        await game.press("escape")
        hold.release()
        await game.sees("Stopped at tick 1")
        assert links(game).pointed is None
        game.inspector.trace(Traced(robot, memory("first"), 7))
        await game.until(lambda: links(game).pointed)
        assert (pointed(game).tick, pointed(game).until) == (1, 7)
