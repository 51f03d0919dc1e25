"""Steps of a test of the screen: keys, and what follows from them."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from tests.tui.conftest import Opened, opened

__all__ = ["pressed", "run_until", "sees_all", "started"]


@asynccontextmanager
async def started(data_dir: Path, **options: Any) -> AsyncIterator[Opened]:
    """Open the game, and wait until its first program is compiled."""
    async with opened(data_dir, **options) as game:
        await game.ready()
        yield game


async def pressed(
    game: Opened,
    *keys: str,
    tick: int | None = None,
    sees: str | tuple[str, ...] = "",
    on: type | None = None,
    until: Callable[[], object] = lambda: True,
) -> None:
    """Press keys, and wait for what follows: a tick, words, a screen, or something else."""
    await game.press(*keys)
    texts = (sees,) if isinstance(sees, str) else sees
    await game.until(
        lambda: (
            (tick is None or game.tick == tick)
            and (on is None or isinstance(game.app.screen, on))
            and until()
            and all(map(game.shows, texts))
        )
    )


async def sees_all(game: Opened, *texts: str) -> None:
    """Wait until the screen shows several texts at once."""
    await game.until(lambda: all(map(game.shows, texts)))


async def run_until(game: Opened, tick: int) -> None:
    """Let the robots run to a tick, without a look at the ticks before."""
    game.session.run_until(tick)
    await game.until(lambda: game.tick == tick and not game.session.busy)
