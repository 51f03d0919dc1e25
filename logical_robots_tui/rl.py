"""Environments in which robots learn: PettingZoo for several, Gymnasium for one.

Importing this module registers an environment for each level that has robots without teams, such as
``gymnasium.make("LogicalRobots/01-first-steps")``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast

import numpy as np

from logical_robots_tui.game.frame import standing
from logical_robots_tui.game.measuring import start_of
from logical_robots_tui.schema import (
    BEACON,
    NO_LABEL,
    NO_OBJECT,
    RADAR_RAYS,
    ROBOT,
    SENSOR_RANGE,
    WALL,
)
from logical_robots_tui.simulation import OneProgram, Simulation, check_robots
from logical_robots_tui.world import Level, World, list_levels, load_level

try:
    import gymnasium
    from gymnasium import spaces
    from pettingzoo import ParallelEnv
except ImportError as error:
    message = "Learning needs gymnasium and pettingzoo: pip install 'logical-robots-tui[rl]'"
    raise ImportError(message, name=error.name) from None

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.mind import Program
    from logical_robots_tui.values import SensorRow
    from logical_robots_tui.world.dynamics import WorldState

OBJECTS = (NO_OBJECT, WALL, BEACON, ROBOT)
"""What a ray ends at, by the number that stands for it."""

PER_UNIT = 0.01
"""The reward for each map unit that a robot has come nearer to its goal."""

_RAYS = RADAR_RAYS + 1

Observation: TypeAlias = "dict[str, NDArray[Any]]"
Action: TypeAlias = "NDArray[np.float32]"
Reward: TypeAlias = Literal["sparse", "shaped"]


class RobotsEnv(ParallelEnv):  # type: ignore[misc] # it has no types
    """A level in which some robots learn and a program in Logica drives the others.

    An observation has arrays, whose last element is that of the forward ray, after the 31 of the
    radar from left to right: ``distance`` of shape (32,), map units divided by 200; ``object`` of
    shape (32,), numbers in `OBJECTS`; ``label`` of shape (32,), numbers in `labels`; and
    ``battery`` of shape (1,), the share that is left, 1 without a battery. An action is the power
    of the left and of the right engine, of shape (2,), from -1 to 1.

    Args:
        level: A level, or its name or path.
        learners: The robots that learn; by default all.
        program: What drives the others, as in `Simulation`.
        starts: Which starts an episode may begin from, 0 for the given one; ``reset`` chooses.
        ticks: After so many an episode is truncated.
        reward: ``sparse`` is 1 for a victory, and the points that a team gains; ``shaped`` adds
            0.01 for each map unit that a robot comes nearer to its goal, along the free way.

    Attributes:
        labels: The labels that a ray can report, by the number that stands for each.

    Raises:
        LevelError: There is no such level, or it is wrong.
        ValueError: There is no such robot.
        InputError, ProgramError: As in `Simulation`.
    """

    metadata: dict[str, Any] = {"name": "logical_robots", "render_modes": []}  # noqa: RUF012 - as declared there

    def __init__(
        self,
        level: Level | str | Path,
        learners: Iterable[str] | None = None,
        program: Program | OneProgram | Mapping[str, OneProgram] | None = None,
        *,
        starts: Sequence[int] = (0,),
        ticks: int = 2_000,
        reward: Reward = "sparse",
    ) -> None:
        self.level = level if isinstance(level, Level) else load_level(level)
        self._teams = {robot.name: robot.team for robot in self.level.robots}
        names = list(self._teams)
        self.possible_agents = names if learners is None else list(learners)
        check_robots(self.possible_agents, names)
        self.agents: list[str] = []
        self.render_mode = None
        self._program, self._starts, self._ticks = program, tuple(starts), ticks
        self._is_shaped = reward == "shaped"
        self._needs_mind = len(self.possible_agents) < len(names)
        solid_areas = [area.name for area in self.level.areas if area.impenetrable]
        object_names = [*names, *(beacon.name for beacon in self.level.beacons), *solid_areas]
        self.labels = tuple(dict.fromkeys((NO_LABEL, WALL, *object_names)))
        self._objects = {kind: number for number, kind in enumerate(OBJECTS)}
        self._labels = {label: number for number, label in enumerate(self.labels)}
        self._observation_space = spaces.Dict(
            {
                "distance": spaces.Box(0, 1, (_RAYS,), np.float32),
                "object": spaces.MultiDiscrete([len(OBJECTS)] * _RAYS),
                "label": spaces.MultiDiscrete([len(self.labels)] * _RAYS),
                "battery": spaces.Box(0, 1, (1,), np.float32),
            }
        )
        self._action_spaces = {
            name: spaces.Box(-1, 1, (2,), np.float32, seed=number)
            for number, name in enumerate(self.possible_agents)
        }
        self._random = np.random.default_rng()
        self._run: World | Simulation | None = None
        self._last_values: dict[str, float] = {}

    def observation_space(self, agent: str) -> spaces.Dict:
        """Return the space of observations, the same for each robot."""
        return self._observation_space

    def action_space(self, agent: str) -> spaces.Box:
        """Return the space of actions of a robot."""
        return self._action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin an episode, from ``options["start"]`` or one of the starts by chance."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        start = (options or {}).get("start", self._starts[self._random.integers(len(self._starts))])
        self.close()
        if self._needs_mind:
            self._run = Simulation(self.level, self._program, start=start)
        else:
            previous_world = self._run if isinstance(self._run, World) else None
            self._run = World(start_of(self.level, start), like=previous_world)
        self.agents = list(self.possible_agents)
        self._last_values = self._values(self._state)
        return self._observe(), {name: {} for name in self.agents}

    def step(
        self, actions: Mapping[str, Action]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Let all robots act once; return observations, rewards, ends, truncations and infos."""
        desires = {name: tuple(map(float, action)) for name, action in actions.items()}
        if isinstance(self._run, World):
            self._run.act(desires)
        elif self._run is not None:
            self._run.step(desires)
        state = self._state
        is_won = state.won_at is not None
        is_over = is_won or state.tick == self.level.match_ticks
        is_late = state.tick >= self._ticks and not is_over
        values = self._values(state)
        rewards = {name: values[name] - self._last_values[name] + is_won for name in self.agents}
        self._last_values = values
        agents, observations = self.agents, self._observe()
        if is_over or is_late:
            self.agents = []
        return (
            observations,
            rewards,
            dict.fromkeys(agents, is_over),
            dict.fromkeys(agents, is_late),
            {name: {"won": is_won} for name in agents},
        )

    def close(self) -> None:
        """Free the mind, if there is one."""
        if isinstance(self._run, Simulation):
            self._run.close()

    @property
    def _state(self) -> WorldState:
        assert self._run is not None, "reset comes first"
        return self._run.save() if isinstance(self._run, World) else self._run.frame.after

    def _observe(self) -> dict[str, Observation]:
        assert self._run is not None
        rows = self._run.sense() if isinstance(self._run, World) else self._run.look()
        return {
            row["robot_name"]: self._observation(row)
            for row in rows
            if row["robot_name"] in self.agents
        }

    def _observation(self, row: SensorRow) -> Observation:
        sensor, battery = row["sensor"], row["sensor"]["self"]
        radar = sensor["radar"]
        distances = [ray["distance"] for ray in radar]
        kinds = [self._objects[ray["object"]] for ray in radar]
        labels = [self._labels[ray["label"]] for ray in radar]
        distances.append(sensor["forward_distance"])
        kinds.append(self._objects[sensor["forward_object"]])
        labels.append(self._labels[sensor["forward_label"]])
        charge = (
            battery["battery_level"] / battery["battery_capacity"]
            if battery["has_battery"]
            else 1.0
        )
        return {
            "distance": np.array(distances, np.float32) / np.float32(SENSOR_RANGE),
            "object": np.array(kinds),
            "label": np.array(labels),
            "battery": np.array([charge], np.float32),
        }

    def _values(self, state: WorldState) -> dict[str, float]:
        """Return the values whose differences are rewards: points and, if shaped, the way left."""
        points = standing(self.level, state)
        values = {name: points.get(self._teams[name], 0.0) for name in self.possible_agents}
        if self._is_shaped:
            for robot in state.robots:
                if (
                    robot.name in values
                    and (distances := self._distances_to_goals.get(robot.name)) is not None
                ):
                    row = min(max(int(robot.y), 0), len(distances) - 1)
                    column = min(max(int(robot.x), 0), distances.shape[1] - 1)
                    values[robot.name] -= PER_UNIT * float(distances[row, column])
        return values

    @cached_property
    def _distances_to_goals(self) -> dict[str, NDArray[np.float64]]:
        """The free way from each place to the goal of each robot that has one, (height, width)."""
        goals: dict[str, list[tuple[float, float, float]]] = {}
        for area in self.level.areas:
            for name in area.victory_robots:
                goals.setdefault(name, []).append((area.x, area.y, area.radius))
        goal_sets = {tuple(places) for places in goals.values()}
        distances = {places: _distances_to(self.level.walls, places) for places in goal_sets}
        return {name: distances[tuple(places)] for name, places in goals.items()}


def _distances_to(
    walls: NDArray[np.bool_], places: Sequence[tuple[float, float, float]]
) -> NDArray[np.float64]:
    """Return the map units to the nearest of some places; those of the farthest in a wall."""
    y, x = np.indices(walls.shape) + 0.5
    front = np.zeros(walls.shape, np.bool_)
    for left, top, radius in places:
        front |= np.hypot(x - left, y - top) <= max(radius, 1)
    distances = np.full(walls.shape, np.inf)
    steps = 0
    while front.any():
        distances[front] = steps
        padded = np.pad(front, 1)
        next_front = padded[1:-1, :-2] | padded[1:-1, 2:] | padded[:-2, 1:-1] | padded[2:, 1:-1]
        if steps % 2:  # every other step also diagonally, so that fronts are nearly round
            next_front |= padded[:-2, :-2] | padded[:-2, 2:] | padded[2:, :-2] | padded[2:, 2:]
        front = next_front & ~walls & np.isinf(distances)
        steps += 1
    distances[np.isinf(distances)] = steps
    return distances


class RobotEnv(gymnasium.Env[Observation, Action]):
    """A level in which one robot learns; spaces and arguments are those of `RobotsEnv`.

    Args:
        level: A level, or its name or path.
        robot: Which one learns; by default the first.
        program: What drives the others.
        options: As for `RobotsEnv`.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - as declared there

    def __init__(
        self,
        level: Level | str | Path,
        robot: str = "",
        program: Program | OneProgram | Mapping[str, OneProgram] | None = None,
        **options: Any,
    ) -> None:
        level = level if isinstance(level, Level) else load_level(level)
        self._robot = robot or level.robots[0].name
        self.robots = RobotsEnv(level, [self._robot], program, **options)
        self.observation_space = cast("Any", self.robots.observation_space(self._robot))
        self.action_space = cast("Any", self.robots.action_space(self._robot))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode, as in `RobotsEnv`."""
        super().reset(seed=seed)
        observations, infos = self.robots.reset(seed, options)
        return observations[self._robot], infos[self._robot]

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Let all robots act once."""
        observations, rewards, is_over, is_late, infos = self.robots.step({self._robot: action})
        robot = self._robot
        return observations[robot], rewards[robot], is_over[robot], is_late[robot], infos[robot]

    def close(self) -> None:
        """Free the mind, if there is one."""
        self.robots.close()


for _name in list_levels():
    if (_key := f"LogicalRobots/{_name}") not in gymnasium.registry:
        gymnasium.register(_key, f"{__name__}:{RobotEnv.__name__}", kwargs={"level": _name})
