"""Games to play with."""

from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import Game
from logical_robots_tui.mind import Program
from logical_robots_tui.world import Level
from tests.game.playing import COUNTER, Play, hall
from tests.virtual_time import VirtualClock, VirtualLoop


def pytest_asyncio_loop_factories() -> dict[str, type[VirtualLoop]]:
    return {"virtual": VirtualLoop}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("LOGICAL_ROBOTS_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache" / "runs"


@pytest.fixture
def level(tmp_path: Path) -> Level:
    return hall(tmp_path)


@pytest.fixture
async def game(play: Play) -> Game:
    return play(clock=VirtualClock())


@pytest.fixture
async def play(level: Level) -> AsyncIterator[Play]:
    games: list[Game] = []

    def open_game(program: str | Program = COUNTER, level: Level = level, **options: Any) -> Game:
        compiled = Program.compile(program) if isinstance(program, str) else program
        games.append(Game(level, compiled, **options))
        games[-1].pace.speed = None
        return games[-1]

    yield open_game
    for game in games:
        await game.close()
