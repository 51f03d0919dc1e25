"""A level that is won by going straight on, and the program that does."""

__all__ = ["AHEAD", "LEVEL", "QUESTIONS"]

LEVEL = """\
title = "A short way"
cell = 5
walls = '''
############
#..........#
#..........#
#..........#
############
'''

[[robots]]
name = "Pip"
x = 12
y = 12.5

[[areas]]
name = "Door"
x = 42
y = 12.5
radius = 6
goal_for = ["Pip"]
"""

QUESTIONS = """\
questions = [
  {ask = "Who is there?", answer = "Here(robot_name:) :- Sensor(robot_name:)", ticks = [0, 2]},
  {ask = "How far?", answer = "Way(sensor.forward_distance) :- Sensor(sensor:)", ticks = [0, 5]},
]
"""

AHEAD = """\
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: "on my way") :-
  Sensor(robot_name:);
"""
