"""Looking whether the file of a program has changed."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from logical_robots_tui.game import Source, load_program
from logical_robots_tui.tui.program.controller import FileWatch
from tests.tui.conftest import PAPER, STILL, opened, source_of
from tests.virtual_time import Hold

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_a_change_before_the_first_look_is_noticed_once(tmp_path: Path) -> None:
    source = source_of(PAPER, tmp_path)
    source.path.write_text(STILL)
    watch = FileWatch(lambda: source, lambda _: None)
    found = watch.newer(source)
    assert found is not None
    assert found.text == STILL
    assert watch.newer(source) is None
    assert watch.newer(found) is None
    source.path.unlink()
    assert watch.newer(found) is None


async def test_the_disk_is_not_waited_for(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hold = Hold()

    def slowly(path: Path) -> Source:
        if path.read_text() == STILL:
            hold.here()
        return load_program(path)

    monkeypatch.setattr("logical_robots_tui.tui.program.controller.load_program", slowly)
    async with opened(data_dir) as game:
        await game.ready()
        game.session.source.path.write_text(STILL)
        try:
            await game.until(lambda: hold.has_begun)
            await game.press("n")
            await game.until(lambda: game.tick == 1)
            assert game.editor.text == PAPER
        finally:
            hold.release()
        await game.until(lambda: game.editor.text == STILL)


async def test_a_program_that_was_left_meanwhile_does_not_come_back(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hold, looked = Hold(), threading.Event()
    other = source_of(STILL, data_dir / "programs", "other")

    def slowly(path: Path) -> Source:
        found = load_program(path)
        if path == other.path:
            looked.set()
        elif found.text != PAPER:
            hold.here()
        return found

    monkeypatch.setattr("logical_robots_tui.tui.program.controller.load_program", slowly)
    async with opened(data_dir) as game:
        await game.ready()
        game.session.source.path.write_text(f"{PAPER}\n")
        try:
            await game.until(lambda: hold.has_begun)
            game.main.library.open_program(other)
        finally:
            hold.release()
        await game.until(looked.is_set)
        assert game.editor.text == STILL
        assert game.session.source.path == other.path
