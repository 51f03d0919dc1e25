"""The game: world + mind + history. Run, pause, step, step back. No screen."""

from logical_robots_tui.game.compiling import compile_program
from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.game import Answer, Game, Superseded
from logical_robots_tui.game.goal import Goal, goals
from logical_robots_tui.game.history import History, NoSuchTickError
from logical_robots_tui.game.pace import FLAT_OUT, SPEEDS, Pace
from logical_robots_tui.game.source import Source, list_programs, load_program, save_program
from logical_robots_tui.game.start import start_frame

__all__ = [
    "FLAT_OUT",
    "SPEEDS",
    "Answer",
    "Frame",
    "Game",
    "Goal",
    "History",
    "NoSuchTickError",
    "Pace",
    "Source",
    "Superseded",
    "compile_program",
    "goals",
    "list_programs",
    "load_program",
    "save_program",
    "start_frame",
]
