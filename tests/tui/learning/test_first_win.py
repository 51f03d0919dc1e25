"""The first win, as a new player comes to it: by the tour, the README and the briefing."""

from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game.pace import FLAT_OUT
from logical_robots_tui.game.source import load_program
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.labyrinth.results import ResultsDialog
from tests.tui.conftest import Size, opened


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
