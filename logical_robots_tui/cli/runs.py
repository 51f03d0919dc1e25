"""What the commands that run a program in a level share."""

from __future__ import annotations

import argparse
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from typing import Any

from logical_robots_tui import game, mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    ProgramFileError,
    line_of_json,
    named_programs,
    own_programs,
    prefers_json,
    progress_bar,
)
from logical_robots_tui.errors import InputError

SOON = 0.5
"""Seconds before the progress bar appears."""


def of_run(
    *,
    first_tick: int | None = None,
    ticks: tuple[int, str] | None = None,
    robot: str = "",
    needs_robot: bool = False,
    only_json: bool = False,
) -> command.Part:
    """Return the arguments of a command that takes a level and a program, which `open_run` loads.

    `first_tick` is the lowest ``--tick``, `ticks` the default and the help of ``--ticks``,
    `robot` the help of ``--robot``; by default there is no such option.
    """
    parts = [command.LEVEL, command.programs()]
    if first_tick is not None:
        said = "the tick" if first_tick else "the tick; 0 is the start"
        read = command.number_from(first_tick)
        parts.append(command.option("--tick", "N", said, type=read, required=True))
    if ticks is not None:
        parts.append(command.number("--ticks", command.number_from(1), *ticks))
    if robot:
        parts.append(command.option("--robot", "R", robot, required=needs_robot))
    parts.append(command.START)
    if not only_json:
        parts.append(command.flag("--json", "print JSON even to a terminal"))
    wants_json = (lambda _options: True) if only_json else prefers_json

    def add(parser: argparse._ActionsContainer) -> None:
        parser.set_defaults(wants_json=wants_json)
        for part in (*parts, command.DATA_DIR, command.NO_SOLUTIONS):
            part(parser)

    return add


def open_run(options: argparse.Namespace) -> tuple[world.Level, mind.Program]:
    """Load level and program, check the robot; raise InputError or ProgramFileError."""
    from logical_robots_tui.game.robustness import named_start_of
    from logical_robots_tui.game.source import programs_for

    level = named_start_of(world.load_level(options.level), options.start_number)
    if not named_programs(options):
        hint = "For a first look: logical-robots run 01-first-steps first-steps"
        raise InputError("No program is named.", hint=hint)
    own = own_programs(options)
    sources = programs_for(level, options.programs, dict(options.teams), own, pipes=True)
    try:
        program = mind.Program.compile({team: each.text for team, each in sources.items()})
    except mind.ProgramError as error:
        source = sources[error.team]
        place = str(source.path) if str(source.path) in named_programs(options) else source.name
        raise ProgramFileError(place, error) from error
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
    level: world.Level, program: mind.Program, ticks: int
) -> AsyncIterator[tuple[game.Run, Callable[[int], None]]]:
    """Open a run, reusing stored ticks; yield it and a progress callback for finished ticks."""
    run = game.Run(level, program)
    try:
        with progress_bar(level.title, ticks, after=SOON) as show:
            yield run, show
    finally:
        await run.close()


async def frame_at(level: world.Level, program: mind.Program, tick: int) -> game.Frame:
    async with run_shown(level, program, tick) as (run, show):
        return await run.frame(tick, show)
