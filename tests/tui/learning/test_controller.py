"""Hints, the lesson, the reference program, results to keep, earlier versions, the first win."""

import asyncio
import re
from pathlib import Path
from typing import Any

import pytest
from textual.widgets import OptionList, Static

from logical_robots_tui.game import load_program, measuring
from logical_robots_tui.game.pace import FLAT_OUT
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.progress import FILE_NAME, Measures, Progress
from logical_robots_tui.tui.commands.general import copy_result
from logical_robots_tui.tui.commands.help import PaletteScreen
from logical_robots_tui.tui.labyrinth.results import ResultsDialog
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.tui.learning.reader import Hints, TextReader, markdown
from logical_robots_tui.tui.library.chooser import Chooser
from logical_robots_tui.world import list_levels, list_shipped, load_level
from tests.short import AHEAD
from tests.tui.conftest import PAPER, STILL, Opened, Size, opened

FIRST = list_levels()[0]


def record_of(data_dir: Path) -> Progress:
    return Progress(data_dir / FILE_NAME)


def versions(data_dir: Path, level: Path) -> list[str]:
    return [version.text for version in record_of(data_dir).versions(str(level))]


async def win(game: Opened) -> None:
    await game.ready()
    await game.press(*["plus"] * 6, "space", until=lambda: game.session.won_at is not None)
    await game.until(lambda: game.main.recorder.record.state == "won")
    await game.sees("Again")


async def stay(game: Opened) -> None:
    await game.press("escape", until=lambda: game.app.screen is game.main)


async def test_hints_are_revealed_one_at_a_time_and_stay_so(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, ready=True) as game:
        await game.press("h", on=Hints)
        hints = game.app.screen
        hints.dismiss()
        await game.until(lambda: not hints.query("#hints"))
        await game.app.run_action("more", hints)  # which reveals nothing any more
        await hints.run_action("more")
        await game.settled()
        assert game.app.screen is game.main
        assert game.main.recorder.record.hints == 1
        await game.press("h", sees_no="straight ahead", sees=("It is not far.", "2 more"))
        # As when a line for a shell is typed into the map.
        await game.press(
            "h", "space", "s", "h", "enter", sees="2 more: wait a second, then press h."
        )
        await game.later(1)
        await game.press("h", sees="It is straight ahead.")
        await stay(game)
        await game.main.library.open_level(load_level(short))
        await game.until(lambda: game.main.recorder.record.hints == 2)
        await game.press("h", sees_no="Just go.", sees=("It is straight ahead.", "h next hint"))
        await game.click("#more", sees="There are no more.", sees_no="h next hint")
        await game.press("h", "t", sees="Lesson · ")
        await game.press("q", "h", "h", "q", until=lambda: game.app.screen is game.main)
    assert record_of(data_dir).record(str(short)).hints == 3


async def test_texts_are_whole_at_80_columns(data_dir: Path) -> None:
    level = shipped_folder("levels") / "10-distributed-mapping.toml"
    async with opened(data_dir, level=level, size=(80, 24), ready=True) as game:
        learning = game.main.learning.learning
        while learning.reveal_next():
            pass
        await game.press("h", on=Hints)
        await game.sees("1. ", "There are no more.", "t lesson   esc close", "↑↓ scroll")
        await game.press("pagedown", sees=learning.revealed[-1].split()[-1])
        await stay(game)
        answers = [("yes", "Yes"), ("show", "Show it")]
        game.app.push_screen(
            QuestionDialog(
                "Text", "Continue?", answers, text="\n".join(f"line {n}" for n in range(40))
            )
        )
        await game.press("s", sees=("line 0", "Show it", "↑↓ scroll"), sees_no="line 20")
        await game.press("pagedown", sees=("line 20", "Show it"), sees_no="line 0")
        await game.press("s", sees_no="scroll")
        await stay(game)
        blocks = [
            block.rstrip("\n")
            for name in list_shipped()
            for block in re.findall(r"^```.*\n([^`]*)^```$", load_level(name).lesson, re.MULTILINE)
        ]
        lesson = markdown("\n".join(f"```\n{block}\n```" for block in blocks))
        game.app.push_screen(TextReader("Lesson", lesson))
        await game.until(lambda: len(lesson.query("MarkdownFence Label")) == len(blocks))
        await game.settled()
        for label, block in zip(lesson.query("MarkdownFence Label"), blocks, strict=True):
            assert label.size.height == len(block.split("\n")), block


async def test_a_level_without_texts_says_so_and_another_brings_a_program(data_dir: Path) -> None:
    progress = record_of(data_dir)
    progress.keep(FIRST, AHEAD)
    progress.close()
    async with opened(data_dir, ready=True) as game:
        for key, words in (
            ("h", "has no hints"),
            ("t", "has no lesson"),
            ("W", "has no reference program"),
            ("x", "has no starter program"),
        ):
            await game.press(key, sees=words)
        await game.press("greater_than_sign", until=lambda: game.session.level.name == FIRST)
        assert game.editor.text == AHEAD
        await game.until(lambda: game.session.state.applied == AHEAD)
        await game.sees("Your program for this level has been restored.")


async def test_challenge_and_reference_are_for_those_who_won(data_dir: Path, short: Path) -> None:
    solution = load_program("first-steps-starter").text.splitlines()[0]
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        copy_result(game.main)
        await game.sees("win this level first")
        await game.command("questions", sees="This level has no questions.")
        await game.press(
            "t", sees=("A rule with one case", "space or esc close"), sees_no="Further"
        )
        await game.press("enter")
        await game.settled()
        assert isinstance(game.app.screen, TextReader)
        await game.sees_no("questions")
        await stay(game)
        for answer in "ny":
            await game.press("W", on=QuestionDialog)
            assert not game.shows(solution[:40])
            await game.press(answer, until=lambda: not isinstance(game.app.screen, QuestionDialog))
        await game.sees(solution[:40])
        assert game.main.recorder.progress.fact("shown first-steps-starter")
        await stay(game)
        await win(game)
        await stay(game)
        await game.until(lambda: game.main.recorder.latest is not None)
        copy_result(game.main)
        copied = game.app.clipboard
        assert copied.startswith("Logical Robots · A short way · 49 ticks · 11 symbols · ")
        await game.press("t", sees="Be there in fewer ticks.")
        assert isinstance(game.app.screen, TextReader)
        await game.press("space", until=lambda: game.app.screen is game.main)
        await game.press("W", sees=solution[:40])
        assert isinstance(game.app.screen, TextReader)


@pytest.mark.usefixtures("trials")
async def test_a_victory_is_measured_compared_kept_and_clicked(data_dir: Path, short: Path) -> None:
    progress = record_of(data_dir)
    progress.win(str(short), "another", Measures(30, 50, 1.0))
    progress.close()
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.until(lambda: game.main.recorder.record.state == "won")
        await win(game)
        await game.sees("this run", "11 ▲")  # fewer symbols than 50
        latest = game.main.recorder.latest
        assert latest is not None
        assert (latest.ticks, latest.size) == (game.session.won_at, 11)
        assert 20 < latest.distance < 40
        await game.until(lambda: game.main.recorder.record.bests.wins is not None)
        bests = game.main.recorder.record.bests
        await game.sees(f"{bests.wins} of 20")
        assert (bests.ticks, bests.size, bests.distance) == (30, 11, 1.0)
        await game.sees_no("so far")
        lines = game.screen().splitlines()
        row = next(row for row, line in enumerate(lines) if "Again" in line and "Stay" in line)
        await game.click(offset=(lines[row].index("Again") + 1, row))
        await game.until(lambda: game.tick == 0 and game.app.screen is game.main)
        await game.press("m", sees="Results")
        await game.press("ctrl+p", on=PaletteScreen)
        await game.press("escape", "m", sees="Results")
        await game.press("m", sees_no="Results")
    assert record_of(data_dir).measures(str(short), AHEAD) == game.main.recorder.latest


@pytest.mark.usefixtures("trials")
async def test_a_changed_program_is_measured_from_the_start(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=STILL, ready=True) as game:
        await game.press("n", tick=1)
        await game.apply(AHEAD)
        await game.press("1")
        await win(game)
        won_at = game.session.won_at
        await game.until(lambda: game.main.recorder.record.bests.ticks is not None)
        assert won_at is not None
        assert game.main.recorder.record.bests.ticks == won_at - 1
        await game.sees("from start")
        await game.sees_no("this run")


async def test_trials_are_told_after_the_results_are_closed_and_can_be_stopped(
    data_dir: Path, short: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed = asyncio.Event()

    async def measure_then(*_: object) -> Measures:
        await closed.wait()
        return Measures(49, 11, 24.5, 13, 20)

    monkeypatch.setattr(measuring, "measure", measure_then)
    async with opened(data_dir, level=short, text=STILL, ready=True) as game:
        await game.command("stop_measuring", sees="No robustness test is running.")
        await game.press("n", tick=1)
        await game.apply(AHEAD)
        await game.press("1")
        await win(game)
        await game.sees("│  Several programs drove on the way", "press r, then")
        await game.sees("varied starts tried: 0 of 20 … 3 s")
        await game.command("stop_measuring", until=lambda: game.main.recorder.trial is None)
        assert game.main.recorder.record.state == "won"
        assert game.main.recorder.record.bests.wins is None
        await stay(game)
        await game.press("r", tick=0)
        recorder = game.main.recorder
        recorder._title = "Swarm"
        async with recorder._turn:
            await win(game)
            await game.sees("this run", "varied starts wait for those of Swarm … 3 s")
        await game.sees("varied starts tried: 0 of 20")
        assert not game.shows("Several programs")
        await stay(game)
        closed.set()
        await game.sees("of 20 varied starts")


async def test_the_reference_program_wins_for_itself_alone(data_dir: Path, short: Path) -> None:
    text = load_program("first-steps-starter").text
    async with opened(data_dir, level=short, text=text, ready=True) as game:
        await game.press(*["plus"] * 6, "space", sees="Won by a reference program")
    assert record_of(data_dir).record(str(short)).state == "started"
    assert versions(data_dir, short) == []


async def test_applied_programs_and_the_starter_come_back(data_dir: Path, short: Path) -> None:
    starter = load_program("obstacle-avoider").text
    async with opened(data_dir, level=short, text=AHEAD, ready=True) as game:
        await game.apply(STILL)
        await game.press("1", "v", on=Chooser)
        entries = game.app.screen.query_one(OptionList)
        await game.until(lambda: entries.option_count == 2)
        assert entries.highlighted == 0, "the program at hand is the first"
        await game.press("down")
        preview = game.app.screen.query_one("#preview-text", Static)
        await game.until(lambda: "on my way" in str(preview.visual))
        await game.press("enter", until=lambda: game.session.state.applied == AHEAD)
        assert game.editor.text == AHEAD
        game.editor.undo()
        assert game.editor.text == STILL
        await game.until(lambda: versions(data_dir, short) == [AHEAD, STILL])

        await game.press("2", "x", "escape")
        await game.until(lambda: sorted(game.editor.text) == sorted(f"x{STILL}"))
        typed = game.editor.text
        for answer, text in (("n", typed), ("y", starter)):
            await game.press("x", on=QuestionDialog)
            await game.press(answer, until=lambda: game.app.screen is game.main)
            assert game.editor.text == text
        await game.until(lambda: game.session.state.applied == starter)
        await game.press("x", sees="This is the starter program.")
        await game.press("v", on=Chooser)
    texts = versions(data_dir, short)
    assert texts[:2] == [starter, typed]
    assert {*texts[2:]} == {AHEAD, STILL}


async def test_text_that_is_kept_as_a_version_is_not_offered_as_unsaved(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.apply(STILL)
        await game.until(lambda: list((data_dir / "drafts").glob("*.json")))
    async with opened(data_dir, text=PAPER, ready=True) as game:
        await game.until(lambda: not list((data_dir / "drafts").glob("*-adopted.json")))
        assert game.app.screen is game.main


async def test_a_bad_disk_is_told_once_and_the_game_goes_on(data_dir: Path, short: Path) -> None:
    (data_dir / FILE_NAME).mkdir(parents=True)
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.sees("Your progress can't be saved")
        await win(game)
        await stay(game)
        await game.press("h", on=Hints)
        assert len([n for n in game.app._notifications if "progress" in n.message]) == 1


async def test_a_damaged_record_is_set_aside_with_a_message(data_dir: Path, short: Path) -> None:
    record_of(data_dir).begin(str(short))
    await asyncio.to_thread((data_dir / FILE_NAME).write_bytes, b"garbage" * 999)
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.sees("was damaged")
        await win(game)
    assert record_of(data_dir).record(str(short)).state == "won"


@pytest.mark.slow
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_first_win_takes_few_keys(data_dir: Path, size: Size) -> None:
    file = shipped_folder("levels") / "01-first-steps.toml"
    starter = load_program("first-steps-starter").text
    pressed: list[str] = []

    async with opened(data_dir, level=file, text=starter, welcome=True, size=size) as game:

        async def press(*keys: str, **awaited: Any) -> None:
            pressed.extend(keys)
            await game.press(*keys, **awaited)

        await game.ready()
        await game.sees("1 of 4")
        await game.press("enter", "enter", "enter", "enter", until=lambda: not game.shows("4 of 4"))
        game.session.pace.speed = FLAT_OUT

        await press("space", sees="Ada is stuck")
        await press("r", sees="Try first: change")
        await press("2", until=lambda: game.editor.has_focus)
        editor = game.editor
        while not editor.get_line(editor.cursor_location[0]).plain.endswith("distance < 1"):
            await press("down")
        await press("end", "backspace", "6", "0", "ctrl+r")
        await game.until(lambda: "distance < 60" in (game.session.state.applied or ""))
        await press("escape", "space", on=ResultsDialog)
        assert game.session.won_at is not None
    assert len(pressed) <= 14, pressed
