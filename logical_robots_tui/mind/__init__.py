"""The mind: Logica programs compiled to SQLite; sensors and memories in, decisions out.

In the compile process `compiling` makes SQL of text, `tuning` makes that quick, and `why` takes
rules apart. Here `sqlite` holds the rows of a moment, `duck` those of a crowd; a `Mind` asks them.
"""

from typing import TYPE_CHECKING

from logical_robots_tui.later import names_from
from logical_robots_tui.mind.decision import Decision, Notice, NoticeKind
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError, QueryError, Stopped
from logical_robots_tui.mind.duck.engine import Engine, check_installed
from logical_robots_tui.mind.duck.notes import why_not_duckdb
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.machinery import Machinery
from logical_robots_tui.mind.mind import Mind, Table
from logical_robots_tui.mind.program import Predicate, Program, Question, Report

if TYPE_CHECKING:
    from logical_robots_tui.mind.why.explanation import Ask, Explanation
    from logical_robots_tui.mind.why.telling import Line, tell

__all__ = [
    "Ask",
    "Decision",
    "Diagnostic",
    "Engine",
    "Explanation",
    "Limits",
    "Line",
    "Machinery",
    "Mind",
    "Notice",
    "NoticeKind",
    "Predicate",
    "Program",
    "ProgramError",
    "QueryError",
    "Question",
    "Report",
    "Stopped",
    "Table",
    "check_installed",
    "tell",
    "why_not_duckdb",
]

__getattr__ = names_from(
    __name__,
    {
        "Ask": "why.explanation",
        "Explanation": "why.explanation",
        "Line": "why.telling",
        "tell": "why.telling",
    },
)
