"""Pictures and recordings of the screen."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cast import events_of, played
from tests.tui.conftest import STILL, opened


def trimmed(lines: list[str]) -> list[str]:
    return [line.rstrip() for line in lines]


async def test_the_screen_is_saved_and_recorded(data_dir: Path) -> None:
    folder = data_dir / "screens"
    async with opened(data_dir, text=STILL, size=(100, 30)) as game:
        await game.ready()
        await game.press("ctrl+p")
        await game.until(lambda: game.shows("Find a command"))
        await game.press(*"screenshot", "enter")
        await game.until(lambda: len(list(folder.glob("*"))) == 2)
        (text,) = folder.glob("*.txt")
        assert "LOGICAL ROBOTS" in text.read_text("utf-8")
        assert "Find a command" not in text.read_text("utf-8")
        (picture,) = folder.glob("*.svg")
        assert picture.read_text("utf-8").startswith("<svg")

        game.main.action_command("record")
        await game.press("n", "question_mark")
        await game.until(lambda: game.tick == 1 and game.shows("esc close"))
        (film,) = folder.glob("*.cast")
        await game.until(
            lambda: trimmed(played(film).display) == trimmed(game.screen().splitlines())
        )
        await game.press("escape", "n")
        await game.pilot.resize_terminal(90, 28)
        await game.until(lambda: game.tick == 2 and any(e[1] == "r" for e in events_of(film)[1]))
        game.main.action_command("record")
        await game.until(lambda: game.shows("Recorded into"))
        assert played(film).columns == 90
        size = film.stat().st_size
        await game.press("n")
        await game.until(lambda: game.tick == 3)
        assert film.stat().st_size == size


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full disk to write to")
async def test_a_recording_ends_with_the_room_on_the_disk_and_the_game_goes_on(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with opened(data_dir, text=STILL, size=(100, 30)) as game:
        await game.ready()
        monkeypatch.setattr(game.main.capture, "_new_file", lambda _ending: Path("/dev/full"))
        game.main.action_command("record")
        await game.until(lambda: game.shows("The recording ended: No space left"))
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        game.main.action_command("record")
        game.main.action_command("record")  # before anything but the head is written
        await game.until(lambda: game.screen().count("The recording ended") == 2)
