"""The inspector: milliseconds from a step to its rows on the screen, for every third predicate."""

from __future__ import annotations

import re
import statistics
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, summed_up
from benchmarks.subjects import LARGEST, solution_of
from benchmarks.with_screen import SIZE, opened
from logical_robots_tui import load_level

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.terminal import Terminal

__all__ = ["inspector"]

DOWN = "\x1b[B"
STEPS = 3  # for each predicate
QUIET = 0.15  # seconds without output, after which a paused game has nothing more to say


def inspector(effort: Effort) -> Iterator[Measurement]:
    """Measure a step with the inspector on predicates of the largest program, and on Why."""
    program = load_level(LARGEST).solution
    predicates = solution_of(LARGEST).predicates
    names = [p.name for p in predicates if p.has_rows][:: 9 if effort.is_quick else 3]
    found: dict[str, list[float]] = {}
    with opened(LARGEST, program) as terminal:
        terminal.send("3")
        tick = 0
        for name in ("Why", *names):
            _go_down_to(terminal, name)
            for _ in range(STEPS):
                tick += 1
                found.setdefault(name, []).append(_step(terminal, name, tick))
    subject = f"{SIZE[0]}x{SIZE[1]}, {LARGEST}"
    reasons = found.pop("Why")
    medians = {name: statistics.median(times) for name, times in found.items()}
    slowest = max(medians, key=lambda name: medians[name])
    yield summed_up("step to rows", subject, "ms", [*medians.values()], target=at_most(50))
    subject_of_one = f"{subject}, {slowest}, the slowest"
    yield summed_up("step to rows", subject_of_one, "ms", found[slowest], target=at_most(50))
    yield summed_up("step to why", f"{subject}, Robot", "ms", reasons, target=at_most(50))


def _go_down_to(terminal: Terminal, name: str) -> None:
    """Move down in the list until a choice is inspected."""
    while (before := _inspected(terminal)) != name:
        terminal.send(DOWN)
        terminal.wait_for(lambda: _inspected(terminal) != before)


def _inspected(terminal: Terminal) -> str:
    """Return the title in the first line of the inspector, or that line if it has none."""
    line = terminal.text.partition("─ Inspector ")[2].split("\n")[1]
    title = re.search(r"(\w+) · tick", line)
    return title[1] if title else line


def _step(terminal: Terminal, name: str, tick: int) -> float:
    """Milliseconds from the key to the rows of the next tick."""
    terminal.wait_for_quiet(QUIET)
    began = perf_counter()
    terminal.send("n")
    there = rf"\b{name} · tick {tick}\b"
    return 1000 * (terminal.arrival_of(lambda: re.search(there, terminal.text)) - began)
