"""The minds that think in a level: one for all robots, or one for each team."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from logical_robots_tui.mind import Decision, Limits, Mind, Program
from logical_robots_tui.values import SensorRow, Value

if TYPE_CHECKING:
    from logical_robots_tui.world import Level


def mind_for(program: Program, level: Level, limits: Limits | None = None) -> Mind:
    """Return what thinks for all robots of a level; its input and output must not be changed.

    In a level with teams, a program for all robots plays every team, each with a mind of its own.
    """
    if level.teams:
        names = [team.name for team in level.teams]
        return TeamMind(program, level, limits, program.team if program.team in names else names[0])
    visibility = level.visibility
    return Mind(program, visibility.memory, visibility.sensor, limits, frozen=True)


class TeamMind(Mind):
    """The mind of a team, which answers for that team only, with all limits for itself."""

    def __init__(self, program: Program, level: Level, limits: Limits | None, team: str) -> None:
        visibility = level.visibility
        visible = visibility.memory, visibility.sensor
        robots = frozenset(robot.name for robot in level.robots if robot.team == team)
        super().__init__(program.for_team(team), *visible, limits, frozen=True, robots=robots)
        self._others: list[TeamMind] | None = None  # needed for thinking only
        names = [t.name for t in level.teams if t.name != team]
        self._new_others: Callable[[], list[TeamMind]] = lambda: [
            TeamMind(program, level, limits, name) for name in names
        ]

    def think(
        self,
        rows: Sequence[SensorRow],
        memories: Mapping[str, Value],
        *,
        stop: threading.Event | None = None,
    ) -> list[Decision]:
        """Decide for the robots of all teams as `Mind.think` does, separately for each team."""
        if self._others is None:
            self._others = self._new_others()
        decisions = {
            decision.robot_name: decision
            for mind in (self, *self._others)
            for decision in Mind.think(mind, rows, memories, stop=stop)  # without its own others
        }
        return [decisions[row["robot_name"]] for row in rows]

    @property
    def steps(self) -> int:
        step_counts = (mind.steps for mind in self._others or ())
        return super().steps + sum(step_counts)

    def close(self) -> None:
        super().close()
        for mind in self._others or ():
            mind.close()
