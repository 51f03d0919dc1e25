"""Nothing typed is lost: drafts on the screen, files that change, and the end of the process."""

import asyncio
import os
import signal
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest
from textual.widgets import Button, Input

from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.player.drafts import Draft, Drafts, Kind
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.tui.library.save_dialog import SaveAs
from logical_robots_tui.tui.program.controller import FileWatch
from logical_robots_tui.tui.terminal.crash_report import BugReport
from tests.terminal import Terminal
from tests.tui.conftest import LEVELS, PAPER, STILL, Opened, key_event, opened, source_of
from tests.tui.program.conftest import PaneApp
from tests.virtual_time import Hold
from tests.virtual_time import until as virtual_until
from tests.waiting import PATIENCE, until

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
    drafts = Drafts(data_dir / "drafts")
    adopted = [draft.text for draft in drafts.adopt("program")]
    drafts.close()
    return adopted


def leave_behind(data_dir: Path, **typed: str) -> None:
    """Keep texts, the newest last, as a session did; in each file is the paper's program."""
    drafts = Drafts(data_dir / "drafts")
    for name, text in typed.items():
        source = source_of(PAPER, data_dir / "programs", name)
        drafts.keep(Draft("program", name, source.draft, text))
    drafts.close()


async def asked(game: Opened, name: str = "mine") -> QuestionDialog:
    await game.sees(f"Continue with your unsaved text of “{name}”", "Yes, continue")
    question = game.app.screen
    assert isinstance(question, QuestionDialog)
    return question


async def test_typed_text_is_on_disk_soon_and_offered_at_the_next_start(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press(*["plus"] * 9, until=lambda: "flat out" in game.status)
        await game.press("2", "x", until=lambda: list((data_dir / "drafts").glob("*.json")))
        await game.press("backspace", until=lambda: not list((data_dir / "drafts").glob("*.json")))
        await game.press(*"hello")
    async with opened(data_dir) as game:
        await asked(game)
        assert "flat out" in game.status  # as it was chosen
        await game.press("s", sees="helloFreedomMotion")
        await game.press("y", until=lambda: game.editor.text == "hello" + PAPER)
        assert game.app.screen is game.main
    assert texts(data_dir) == ["hello" + PAPER]


async def test_a_key_meant_for_the_game_is_no_answer_and_the_text_is_kept(data_dir: Path) -> None:
    leave_behind(data_dir, mine="hello" + PAPER)
    keys = ("n", "y", "s", "enter", "right", "tab", "escape")
    async with opened(data_dir) as game:
        await game.sees("Continue with your unsaved text")
        await game.sees_no("set it aside")
        await game.press(*keys, sees_no="set it aside")
        question = await asked(game)
        for key in keys:
            late = key_event(key)
            late.time = question.answered_from - 0.001
            game.app.post_message(late)
        await game.handled()
        assert game.app.screen is question
        assert isinstance(question.focused, Button)
        assert question.focused.id == "answer-yes"
        await game.sees_no("hello")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        await game.press("2", "x", "backspace", until=lambda: game.editor.text == PAPER)
    assert texts(data_dir) == ["hello" + PAPER]


async def test_text_that_is_unwanted_or_saved_is_not_offered_again(data_dir: Path) -> None:
    leave_behind(data_dir, saved="saved" + PAPER, other="other" + PAPER, mine="hello" + PAPER)
    (data_dir / "programs" / "saved.l").write_text("saved" + PAPER)
    async with opened(data_dir) as game:
        await asked(game)
        await game.press("n", until=lambda: list((data_dir / "drafts" / "old").glob("*")))
        assert game.app.screen is game.main
        assert game.editor.text == PAPER
    async with opened(data_dir, name="third") as game:
        await asked(game, "other")
        await game.press("y", until=lambda: game.editor.text == "other" + PAPER)
        assert game.session.source.name == "other"
    assert texts(data_dir) == ["other" + PAPER]


async def test_a_question_waits_its_turn(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    leave_behind(data_dir, mine="hello" + PAPER, other="other" + PAPER)
    hold = Hold()
    adopt = Drafts.adopt

    def slowly(drafts: Drafts, kind: Kind) -> list[Draft]:
        adopted = adopt(drafts, kind)
        hold.here()
        return adopted

    monkeypatch.setattr(Drafts, "adopt", slowly)
    async with opened(data_dir, name="third") as game:
        try:
            await game.until(lambda: hold.has_begun)
            await game.press("s", on=SaveAs)
            game.main.library.open_program(load_program(data_dir / "programs" / "mine.l"))
        finally:
            hold.release()
        await game.ready()
        await game.settled()
        assert isinstance(game.app.screen, SaveAs)
        await game.press("escape")
        await asked(game, "other")
        assert game.editor.text == "hello" + PAPER
        await game.press("n", until=lambda: game.app.screen is game.main)
        await game.settled()
        assert not game.shows("Continue with")


async def test_nobody_leaves_unasked_what_cannot_be_kept(data_dir: Path, tmp_path: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        (data_dir / "drafts").write_text("in the way")
        await game.press("2", "x", sees="can't be kept on disk")
        await game.press("y", "backspace", "escape", "n", tick=1)
        for answer in ("s", "escape"):
            await game.press("q", sees="Your changes to “mine” are not saved and")
            await game.press(answer, until=lambda: game.app.screen is game.main)
        await game.press("s", on=SaveAs)
        game.app.screen.query_one(Input).value = str(tmp_path / "elsewhere.l")
        await game.press("enter", until=lambda: game.app.screen is game.main)
        await game.press("q", until=lambda: not game.app.is_running)
    assert (tmp_path / "elsewhere.l").read_text() == "x" + PAPER


async def test_who_does_not_want_what_cannot_be_kept_leaves(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        (data_dir / "drafts").write_text("in the way")
        await game.press("M", until=lambda: game.main.editing.is_on)
        await game.press("b", "enter", sees="The edited level can't be kept on disk")
        await game.command("quit", sees="are not saved and can't be kept")
        await game.press("s", until=lambda: game.app.screen is game.main)
        await game.press("ctrl+c", "ctrl+c", on=QuestionDialog)
        await game.press("l", until=lambda: not game.app.is_running)


async def test_our_mistakes_keep_the_text(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BugReport) as caught:  # noqa: PT012 - it is raised at the end
        async with opened(data_dir) as game:
            await game.press("2", *"hello", until=lambda: game.editor.text.startswith("hello"))
            monkeypatch.setattr(LabyrinthView, "look_at_next", lambda self: 1 / 0)
            await game.command("map")
            await game.press("f", until=lambda: not game.app.is_running)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert isinstance(game.app.mistake, ZeroDivisionError)
    assert "division" not in str(caught.value.__rich__())
    assert texts(data_dir) == ["hello" + PAPER]


@pytest.mark.parametrize("is_exit", [True, False], ids=["by exit", "by its owner"])
async def test_a_question_that_comes_when_the_game_ends_is_no_mistake(is_exit: bool) -> None:
    mounting = asyncio.Event()

    class Late(QuestionDialog):
        """Shown when the parts of it are taken away already."""

        async def on_mount(self) -> None:  # type: ignore[override] # Textual waits for it
            mounting.set()
            if is_exit:
                self.app.exit()
            else:
                await virtual_until(lambda: not self.app.is_running)
            self.query_one("#taken-away")

    app = PaneApp()
    async with app.run_test():
        app.push_screen(Late("Title", "Really?", [("yes", "Yes")]))
        await mounting.wait()
        if is_exit:
            await virtual_until(lambda: not app.is_running)
    assert app.mistake is None


@pytest.mark.parametrize(
    ("number", "is_closed"),
    [
        # A session leader with a terminal of its own is told by the kernel that it is gone.
        (signal.SIGHUP, True),
        pytest.param(None, True, marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, False, marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, False, marks=pytest.mark.slow),
        pytest.param(signal.SIGKILL, False, marks=pytest.mark.slow),
    ],
)
def test_a_signal_or_a_closed_terminal_ends_the_game_and_all_it_started_with_the_text_kept(
    data_dir: Path, number: signal.Signals | None, is_closed: bool
) -> None:
    program = data_dir / "programs" / "mine.l"
    program.parent.mkdir(parents=True)
    program.write_text(PAPER)
    game = [sys.executable, "-c", PLAY, LEVELS / "open_room.json", program, data_dir]
    with Terminal(game, size=(90, 30)) as terminal:
        for keys, shown in [("", "1 Map"), ("2", "Leave"), ("hello", "helloFreedomMotion")]:
            terminal.send(keys)
            terminal.wait_for(shown)
        group = os.getpgid(terminal.process.pid)
        if number == signal.SIGKILL:
            drafts = data_dir / "drafts"
            until(lambda: any("hello" in file.read_text() for file in drafts.glob("*.json")))
        if is_closed:
            os.close(terminal._ours)
            terminal._ours = os.open(os.devnull, os.O_RDWR)
        if number is not None:
            terminal.process.send_signal(number)
        if is_closed:
            terminal.process.wait(PATIENCE)
        else:
            terminal.finish()
        until(lambda: not is_alive(group))
    assert texts(data_dir) == ["hello" + PAPER]


def is_alive(group: int) -> bool:
    with suppress(ProcessLookupError):
        os.killpg(group, 0)
        return True
    return False


def test_a_change_before_the_first_look_is_noticed_once(tmp_path: Path) -> None:
    source = source_of(PAPER, tmp_path)
    source.path.write_text(STILL)
    watch = FileWatch(lambda: source, lambda _: None)
    newer = watch.newer(source)
    assert newer is not None
    assert newer.text == STILL
    assert watch.newer(source) is None
    assert watch.newer(newer) is None
    source.path.unlink()
    assert watch.newer(newer) is None


async def test_a_file_that_changes_on_disk_is_applied_unless_one_has_typed(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        path = game.session.source.path
        path.write_text(STILL)
        await game.until(lambda: game.editor.text == game.session.state.applied == STILL)
        await game.press("2", "ctrl+home", "x")
        path.write_text("x" + STILL)  # it counts as saved
        await game.until(lambda: game.session.source.text == "x" + STILL)
        await game.handled()
        await game.sees_no("has changed on disk")
        await game.press("y", until=lambda: game.editor.text == "xy" + STILL)
        path.write_text(PAPER)
        await game.sees("has changed on disk")
        assert game.editor.text == "xy" + STILL


async def test_the_disk_is_not_waited_for(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, looked = Hold(), Hold(), threading.Event()
    holds = {STILL: first, f"{STILL}\n": second}
    other = source_of(PAPER, data_dir / "programs", "other")

    def slowly(path: Path) -> ProgramSource:
        source = load_program(path)
        if path == other.path:
            looked.set()
        elif source.text in holds:
            holds[source.text].here()
        return source

    monkeypatch.setattr("logical_robots_tui.tui.program.controller.load_program", slowly)
    async with opened(data_dir, ready=True) as game:
        path = game.session.source.path
        path.write_text(STILL)
        try:
            await game.until(lambda: first.has_begun)
            await game.press("n", tick=1)
            assert game.editor.text == PAPER
        finally:
            first.release()
        await game.until(lambda: game.editor.text == STILL)
        path.write_text(f"{STILL}\n")
        try:
            await game.until(lambda: second.has_begun)
            game.main.library.open_program(other)
        finally:
            second.release()
        await game.until(looked.is_set)
        assert (game.editor.text, game.session.source.path) == (PAPER, other.path)
