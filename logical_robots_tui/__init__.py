"""Logical Robots: a terminal game and laboratory for programming robots in logic.

The names below are the public interface. Each is loaded when it is first used, so that a script
which needs only the world never loads the mind, and none of them loads a screen.

Example:
    >>> from logical_robots_tui import World, load_level
    >>> world = World(load_level("01-first-steps"))
    >>> rows = world.sense()
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.later import lazy_exports

if TYPE_CHECKING:
    from logical_robots_tui.errors import InputError, LogicalRobotsError
    from logical_robots_tui.game import Frame, Game
    from logical_robots_tui.mind import Decision, Diagnostic, Mind, Program, ProgramError
    from logical_robots_tui.simulation import Simulation
    from logical_robots_tui.values import Desire
    from logical_robots_tui.world import Level, Sensors, World, list_arenas, list_levels, load_level

__version__ = "0.2.0"

__all__ = [
    "Decision",
    "Desire",
    "Diagnostic",
    "Frame",
    "Game",
    "InputError",
    "Level",
    "LogicalRobotsError",
    "Mind",
    "Program",
    "ProgramError",
    "Sensors",
    "Simulation",
    "World",
    "__version__",
    "list_arenas",
    "list_levels",
    "load_level",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "errors": "InputError LogicalRobotsError",
        "game": "Frame Game",
        "mind": "Decision Diagnostic Mind Program ProgramError",
        "simulation": "Simulation",
        "values": "Desire",
        "world": "Level Sensors World list_arenas list_levels load_level",
    },
)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
