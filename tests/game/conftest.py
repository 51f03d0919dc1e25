"""Games to play with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.game.playing import game
from tests.virtual_time import VirtualClock, VirtualLoop

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from pathlib import Path

    from logical_robots_tui.game import Game


def pytest_asyncio_loop_factories() -> dict[str, type[VirtualLoop]]:
    return {"virtual": VirtualLoop}


@pytest.fixture
async def hall_game(tmp_path: Path) -> AsyncIterator[Game]:
    made = game(tmp_path, clock=VirtualClock())
    yield made
    await made.close()
