"""What the commands that run a program in a level share."""

from __future__ import annotations

import argparse
import sys
from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from contextlib import ExitStack, asynccontextmanager, contextmanager
from time import monotonic
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    ProgramFileError,
    harmless,
    line_of_json,
    named_programs,
    own_programs,
    prefers_json,
)
from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    from rich.progress import Progress

    from logical_robots_tui.game import Frame, Run
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

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


def open_run(options: argparse.Namespace) -> tuple[Level, Program]:
    """Load level and program, check the robot; raise InputError or ProgramFileError."""
    from logical_robots_tui.game.robustness import named_start_of
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


@contextmanager
def progress_bar(title: str, ticks: int, *, after: float = 0.0) -> Iterator[Callable[..., None]]:
    """Show a progress bar after some seconds; yield a callback for finished ticks, and of all."""
    began = monotonic()
    with drawn_bar(title, after) as draw:

        def show(tick: int, of_all: int = ticks) -> None:
            pace = tick / max(monotonic() - began, 1e-9)
            draw(tick, of_all, f"tick {tick} of {of_all}", f"{pace:.0f} ticks/s")

        yield show


_REDRAW_EVERY = 0.1  # seconds


@contextmanager
def drawn_bar(title: str, after: float = 0.0) -> Iterator[Callable[[int, int, str, str], None]]:
    """Yield what draws a bar: part, whole, and two texts beside it. In a pipe it does nothing."""
    due = monotonic() + after if sys.stderr.isatty() else float("inf")
    bar: Progress | None = None
    with ExitStack() as stack:

        def draw(part: int, whole: int, count: str, rest: str) -> None:
            nonlocal bar, due
            now = monotonic()
            if now < due:
                return
            due = now + _REDRAW_EVERY
            if bar is None:
                bar = stack.enter_context(_new_bar())
                bar.add_task(harmless(title), total=whole, count="", rest="")
            task = bar.task_ids[0]
            bar.update(task, completed=part, total=whole, count=count, rest=rest, refresh=True)

        yield draw


def _new_bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.fields[count]}"),
        TextColumn("{task.fields[rest]}"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
