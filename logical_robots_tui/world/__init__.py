"""Levels, and the simulation that runs them."""

from __future__ import annotations

from logical_robots_tui.world.dynamics import AreaState, RobotState, WorldState
from logical_robots_tui.world.level import (
    Area,
    Beacon,
    Level,
    LevelError,
    Robot,
    Score,
    Team,
    Visibility,
)
from logical_robots_tui.world.levels.load import list_arenas, list_levels, list_shipped, load_level
from logical_robots_tui.world.world import World

__all__ = [
    "Area",
    "AreaState",
    "Beacon",
    "Level",
    "LevelError",
    "Robot",
    "RobotState",
    "Score",
    "Team",
    "Visibility",
    "World",
    "WorldState",
    "list_arenas",
    "list_levels",
    "list_shipped",
    "load_level",
]
