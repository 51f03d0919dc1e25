"""A small level to play on."""

from collections.abc import Callable
from pathlib import Path

from logical_robots_tui.game import Game
from logical_robots_tui.world import Level, load_level

HALL = """
title = "Hall"
cell = 10
walls = '''
####################
#..................#
#..................#
#..................#
####################
'''

[[robots]]
name = "Ada"
x = 40
y = 25

[[robots]]
name = "Bo"
x = 40
y = 35

[[areas]]
name = "Door"
x = 100
y = 25
radius = 20
goal_for = ["Ada", "Bo"]
"""
COUNTER = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1);
"""
BACKWARDS = COUNTER.replace("left_engine: 1, right_engine: 1", "left_engine: -1, right_engine: -1")
SLOW = """
N(x) :- x in Range(3000);
Big(s? += a * b) distinct :- N(a), N(b), N(c);
Robot(robot_name:, desire: {left_engine: s, right_engine: 0}, memory: 1) :-
  Sensor(robot_name:), Big(s:);
"""


def hall(tmp_path: Path) -> Level:
    path = tmp_path / "hall.toml"
    path.write_text(HALL, encoding="utf-8")
    return load_level(path)


Play = Callable[..., Game]
"""Opens a game, flat out and in the hall unless told otherwise, that is closed at the end."""
