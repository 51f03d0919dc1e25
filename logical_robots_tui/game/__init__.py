"""The game: world + mind + history. Run, pause, step, step back. No screen."""

from logical_robots_tui.game.breakpoints import (
    EVENTS,
    Breakpoint,
    Breakpoints,
    Event,
    Hit,
    mistake_in,
    subjects,
)
from logical_robots_tui.game.compiling import compile_program, mistake_in_question
from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.game import Answer, Game, Superseded
from logical_robots_tui.game.goal import Goal, goals
from logical_robots_tui.game.history import History, NoSuchTickError
from logical_robots_tui.game.holding import Holding, when_it_holds
from logical_robots_tui.game.inquiry import Inquiry
from logical_robots_tui.game.marks import MARK_KINDS, Mark, MarkKind
from logical_robots_tui.game.origin import Link, Origin, origin_in_game, origin_in_run, read_path
from logical_robots_tui.game.pace import FLAT_OUT, SPEEDS, Pace
from logical_robots_tui.game.parting import Difference, Parting
from logical_robots_tui.game.pins import MIND, ROBOT_COLUMNS, Path, Pin, Reading, pin_of_cell, read
from logical_robots_tui.game.place import Place, place_of
from logical_robots_tui.game.reference import is_shipped, level_key, reference_for
from logical_robots_tui.game.rules import count_rules
from logical_robots_tui.game.run import Run, run_key
from logical_robots_tui.game.seeking import Sought, seek
from logical_robots_tui.game.source import Source, list_programs, load_program, save_program
from logical_robots_tui.game.start import start_frame
from logical_robots_tui.game.watching import rows_that_count

__all__ = [
    "EVENTS",
    "FLAT_OUT",
    "MARK_KINDS",
    "MIND",
    "ROBOT_COLUMNS",
    "SPEEDS",
    "Answer",
    "Breakpoint",
    "Breakpoints",
    "Difference",
    "Event",
    "Frame",
    "Game",
    "Goal",
    "History",
    "Hit",
    "Holding",
    "Inquiry",
    "Link",
    "Mark",
    "MarkKind",
    "NoSuchTickError",
    "Origin",
    "Pace",
    "Parting",
    "Path",
    "Pin",
    "Place",
    "Reading",
    "Run",
    "Sought",
    "Source",
    "Superseded",
    "compile_program",
    "count_rules",
    "goals",
    "is_shipped",
    "level_key",
    "list_programs",
    "load_program",
    "mistake_in",
    "mistake_in_question",
    "origin_in_game",
    "origin_in_run",
    "pin_of_cell",
    "place_of",
    "read",
    "read_path",
    "reference_for",
    "rows_that_count",
    "run_key",
    "save_program",
    "seek",
    "start_frame",
    "subjects",
    "when_it_holds",
]
