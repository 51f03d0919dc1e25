"""What the commands that run a program in a level have in common."""

from __future__ import annotations

from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import (
    add_data_dir,
    add_json,
    new_command,
    number_from,
    own_programs,
    prefers_json,
)
from logical_robots_tui.cli.failure import ProgramFileError
from logical_robots_tui.cli.runs.progress import progress_bar
from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    import argparse
    from collections.abc import AsyncIterator, Callable, Iterable

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.game import Frame, Run
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["check_name", "frame_at", "new_run_command", "opened", "run_shown"]

_SOON = 0.5  # seconds without a progress bar


def new_run_command(
    commands: Commands,
    name: str,
    *,
    start: Callable[[argparse.Namespace], int],
    summary: str,
    description: str,
    epilog: str,
    first_tick: int | None = None,
    ticks: tuple[int, str] | None = None,
    robot: str = "",
    needs_robot: bool = False,
    only_json: bool = False,
) -> argparse.ArgumentParser:
    """Declare a command about a program in a level; `opened` reads what it is about.

    Args:
        commands: Where to add it.
        name: What is typed.
        start: Does the work and returns the exit status.
        summary: One line for the list of commands.
        description: The head of the command's own help.
        epilog: Examples and exit status, laid out by hand.
        first_tick: The first tick that ``--tick`` may name, or None for no such option.
        ticks: How many ticks to run by default and what ``--ticks`` is for, or None for no such
            option.
        robot: What ``--robot`` is for, or "" for no such option.
        needs_robot: Whether a robot must be named.
        only_json: Whether it prints nothing but JSON.
    """
    command = new_command(
        commands,
        name,
        start=start,
        wants_json=(lambda _options: True) if only_json else prefers_json,
        summary=summary,
        description=description,
        epilog=epilog,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("program", metavar="PROGRAM", help="a program's name or file")
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
    if not only_json:
        add_json(command)
    add_data_dir(command)
    return command


def opened(options: argparse.Namespace) -> tuple[Level, Program]:
    """The level and the compiled program that were named; the robot must be in that level.

    Raises:
        InputError: One of them can't be read, or there is no such robot.
        ProgramFileError: The program is wrong.
    """
    from logical_robots_tui.game import load_program
    from logical_robots_tui.mind import Program, ProgramError
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    source = load_program(options.program, own_programs(options.data_dir), pipes=True)
    try:
        program = Program.compile(source.text)
    except ProgramError as error:
        place = str(source.path if options.program == str(source.path) else options.program)
        raise ProgramFileError(place, error) from error
    if getattr(options, "robot", None) is not None:
        check_name("robot", options.robot, (robot.name for robot in level.robots))
    return level, program


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


@asynccontextmanager
async def run_shown(
    level: Level, program: Program, ticks: int
) -> AsyncIterator[tuple[Run, Callable[[int], None]]]:
    """Open a run, with a progress bar once it takes its time.

    Ticks that an earlier process has computed are not computed again.

    Args:
        level: Where it happens.
        program: What the robots think.
        ticks: The last tick that will be asked for.

    Yields:
        The run, and what is to be told each finished tick.
    """
    from logical_robots_tui.game import Run

    run = Run(level, program)
    try:
        with progress_bar(level.title, ticks, after=_SOON) as show:
            yield run, show
    finally:
        await run.close()


async def frame_at(level: Level, program: Program, tick: int) -> Frame:
    """The frame of a tick of a run from the start; a victory on the way does not end it.

    Args:
        level: Where it happens.
        program: What the robots think.
        tick: Which tick; 0 is the start.
    """
    async with run_shown(level, program, tick) as (run, show):
        return await run.frame(tick, show)
