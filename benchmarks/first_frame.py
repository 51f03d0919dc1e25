"""The time to the first picture, in a real pseudo-terminal."""

from __future__ import annotations

import sys
import tempfile
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, ratio_of_bests, repeated, summed_up
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["first_frame"]

SIZES = ((80, 24), (120, 40))
MINIMAL = """
from textual.app import App
from textual.widgets import Static

class Minimal(App):
    def compose(self):
        yield Static("a minimal picture")

Minimal().run()
"""
"""A minimal Textual app, as a lower bound."""


def first_frame(effort: Effort) -> Iterator[Measurement]:
    """Measure the milliseconds from starting the process to the picture and to a ready program.

    Each round also measures a minimal Textual app, so that other load on the machine slows both.
    """
    for size in SIZES[: 1 if effort.is_quick else None]:
        subject = f"{size[0]}x{size[1]}"
        least, picture, ready = zip(*repeated(effort.repeats, partial(_round, size)), strict=True)
        for event, found, target in (
            ("minimal Textual app", least, None),
            ("first picture", picture, at_most(600)),
            ("program ready", ready, None),
        ):
            yield summed_up(event, subject, "ms", found, target=target, value=min)
        yield ratio_of_bests(
            "first picture / minimal app", subject, "times", picture, least, target=at_most(1.7)
        )


def _round(size: tuple[int, int]) -> tuple[float, float, float]:
    """Return the milliseconds to the minimal app, to the game's picture and to its program."""
    (least,) = _milliseconds([sys.executable, "-c", MINIMAL], size, "a minimal picture")
    with tempfile.TemporaryDirectory() as data_dir:
        game = [sys.executable, "-m", "logical_robots_tui", "play", "--data-dir", data_dir]
        picture, ready = _milliseconds(game, size, "tick 0", "· applied")
    return least, picture, ready


def _milliseconds(command: Sequence[str], size: tuple[int, int], *seen: str) -> list[float]:
    """Return the times from starting a command until each text is on the screen."""
    began = perf_counter()
    with Terminal(command, size=size) as terminal:
        return [1000 * (_arrival(terminal, text) - began) for text in seen]


def _arrival(terminal: Terminal, text: str) -> float:
    return terminal.arrival_of(lambda: text in terminal.text)
