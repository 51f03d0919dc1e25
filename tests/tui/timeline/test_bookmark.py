"""A session that was cut off, and the next one."""

import json
from pathlib import Path

from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.player.recovery import GamePosition, position_of
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from tests.game.playing import BACKWARDS, COUNTER
from tests.short import AHEAD
from tests.tui.conftest import STILL, opened
from tests.tui.program.test_teams import match

OLD = Path(__file__).parents[2] / "old/place.json"


async def test_the_next_session_goes_on_there_with_any_program(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.run_until(3)
        await game.apply(STILL)
        await game.run_until(5)
        there = game.session.frame
        game.session.pace.speed = 160.0
        game.app.save_unsaved()
        await game.press("n", tick=6)

    async with opened(data_dir, level=short, text=AHEAD, name="other", ready=True) as game:
        await game.sees("Cut off")
        await game.press("n", sees="Yes, continue")
        await game.press("enter", until=lambda: game.tick == 5 and not game.session.busy)
        again = game.session.frame
        assert (again.after, again.memories) == (there.after, there.memories)
        assert game.session.state.applied == game.editor.text == STILL
        assert (game.session.source.name, game.session.pace.speed) == ("mine", 160.0)

    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        assert not isinstance(game.app.screen, QuestionDialog)
        assert game.tick == 0


async def test_a_run_that_was_cut_off_is_offered_in_its_level(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.press("n", tick=1)
        level = game.session.level
        game.app.save_unsaved()

    for is_opened in (False, True, True):
        async with opened(data_dir, text=AHEAD, ready=True) as game:
            await game.until(lambda: any((data_dir / "drafts").glob("*-adopted.json")))
            assert not isinstance(game.app.screen, QuestionDialog)
            if is_opened:  # it may have been left without being opened, or without an answer
                await game.app.main.player.library.open_level(level)
                await game.until(lambda: game.shows("Cut off") and game.shows("Yes, continue"))


async def test_the_start_and_changes_by_hand_are_no_bookmarks(data_dir: Path, short: Path) -> None:
    drafts = data_dir / "drafts"
    drafts.mkdir(parents=True)
    (drafts / "20260101000000abcdef01-0123456789abcdef.json").write_text("{}")
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.until(lambda: not Drafts(drafts).adopt("place"))  # what can't be read is none
        assert not isinstance(game.app.screen, QuestionDialog)
        session = game.session
        assert session.game is not None
        assert position_of(session.game, session.opened, session.source) is None
        await game.press("n", tick=1)
        assert position_of(session.game, session.opened, session.source) is not None
        session.change_level(session.level, {"Pip": (20.0, 20.0, 1.0)})
        await game.press("n", tick=2)
        assert position_of(session.game, session.opened, session.source) is None


async def test_an_older_version_s_bookmark_leads_to_its_tick_with_all_teams(data_dir: Path) -> None:
    text = OLD.read_text("utf-8").replace("{level}", str(data_dir / "match.toml"))
    both = {"red": COUNTER, "blue": COUNTER}
    place = GamePosition.from_text(json.loads(text)["text"])
    assert place.programs == ((1, {"red": COUNTER, "blue": BACKWARDS}), (5, both))
    (data_dir / "drafts").mkdir(parents=True)
    (data_dir / "drafts/be3f4e68438a93fb-1bac1478a299539b.json").write_text(text, "utf-8")
    async with match(data_dir) as game:
        await game.sees("Cut off")
        await game.press("n", sees="Yes, continue")
        await game.press("enter", until=lambda: game.tick == 7 and not game.session.busy)
        assert [robot.x for robot in game.session.frame.after.robots] == [47, 39, 67]
        assert game.session.program is not None
        assert (game.session.program.texts, game.editor.text) == (both, COUNTER)
