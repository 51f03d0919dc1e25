"""The board: drawing the histogram of five hundred players, and entering a victory."""

from __future__ import annotations

import random
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, median_of, seconds_for
from logical_robots_tui.progress import Measures
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.tui.labyrinth.results import histogram_lines

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["boards"]

PLAYERS = 500
MOST_DRAW, MOST_ENTER = 30, 20  # milliseconds
_GHOST = bytes(7_000)


def boards(effort: Effort) -> Iterator[Measurement]:
    """Measure milliseconds to read and draw the histogram, and to enter a victory."""
    chance = random.Random(59)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(PLAYERS):
            board = Board(folder, f"player-{number}")
            board.create()
            board.join(BoardMembership(is_listed=True, name=f"Player {number}", shares=True))
            _enter(board, chance, 0)
        subject = f"{PLAYERS} players"
        yield median_of(
            "histogram of a board",
            f"{subject}, read and drawn",
            "ms",
            effort.repeats,
            lambda: 1000 * seconds_for(lambda: list(histogram_lines(board.standings("level")))),
            target=at_most(MOST_DRAW),
        )
        turns = iter(range(1, 10**6))
        yield median_of(
            "victory on a board",
            f"{subject}, entered",
            "ms",
            effort.repeats,
            lambda: 1000 * seconds_for(lambda: _enter(board, chance, next(turns))),
            target=at_most(MOST_ENTER),
        )


def _enter(board: Board, chance: random.Random, turn: int) -> None:
    """Enter a victory with fewer ticks each turn, so that each is kept."""
    measures = Measures(10**6 - turn, chance.randint(20, 90), chance.uniform(300, 900))
    board.add("level", "level", "engine", f"{board.player} {turn}", measures, _GHOST)
