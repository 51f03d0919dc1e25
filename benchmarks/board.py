"""The board: drawing the histogram of five hundred players, and entering a victory."""

from __future__ import annotations

import asyncio
import random
import tempfile
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from benchmarks.measure import Effort, Measurement, at_most, median_of, seconds_for, summed_up
from logical_robots_tui.cli.line_ui import LineText, LineUi, with_words
from logical_robots_tui.game import load_program
from logical_robots_tui.player.opening import LocalPlayer, Opening
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.progress import FILE_NAME, Measures
from logical_robots_tui.progress.board import Board, BoardMembership
from logical_robots_tui.tui.labyrinth.results import histogram_lines
from logical_robots_tui.world import load_level

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.victory import Victory

__all__ = ["boards"]

PLAYERS = 500
MOST_DRAW, MOST_ENTER = 30, 20  # milliseconds
MOST_TICKS, MOST_VICTORIES = 5_000, 5
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
        yield summed_up(
            "victory on a board",
            f"{subject}, from the victory to its entry",
            "ms",
            asyncio.run(_victories(folder, folder / "data", min(effort.repeats, MOST_VICTORIES))),
            target=at_most(MOST_ENTER),
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


class _TimedBoard(Board):
    """A board that notes when its last entry was committed."""

    committed = 0.0

    def add(self, *entry: Any) -> None:
        super().add(*entry)
        if entry[-1] is None:  # the run that others may race follows
            self.committed = perf_counter()


class _Victory(SessionListener):
    at = 0.0

    def won(self, victory: Victory) -> None:
        self.at = perf_counter()


async def _victories(folder: Path, data_dir: Path, repeats: int) -> list[float]:
    """Win the first level some times; return milliseconds from each victory to its entry."""
    board = _TimedBoard(folder, "winner")
    board.create()
    board.join(BoardMembership(is_listed=True, shares=True))
    program = load_program("first-steps")
    text = f"{program.text}\n# one's own"
    opening = Opening(load_level("01-first-steps"), {"": program}, data_dir, text=text, board=board)
    ui, recorder, victory = LineUi(), ProgressRecorder(data_dir / FILE_NAME), _Victory()
    player = LocalPlayer(opening, recorder, ui, LineText(), lambda: None, with_words)
    recorder.attach(ui, on_change=lambda: None, on_measured=lambda *_: None)
    player.session.listeners += [recorder, victory]
    player.start()
    player.session.apply(text)
    await ui.drain(skip="measure")
    durations = []
    for _ in range(repeats + 1):
        player.session.restart()
        player.session.run_until(MOST_TICKS)
        await ui.drain(skip="measure")
        durations.append(1000 * (board.committed - victory.at))
    await ui.close()
    await player.close()
    return durations[1:]  # the first victory of a game also loads what reads its code


def _enter(board: Board, chance: random.Random, turn: int) -> None:
    """Enter a victory with fewer ticks each turn, so that each is kept."""
    measures = Measures(10**6 - turn, chance.randint(20, 90), chance.uniform(300, 900))
    board.add("level", "level", "engine", f"{board.player} {turn}", measures, _GHOST)
