"""The cost of hostile input: memory of hungry programs, time and memory to read level files."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, Target, at_most, need, summed_up
from tests.game.test_memory import HUNGRY, MOST, SCREEN, played
from tests.mind.rows import ROBOT
from tests.world.hostile import FILES
from tests.world.test_hostile import BYTES, read

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["memory"]

LEVEL, TICKS = "01-first-steps", 130
SECONDS = 2.0  # of a processor, for each level file


def memory(effort: Effort) -> Iterator[Measurement]:
    """Measure peak memory of a game without a screen, and the worst hostile level file."""
    need("/proc", Path("/proc/self/status").exists())
    for what, rule in HUNGRY.items():
        kibibytes, _ = played(LEVEL, ROBOT + rule + ";", min(TICKS, effort.ticks))
        target = at_most(round((MOST - SCREEN) * 1024 / 1e6))
        yield _one("hungry programs", f"{LEVEL}, {what}", kibibytes, target)
    with tempfile.TemporaryDirectory() as folder:
        told = read([*FILES], Path(folder))
    of_all = f"worst of {len(FILES)} files"
    slowest = max(seconds for _, seconds, _ in told)
    yield summed_up("reading a level", of_all, "s", [slowest], target=at_most(SECONDS))
    most = max(grown for *_, grown in told)
    yield _one("reading a level", of_all, most, at_most(round(BYTES * 1024 / 1e6)))


def _one(group: str, subject: str, kibibytes: int, target: Target) -> Measurement:
    return summed_up(group, subject, "MB", [kibibytes * 1024 / 1e6], target=target)
