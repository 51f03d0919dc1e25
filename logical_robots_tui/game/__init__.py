"""The game: world + mind + history. Run, pause, step, step back. No screen."""

from typing import TYPE_CHECKING

from logical_robots_tui.later import lazy_exports

if TYPE_CHECKING:
    from logical_robots_tui.game.advancing import start_frame
    from logical_robots_tui.game.debugging.breakpoints import (
        EVENTS,
        Breakpoint,
        Breakpoints,
        Event,
        Hit,
        mistake_in,
        subjects,
    )
    from logical_robots_tui.game.debugging.inquiry import (
        MIND,
        ROBOT_COLUMNS,
        Inquiry,
        Path,
        Pin,
        PinReading,
        pin_of_cell,
        read,
    )
    from logical_robots_tui.game.debugging.matches import (
        Matches,
        SearchResult,
        find_matches,
        search_ticks,
    )
    from logical_robots_tui.game.debugging.origin import (
        Link,
        Origin,
        origin_in_game,
        origin_in_run,
        read_part,
        subject_name,
    )
    from logical_robots_tui.game.frame import Frame, Goal, NoSuchTickError, Peak, Superseded, goals
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.branch import BranchDifference, Divergence
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.game.history.marks import MARK_KINDS, Mark, MarkKind
    from logical_robots_tui.game.pace import Pace
    from logical_robots_tui.game.run import Run, run_key
    from logical_robots_tui.game.source import (
        ProgramSource,
        compile_program,
        list_programs,
        load_program,
        mistake_in_question,
        save_program,
        warnings_in,
    )
    from logical_robots_tui.game.victory import is_shipped, level_key, reference_for

__getattr__ = lazy_exports(
    __name__,
    {
        "debugging.breakpoints": "EVENTS Breakpoint Breakpoints Event Hit mistake_in subjects",
        "frame": "Frame Goal NoSuchTickError Peak Superseded goals",
        "game": "Game",
        "history.history": "History",
        "debugging.matches": "Matches SearchResult find_matches search_ticks",
        "debugging.inquiry": "MIND ROBOT_COLUMNS Inquiry Path Pin PinReading pin_of_cell read",
        "history.marks": "MARK_KINDS Mark MarkKind",
        "debugging.origin": "Link Origin origin_in_game origin_in_run read_part subject_name",
        "history.branch": "BranchDifference Divergence",
        "pace": "Pace",
        "victory": "is_shipped level_key reference_for",
        "run": "Run run_key",
        "source": (
            "ProgramSource compile_program list_programs load_program mistake_in_question "
            "save_program warnings_in"
        ),
        "advancing": "start_frame",
    },
)
