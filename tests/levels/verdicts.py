"""Verdicts: what becomes of a level under a program, played once for all tests that ask.

A verdict depends on the level with its start, on the program and on the code that plays, so these
name it. Verdicts lie in the folder of compiled programs, where a quick run finds those of the run
before; ``--all`` empties that folder first, and so plays everything.
"""

import hashlib
import json
from pathlib import Path
from typing import Any, NamedTuple

from logical_robots_tui import Level, Program
from logical_robots_tui.caching import CacheFolder, cache_place, digest_of_code
from logical_robots_tui.game import Frame
from logical_robots_tui.game.advancing import start_frame
from logical_robots_tui.game.history.marks import Rounds
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.game.run import run_key
from logical_robots_tui.mind import Limits, Mind
from logical_robots_tui.world.dynamics import points

LARGEST = 10_000  # bytes of a verdict, with the names of a swarm
MOST, MOST_BYTES = 4_000, 4_000_000
HERE = digest_of_code([Path(__file__)], ())


class Verdict(NamedTuple):
    """How a run ended: with a victory, where it repeats itself for ever, or out of patience."""

    ticks: int
    won_at: int | None
    distance: float
    is_blocked: bool
    circling: tuple[str, ...]
    """Robots that went round in circles at some time."""
    repeats: bool
    notices: dict[str, int]
    """What was remarked of decisions: each kind, and its first tick."""
    points: tuple[float, ...]
    """What each team has at the end of a match, rounded as the screen does."""

    def noticed(self, ticks: int) -> set[str]:
        """The kinds of what was remarked in the first ticks."""
        return {kind for kind, first in self.notices.items() if first <= ticks}

    def answers(self, ticks: int) -> bool:
        """Whether more ticks than were played say nothing new about so many."""
        return self.won_at is not None or self.repeats or self.ticks >= ticks


def verdict(level: Level, program: Program, ticks: int) -> Verdict:
    """What becomes of a level in so many ticks at least, or until it is decided."""
    name = key_of(level, program)
    kept = read(name)
    if kept is None or not kept.answers(ticks):
        kept = play(level, program, ticks)
        text = json.dumps(kept).encode()
        folder().keep(name, [hashlib.sha256(text).hexdigest().encode(), text])
    return kept


def folder() -> CacheFolder:
    return CacheFolder(cache_place("verdicts", subfolder="verdicts"), ".json", MOST, MOST_BYTES)


def key_of(level: Level, program: Program) -> str:
    """The name of a verdict: a digest of all that it depends on, but for the ticks."""
    return hashlib.sha256(HERE + run_key(level, program, Limits()).encode()).hexdigest()


def read(name: str) -> Verdict | None:
    content = folder().read(name, LARGEST) or b""
    digest, text = content[:64], content[64:]
    if hashlib.sha256(text).hexdigest().encode() != digest:
        return None
    parts = [tuple(part) if isinstance(part, list) else part for part in json.loads(text)]
    return Verdict._make(parts)


def play(level: Level, program: Program, ticks: int) -> Verdict:
    rounds, circling, notices = Rounds(), 0, dict[str, int]()
    repetition = Repetition(level, program)
    last = start_frame(level)

    def is_over(frame: Frame, _mind: Mind) -> bool:
        nonlocal circling, last
        circling |= rounds.follow(frame.after.robots)
        for kind in (notice.kind for each in frame.decisions for notice in each.notices):
            notices.setdefault(kind, frame.tick)
        last = frame
        return repetition.is_reached(frame)

    played = play_through(level, program, ticks, is_over=is_over)
    return Verdict(
        played.ticks,
        played.won_at,
        played.distance,
        played.is_blocked,
        tuple(robot.name for i, robot in enumerate(level.robots) if circling >> i & 1),
        played.won_at is None and played.ticks < ticks,
        notices,
        tuple(round(sum(parts), 2) for parts in points(level, last.after).values()),
    )


class Repetition:
    """Notices that the state of an earlier tick is there again, from which all happens again.

    That is so unless the time counts: in a match, or where a program reads the clock. Each tick is
    compared with the one before, which is the same where all stand in front of walls, and with an
    earlier one.
    """

    MOST_TICKS = 256  # to the earlier one

    def __init__(self, level: Level, program: Program) -> None:
        tuned = program.tuned.get("Robot")
        reads = {"clock"} if tuned is None else {*tuned.columns.get("Sensor", ())}
        self._counts_time = not reads.isdisjoint({"clock", "sensor"}) or bool(level.match_ticks)
        self._before: Any = None
        self._earlier: Any = None
        self._next = 1

    def is_reached(self, frame: Frame) -> bool:
        if self._counts_time:
            return False
        state = frame.after.robots, frame.after.areas, frame.memories
        # What is equal may yet be another value, as are 1 and true.
        if any(
            state == past and repr(state) == repr(past) for past in (self._before, self._earlier)
        ):
            return True
        if frame.tick >= self._next:
            self._earlier, self._next = state, frame.tick + min(frame.tick, self.MOST_TICKS)
        self._before = state
        return False
