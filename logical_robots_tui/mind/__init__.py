"""Logica programs compiled to SQLite: sensors and memories in, decisions out.

The compile process runs `checking` (mistakes), `compiling` (text to SQL), `tuning` (faster
SQL), `clauses` (decomposed rules) and `diagnosis` (what a checkup watches). In the main
process, `sqlite` holds the rows of a moment, `Mind` queries them, and `why` explains them.
"""

from typing import TYPE_CHECKING

from logical_robots_tui.later import lazy_exports

if TYPE_CHECKING:
    from logical_robots_tui.language.diagnostics import (
        Diagnostic,
        ProgramError,
        QueryError,
        Stopped,
    )
    from logical_robots_tui.mind.compilation import Report
    from logical_robots_tui.mind.decision import Decision, Notice, NoticeKind
    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.mind import Mind
    from logical_robots_tui.mind.program import Predicate, Program, Question
    from logical_robots_tui.mind.table import QueryPlan, Table

__all__ = [
    "Decision",
    "Diagnostic",
    "Limits",
    "Mind",
    "Notice",
    "NoticeKind",
    "Predicate",
    "Program",
    "ProgramError",
    "QueryError",
    "QueryPlan",
    "Question",
    "Report",
    "Stopped",
    "Table",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Decision": "decision",
        "Diagnostic": ".language.diagnostics",
        "Limits": "limits",
        "QueryPlan": "table",
        "Mind": "mind",
        "Notice": "decision",
        "NoticeKind": "decision",
        "Predicate": "program",
        "Program": "program",
        "ProgramError": ".language.diagnostics",
        "QueryError": ".language.diagnostics",
        "Question": "program",
        "Report": "compilation",
        "Stopped": ".language.diagnostics",
        "Table": "table",
    },
)
