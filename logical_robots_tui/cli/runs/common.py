"""What the commands that run a program in a level share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import (
    Commands,
    add_data_dir,
    add_json,
    add_no_solutions,
    add_programs,
    add_start,
    harmless,
    line_of_json,
    named_programs,
    new_command,
    number_from,
    own_programs,
    prefers_json,
)
from logical_robots_tui.cli.failure import ProgramFileError
from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    from rich.progress import Progress

    from logical_robots_tui.game import Frame, Run
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

SOON = 0.5
"""Seconds before the progress bar appears."""


def new_run_command(
    commands: Commands,
    name: str,
    start: Callable[[argparse.Namespace], int],
    *,
    first_tick: int | None = None,
    ticks: tuple[int, str] | None = None,
    robot: str = "",
    needs_robot: bool = False,
    only_json: bool = False,
) -> argparse.ArgumentParser:
    """Declare a command that takes a level and a program, which `opened` loads.

    `first_tick` is the lowest ``--tick``, `ticks` the default and the help of ``--ticks``,
    `robot` the help of ``--robot``; by default there is no such option.
    """
    wants_json = (lambda _options: True) if only_json else prefers_json
    command = new_command(commands, name, start, wants_json=wants_json)
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    add_programs(command)
    if first_tick is not None:
        said = "the tick" if first_tick else "the tick; 0 is the start"
        command.add_argument(
            "--tick", type=number_from(first_tick), required=True, metavar="N", help=said
        )
    if ticks is not None:
        command.add_argument(
            "--ticks",
            type=number_from(1),
            default=ticks[0],
            metavar="N",
            help=f"{ticks[1]} (default: %(default)s)",
        )
    if robot:
        command.add_argument("--robot", required=needs_robot, metavar="R", help=robot)
    add_start(command)
    if not only_json:
        add_json(command)
    add_data_dir(command)
    add_no_solutions(command)
    return command


def open_run(options: argparse.Namespace) -> tuple[Level, Program]:
    """Load level and program, check the robot; raise InputError or ProgramFileError."""
    from logical_robots_tui.game.measuring import named_start_of
    from logical_robots_tui.game.source import programs_for
    from logical_robots_tui.mind import Program, ProgramError
    from logical_robots_tui.world import load_level

    level = named_start_of(load_level(options.level), options.start_number)
    if not named_programs(options):
        hint = "For a first look: logical-robots run 01-first-steps first-steps"
        raise InputError("No program is named.", hint=hint)
    own = own_programs(options)
    sources = programs_for(level, options.programs, dict(options.teams), own, pipes=True)
    try:
        program = Program.compile({team: each.text for team, each in sources.items()})
    except ProgramError as error:
        path, typed = str(sources[error.team].path), named_programs(options)
        raise ProgramFileError(
            path if path in typed else sources[error.team].name, error
        ) from error
    robot = getattr(options, "robot", None)
    if robot is not None:
        check_name("robot", robot, (robot.name for robot in level.robots))
    return level, program.for_team(level.team_of(robot or ""))


def show(options: argparse.Namespace, data: Any, lines: Iterable[str]) -> None:
    print(line_of_json(data) if prefers_json(options) else "\n".join(lines))


def check_name(what: str, name: str, known: Iterable[str]) -> None:
    """Raise InputError, with the known names as a hint, unless the name is known."""
    names = list(known)
    if name not in names:
        listed = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
        raise InputError(
            f"there is no {what} {name}.",
            hint=f"There {'is' if len(names) == 1 else 'are'} {listed}.",
        )


@asynccontextmanager
async def run_shown(
    level: Level, program: Program, ticks: int
) -> AsyncIterator[tuple[Run, Callable[[int], None]]]:
    """Open a run, reusing stored ticks; yield it and a progress callback for finished ticks."""
    from logical_robots_tui.game import Run

    run = Run(level, program)
    try:
        with progress_bar(level.title, ticks, after=SOON) as show:
            yield run, show
    finally:
        await run.close()


async def frame_at(level: Level, program: Program, tick: int) -> Frame:
    async with run_shown(level, program, tick) as (run, show):
        return await run.frame(tick, show)


_REDRAW_EVERY = 0.1  # seconds


@contextmanager
def progress_bar(title: str, ticks: int, *, after: float = 0.0) -> Iterator[Callable[..., None]]:
    """Show a progress bar after some seconds; yield a callback for finished ticks, and of all."""
    began = monotonic()
    due = began + after if sys.stderr.isatty() else float("inf")
    bar: Progress | None = None
    with ExitStack() as stack:

        def show(tick: int, of_all: int = ticks) -> None:
            nonlocal bar, due
            now = monotonic()
            if now < due:
                return
            due = now + _REDRAW_EVERY
            if bar is None:
                bar = stack.enter_context(_new_bar())
                bar.add_task(harmless(title), total=ticks, pace=0.0)
            pace = tick / max(now - began, 1e-9)
            bar.update(bar.task_ids[0], completed=tick, total=of_all, pace=pace, refresh=True)

        yield show


def _new_bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("tick {task.completed:.0f} of {task.total:.0f}"),
        TextColumn("{task.fields[pace]:.0f} ticks/s"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
