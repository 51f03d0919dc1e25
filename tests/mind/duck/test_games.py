"""A game goes the same with either engine."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

from logical_robots_tui import Game, list_levels, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.mind import Program
from tests.mind.rows import nearly_same

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Engine

LEVEL = next(name for name in list_levels() if name.endswith("everybody-home"))
TICKS = 40


async def played(program: Program, wanted: Engine) -> list[Frame]:
    """The frames of some ticks, after a step back half way."""
    game = Game(load_level(LEVEL), program, engine=wanted)
    try:
        await game.run_until(tick=TICKS // 2, condition=lambda _: False)
        game.back()
        await game.run_until(tick=TICKS, condition=lambda _: False)
        assert (await game.query("Robot", game.frame)).table.rows
        return [game.frame_at(tick) for tick in range(TICKS + 1)]
    finally:
        await game.close()


async def test_a_game_goes_the_same_with_duckdb(answered: Callable[[], int]) -> None:
    program = Program.compile(load_program("everybody-home").text)
    ours, theirs = [await played(program, wanted) for wanted in ("sqlite", "duckdb")]
    assert answered() == TICKS
    for one, other in zip(ours, theirs, strict=True):
        assert nearly_same(asdict(other.after), asdict(one.after))
        assert [d.notices for d in other.decisions] == [d.notices for d in one.decisions]
    assert await played(program, "duckdb") == theirs
