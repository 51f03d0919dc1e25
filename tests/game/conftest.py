"""Games to play with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.game.playing import game

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from logical_robots_tui.game import Game


@pytest.fixture
async def hall_game(tmp_path: Path) -> AsyncIterator[Game]:
    made = game(tmp_path)
    yield made
    await made.close()
