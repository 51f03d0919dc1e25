"""A tick of a run, for commands that look at one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["check_name", "frame_at"]


async def frame_at(level: Level, program: Program, tick: int) -> Frame:
    """The frame of a tick of a run from the start; a victory on the way does not end it.

    Ticks that an earlier process has computed are not computed again.

    Args:
        level: Where it happens.
        program: What the robots think.
        tick: Which tick; 0 is the start.
    """
    from logical_robots_tui.cli.patience import Patience
    from logical_robots_tui.game import Run

    run = Run(level, program)
    with Patience(level.title, tick) as show:
        try:
            return await run.frame(tick, show)
        finally:
            await run.close()


def check_name(what: str, name: str, known: Iterable[str]) -> None:
    """Make sure that a name is one of those there are.

    Args:
        what: What it names: robot, predicate.
        name: As it was typed.
        known: Those there are.

    Raises:
        InputError: It is not; says which there are.
    """
    there = list(known)
    if name not in there:
        listed = ", ".join(there[:20]) + (", ..." if len(there) > 20 else "")
        raise InputError(
            f"there is no {what} {name}.",
            hint=f"There {'is' if len(there) == 1 else 'are'} {listed}.",
        )
