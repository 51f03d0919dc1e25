"""Levels, programs and games for the tests of this folder."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui import Game, Program
from logical_robots_tui.shipped import shipped_folder

if TYPE_CHECKING:
    from logical_robots_tui import Level

FARTHEST_SHIFT = 8.0  # units
WIDEST_TURN = 0.2  # radians


def program_text(name: str) -> str:
    return (shipped_folder("programs") / f"{name}.l").read_text("utf-8")


def shifted(level: Level, seed: int) -> Level:
    """Return the level with every robot's start moved and turned a little."""
    chance = random.Random(seed)
    robots = tuple(
        replace(
            robot,
            x=robot.x + chance.uniform(-FARTHEST_SHIFT, FARTHEST_SHIFT),
            y=robot.y + chance.uniform(-FARTHEST_SHIFT, FARTHEST_SHIFT),
            angle=robot.angle + chance.uniform(-WIDEST_TURN, WIDEST_TURN),
        )
        for robot in level.robots
    )
    return replace(level, robots=robots)


async def ticks_to_win(level: Level, text: str, ticks: int) -> int | None:
    """Return the tick of victory, or None if it isn't reached in so many ticks."""
    game = Game(level, Program.compile(text))
    try:
        return (await game.run_until(tick=ticks)).after.won_at
    finally:
        await game.close()
