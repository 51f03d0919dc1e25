"""``logical-robots run``: run a program in a level without a screen."""

from __future__ import annotations

import argparse
import asyncio
import json
import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import (
    UNRELIABLE,
    Commands,
    columns,
    finite,
    harmless,
    named_programs,
    prefers_json,
)
from logical_robots_tui.cli.runs.common import new_run_command, open_run, progress_bar

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

WON, NOT_WON = 0, 1
DEFAULT_TICKS = 5000
SAMPLE = 10  # notices reported in full


def declare(commands: Commands) -> None:
    command = new_run_command(
        commands, "run", start, ticks=(DEFAULT_TICKS, "give up after this many ticks")
    )
    command.add_argument("--times", action="store_true", help="include times in the JSON output")


def start(options: argparse.Namespace) -> int:
    """run a program in a level without a screen

    Run a program in a level without a screen, as fast as possible.

    examples:
      logical-robots run 01-first-steps first-steps            print the result
      logical-robots run 01-first-steps first-steps --json     print it as JSON
      logical-robots run 01-first-steps first-steps | jq .won  piped output is JSON
      logical-robots run my-level.toml my-program.l --ticks 900
      logical-robots run 13-high-ground high-ground high-ground-sparring

    exit status: 0 won or match over, 1 not won in time, 2 bad level or program
    """
    level, program = open_run(options)
    with progress_bar(level.title, options.ticks) as show:
        outcome = asyncio.run(
            play_out(level, program, " ".join(named_programs(options)), options.ticks, show)
        )
    print(outcome.as_json(times=options.times) if prefers_json(options) else outcome.as_text())
    is_over = level.match_ticks == outcome.frame.tick
    return WON if outcome.won_at is not None or is_over else NOT_WON


async def play_out(
    level: Level,
    program: Program,
    program_name: str,
    ticks: int,
    show: Callable[[int], object] = lambda _tick: None,
) -> Outcome:
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.victory import victory_of

    game = Game(level, program, history=1)
    outcome = Outcome(level, program_name, game.frame)

    def look(frame: Frame) -> None:
        outcome.count(frame)
        show(frame.tick)

    game.listen(look)
    began = perf_counter()
    try:
        await game.run_until(tick=ticks)
        victory = victory_of(game, level)
    finally:
        await game.close()
    outcome.seconds = perf_counter() - began
    if victory is not None and victory.measures is not None:
        outcome.reached = victory.measures.goals
    return outcome


@dataclass
class Outcome:
    """The result of a run so far; `first` are a few notices: tick, robot, kind and message."""

    level: Level
    program_name: str
    frame: Frame
    notices: Counter[str] = field(default_factory=Counter)
    first: list[tuple[int, str, str, str]] = field(default_factory=list)
    think_milliseconds: float = 0.0
    is_reliable: bool = True
    seconds: float = 0.0
    reached: tuple[str, ...] = ()

    def count(self, frame: Frame) -> None:
        self.frame = frame
        self.think_milliseconds += frame.think_milliseconds
        self.is_reliable = self.is_reliable and frame.is_reliable
        for decision in frame.decisions:
            for notice in decision.notices:
                self.notices[notice.kind] += 1
                if len(self.first) < SAMPLE:
                    entry = (frame.tick, decision.robot_name, notice.kind, notice.message)
                    self.first.append(entry)

    @property
    def won_at(self) -> int | None:
        return self.frame.after.won_at

    def as_json(self, *, times: bool = False) -> str:
        """Return the result as JSON, without times by default, because they vary."""
        from logical_robots_tui.game import goals
        from logical_robots_tui.world.dynamics import points

        ticks = self.frame.tick
        found: dict[str, Any] = {
            "level": self.level.name,
            "program": self.program_name,
            "won": self.won_at is not None,
            "ticks": ticks,
            "reliable": self.is_reliable,
            "robots": self._robots(),
            "goals": [
                {"area": goal.area_name, "wanted": goal.wanted, "inside": goal.inside}
                for goal in goals(self.level, self.frame.after)
            ],
            **({"scores": points(self.level, self.frame.after)} if self.level.scores else {}),
            "second_goals": {
                goal.words: goal.words in self.reached for goal in self.level.second_goals
            },
            "notices": {
                "count": self.notices.total(),
                "kinds": dict(self.notices),
                "first": [
                    {"tick": tick, "robot": robot, "kind": kind, "message": message}
                    for tick, robot, kind, message in self.first
                ],
            },
        }
        if times:
            found["milliseconds_per_tick"] = round(self.seconds * 1000 / ticks, 4)
            think = self.think_milliseconds / ticks
            found["think_milliseconds_per_tick"] = round(think, 4)
        return json.dumps(finite(found), indent=2, allow_nan=False)

    def as_text(self) -> str:
        lines = [self._verdict()]
        if self.won_at is not None and self.level.second_goals:
            goals = (goal.words for goal in self.level.second_goals)
            told = "; ".join(
                f"{words}: {'yes' if words in self.reached else 'no'}" for words in goals
            )
            lines.append(f"Second goals: {told}.")
        lines += ["", *self._table()]
        if self.first:
            total = self.notices.total()
            lines += ["", f"{total} notice{'' if total == 1 else 's'} from the program:"]
            lines += [
                f"  tick {tick}, {harmless(robot)}: {harmless(message)}"
                for tick, robot, _kind, message in self.first
            ]
            if total > len(self.first):
                lines.append(f"  ... and {total - len(self.first)} more")
        if not self.is_reliable:
            lines += ["", UNRELIABLE]
        pace = self.frame.tick / self.seconds
        lines += ["", f"{self.frame.tick} ticks in {self.seconds:.1f} s ({pace:.0f} ticks/s)"]
        return "\n".join(lines)

    def _verdict(self) -> str:
        from logical_robots_tui.game import goals
        from logical_robots_tui.game.frame import standing_words

        title = harmless(self.level.title)
        if self.level.scores:
            told = harmless(standing_words(self.level, self.frame.after))
            return f"{title}: after {self.frame.tick} ticks {told}."
        if self.won_at is not None:
            return f"{title}: won at tick {self.won_at}."
        if not any(area.victory_robots for area in self.level.areas):
            return f"{title}: {self.frame.tick} ticks done. This level has no goal."
        missing = [
            f"{harmless(goal.area_name)} is still missing "
            + ", ".join(harmless(name) for name in goal.wanted if name not in goal.inside)
            for goal in goals(self.level, self.frame.after)
            if not goal.reached and len(goal.inside) < len(goal.wanted)
        ]
        return ". ".join([f"{title}: not won within {self.frame.tick} ticks", *missing]) + "."

    def _table(self) -> list[str]:
        rows: list[tuple[str, ...]] = [("ROBOT", "X", "Y", "HEADING", "BATTERY")]
        for given, now in zip(self.level.robots, self.frame.after.robots, strict=True):
            heading = f"{math.degrees(now.angle) % 360:.0f} deg"
            battery = "none"
            if given.has_battery:
                battery = f"{now.battery_level:.1f} of {given.battery_capacity:g}"
            rows.append((now.name, f"{now.x:.1f}", f"{now.y:.1f}", heading, battery))
        return columns(rows)

    def _robots(self) -> list[dict[str, Any]]:
        return [
            {
                "name": now.name,
                "x": now.x,
                "y": now.y,
                "angle": now.angle,
                "battery_level": now.battery_level if given.has_battery else None,
                "blocked": now.blocked,
                "memory": self.frame.memories.get(now.name),
            }
            for given, now in zip(self.level.robots, self.frame.after.robots, strict=True)
        ]
