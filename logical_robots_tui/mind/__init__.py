"""Logica programs compiled to SQLite: sensors and memories in, decisions out.

The compile process runs `compiling` (text to SQL) and `tuning` (faster SQL). In the main process,
`sqlite` holds a mind's inputs, and `Mind` queries them.
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
    from logical_robots_tui.mind.program import (
        CompiledQuery,
        Predicate,
        Program,
        QueryPlan,
        ResultTable,
    )

__getattr__ = lazy_exports(
    __name__,
    {
        ".language.diagnostics": "Diagnostic ProgramError QueryError Stopped",
        "compilation": "Report",
        "decision": "Decision Notice NoticeKind",
        "limits": "Limits",
        "mind": "Mind",
        "program": "Predicate Program QueryPlan CompiledQuery ResultTable",
    },
)
