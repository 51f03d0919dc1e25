"""Nothing typed is ever lost: drafts on the screen, and the end of the process."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from typing import TYPE_CHECKING

import pytest
from textual import events
from textual.widgets import Button, Input

from logical_robots_tui.game import load_program
from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.tui.commands.help import Help
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.dialogs import Question
from logical_robots_tui.tui.level_editor.controller import LevelController
from logical_robots_tui.tui.library.save_dialog import SaveAs
from logical_robots_tui.tui.terminal.crash_report import BugReport
from tests.terminal import Terminal
from tests.tui.conftest import CHARACTERS, LEVELS, PAPER, opened
from tests.virtual_time import Hold
from tests.waiting import PATIENCE, until

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from logical_robots_tui.player.drafts import Draft, Kind
    from tests.tui.conftest import Opened


PLAY = """
import sys
from pathlib import Path
from logical_robots_tui.player.opening import open_game
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.app.app import play
data_dir = Path(sys.argv[3])
recorder = ProgressRecorder(data_dir / FILE_NAME)
sys.exit(play(open_game(recorder.progress, data_dir, sys.argv[1], [sys.argv[2]]), recorder))
"""


def texts(data_dir: Path) -> list[str]:
    """What the next session would find."""
    drafts = Drafts(data_dir / "drafts")
    found = [draft.text for draft in drafts.adopt("program")]
    drafts.close()
    return found


async def type_and_leave(data_dir: Path, words: str) -> None:
    async with opened(data_dir) as game:
        await game.press("2", *words)
        await game.until(lambda: game.editor.text.startswith(words))


async def asked(game: Opened) -> None:
    await game.until(lambda: isinstance(game.app.screen, Question))
    await game.sees("Continue with your unsaved text of “mine”")
    await game.sees("Yes, continue")


async def test_unsaved_text_is_offered_at_the_next_start(data_dir: Path) -> None:
    await type_and_leave(data_dir, "hello")
    async with opened(data_dir) as game:
        await asked(game)
        await game.press("s")
        await game.sees("helloFreedomMotion")
        await game.press("y")
        await game.until(lambda: game.editor.text == "hello" + PAPER)
        assert game.app.screen is game.main
    assert texts(data_dir) == ["hello" + PAPER]


@pytest.mark.sampled
@pytest.mark.parametrize("key", ["n", "y", "s", "enter", "right", "tab", "escape"])
async def test_a_key_that_was_meant_for_the_game_is_no_answer(data_dir: Path, key: str) -> None:
    await type_and_leave(data_dir, "hello")
    async with opened(data_dir) as game:
        await game.sees("Continue with your unsaved text")
        question = game.app.screen
        assert isinstance(question, Question)
        await game.sees_no("set it aside")
        await game.press(key)
        await game.sees("set it aside")
        late = events.Key(key, CHARACTERS.get(key, key if len(key) == 1 else None))
        late.time = question.answered_from - 0.001
        game.app.post_message(late)
        await game.handled()
        assert game.app.screen is question
        assert isinstance(question.focused, Button)
        assert question.focused.id == "answer-yes"
        await game.sees_no("helloFreedomMotion")
        await game.press("n")
        await game.until(lambda: game.app.screen is game.main)


async def test_the_question_waits_until_no_dialog_lies_over_the_game(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    await type_and_leave(data_dir, "hello")
    hold = Hold()
    adopt = Drafts.adopt

    def slowly(drafts: Drafts, kind: Kind) -> list[Draft]:
        hold.here()
        return adopt(drafts, kind)

    monkeypatch.setattr(Drafts, "adopt", slowly)
    async with opened(data_dir) as game:
        try:
            await game.until(lambda: hold.has_begun)
            await game.press("question_mark")
            await game.until(lambda: isinstance(game.app.screen, Help))
        finally:
            hold.release()
        await game.until(lambda: game.main.player.drafts._adopted)
        await game.ready()
        assert isinstance(game.app.screen, Help)
        await game.press("escape")
        await asked(game)


async def test_text_that_has_come_back_under_a_dialog_is_not_offered(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    await type_and_leave(data_dir, "hello")
    hold = Hold()
    adopt = Drafts.adopt

    def slowly(drafts: Drafts, kind: Kind) -> list[Draft]:
        found = adopt(drafts, kind)
        hold.here()
        return found

    monkeypatch.setattr(Drafts, "adopt", slowly)
    async with opened(data_dir, name="other") as game:
        try:
            await game.until(lambda: hold.has_begun)
            await game.press("question_mark")
            await game.until(lambda: isinstance(game.app.screen, Help))
            game.main.library.open_program(load_program(data_dir / "programs" / "mine.l"))
        finally:
            hold.release()
        offered = asyncio.Event()
        monkeypatch.setattr(LevelController, "offer", lambda door, offers: _now(offered))
        await game.ready()
        await game.press("escape")
        await game.until(offered.is_set)
        assert game.editor.text == "hello" + PAPER


async def _now(event: asyncio.Event) -> None:
    event.set()


async def test_unwanted_text_is_put_away_and_not_offered_again(data_dir: Path) -> None:
    await type_and_leave(data_dir, "hello")
    async with opened(data_dir) as game:
        await asked(game)
        await game.press("n")
        await game.until(lambda: game.app.screen is game.main)
        assert game.editor.text == PAPER
        await game.until(lambda: list((data_dir / "drafts" / "old").glob("*")))
    assert texts(data_dir) == []


@pytest.mark.slow
async def test_a_question_left_unanswered_is_asked_again(data_dir: Path) -> None:
    await type_and_leave(data_dir, "hello")
    for _ in range(2):
        async with opened(data_dir) as game:
            await asked(game)
            await game.press("escape")
            await game.until(lambda: game.app.screen is game.main)
            await game.press("2", "x")
            await game.until(lambda: game.editor.text == "x" + PAPER)
            await game.press("backspace")
            await game.until(lambda: game.editor.text == PAPER)


async def test_text_that_was_saved_meanwhile_is_not_offered(data_dir: Path) -> None:
    await type_and_leave(data_dir, "hello")
    (data_dir / "programs" / "mine.l").write_text("hello" + PAPER)
    async with opened(data_dir) as game:
        await game.ready()
        assert game.app.screen is game.main
    assert texts(data_dir) == []


async def test_text_of_another_program_is_offered_with_its_program(data_dir: Path) -> None:
    await type_and_leave(data_dir, "hello")
    async with opened(data_dir, name="other") as game:
        await asked(game)
        await game.press("y")
        await game.until(lambda: game.editor.text == "hello" + PAPER)
        assert game.session.source.name == "mine"


async def test_an_edit_is_on_disk_soon_and_gone_when_it_is_taken_back(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2", "x")
        await game.until(lambda: list((data_dir / "drafts").glob("*.json")))
        await game.press("backspace")
        await game.until(lambda: not list((data_dir / "drafts").glob("*.json")))


async def test_two_games_at_once_do_not_offer_each_other_their_texts(data_dir: Path) -> None:
    async with opened(data_dir) as first:
        await first.press("2", *"one")
        await first.until(lambda: list((data_dir / "drafts").glob("*.json")))
        async with opened(data_dir) as second:
            await second.ready()
            assert second.app.screen is second.main
            assert second.editor.text == PAPER


async def test_a_data_folder_that_cannot_be_written_is_said_once(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        (data_dir / "drafts").write_text("in the way")
        await game.press("2", "x")
        await game.sees("can't be kept on disk")
        await game.press("y", "escape")
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)


async def nowhere_to_keep(game: Opened, data_dir: Path) -> None:
    """Type something that can neither be kept nor was saved."""
    (data_dir / "drafts").write_text("in the way")
    await game.press("2", "x")
    await game.sees("can't be kept on disk")
    await game.press("escape")


async def test_nobody_leaves_unasked_what_cannot_be_kept(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir) as game:
        await nowhere_to_keep(game, data_dir)
        for answer in ("s", "escape"):
            await game.press("q")
            await game.sees("Your changes to “mine” are not saved and")
            await game.press(answer)
            await game.until(lambda: game.app.screen is game.main)
        await game.press("s")
        await game.until(lambda: isinstance(game.app.screen, SaveAs))
        game.app.screen.query_one(Input).value = str(tmp_path / "elsewhere.l")
        await game.press("enter")
        await game.until(lambda: game.app.screen is game.main)
        await game.press("q")
        await game.until(lambda: not game.app.is_running)
    assert (tmp_path / "elsewhere.l").read_text() == "x" + PAPER


@pytest.mark.parametrize("keys", ["ql", ("ctrl+c", "ctrl+c", "l")])
async def test_who_does_not_want_it_leaves(data_dir: Path, keys: Sequence[str]) -> None:
    async with opened(data_dir) as game:
        await nowhere_to_keep(game, data_dir)
        *before, last = keys
        await game.press(*before)
        await game.until(lambda: isinstance(game.app.screen, Question))
        await game.press(last)
        await game.until(lambda: not game.app.is_running)


async def test_nobody_leaves_unasked_a_level_that_cannot_be_kept(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        (data_dir / "drafts").write_text("in the way")
        await game.press("M")
        await game.until(lambda: game.main.editing.is_on)
        await game.press("b", "enter")
        await game.sees("The edited level can't be kept on disk")
        game.main.action_command("quit")
        await game.sees("are not saved and can't be kept")
        await game.press("l")
        await game.until(lambda: not game.app.is_running)


async def test_a_mistake_of_our_own_keeps_the_text_and_shows_no_traceback(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(BugReport) as caught:  # noqa: PT012 - it is raised at the end
        async with opened(data_dir) as game:
            await game.press("2", *"hello")
            await game.until(lambda: game.editor.text.startswith("hello"))
            monkeypatch.setattr(LabyrinthView, "look_at_next", lambda self: 1 / 0)
            game.main.action_command("map")
            await game.press("f")
            await game.until(lambda: not game.app.is_running)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert isinstance(game.app.mistake, ZeroDivisionError)
    assert "division" not in str(caught.value.__rich__())
    assert texts(data_dir) == ["hello" + PAPER]


@pytest.mark.parametrize("is_exit", [True, False], ids=["by exit", "by its owner"])
async def test_a_question_that_comes_when_the_game_ends_is_no_mistake(
    data_dir: Path, is_exit: bool
) -> None:
    mounting = asyncio.Event()

    class Late(Question):
        """Shown when the parts of it are taken away already."""

        async def on_mount(self) -> None:  # type: ignore[override] # Textual waits for it
            mounting.set()
            if is_exit:
                self.app.exit()
            else:
                await game.until(lambda: not self.app.is_running)
            self.query_one("#taken-away")

    async with opened(data_dir) as game:
        game.app.push_screen(Late("Title", "Really?", [("yes", "Yes")]))
        await mounting.wait()
        if is_exit:
            await game.until(lambda: not game.app.is_running)
    assert game.app.mistake is None


class Played(Terminal):
    """The game in a real terminal, with a program of the player's own."""

    def __init__(self, data_dir: Path) -> None:
        program = data_dir / "programs" / "mine.l"
        program.parent.mkdir(parents=True)
        program.write_text(PAPER)
        level = LEVELS / "open_room.json"
        super().__init__([sys.executable, "-c", PLAY, level, program, data_dir], size=(100, 30))


def type_hello(terminal: Terminal) -> None:
    terminal.wait_for("1 Map")
    terminal.send("2")
    terminal.wait_for("Leave")
    terminal.send("hello")
    terminal.wait_for("helloFreedomMotion")


@pytest.mark.sampled
@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM])
def test_a_signal_ends_the_game_with_the_text_kept(data_dir: Path, number: signal.Signals) -> None:
    with Played(data_dir) as terminal:
        type_hello(terminal)
        terminal.process.send_signal(number)
        terminal.finish()
    assert texts(data_dir) == ["hello" + PAPER]


@pytest.mark.sampled
@pytest.mark.parametrize("told", [True, False], ids=["told", "not told"])
def test_a_terminal_that_is_closed_ends_the_game_and_all_it_started(
    data_dir: Path, told: bool
) -> None:
    with Played(data_dir) as terminal:
        type_hello(terminal)
        group = os.getpgid(terminal.process.pid)
        os.close(terminal._ours)
        terminal._ours = os.open(os.devnull, os.O_RDWR)
        if told:  # as the kernel does for a session leader with a terminal of its own
            terminal.process.send_signal(signal.SIGHUP)
        terminal.process.wait(PATIENCE)
        until(lambda: not alive(group))
    assert texts(data_dir) == ["hello" + PAPER]


def test_a_killed_game_leaves_its_text_for_the_next(data_dir: Path) -> None:
    with Played(data_dir) as terminal:
        type_hello(terminal)
        until(lambda: list((data_dir / "drafts").glob("*.json")))
        terminal.process.kill()
        terminal.process.wait(PATIENCE)
    assert texts(data_dir) == ["hello" + PAPER]


def alive(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
