"""Environments in which robots learn."""

import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Discrete
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test, parallel_seed_test

from docs.learner import learn
from logical_robots_tui import Sensors, Simulation, list_levels, load_level
from logical_robots_tui.rl import OBJECTS, PER_UNIT, RobotEnv, RobotsEnv
from logical_robots_tui.values import Desire

FIRST, HOME, MEETING = "LogicalRobots/FirstSteps-v0", "04-everybody-home", "14-right-of-way"
ECHO = "Robot(robot_name:, desire: {left_engine: power, right_engine: power}, memory: 0) :- "
ECHO += 'Sensor(robot_name:), Memory(robot_name: "Moss", memory: power);'


@pytest.fixture
def mixed() -> Iterator[RobotsEnv]:
    env = RobotsEnv(HOME, [load_level(HOME).robots[0].name], "everybody-home", ticks=60)
    yield env
    env.close()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("reward", ["sparse", "shaped"])
def test_the_checker_of_gymnasium_is_content(reward: str) -> None:
    env = gymnasium.make(FIRST, reward=reward, render_mode="ansi", max_episode_steps=5)
    check_env(env.unwrapped)
    assert env.spec is not None
    assert env.spec.max_episode_steps == 5
    env.reset()
    lates = [env.step(np.zeros(2, np.float32))[3] for _ in range(5)]
    assert lates == [False] * 4 + [True]
    vector = gymnasium.make_vec(FIRST, num_envs=2, reward=reward)
    vector.reset(seed=1)
    assert vector.step(vector.action_space.sample())[-1]["tick"].tolist() == [1, 1]


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_the_tests_of_pettingzoo_pass(mixed: RobotsEnv) -> None:
    parallel_api_test(RobotsEnv(HOME, ticks=60, reward="shaped"), num_cycles=150)
    parallel_api_test(mixed, num_cycles=150)
    parallel_seed_test(lambda: RobotsEnv(HOME, ticks=60, starts=range(5)))


def test_each_level_has_an_environment() -> None:
    specs = [spec for key, spec in gymnasium.registry.items() if "LogicalRobots/" in key]
    assert sorted(spec.kwargs["level"] for spec in specs) == sorted(list_levels())
    assert {(spec.version, spec.max_episode_steps) for spec in specs} == {(0, 2_000)}


@pytest.mark.parametrize("sensors", [Sensors(), Sensors(7, 90, 100, 2.5)])
def test_an_observation_is_what_a_program_senses(sensors: Sensors) -> None:
    env = RobotsEnv("12-power-line", sensors=sensors)
    observed, _ = env.reset()
    assert observed["Volta"] in env.observation_space("Volta")
    for row in Simulation("12-power-line", sensors=sensors).look():
        seen, sensor = observed[row["robot_name"]], row["sensor"]
        rays = [*sensor["radar"], {key: sensor[f"forward_{key}"] for key in ("distance", "label")}]
        assert np.allclose(seen["distance"] * sensors.reach, [ray["distance"] for ray in rays])
        assert [env.labels[n] for n in seen["label"]] == [ray["label"] for ray in rays]
        kinds = [*(ray["object"] for ray in sensor["radar"]), sensor["forward_object"]]
        assert [OBJECTS[n] for n in seen["object"]] == kinds
        own = sensor["self"]
        full = own["battery_level"] / own["battery_capacity"] if own["has_battery"] else 1
        assert seen["battery"] == pytest.approx([full])


def test_learners_act_among_robots_that_a_program_drives(mixed: RobotsEnv) -> None:
    (learner,) = mixed.possible_agents
    mixed.reset()
    simulation = Simulation(HOME, "everybody-home")
    for tick in range(60):
        powers = (1, 0.5 * (tick % 3))
        _, _, _, late, _ = mixed.step({learner: np.array(powers, np.float32)})
        simulation.step({learner: powers})
    assert late == {learner: True}
    assert mixed.agents == []
    assert mixed._state == simulation.frame.after


@cache
def powers_that_win() -> list[tuple[float, float]]:
    simulation, powers = Simulation("01-first-steps", "first-steps"), []
    while not simulation.won:
        (decision,) = simulation.step().decisions
        assert decision.desire is not None
        powers.append((decision.desire.left_engine, decision.desire.right_engine))
    return powers


def won(env: RobotEnv) -> tuple[list[float], dict[str, Any]]:
    """The rewards of driving as the solution of the first level does, and the last info."""
    env.reset()
    steps = [env.step(np.array(powers)) for powers in powers_that_win()]
    assert [is_over for _, _, is_over, _, _ in steps].index(True) == len(steps) - 1
    assert not any(is_late for _, _, _, is_late, _ in steps)
    return [reward for _, reward, *_ in steps], steps[-1][-1]


def test_a_victory_is_worth_1_and_the_way_to_it_what_it_shortens() -> None:
    rewards, info = won(RobotEnv("01-first-steps"))
    assert info.pop("goal_distance") <= 1
    assert info == {"start": 0, "tick": len(rewards), "won": True}
    assert (rewards[-1], sum(rewards)) == (1, 1)
    rewards, _ = won(RobotEnv("01-first-steps", reward="shaped"))
    way = sum(rewards) - 1
    level = load_level("01-first-steps")
    (robot,), (goal,) = level.robots, [area for area in level.areas if area.victory_robots]
    straight = np.hypot(robot.x - goal.x, robot.y - goal.y) - goal.radius
    assert PER_UNIT * straight <= way <= 5 * PER_UNIT * straight


def test_the_points_of_a_team_are_rewards() -> None:
    level, ticks = load_level("16-high-ground"), 40
    (holder, *others), meadow = level.robots, next(a for a in level.areas if a.name == "Meadow")
    level = replace(level, robots=(replace(holder, x=meadow.x, y=meadow.y), *others))
    name = holder.name
    env, run = RobotsEnv(level, [name], ticks=ticks), Simulation(level)
    env.reset()
    total = sum(env.step({name: np.zeros(2, np.float32)})[1][name] for _ in range(ticks))
    for _ in range(ticks):
        run.step({name: (0, 0)})
    assert env.agents == []
    assert total == pytest.approx(run.points[holder.team])
    assert total > 0
    env.close()
    run.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"learners": ["Adda"]}, "There is no robot 'Adda'. Did you mean \"Ada\"?"),
        ({"learners": ["Ada", "Ada"]}, "'Ada' is in learners 2 times: name each robot once."),
        ({"reward": "dense"}, "reward is 'sparse' or 'shaped', not 'dense'."),
        ({"render_mode": "human"}, "render_mode is None or 'ansi' or 'rgb_array', not 'human'."),
        ({"starts": []}, "starts is empty: name at least one, 0 for the given start."),
        ({"starts": [-1]}, "A start is 0, the given one, or the number of a varied one: -1."),
        ({"ticks": 0}, "ticks is 1 or more, or None for no end, not 0."),
        ({"memory": Discrete(2)}, "memory is for a program that reads it, and here all robots"),
    ],
)
def test_wrong_words_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        RobotsEnv("01-first-steps", **options)


def test_a_step_needs_an_episode_and_an_action_of_each_learner() -> None:
    env, idle = RobotsEnv("01-first-steps", ticks=1), {"Ada": np.zeros(2, np.float32)}
    for _ in range(2):  # before the first episode, and after it
        with pytest.raises(ResetNeeded, match="call reset"):
            env.step(idle)
        env.reset(options={"start": 3})
        for actions in ({}, idle | {"Bob": idle["Ada"]}):
            with pytest.raises(ValueError, match="Give an action to each"):
                env.step(actions)
        *_, infos = env.step(idle)
        assert (infos["Ada"]["start"], infos["Ada"]["tick"]) == (3, 1)
    with pytest.raises(ValueError, match="A start is 0"):
        env.reset(options={"start": "3"})


def test_an_episode_is_drawn_and_becomes_a_simulation(tmp_path: Path) -> None:
    env = RobotsEnv(HOME, render_mode="rgb_array")
    env.reset(seed=1, options={"start": 2})
    pictures: list[Any] = [env.render()]
    for _ in range(20):
        env.step(dict.fromkeys(env.agents, np.array([1, 0.9], np.float32)))
        pictures.append(env.render())
    assert {picture.shape for picture in pictures} == {(358, 640, 3)}
    assert len({picture.tobytes() for picture in pictures}) == len(pictures)
    assert env.state() in env.state_space
    simulation = env.simulation()
    assert simulation.frame.after == env._state
    assert "Robot" in str(simulation.why("Ruby"))
    simulation.record(tmp_path / "episode.replay")
    assert (tmp_path / "episode.replay").stat().st_size


def test_a_program_reads_what_a_learner_remembers() -> None:
    env = RobotsEnv(MEETING, ["Moss"], ECHO, memory=Discrete(2))
    env.reset()
    assert env.action_space("Moss").sample().keys() == {"engines", "memory"}
    for number in (1, 0, 1):
        env.step({"Moss": {"engines": np.zeros(2, np.float32), "memory": np.int64(number)}})
    simulation = env.simulation()
    powers = [simulation.at(tick).decisions[0].desire for tick in (2, 3)]
    assert powers == [Desire(1, 1), Desire(0, 0)]
    assert simulation.frame.after == env._state
    env.close()


@pytest.mark.slow
def test_fifty_lines_learn_to_win_the_first_level() -> None:
    found = learn(most=100)
    assert found is not None
    weights, episodes = found
    assert weights.shape == (2, 4)
    assert episodes > 5
