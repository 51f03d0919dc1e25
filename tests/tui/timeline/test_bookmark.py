"""A session that was cut off, and the next one."""

import json
from pathlib import Path

from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.player.recovery import Place, place_of
from logical_robots_tui.tui.layout.dialogs import Question
from tests.game.playing import BACKWARDS, COUNTER
from tests.short import AHEAD
from tests.tui.conftest import STILL
from tests.tui.inspector.steps import pressed, run_until, started
from tests.tui.program.test_teams import match

OLD = Path(__file__).parents[2] / "old/place.json"


async def test_the_next_session_goes_on_exactly_there_whatever_programs_it_took(
    data_dir: Path, short: Path
) -> None:
    async with started(data_dir, level=short, text=AHEAD) as game:
        await run_until(game, 3)
        await game.apply(STILL)
        await run_until(game, 5)
        there = game.session.frame
        game.session.pace.speed = 160.0
        game.app.save_unsaved()
        await pressed(game, "n", tick=6)

    async with started(data_dir, level=short, text=AHEAD, name="other") as game:
        await game.sees("Cut off")
        await pressed(game, "n", sees="Yes, continue")
        await pressed(game, "enter", until=lambda: game.tick == 5 and not game.session.busy)
        again = game.session.frame
        assert (again.after, again.memories) == (there.after, there.memories)
        assert game.session.state.applied == game.editor.text == STILL
        assert game.session.source.name == "mine"
        assert game.session.pace.speed == 160.0

    async with started(data_dir, level=short, text=AHEAD) as game:
        assert not isinstance(game.app.screen, Question)
        assert game.tick == 0


async def test_a_run_cut_off_in_another_level_is_offered_when_that_level_is_opened(
    data_dir: Path, short: Path
) -> None:
    async with started(data_dir, level=short, text=AHEAD) as game:
        await pressed(game, "n", tick=1)
        level = game.session.level
        game.app.save_unsaved()

    for is_opened in (False, True, True):
        async with started(data_dir, text=AHEAD) as game:
            await game.until(lambda: any((data_dir / "drafts").glob("*-adopted.json")))
            assert not isinstance(game.app.screen, Question)
            if is_opened:  # it may have been left without being opened, or without an answer
                await game.app.main.player.library.open_level(level)
                await game.until(lambda: game.shows("Cut off") and game.shows("Yes, continue"))


async def test_there_is_no_going_back_to_the_start_or_through_a_level_changed_by_hand(
    data_dir: Path, short: Path
) -> None:
    async with started(data_dir, level=short, text=AHEAD) as game:
        session = game.session
        assert session.game is not None
        assert place_of(session.game, session.opened, session.source) is None
        await pressed(game, "n", tick=1)
        assert place_of(session.game, session.opened, session.source) is not None
        session.change_level(session.level, {"Pip": (20.0, 20.0, 1.0)})
        await pressed(game, "n", tick=2)
        assert place_of(session.game, session.opened, session.source) is None


async def test_a_bookmark_that_cannot_be_read_is_passed_over(data_dir: Path, short: Path) -> None:
    drafts = data_dir / "drafts"
    drafts.mkdir(parents=True)
    (drafts / "20260101000000abcdef01-0123456789abcdef.json").write_text("{}")
    async with started(data_dir, level=short, text=AHEAD) as game:
        await game.until(lambda: not Drafts(drafts).adopt("place"))
        assert not isinstance(game.app.screen, Question)


async def test_an_older_version_s_bookmark_leads_to_its_tick_with_all_teams(data_dir: Path) -> None:
    text = OLD.read_text("utf-8").replace("{level}", str(data_dir / "match.toml"))
    both = {"red": COUNTER, "blue": COUNTER}
    place = Place.from_text(json.loads(text)["text"])
    assert place.programs == ((1, {"red": COUNTER, "blue": BACKWARDS}), (5, both))
    (data_dir / "drafts").mkdir(parents=True)
    (data_dir / "drafts/be3f4e68438a93fb-1bac1478a299539b.json").write_text(text, "utf-8")
    async with match(data_dir) as game:
        await game.sees("Cut off")
        await pressed(game, "n", sees="Yes, continue")
        await pressed(game, "enter", until=lambda: game.tick == 7 and not game.session.busy)
        assert [robot.x for robot in game.session.frame.after.robots] == [47, 39, 67]
        assert game.session.program is not None
        assert game.session.program.texts == both
        assert game.editor.text == COUNTER
