"""Victories: what they count for, and how they compare with the reference programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from logical_robots_tui.game.source import reference_names, shipped_texts
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.progress import Bests, Measures
from logical_robots_tui.wording import count_of
from logical_robots_tui.world import Level
from logical_robots_tui.world.level import GoalKind, alike

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Program

FILE_NAME = "reference.csv"
_WHOLE = ("ticks", "size", "wins", "starts")
FIELDS = ("level", "program", "ticks", "size", "distance", "wins", "starts", "goals")


def is_shipped(level: Level) -> bool:
    if not level.source:
        return False
    return Path(level.source).resolve().parent == shipped_folder("levels").resolve()


def level_key(level: Level) -> str:
    """Return the key for progress at a level: its name, or the full path of a player's level."""
    return level.name if is_shipped(level) else str(Path(level.source or level.name).absolute())


def references_for(level: Level) -> Mapping[str, Measures]:
    """Return the measures of a level's reference programs by name, its solution first."""
    return reference_table().get(level.name, {}) if is_shipped(level) else {}


def reference_for(level: Level) -> Measures | None:
    return references_for(level).get(level.solution)


@lru_cache(maxsize=1)
def reference_table() -> Mapping[str, Mapping[str, Measures]]:
    import csv  # takes time that the first picture needs

    table: dict[str, dict[str, Measures]] = {}
    try:
        with (shipped_folder("levels") / FILE_NAME).open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                ticks, size, wins, starts = (int(row[name]) for name in _WHOLE)
                goals = tuple(filter(None, row["goals"].split("; ")))
                measures = Measures(ticks, size, float(row["distance"]), wins, starts, goals)
                table.setdefault(row["level"], {})[row["program"]] = measures
    except FileNotFoundError:
        return {}
    return table


Verdict: TypeAlias = Literal["counts", "reference", "clock", "edited"]

_REFUSALS: dict[Verdict, str] = {
    "clock": "A thought was ended by the clock on the way: this victory is not kept.",
    "edited": "The level was changed or a robot moved by hand: this victory is not kept.",
}


class Victory(NamedTuple):
    """A victory.

    Attributes:
        level: The level as in its file.
        program: The robots' last program, from the view of the player's team.
        tick: The tick of victory.
        verdict: ``counts``; won by a ``reference`` program; or not saved, because a time limit
            (``clock``) ended a thought or the level was ``edited``.
        measures: Its measures; None if other programs decided earlier ticks.
    """

    level: Level
    program: Program
    tick: int
    verdict: Verdict
    measures: Measures | None

    @property
    def refusal(self) -> str:
        return _REFUSALS.get(self.verdict, "")


def victory_of(game: Game, level: Level) -> Victory | None:
    """Return the victory at a game's current tick, or None; the level is as in its file."""
    tick, program, history = game.frame.tick, game.program.first, game.history
    if game.won_at != tick:
        return None
    verdict: Verdict = "counts"
    if not history.is_reliable_up_to(tick):
        verdict = "clock"
    elif not is_by_the_book(history, level, tick):
        verdict = "edited"
    elif is_reference(level, program.text):
        verdict = "reference"
    measures = None
    if all(p.texts == program.texts for _, p in history.programs(tick)):
        is_blocked = history.is_blocked_up_to(tick)
        measures = measures_of(level, program, tick, history.moment(tick).driven, is_blocked)
    return Victory(level, program, tick, verdict, measures)


def measures_of(
    level: Level, program: Program, ticks: int, distance: float, is_blocked: bool
) -> Measures:
    """Return the measures of a victory; the distance is map units of all robots together."""
    size = size_of(program.text)
    goal_values: dict[GoalKind, int] = {
        "tick": ticks,
        "symbol": size,
        "unit": round(distance),
        "blocked": int(is_blocked),
    }
    return Measures(ticks, size, distance, goals=tuple(reached_goals(level, goal_values)))


def reached_goals(level: Level, goal_values: Mapping[GoalKind, int]) -> Iterator[str]:
    """Yield the bonus goals that are reached, as far as what they limit was found."""
    for goal in level.second_goals:
        if goal.kind in goal_values and goal_values[goal.kind] <= goal.limit:
            yield goal.words


def is_reference(level: Level, text: str) -> bool:
    return any(text == shipped_texts().get(name) for name in reference_names(level.solution))


def is_by_the_book(history: History, level: Level, tick: int) -> bool:
    """Return whether the level matched its file in every tick up to this one."""
    return not history.is_changed_up_to(tick) and alike(history.level_at(0), level)


def robustness_line(level: Level, measures: Measures) -> str:
    return f"{level.title}: won from {measures.wins} of {measures.starts} varied starts."


def result_line(level: Level, measures: Measures) -> str:
    ticks, size = count_of(measures.ticks, "tick"), count_of(measures.size, "symbol")
    line = f"Logical Robots · {level.title} · {ticks} · {size}"
    line += f" · {measures.distance:,.0f} units driven"
    if measures.wins is not None:
        line += f" · {measures.wins} of {measures.starts} starts"
    return line


def brief(bests: Bests | Measures, width: int = 100) -> str:
    """Return results in one line; the distance is left out where the line is too narrow."""
    if bests.ticks is None or bests.size is None or bests.distance is None:
        return ""
    size = [count_of(bests.ticks, "tick"), f"size {bests.size}"]
    wins = [] if bests.wins is None else [f"{bests.wins}/{bests.starts}"]
    line = " · ".join([*size, f"{bests.distance:,.0f} units", *wins])
    return line if len(line) <= width else " · ".join([*size, *wins])
