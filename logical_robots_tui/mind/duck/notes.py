"""What a player is told who has chosen DuckDB."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.diagnostics import Diagnostic

if TYPE_CHECKING:
    from logical_robots_tui.mind.program import Program

__all__ = ["why_not_duckdb"]


def why_not_duckdb(program: Program) -> tuple[Diagnostic, ...]:
    """A warning if a program thinks with SQLite even where DuckDB was chosen, with the reason."""
    tuned = program.tuned.get("Robot")
    duck = tuned.duck if tuned is not None else None
    sees_all = program.memory == program.sensor == "all"
    if duck is not None and (duck.own or (duck.all and sees_all)):
        return ()
    reason = duck.unlike if duck is not None else "can't be computed for all robots at once"
    robot = program.predicate("Robot")
    return (
        Diagnostic(
            (robot.line if robot is not None else None) or 1,
            1,
            f"DuckDB can't compute Robot: it {reason}",
            "The robots think with SQLite, which means the same.",
            severity="warning",
        ),
    )
