"""A learner for level 1: eight numbers, changed at random and kept when they do better.

The powers of the engines are sums of four features of what the robot sees, weighted with these
numbers. The reward is how much nearer the robot has come to its goal.
"""

from __future__ import annotations

import gymnasium
import numpy as np
from numpy.typing import NDArray

import logical_robots_tui.rl  # noqa: F401 - it registers the environments

TICKS = 1_500
SIDE = 11  # rays to the left and to the right


def features(seen: dict[str, NDArray[np.float32]]) -> NDArray[np.float64]:
    """The least room to the left, ahead and to the right, and a constant."""
    rays = seen["distance"]
    parts = rays[:SIDE], rays[SIDE : -SIDE - 1], rays[-SIDE - 1 : -1]
    return np.array([*(part.min() for part in parts), 1.0])


def episode(env: gymnasium.Env, weights: NDArray[np.float64]) -> tuple[float, bool]:
    """Return the sum of rewards, and whether the level was won."""
    seen, _ = env.reset()
    total, is_over, is_late = 0.0, False, False
    while not (is_over or is_late):
        action = np.tanh(weights @ features(seen)).astype(np.float32)
        seen, reward, is_over, is_late, _ = env.step(action)
        total += float(reward)
    return total, is_over


def learn(seed: int = 1, most: int = 300) -> tuple[NDArray[np.float64], int] | None:
    """Return weights that win and the number of episodes that it took, or None."""
    chance = np.random.default_rng(seed)
    env = gymnasium.make("LogicalRobots/FirstSteps-v0", reward="shaped", max_episode_steps=TICKS)
    best, score = chance.normal(size=(2, 4)), -np.inf
    for number in range(1, most + 1):
        tried = best + chance.normal(size=best.shape) * chance.choice([0.1, 0.5, 2.0])
        total, is_won = episode(env, tried)
        if is_won:
            return tried, number
        if total > score:
            best, score = tried, total
    return None


if __name__ == "__main__":
    print(learn())
