"""Levels, and the simulation that runs them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.later import lazy_exports

if TYPE_CHECKING:
    from logical_robots_tui.world.dynamics import AreaState, RobotState, WorldState
    from logical_robots_tui.world.level import (
        Area,
        Beacon,
        Level,
        LevelError,
        Robot,
        Score,
        Sensors,
        Team,
        Visibility,
    )
    from logical_robots_tui.world.levels.load import (
        current_name,
        list_arenas,
        list_levels,
        list_shipped,
        load_level,
    )
    from logical_robots_tui.world.world import World

__getattr__ = lazy_exports(
    __name__,
    {
        "dynamics": "AreaState RobotState WorldState",
        "level": "Area Beacon Level LevelError Robot Score Sensors Team Visibility",
        "levels.load": "current_name list_arenas list_levels list_shipped load_level",
        "world": "World",
    },
)
