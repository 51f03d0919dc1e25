"""Where a value comes from, in the game: asked of any memory, told in the background, followed."""

from pathlib import Path

import pytest

from logical_robots_tui.explain.why.explainer import Explainer
from logical_robots_tui.explain.why.explanation import Ask, Read, Subject, ValueSource
from logical_robots_tui.explain.why.explanation import Path as Parts
from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.game import Link, Origin, Pin
from logical_robots_tui.tui.inspector.page import Traced, traced_pin
from logical_robots_tui.tui.inspector.pages.origin import LinksView, lines_of
from logical_robots_tui.tui.inspector.pages.watch import WatchView
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.value_tree import ValueTree
from logical_robots_tui.values import Value
from tests.tui.conftest import Opened, Size, at_both_sizes, opened
from tests.virtual_time import Hold

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
    await game.run_until(tick)


async def followed(game: Opened, *keys: str) -> None:
    """Open the tree of what the decision came from, and follow the part that the keys go to."""
    await game.press("X", on=ValueTree)
    await game.press(*keys, "less_than_sign")
    await game.until(
        lambda: game.app.screen is game.main and links(game).plain and links(game).pointed
    )


async def in_table(game: Opened, name: str) -> None:
    game.inspector.open(name)
    await game.sees(f"{name} · tick {game.tick}")
    await game.press("enter", until=lambda: game.main.query_one("#rows").has_focus)
    await game.press("right")


async def pointed_at(game: Opened, text: str, kind: str = "") -> None:
    view = game.main.query_one(WhyView)

    def places() -> list[int]:
        nodes = [line.node for line in view.lines]
        return [n for n, each in enumerate(nodes) if each.text == text and kind in ("", each.kind)]

    await game.until(places)
    assert view.line is not None
    view.action_move(places()[0] - view.lines.index(view.line))


@at_both_sizes
async def test_a_field_is_followed_to_where_it_was_set_and_back(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, text=PHASES, size=size) as game:
        await at_tick(game, 9)
        await game.press("3")
        robot = game.inspector.robot
        game.inspector.open("Sensor")
        await game.press("less_than_sign", sees="Put the cursor on a value")

        game.inspector.open("decision")
        await followed(game, "end")  # the field `seen` of the memory afterwards
        assert game.inspector.inspected == "origin"
        plain = links(game).plain.splitlines()
        assert plain[:4] == [
            f"1. {robot}'s memory.seen = 2",
            "    the same since tick 6, set then by the rule in line 1",
            "    line 6: Coalesce(memory.seen, 0) + 1",
            "    as in line 6 holds: sensor.clock in [2, 6]",
        ]
        assert f"    from {robot}'s memory.seen = 1 (2.)" in plain
        assert f"2. {robot}'s memory.seen = 1" in plain
        await game.sees(f"{robot}'s memory.seen after tick 9 comes from", "the same since tick 6")

        # The cursor shows the expression in the program, and enter goes to its tick.
        await game.press("down", until=lambda: pointed(game).tick == 2)
        await game.until(lambda: game.editor.selected_text == "Coalesce(memory.seen, 0) + 1")
        await game.sees("the same since tick 2")
        await game.press("enter")
        await game.until(lambda: game.tick == 2 and game.inspector.inspected == "why")
        await game.sees("Why · tick 2")
        await game.press("less_than_sign", until=lambda: game.inspector.inspected == "origin")
        assert links(game).has_focus

        # Escape and backspace return to the page and the tick of the question.
        await game.press("escape")
        await game.until(lambda: game.inspector.inspected == "decision" and game.tick == 9)
        await in_table(game, "Memory")
        await game.press("less_than_sign", until=lambda: links(game).pointed)
        await game.sees("memory after tick 8 comes from")
        await game.press("p", tick=8)
        links(game).show(Origin((pointed(game),), complete=False))
        await game.sees("This is incomplete")
        assert game.inspector.inspected == "origin"
        await game.press("backspace")
        await game.until(lambda: game.inspector.inspected == "Memory" and game.tick == 9)


async def test_pins_and_reads_are_followed(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with opened(data_dir, text=PHASES, size=(100, 54)) as game:
        await at_tick(game, 5)
        robot = game.inspector.robot
        pin = Pin("Robot", "memory", (("robot_name", robot),), ("plan", "phase"))
        game.inspector.go_to("watch")
        game.main.query_one(WatchView).toggle(pin)
        await game.press("less_than_sign", until=lambda: links(game).pointed)
        await game.sees("the same since tick 4")
        assert pointed(game).value == "fetch"
        await game.press("w")
        await pointed_at(game, "memory.plan", "read")
        await game.press("less_than_sign", sees="memory.plan after tick 4 comes from")

        # It says how far back it is, and can be stopped.
        source, hold = Explainer.source, Hold()

        def slow(explainer: Explainer, subject: Subject) -> ValueSource:
            hold.here()
            return source(explainer, subject)

        monkeypatch.setattr(Explainer, "source", slow)
        game.inspector.trace(Traced(robot, memory("seen"), 5))
        await game.until(lambda: hold.has_begun and game.shows("at tick 2, 3 ticks back"))
        await game.press("escape")
        hold.release()
        await game.sees("Stopped at tick 2")
        assert links(game).pointed is None
        game.inspector.trace(Traced(robot, memory("seen"), 4))
        await game.until(lambda: links(game).pointed)
        assert (pointed(game).tick, pointed(game).until) == (2, 4)

        await game.press("r", tick=0)
        assert links(game).pointed is not None
        assert game.session.game is not None
        game.session.game.forget_future()
        game.inspector.follow()
        await game.sees("went on in another branch")
        assert links(game).pointed is None


SIGHT = """\
Near(robot_name:, ray? ArgMin= ray -> ray.distance) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar;
Speed(way) = way / 1000;
Robot(robot_name:, desire: {left_engine: Speed(ray.distance), right_engine: 0}, memory: {far:}) :-
  Near(robot_name:, ray:), Memory(robot_name:, memory:), far = ray.distance + 1;
"""


async def test_any_value_of_a_table_and_of_a_proof_is_traced_to_its_rays(data_dir: Path) -> None:
    async with opened(data_dir, text=SIGHT, size=(100, 54)) as game:
        await at_tick(game, 2)
        robot = game.inspector.robot
        await in_table(game, "Near")
        await game.press("less_than_sign", until=lambda: links(game).plain and links(game).pointed)
        await game.sees("Near.ray in tick 2 comes from")
        assert "read from" in links(game).plain
        assert " wall, distance " in links(game).plain

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
            await game.press("escape", until=lambda: game.inspector.inspected == "why")


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
def test_only_memory_is_from_the_tick_before(pin: Pin | None, found: Traced | None) -> None:
    assert traced_pin(pin, "Bo", 7) == found


def test_a_link_tells_the_rays_and_how_much_more_was_read() -> None:
    span = SourceSpan(0, 5, 31, "Avg{ray.distance}")
    rays: list[Value] = [
        {"angle": 0.0, "object": "beacon", "label": "Key", "distance": n} for n in range(7)
    ]
    inputs = tuple(
        ValueSource("", ray, read=Read("sensor", "Ada", ("radar", n), ray))
        for n, ray in enumerate(rays)
    )
    source = ValueSource("d", 43, span, span, inputs=inputs)
    link = Link("Ada", "Ada's memory.d", 43, 12, 12, source, ("d",), input_links=(None,) * 7)
    told = [line.plain for line in lines_of(0, link, 80)]
    assert told[:4] == [
        "1. Ada's memory.d = 43",
        "    set in tick 12 by the rule in line 31",
        "    line 31: Avg{ray.distance}",
        '    from Ada\'s ray 0 at 0°: beacon "Key", distance 0',
    ]
    assert told[-1] == "    and from 2 more"
