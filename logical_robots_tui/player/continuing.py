"""Where a player continues: the position in a game, the last level and program."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.pace import SPEEDS
from logical_robots_tui.game.source import Source, programs_for, shipped_texts
from logical_robots_tui.game.victory import level_key
from logical_robots_tui.progress import Progress
from logical_robots_tui.records import record, texts_of
from logical_robots_tui.world import Level, LevelError, list_levels, load_level

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.world.levels.labyrinths import DailySize

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
    from logical_robots_tui.game.measuring import LateError, play_through
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
    progress: Progress, level: Level, names: Sequence[str], by_team: Mapping[str, str], own: Path
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
