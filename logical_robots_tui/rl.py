"""Environments in which robots learn: PettingZoo for several, Gymnasium for one.

Importing this module registers an environment for each level that has robots without teams, such as
``gymnasium.make("LogicalRobots/FirstSteps-v0")``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast, get_args

import numpy as np

from logical_robots_tui.game.frame import Frame, standing
from logical_robots_tui.game.measuring import start_of
from logical_robots_tui.schema import (
    BEACON,
    NO_LABEL,
    NO_OBJECT,
    ROBOT,
    WALL,
)
from logical_robots_tui.simulation import OneProgram, Simulation, check_robots
from logical_robots_tui.world import Level, Sensors, World, list_levels, load_level

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
    from logical_robots_tui.tui.labyrinth.drawing import Picture
    from logical_robots_tui.values import SensorRow, Value
    from logical_robots_tui.world.dynamics import WorldState

OBJECTS = (NO_OBJECT, WALL, BEACON, ROBOT)
"""What a ray ends at, by the number that stands for it."""

PER_UNIT = 0.01
"""The reward for each map unit that a robot has come nearer to its goal."""

EPISODE_TICKS = 2_000
"""After so many ticks an episode is truncated, unless another number is given."""

_LARGEST_PICTURE = 640  # pixels across or down, at most one for each map unit
_TEXT_COLUMNS = 80

Observation: TypeAlias = "dict[str, NDArray[Any]]"
Action: TypeAlias = "NDArray[np.float32] | dict[str, Any]"
Reward: TypeAlias = Literal["sparse", "shaped"]
RenderMode: TypeAlias = Literal["ansi", "rgb_array"]

_RENDERING = {"render_modes": [*get_args(RenderMode)], "render_fps": 30}


class RobotsEnv(ParallelEnv):  # type: ignore[misc] # it has no types
    """A level in which some robots learn and a program in Logica drives the others.

    An observation has arrays, whose last element is that of the forward ray, after the 31 of the
    radar from left to right: ``distance`` of shape (32,), as shares of the reach; ``object`` of
    shape (32,), numbers in `OBJECTS`; ``label`` of shape (32,), numbers in `labels`; and
    ``battery`` of shape (1,), the share that is left, 1 without a battery. An action is the power
    of the left and of the right engine, of shape (2,), from -1 to 1; with `memory` a mapping of
    ``engines`` to these and of ``memory`` to what the robot remembers. An info has the ``start``
    of the episode, the ``tick``, whether it is ``won``, and ``goal_distance``, the map units of
    the free way to the goal, if the robot has one.

    Args:
        level: A level, or its name or path.
        learners: The robots that learn; by default all.
        program: What drives the others, as in `Simulation`.
        starts: Which starts an episode may begin from, 0 for the given one; ``reset`` chooses.
        ticks: After so many an episode is truncated; None for never.
        sensors: Rays, field of view, reach and noise; by default those of the level.
        memory: The space of what a learner writes into its memory, where the program of the
            others reads it: a ``Discrete`` is a whole number, a ``Text`` a string, an array a list.
        render_mode: ``ansi`` for plain text, ``rgb_array`` for an array of shape (y, x, 3).
        reward: ``sparse`` is 1 for a victory, and the points that a team gains; ``shaped`` adds
            0.01 for each map unit that a robot comes nearer to its goal, along the free way.

    Attributes:
        labels: The labels that a ray can report, by the number that stands for each.
        observation_spaces, action_spaces: The spaces by learner.
        state_space: That of `state`.

    Raises:
        LevelError: There is no such level, or it is wrong.
        ValueError: There is no such robot, start, reward or render mode.
        InputError, ProgramError: As in `Simulation`.
    """

    metadata: dict[str, Any] = {"name": "logical_robots_v0", **_RENDERING}  # noqa: RUF012 - as declared there

    def __init__(
        self,
        level: Level | str | Path,
        learners: Iterable[str] | None = None,
        program: Program | OneProgram | Mapping[str, OneProgram] | None = None,
        *,
        starts: Sequence[int] = (0,),
        ticks: int | None = EPISODE_TICKS,
        reward: Reward = "sparse",
        sensors: Sensors | None = None,
        memory: spaces.Space[Any] | None = None,
        render_mode: RenderMode | None = None,
    ) -> None:
        level = level if isinstance(level, Level) else load_level(level)
        self.level = replace(level, sensors=sensors or level.sensors)
        self._teams = {robot.name: robot.team for robot in self.level.robots}
        names = list(self._teams)
        self.possible_agents = names if learners is None else list(learners)
        check_robots(self.possible_agents, names)
        for name, count in Counter(self.possible_agents).items():
            if count > 1:
                raise ValueError(f"{name!r} is in learners {count} times: name each robot once.")
        _check_word("reward", reward, get_args(Reward))
        _check_word("render_mode", render_mode, (None, *get_args(RenderMode)))
        self._starts = tuple(map(_check_start, starts))
        if not self._starts:
            raise ValueError("starts is empty: name at least one, 0 for the given start.")
        if ticks is not None and ticks < 1:
            raise ValueError(f"ticks is 1 or more, or None for no end, not {ticks!r}.")
        self.agents: list[str] = []
        self.render_mode = render_mode
        self._program, self._ticks = program, ticks
        self._is_shaped = reward == "shaped"
        self._needs_mind = len(self.possible_agents) < len(names)
        if memory is not None and not self._needs_mind:
            raise ValueError("memory is for a program that reads it, and here all robots learn.")
        solid_areas = [area.name for area in self.level.areas if area.impenetrable]
        object_names = [*names, *(beacon.name for beacon in self.level.beacons), *solid_areas]
        self.labels = tuple(dict.fromkeys((NO_LABEL, WALL, *object_names)))
        self._objects = {kind: number for number, kind in enumerate(OBJECTS)}
        self._labels = {label: number for number, label in enumerate(self.labels)}
        rays = self.level.sensors.rays + 1
        observation_space = spaces.Dict(
            {
                "distance": spaces.Box(0, 1, (rays,), np.float32),
                "object": spaces.MultiDiscrete([len(OBJECTS)] * rays),
                "label": spaces.MultiDiscrete([len(self.labels)] * rays),
                "battery": spaces.Box(0, 1, (1,), np.float32),
            }
        )
        self.observation_spaces = dict.fromkeys(self.possible_agents, observation_space)
        engines = spaces.Box(-1, 1, (2,), np.float32)
        self._has_memory = memory is not None
        action_space = spaces.Dict(engines=engines, memory=memory) if memory else engines
        self.action_spaces = {name: deepcopy(action_space) for name in self.possible_agents}
        for number, space in enumerate(self.action_spaces.values()):
            space.seed(number)
        state_shape = (5 * len(names) + len(self.level.areas),)
        self.state_space = spaces.Box(-1, 1, state_shape, np.float32)
        self._random = np.random.default_rng()
        self._run: World | Simulation | None = None
        self._picture: Picture | None = None
        self._start = 0
        self._actions: list[tuple[dict[str, tuple[float, ...]], dict[str, Value]]] = []
        self._last_values: dict[str, float] = {}

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of observations, the same for each robot."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return the space of actions of a robot."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin an episode, from ``options["start"]`` or one of the starts by chance."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        start = self._starts[self._random.integers(len(self._starts))]
        self._start = _check_start((options or {}).get("start", start))
        self.close()
        if self._needs_mind:
            self._run = Simulation(self.level, self._program, start=self._start)
        else:
            previous_world = self._run if isinstance(self._run, World) else None
            self._run = World(start_of(self.level, self._start), like=previous_world)
        self.agents = list(self.possible_agents)
        self._actions = []
        self._last_values = self._values(self._state)
        return self._observe(), self._infos(self._state)

    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[
        dict[str, Observation],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Let all robots act once; return observations, rewards, ends, truncations and infos.

        Raises:
            gymnasium.error.ResetNeeded: There is no episode, or it is over.
            ValueError: A learner has no action, or something else has one.
        """
        if not self.agents:
            raise gymnasium.error.ResetNeeded("No episode is running: call reset() before step().")
        if actions.keys() != {*self.agents}:
            raise ValueError(f"Give an action to each of {self.agents}, not to {[*actions]}.")
        memories: dict[str, Value] = {}
        if self._has_memory:
            memories = {name: _value(action["memory"]) for name, action in actions.items()}
            actions = {name: action["engines"] for name, action in actions.items()}
        desires = {name: tuple(map(float, action)) for name, action in actions.items()}
        if isinstance(self._run, World):
            self._run.act(desires)
        elif self._run is not None:
            self._run.step(desires, memories)
        self._actions.append((desires, memories))
        state = self._state
        is_won = state.won_at is not None
        is_over = is_won or state.tick == self.level.match_ticks
        is_late = self._ticks is not None and state.tick >= self._ticks and not is_over
        values = self._values(state)
        rewards = {name: values[name] - self._last_values[name] + is_won for name in self.agents}
        self._last_values = values
        agents, observations, infos = self.agents, self._observe(), self._infos(state)
        if is_over or is_late:
            self.agents = []
        return (
            observations,
            rewards,
            dict.fromkeys(agents, is_over),
            dict.fromkeys(agents, is_late),
            infos,
        )

    def state(self) -> NDArray[np.float32]:
        """Return where everybody is, of shape (5 * robots + areas,).

        For each robot x and y as shares of the map, cosine and sine of its heading, and the share
        of charge that is left; then for each area 1 if it is active, else 0.
        """
        state, level = self._state, self.level
        numbers: list[float] = []
        for robot, body in zip(level.robots, state.robots, strict=True):
            numbers += (body.x / level.width, body.y / level.height)
            numbers += (np.cos(body.angle), np.sin(body.angle))
            numbers.append(_charge(robot.has_battery, body.battery_level, robot.battery_capacity))
        return np.array(numbers + [area.active for area in state.areas], np.float32)

    def render(self) -> str | NDArray[np.uint8] | None:
        """Return the map as text or as an array, as the render mode says."""
        if self.render_mode is None:
            gymnasium.logger.warn('There is nothing to render without render_mode="rgb_array".')
            return None
        from logical_robots_tui.tui.labyrinth.drawing import Drawing, Look, Picture, Viewport

        run, level, state = self._run, self.level, self._state
        assert run is not None
        frame = Frame(state.tick, state, state, tuple(run.look()), {}, (), {}, 0.0)
        self._picture = self._picture or Picture()
        if self.render_mode == "ansi":
            rows = max(1, round(_TEXT_COLUMNS * level.height / level.width / 2))
            viewport = Viewport.fit(level.width, level.height, _TEXT_COLUMNS, rows)
            cells = self._picture.draw(level, frame, viewport, Look(drawing=Drawing.ASCII))
            return "\n".join(line.rstrip() for line in cells.plain()) + "\n"
        scale = min(1, _LARGEST_PICTURE / max(level.width, level.height))
        columns, rows = max(1, round(level.width * scale)), -(-round(level.height * scale) // 2)
        viewport = Viewport.fit(level.width, level.height, columns, max(1, rows))
        self._picture.draw(level, frame, viewport, Look(drawing=Drawing.HALVES, names=False))
        return self._picture.image.astype(np.uint8)

    def simulation(self) -> Simulation:
        """Return the episode so far, played once more, to record, draw and ask it."""
        simulation = Simulation(self.level, self._program, start=self._start)
        for desires, memories in self._actions:
            simulation.step(desires, memories)
        return simulation

    def close(self) -> None:
        """Free the mind, if there is one."""
        if isinstance(self._run, Simulation):
            self._run.close()

    @property
    def _state(self) -> WorldState:
        if self._run is None:
            raise gymnasium.error.ResetNeeded("No episode has begun: call reset() first.")
        return self._run.save() if isinstance(self._run, World) else self._run.frame.after

    def _infos(self, state: WorldState) -> dict[str, dict[str, Any]]:
        facts = {"start": self._start, "tick": state.tick, "won": state.won_at is not None}
        distances = self._goal_distances(state)
        return {
            name: facts | ({"goal_distance": distances[name]} if name in distances else {})
            for name in self.agents
        }

    def _observe(self) -> dict[str, Observation]:
        assert self._run is not None
        if isinstance(self._run, World) and not self.level.sensors.noise:
            rows = self._run.sense()  # which the next step needs not do again
        else:
            rows = self._run.look()
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
        charge = _charge(*(battery[key] for key in _BATTERY))
        return {
            "distance": np.array(distances, np.float32) / np.float32(self.level.sensors.reach),
            "object": np.array(kinds),
            "label": np.array(labels),
            "battery": np.array([charge], np.float32),
        }

    def _values(self, state: WorldState) -> dict[str, float]:
        """Return the values whose differences are rewards: points and, if shaped, the way left."""
        points = standing(self.level, state)
        values = {name: points.get(self._teams[name], 0.0) for name in self.possible_agents}
        if self._is_shaped:
            for name, distance in self._goal_distances(state).items():
                values[name] -= PER_UNIT * distance
        return values

    def _goal_distances(self, state: WorldState) -> dict[str, float]:
        """Return the map units of the free way to its goal, for each learner that has one."""
        distances = {}
        for robot in state.robots:
            if (way := self._ways_to_goals.get(robot.name)) is not None:
                row = min(max(int(robot.y), 0), len(way) - 1)
                column = min(max(int(robot.x), 0), way.shape[1] - 1)
                distances[robot.name] = float(way[row, column])
        return distances

    @cached_property
    def _ways_to_goals(self) -> dict[str, NDArray[np.float64]]:
        """The free way from each place to the goal of each learner with one, (height, width)."""
        goals: dict[str, list[tuple[float, float, float]]] = {}
        for area in self.level.areas:
            for name in area.victory_robots:
                goals.setdefault(name, []).append((area.x, area.y, area.radius))
        walls = self.level.walls
        return {
            name: _distances_to(walls.tobytes(), (len(walls), walls.shape[1]), tuple(places))
            for name, places in goals.items()
            if name in self.action_spaces
        }


_BATTERY = ("has_battery", "battery_level", "battery_capacity")


def _charge(has_battery: bool, level: float, capacity: float) -> float:
    return level / capacity if has_battery else 1.0


def _check_word(title: str, word: object, words: Sequence[object]) -> None:
    if word not in words:
        choices = " or ".join(map(repr, words))
        raise ValueError(f"{title} is {choices}, not {word!r}.")


def _check_start(start: Any) -> int:
    if isinstance(start, bool) or not isinstance(start, int | np.integer) or start < 0:
        raise ValueError(f"A start is 0, the given one, or the number of a varied one: {start!r}.")
    return int(start)


def _value(memory: Any) -> Value:
    """Return an element of a space as a value that programs read."""
    if isinstance(memory, Mapping):
        return {str(key): _value(part) for key, part in memory.items()}
    if isinstance(memory, tuple):
        return [_value(part) for part in memory]
    return cast("Value", np.asarray(memory).tolist())


@lru_cache(maxsize=16)  # environments of one level share them
def _distances_to(
    packed_walls: bytes, shape: tuple[int, int], places: tuple[tuple[float, float, float], ...]
) -> NDArray[np.float64]:
    """Return the map units to the nearest of some places; those of the farthest in a wall."""
    walls = np.frombuffer(packed_walls, np.bool_).reshape(shape)
    y, x = np.indices(walls.shape) + 0.5
    is_goal = np.zeros(walls.shape, np.bool_)
    for left, top, radius in places:
        is_goal |= np.hypot(x - left, y - top) <= max(radius, 1)
    is_free = ~np.pad(walls, 1, constant_values=True).ravel()
    distances = np.full(is_free.shape, np.inf)
    front = np.flatnonzero(np.pad(is_goal, 1))
    width, steps = walls.shape[1] + 2, 0
    straight = np.array([-1, 1, -width, width])
    turns = straight, np.append(straight, [-width - 1, 1 - width, width - 1, width + 1])
    while len(front):
        distances[front] = steps
        # Every other step also diagonally, so that fronts are nearly round.
        front = np.unique(np.add.outer(turns[steps % 2], front))
        front = front[is_free[front] & np.isinf(distances[front])]
        steps += 1
    distances[np.isinf(distances)] = steps
    return distances.reshape(-1, width)[1:-1, 1:-1]


class RobotEnv(gymnasium.Env[Observation, Action]):
    """A level in which one robot learns; spaces and arguments are those of `RobotsEnv`.

    Args:
        level: A level, or its name or path.
        robot: Which one learns; by default the first.
        program: What drives the others.
        options: As for `RobotsEnv`.

    Attributes:
        robots: The `RobotsEnv` with this learner.
    """

    metadata: dict[str, Any] = _RENDERING

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
        self.render_mode = self.robots.render_mode
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

    def render(self) -> Any:
        """Return the map as text or as an array, as the render mode says."""
        return self.robots.render()

    def simulation(self) -> Simulation:
        """Return the episode so far, as in `RobotsEnv`."""
        return self.robots.simulation()

    def close(self) -> None:
        """Free the mind, if there is one."""
        self.robots.close()


def register_envs() -> None:
    """Register an environment for each level, which importing this module does.

    Their episodes are truncated by Gymnasium, after ``max_episode_steps`` of ``gymnasium.make``.
    """
    for name in list_levels():
        words = (word.capitalize() for word in name.split("-") if not word.isdigit())
        key = f"LogicalRobots/{''.join(words)}-v0"
        if key not in gymnasium.registry:
            gymnasium.register(
                key,
                f"{__name__}:{RobotEnv.__name__}",
                max_episode_steps=EPISODE_TICKS,
                kwargs={"level": name, "ticks": None},
            )


register_envs()
