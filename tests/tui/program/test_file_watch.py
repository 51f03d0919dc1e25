"""Looking whether the file of a program has changed."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from logical_robots_tui.game import Source, load_program
from logical_robots_tui.tui.program.controller import FileWatch
from tests.tui.conftest import PAPER, STILL, opened, source_of
from tests.virtual_time import Hold


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


async def test_a_file_that_changes_on_disk_is_applied_unless_something_else_was_typed(
    data_dir: Path,
) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        path = game.session.source.path
        path.write_text(STILL)
        await game.until(lambda: game.editor.text == game.session.state.applied == STILL)
        await game.press("2", "ctrl+home", "x")
        path.write_text("x" + STILL)  # it counts as saved
        await game.until(lambda: game.session.source.text == "x" + STILL)
        await game.handled()
        await game.sees_no("has changed on disk")
        await game.press("y")
        await game.until(lambda: game.editor.text == "xy" + STILL)
        path.write_text(PAPER)
        await game.sees("has changed on disk")
        assert game.editor.text == "xy" + STILL


async def test_the_disk_is_not_waited_for_and_what_comes_late_changes_nothing(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, looked = Hold(), Hold(), threading.Event()
    holds = {STILL: first, f"{STILL}\n": second}
    other = source_of(PAPER, data_dir / "programs", "other")

    def slowly(path: Path) -> Source:
        source = load_program(path)
        if path == other.path:
            looked.set()
        elif source.text in holds:
            holds[source.text].here()
        return source

    monkeypatch.setattr("logical_robots_tui.tui.program.controller.load_program", slowly)
    async with opened(data_dir) as game:
        await game.ready()
        path = game.session.source.path
        path.write_text(STILL)
        try:
            await game.until(lambda: first.has_begun)
            await game.press("n")
            await game.until(lambda: game.tick == 1)
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
        assert game.editor.text == PAPER
        assert game.session.source.path == other.path
