"""Where a player continues: the position in a game, the last level and program."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import programs_for, shipped_texts
from logical_robots_tui.game.victory import level_key
from logical_robots_tui.records import record, texts_of
from logical_robots_tui.world import LevelError, list_levels, load_level

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from datetime import date
    from pathlib import Path

    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.source import Source
    from logical_robots_tui.progress import Progress
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.levels.labyrinths import DailySize


FLAT_OUT: float | None = None
"""The speed "as fast as possible"."""

SPEEDS: tuple[float | None, ...] = (1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, FLAT_OUT)
"""Available speeds in ticks per second, slowest first."""

_WAY_SECONDS = 0.03  # that a game at full speed pauses after a key press

_LOT = 1 / 30  # seconds of ticks that are computed in one batch on an idle machine
_LONGEST_LOT = 0.1  # and at most

_WINDOW = 1.0  # seconds over which the achieved speed is measured


class Pace:
    """Keeps `Game.run` at a target number of ticks per second and measures the actual one.

    `spacing` is the seconds to leave to others between two batches of ticks. Batches grow with
    it up to a tenth of a second; beyond that the game gets slower.
    """

    def __init__(self, speed: float | None = 40.0, clock: Clock = CLOCK) -> None:
        self._clock = clock
        self.spacing = 0.0
        self._speed = speed
        self._computed = 0  # ticks since the last wait
        self._due = 0.0
        self._free_at = 0.0
        self._times: deque[float] = deque()
        self._changed = asyncio.Event()

    @property
    def speed(self) -> float | None:
        """Target ticks per second; None means full speed."""
        return self._speed

    @speed.setter
    def speed(self, speed: float | None) -> None:
        self._speed = speed
        self._begin()
        self.wake()

    @property
    def achieved(self) -> float:
        """Ticks per second over the last second, 0.0 when nothing ran."""
        self._forget_old(self._clock.now())
        if len(self._times) < 2:
            return float(len(self._times))
        span = self._times[-1] - self._times[0]
        return (len(self._times) - 1) / span if span > 0 else 0.0

    @property
    def period(self) -> float:
        """Seconds from tick to tick, including idle time; 0.0 at full speed."""
        return 1 / self._speed + self.spacing if self._speed else 0.0

    @property
    def together(self) -> int | None:
        """The number of ticks per batch; None means as many as time allows."""
        if self._speed is None:
            return None
        return max(1, int(self._speed * min(self._lot, _LONGEST_LOT)))

    def faster(self) -> None:
        self._move(1)

    def slower(self) -> None:
        self._move(-1)

    def start(self) -> None:
        self._begin()
        self._times.clear()

    def stop(self) -> None:
        self._times.clear()

    def count(self) -> None:
        now = self._clock.now()
        self._computed += 1
        self._times.append(now)
        self._forget_old(now)

    def give_way(self) -> None:
        """Pause briefly at full speed or on a busy machine, so that other threads get a turn."""
        self._free_at = self._clock.now() + _WAY_SECONDS + self.spacing

    def wake(self) -> None:
        self._changed.set()

    async def wait(self) -> None:
        """Wait until the next ticks are due; a game that is too slow doesn't catch up."""
        if self._speed is None:
            await asyncio.sleep(max(self._free_at - self._clock.now(), 0))
            return
        now = self._clock.now()
        rest = self._lot if self._lot > _LONGEST_LOT else 0.0
        self._due = max(self._due + max(self._computed / self._speed, rest), now)
        if self.spacing:
            self._due = max(self._due, self._free_at)
        self._computed = 0
        self._changed.clear()
        try:
            async with asyncio.timeout(self._due - now):
                await self._changed.wait()
        except TimeoutError:
            pass

    def _begin(self) -> None:
        self._due, self._computed = self._clock.now(), 0

    @property
    def _lot(self) -> float:
        return _LOT + self.spacing

    def _move(self, steps: int) -> None:
        at = SPEEDS.index(self._speed) if self._speed in SPEEDS else 0
        self.speed = SPEEDS[max(0, min(at + steps, len(SPEEDS) - 1))]

    def _forget_old(self, now: float) -> None:
        while self._times and self._times[0] < now - _WINDOW:
            self._times.popleft()


_LAST_LEVEL = "level"

_PROVING = "the-long-hall"  # follows a wall, which leads everywhere where there are no loops
_TICKS_PER_CELL = 250
_MOST_DAILIES = 9


def level_to_begin_with(progress: Progress) -> Level:
    """Return the level played last, or the first one; raise InputError if levels are missing."""
    names = list_levels()
    if not names:
        raise InputError("The levels are missing from this installation.", hint="Install it again.")
    last = progress.fact(_LAST_LEVEL)
    if last is not None:
        with suppress(LevelError):  # it was deleted, broken, or renamed in a newer version
            return load_level(last)
    return load_level(names[0])


def note_level(progress: Progress, level: Level) -> None:
    """Record the level opened last, if it has a file."""
    if level.source:
        progress.set_fact(_LAST_LEVEL, level_key(level))


def daily_level(progress: Progress, day: date, size: DailySize) -> Level:
    """Return the labyrinth of a day, shown to be winnable, or raise InputError."""
    from logical_robots_tui.game.robustness import LateError, play_through
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world.levels.labyrinths import Daily

    program: Program | None = None
    for number in range(1, _MOST_DAILIES + 1):
        daily = Daily(day, size, number)
        level = load_level(daily.name)
        fact = f"won {daily.name}"
        if progress.fact(fact) is not None:
            return level
        program = program or Program.compile(shipped_texts()[_PROVING])
        try:
            played = play_through(level, program, _TICKS_PER_CELL * daily.cells)
        except LateError:
            message = "This machine is too busy to check that the labyrinth can be won."
            raise InputError(message, hint="Try again.") from None
        if played.won_at is not None:
            progress.set_fact(fact, str(played.won_at))
            return level
    raise InputError(f"No {size} labyrinth of {day.isoformat()} can be won.")


def programs_to_begin_with(
    progress: Progress,
    level: Level,
    names: Sequence[str],
    by_team: Mapping[str, str],
    own: Path,
) -> tuple[dict[str, Source], str | None]:
    """Return the programs to open, by team, and the player's last text of the first.

    `names` follow the order of the teams; by default the usual ones. In a level without teams
    the program is that of "". Raises InputError.
    """
    sources = programs_for(level, names, by_team, own)
    mine = next(iter(sources) if names or not by_team else iter(by_team))
    goes_on = not (names or by_team) and bool(level.starter)
    text = progress.newest(level_key(level)) if goes_on else None
    return {mine: sources[mine]} | sources, text


def keep_if_own(progress: Progress, key: str, text: str) -> None:
    if text not in shipped_texts().values():
        progress.keep(key, text)


@dataclass(frozen=True, slots=True)
class Place:
    """A tick, and how to get there: same level, same programs, same ticks.

    Attributes:
        level: Name of a shipped level, otherwise the path of its file.
        title: The level's title.
        program: Name of the last program if it is a shipped one, otherwise the path of its file.
        tick: Number of the tick, at least 1.
        programs: The first tick that programs decided, and their texts, in order.
        speed: The speed in ticks per second; None is full speed.
    """

    level: str
    title: str
    program: str
    tick: int
    programs: tuple[tuple[int, Mapping[str, str]], ...]
    speed: float | None = 40.0

    def as_text(self) -> str:
        return json.dumps(asdict(self), ensure_ascii=False)

    @classmethod
    def from_text(cls, text: str) -> Place:
        """Parse a place, or raise ValueError."""
        try:
            found = json.loads(text)
            found["programs"] = [
                [begin, texts_of(texts) if isinstance(texts, str) else texts]
                for begin, texts in found["programs"]
            ]
            if found.get("speed") not in SPEEDS:
                del found["speed"]
            place = record(cls, found)
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError("this is not a place in a game") from error
        begins = [begin if texts else 0 for begin, texts in place.programs]
        if begins[:1] != [1] or begins != sorted(set(begins)) or begins[-1] > place.tick:
            raise ValueError("the programs of this place are out of order")
        return place

    def stretches(self) -> list[tuple[Mapping[str, str], int]]:
        ends = [begin - 1 for begin, _ in self.programs[1:]]
        texts = (texts for _, texts in self.programs)
        return list(zip(texts, [*ends, self.tick], strict=True))


def place_of(game: Game, level: Level, source: Source) -> Place | None:
    """Return the position of a game; None at the start, or if the level was edited on the way."""
    history, tick = game.history, game.frame.tick
    if tick == 0 or history.level_at(0) is not level or history.is_changed_up_to(tick):
        return None
    programs = tuple((begin, program.texts) for begin, program in history.programs(tick))
    program = source.name if source.shipped else str(source.path)
    return Place(level_key(level), level.title, program, tick, programs)
