"""Steps of a test of the screen: keys, and what follows from them."""

from collections.abc import Callable

from tests.tui.conftest import Opened

__all__ = ["pressed", "run_until"]


async def pressed(
    game: Opened,
    *keys: str,
    tick: int | None = None,
    sees: str = "",
    on: type | None = None,
    until: Callable[[], object] = lambda: True,
) -> None:
    """Press keys, and wait for what follows: a tick, words, a screen, or something else."""
    await game.press(*keys)
    await game.until(
        lambda: (
            (tick is None or game.tick == tick)
            and (on is None or isinstance(game.app.screen, on))
            and until()
            and (not sees or game.shows(sees))
        )
    )


async def run_until(game: Opened, tick: int) -> None:
    """Let the robots run to a tick, without a look at the ticks before."""
    game.session.run_until(tick)
    await game.until(lambda: game.tick == tick and not game.session.busy)
