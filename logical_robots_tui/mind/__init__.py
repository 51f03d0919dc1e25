"""The mind: Logica programs compiled to SQLite; sensors and memories in, decisions out."""

from logical_robots_tui.mind.decision import Decision, Notice, NoticeKind
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError, QueryError, Stopped
from logical_robots_tui.mind.duck.engine import Engine, check_installed
from logical_robots_tui.mind.duck.notes import why_not_duckdb
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.mind import Mind, Table
from logical_robots_tui.mind.program import Predicate, Program, Report

__all__ = [
    "Decision",
    "Diagnostic",
    "Engine",
    "Limits",
    "Mind",
    "Notice",
    "NoticeKind",
    "Predicate",
    "Program",
    "ProgramError",
    "QueryError",
    "Report",
    "Stopped",
    "Table",
    "check_installed",
    "why_not_duckdb",
]
