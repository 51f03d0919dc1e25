"""The briefing is there at the start of a level; what is told later of robots that get nowhere."""

from functools import partial
from pathlib import Path

import pytest

from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.briefing import BriefingTask
from logical_robots_tui.world import list_arenas, list_levels, load_level
from tests.player.test_session import table
from tests.tui.conftest import STILL, Opened, Size, opened

TASK = "Bring Pip to the door."
SIZES = [(80, 24), (100, 24), (120, 40), (90, 50), (200, 60)]


async def test_the_briefing_is_there_at_first_and_when_wanted(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=STILL, ready=True) as game:
        await game.until(lambda: game.shows(TASK) and game.main.briefing.over.display)
        view = game.main.labyrinth.view
        shown, size = view.view, view.size
        await game.press("space", until=lambda: game.tick > 2 and not game.shows(TASK))
        assert (view.view, view.size) == (shown, size)
        await game.press("r", until=lambda: game.tick == 0 and game.shows(TASK))
        assert (view.view, view.size) == (shown, size)
        await game.press("b", until=lambda: not game.shows(TASK))
        await game.press("r", sees=TASK)
        await game.press("n", until=lambda: game.tick > 0 and not game.shows(TASK))
        await game.press("p", until=lambda: game.tick == 0 and game.shows(TASK))
        await game.press("right_parenthesis", until=lambda: game.tick > 0 and not game.shows(TASK))
        await game.press("b", sees=TASK)
        await game.press("b", until=lambda: not game.shows(TASK))
        await game.press("M", until=lambda: game.main.editing.is_on)
        game.session.go_to(0)
        await game.until(lambda: game.tick == 0)
        await game.sees_no(TASK)
        await game.press("escape", until=lambda: not game.main.editing.is_on and game.shows(TASK))
        assert game.main.briefing.over.display
        await game.press("3", until=lambda: not game.main.briefing.over.display)
        keys = ("b Hide the briefing", "enter Inspect")
        for words, others in (keys, keys[::-1], keys):
            await game.press("b", sees=words, sees_no=others)


def shows_beside_the_map(game: Opened) -> bool:
    """Whether the whole briefing is on the screen, no cell of it over the map, none to spare."""
    briefing, view = game.main.briefing, game.main.labyrinth.view
    shown = [card.region for card in (briefing.beside, briefing.over) if card.display]
    rest = game.main.inspector.content_region.width - briefing.over.region.width
    return (
        len(shown) == 1
        and shown[0].area > 0
        and view.region.area > 0
        and not shown[0].overlaps(view.region)
        and game.main.region.contains_region(shown[0])
        and (not briefing.over.display or not rest or rest > 40)
        and not game.shows("space runs")
        and not game.shows("││ First")
        and all(game.shows(words) for words in ("First steps", "in the mirrored", "t lesson"))
    )


@pytest.mark.parametrize(
    "size", [SIZES[0], *(pytest.param(size, marks=pytest.mark.slow) for size in SIZES[1:])]
)
async def test_the_briefing_finds_its_place_at_any_size(data_dir: Path, size: Size) -> None:
    file = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=file, text=STILL, size=size, ready=True) as game:
        await game.until(partial(shows_beside_the_map, game))
        for other in (*SIZES, (140, 45), (80, 24), (120, 40)):
            await game.resize(*other, until=partial(shows_beside_the_map, game))
        await game.press("b")
        await game.until(lambda: not game.main.briefing.is_open and not game.shows("t lesson"))
        for key in "bkk":
            await game.press(key, until=partial(shows_beside_the_map, game))


def test_each_shipped_briefing_fits_in_its_smallest_place() -> None:
    KEY_MAP.set(KeyMap(COMMANDS))
    for name in list_levels():
        task = BriefingTask.of(load_level(name))
        assert len(task.side_by_side(95, 8).split("\n", allow_blank=True)) <= 8, name
        assert len(task.stacked(36).split("\n", allow_blank=True)) <= 20, name
    terms = [tuple(BriefingTask.of(load_level(name)).lines[-2:]) for name in list_arenas()]
    sight = "A robot sees its own rows, and Memory of its team."
    others = ("Your team is red: Raven, Rook.", sight)
    assert terms == [trio := ("Your team is red: Raven, Robin, Rook.", sight), others, trio]
    assert BriefingTask.of(load_level("13-swarm")).lines[-1].endswith("robots on its radar.")


async def test_a_stuck_robot_is_told_and_marked(data_dir: Path, short: Path) -> None:
    backwards = STILL.replace(": 0.0", ": -1.0")
    async with opened(data_dir, level=short, text=backwards, ready=True) as game:
        game.session.run_until(115)
        await game.sees("Pip is stuck: blocked for 100 ticks.", "Diagnosis, in ^P")
        await game.until(lambda: game.tick == 115)
        history = game.session.history
        assert history is not None
        await game.press("left_curly_bracket", sees="⊘ Pip is stuck")
        first = game.tick
        ticks = range(first - 99, first + 1)
        assert all(history.moment(tick).after.robots[0].blocked for tick in ticks)
        game.session.go_to(first - 50)
        await game.until(lambda: game.tick == first - 50)
        await game.write(backwards.replace("memory: 1", "memory: 2"))
        await game.until(lambda: "memory: 2" in (game.session.state.applied or ""))
        await game.run_until(first + 20)
        assert [mark.kind for mark in history.marks.marks_at(first)].count("stuck") == 1
        history.marks.note(first + 20, "circling")
        game.session.go_to(first + 20)
        await game.sees("↻ Pip goes in circles")


async def test_a_robot_that_goes_round_in_circles_is_told_and_marked(tmp_path: Path) -> None:
    turning = STILL.replace("left_engine: 0.0", "left_engine: 1.0")
    async with table(tmp_path, turning) as at:
        at.session.run_until(500)
        await at.until(lambda: at.session.frame.tick == 500)
        history = at.session.history
        assert history is not None
        first = history.marks.nearest(500, -1, ["circling"], None)
        assert first is not None
        (words,) = filter(None, map(trouble, history.marks.marks_at(first)))
        assert words == "Pip goes round in circles: 3 times the same way."
        at.session.go_to(first)
        await at.apply(turning.replace("memory: 1", "memory: 2"))
        at.session.run_until(first + 50)
        await at.until(lambda: at.session.frame.tick == first + 50)
        assert not history.marks.has("circling", first + 1, first + 50), "it has only begun"
