"""The game as lines of text, for screen readers and pipes: typed commands, printed events."""

from __future__ import annotations

import asyncio
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from logical_robots_tui.cli.command import harmless
from logical_robots_tui.cli.failure import ProgramFileError
from logical_robots_tui.errors import InputError
from logical_robots_tui.game import (
    Breakpoint,
    Frame,
    Game,
    NoSuchTickError,
    Source,
    goals,
    level_key,
    load_program,
    save_program,
)
from logical_robots_tui.game.frame import events_between
from logical_robots_tui.game.robustness import named_start_of
from logical_robots_tui.game.source import hide_solutions, target, warnings_in
from logical_robots_tui.game.victory import Victory, keep_victory, result_line, victory_of
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.paths import is_there
from logical_robots_tui.player.continuing import (
    keep_if_own,
    level_to_begin_with,
    note_level,
    programs_to_begin_with,
)
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import Level, load_level

MOST = 5000
"""The default tick limit of ``run``."""

HELP = f"""\
run [N]         run until victory or a stop, for at most N ticks ({MOST} by default)
step [N]        one tick forward, or N ticks
back [N]        one tick back, or N ticks
restart         start again at tick 0
where           positions of the robots, and who is in a goal
stop PREDICATE  stop a run when a predicate has rows; repeat to remove the stop
save NAME       save the program as a file of your own, which you can edit
apply           read the program's file again and continue with it
help            this list
quit            leave; so does the end of the input"""


def play_in_lines(
    level_name: str | None,
    programs: Sequence[str],
    teams: Mapping[str, str],
    data_dir: Path,
    *,
    start: int,
    solutions: bool,
) -> int:
    """Play in lines of text until the player leaves; return the exit status.

    Raises InputError or ProgramFileError if the level or a program can't be used.
    """
    progress = Progress(data_dir / FILE_NAME, _say)
    if not solutions:
        hide_solutions(progress)
    own = data_dir / "programs"
    try:
        level = load_level(level_name) if level_name else level_to_begin_with(progress)
        level = named_start_of(level, start)
        sources, kept = programs_to_begin_with(progress, level, programs, teams, own)
        mine = next(iter(sources))
        if kept is not None and kept != sources[mine].text:
            sources[mine] = sources[mine]._replace(text=kept)
            _say("Loaded your last program for this level.")
        try:
            program = Program.compile({team: each.text for team, each in sources.items()})
        except ProgramError as error:
            raise ProgramFileError(sources[error.team].name, error) from error
        game = _TextGame(level, sources, program, progress, own)
        return asyncio.run(game.play())
    finally:
        progress.close()


class _TextGame:
    def __init__(
        self,
        level: Level,
        sources: dict[str, Source],
        program: Program,
        progress: Progress,
        own: Path,
    ) -> None:
        self._level, self._sources, self._mine = level, sources, next(iter(sources))
        self._progress, self._key, self._own = progress, level_key(level), own
        self._game = Game(level, program)
        self._game.listen(self._tell_events)
        self._past = self._game.frame
        note_level(progress, level)
        keep_if_own(progress, self._key, program.text)
        self._commands: dict[str, Callable[[int], object]] = {
            "back": lambda ticks: self._go(lambda: self._game.back(ticks)),
            "restart": lambda _: self._go(self._game.restart),
            "where": lambda _: _say(*self._places()),
            "apply": lambda _: self._apply(),
            "help": lambda _: _say(HELP),
        }

    async def play(self) -> int:
        _say(self._level.title, *self._level.briefing.strip().splitlines())
        _say(*(f"Second goal: {goal.words}." for goal in self._level.second_goals), *self._places())
        self._tell_warnings(self._game.program)
        _say("Type help for the commands.")
        try:
            while line := await asyncio.to_thread(sys.stdin.readline):
                if line.strip() in ("quit", "q"):
                    break
                await self._execute(line)
        finally:
            await self._game.close()
        return 0

    async def _execute(self, line: str) -> None:
        word, _, rest = line.strip().partition(" ")
        if not word:
            return
        if word == "stop":
            self._stop_at(rest.strip())
            return
        if word == "save":
            self._save(rest.strip())
            return
        if rest and not (rest.isdecimal() and int(rest)):
            _say(f"{rest} is not a number of ticks.")
        elif word in ("run", "step"):
            await self._run(int(rest or (MOST if word == "run" else 1)))
        elif word in self._commands:
            self._commands[word](int(rest or 1))
        else:
            _say(f"Unknown command {word}. Type help for a list.")

    async def _run(self, ticks: int) -> None:
        frame = await self._game.run_until(tick=self._game.frame.tick + ticks)
        for hit in self._game.hits:
            _say(f"Stopped: {hit.breakpoint.words}. {hit.values}")
        _say(f"Tick {frame.tick}.")

    def _go(self, move: Callable[[], Frame]) -> None:
        try:
            self._past = move()
        except NoSuchTickError as error:
            _say(str(error))
        _say(f"Tick {self._game.frame.tick}.")

    def _stop_at(self, predicate: str) -> None:
        wanted = Breakpoint("rows", predicate)
        if wanted in self._game.breakpoints:
            self._game.breakpoints.remove(wanted)
            _say(f"Runs no longer stop when {wanted.words}.")
            return
        problem = self._game.problem_with(wanted)
        if not problem:
            self._game.breakpoints.add(wanted)
        _say(problem or f"Runs will stop when {wanted.words}.")

    def _save(self, name: str) -> None:
        try:
            path = target(name, self._own)
            if is_there(path):
                raise InputError("already exists.", place=str(path), hint="Choose another name.")
            save_program(path, self._source.text)
            self._sources[self._mine] = load_program(path)
        except InputError as error:
            _say(str(error))
        else:
            _say(f"Saved as {path}. Edit that file, then type apply.")

    @property
    def _source(self) -> Source:
        return self._sources[self._mine]

    def _apply(self) -> None:
        if self._source.shipped:
            _say("This program is not in a file of yours. Type save and a name first.")
            return
        try:
            self._sources[self._mine] = load_program(self._source.path)
            program = Program.compile({team: each.text for team, each in self._sources.items()})
        except InputError as error:
            _say(str(error))
        except ProgramError as error:
            for found in error.diagnostics:
                _say(f"Line {found.line}: {found.message} {found.hint}")
        else:
            self._game.use(program)
            keep_if_own(self._progress, self._key, program.text)
            _say("The robots will use it from the next tick.")
            self._tell_warnings(program)

    def _tell_warnings(self, program: Program) -> None:
        for found in warnings_in(program.for_team(self._mine), self._level):
            _say(f"Warning, line {found.line}: {found.message}. {found.hint}".rstrip())

    def _tell_events(self, frame: Frame) -> None:
        if frame.tick == self._past.tick + 1:
            for event in events_between(self._level, self._past, frame):
                _say(f"Tick {frame.tick}: {event}")
            if frame.tick == 1:
                self._progress.begin(self._key)
            if (victory := victory_of(self._game, self._level)) is not None:
                self._keep(victory)
        self._past = frame

    def _keep(self, victory: Victory) -> None:
        keep_victory(self._progress, self._key, victory)
        if victory.verdict == "reference":
            _say("Won by a reference program: not counted.")
        elif victory.refusal:
            _say(victory.refusal)
        elif self._progress.is_kept:
            _say("The victory is saved in your progress.")
        else:
            _say("The victory only counts until you leave: nothing can be saved on this disk.")
        if victory.verdict == "counts" and victory.measures is not None:
            _say(result_line(victory.level, victory.measures))
            _say(*(f"Second goal reached: {goal}." for goal in victory.measures.goals))

    def _places(self) -> Iterator[str]:
        frame = self._game.frame
        for given, robot in zip(self._level.robots, frame.after.robots, strict=True):
            heading = f"{math.degrees(robot.angle) % 360:.0f} degrees"
            charge = f", battery {robot.battery_level:.0f}" if given.has_battery else ""
            yield f"{robot.name}: at {robot.x:.0f}, {robot.y:.0f}, heading {heading}{charge}."
        for goal in goals(self._level, frame.after):
            yield goal.words


def _say(*sentences: str) -> None:
    """Print and flush, because a screen reader or another program waits for the line."""
    for sentence in sentences:
        for line in sentence.splitlines():
            print(harmless(line), flush=True)
