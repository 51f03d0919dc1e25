"""The labyrinth of the day on the screen, and a result in words."""

from datetime import date
from pathlib import Path

import pytest

from logical_robots_tui.game.victory import result_line
from logical_robots_tui.progress import Measures
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.world import load_level
from tests.tui.conftest import opened


async def test_today_s_labyrinth_is_opened_in_the_chosen_size_or_not(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        before = game.session.level
        today = f"daily-{date.today().isoformat()}-small"
        game.main.recorder.progress.set_fact(f"won {today}", "900")
        for key in ("escape", "s"):
            assert game.session.level is before
            game.main.run_worker(game.main.library.open_daily())
            await game.until(lambda: isinstance(game.app.screen, QuestionDialog))
            await game.press(key, until=lambda: game.app.screen is game.main)
        await game.until(lambda: game.session.level.name == today)
        await game.sees("Everybody has this labyrinth today.")


@pytest.mark.parametrize(
    ("measures", "line"),
    [
        (Measures(1258, 2, 971.4), "1,258 ticks · 2 symbols · 971 units driven"),
        (Measures(31, 1, 15.5, 19, 20), "31 ticks · 1 symbol · 16 units driven · 19 of 20 starts"),
    ],
)
def test_a_result_is_one_line(measures: Measures, line: str) -> None:
    whole = f"Logical Robots · First steps · {line}"
    assert result_line(load_level("01-first-steps"), measures) == whole
