"""The session: level, program and game at hand, and the work under way for them."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.game import (
    Breakpoints,
    Frame,
    Pace,
    Superseded,
    compile_program,
    mistake_in,
    start_frame,
)
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.tui.program.state import ProgramState

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping

    from logical_robots_tui.game import Breakpoint, Game, Hit, Place, Source
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Predicate, Program, Table
    from logical_robots_tui.tui.app.background import Spawn, Work
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.changing import Pose

__all__ = ["Session"]

_MOST_OWED = 5  # steps that a key held down may leave behind
_NOTICEABLE = 0.5  # seconds of thinking from which on the screen says so


class Session:
    """One level under one program at a time; another level begins a new game.

    `level` is that of the frame on the screen, `opened` the one that its file holds.

    Args:
        level: Where to begin.
        source: The program to begin with.
        spawn: Starts work in the background.
        changed: Called after everything that the screen may want to show.
        used: Called with each program that the robots begin to think with.
        stopped: Called with the breakpoints at which the robots have stopped.
    """

    def __init__(
        self,
        level: Level,
        source: Source,
        *,
        spawn: Spawn,
        changed: Callable[[], None],
        used: Callable[[Program], None],
        stopped: Callable[[tuple[Hit, ...]], None],
    ) -> None:
        self.level = self.opened = level
        self.source = source
        self.state = ProgramState()
        self.pace = Pace()
        self.game: Game | None = None
        self.frame = start_frame(level)
        self.breakpoints = Breakpoints()
        self._spawn = spawn
        self._changed = changed
        self._used = used
        self._stopped = stopped
        self._program: Program | None = None
        self._run_when_ready = False
        self._stepping: object = None
        self._steps_owed = 0
        self._runs_until: int | None = None
        self._waiting_since = 0.0

    # -- looking -------------------------------------------------------------------------------

    @property
    def running(self) -> bool:
        """Whether the robots go on by themselves, or will as soon as the program is compiled."""
        is_on_its_way = self._runs_until is not None and self._stepping is not None
        return (
            self._run_when_ready or is_on_its_way or (self.game is not None and self.game.running)
        )

    @property
    def busy(self) -> bool:
        """Whether something is under way that the player may want to stop."""
        return self.running or self._stepping is not None

    @property
    def program(self) -> Program | None:
        """What the robots think with, or None before the first compilation."""
        return self._program

    @property
    def predicates(self) -> tuple[Predicate, ...]:
        """The predicates of the program that the robots think with."""
        return self._program.predicates if self._program else ()

    @property
    def history(self) -> History | None:
        """What is known of other ticks, or None before there is a program."""
        return self.game.history if self.game is not None else None

    def problem_with(self, breakpoint_: Breakpoint) -> str:
        """Why a breakpoint can't be hit, one sentence, or ""."""
        if self.game is None:
            return mistake_in(breakpoint_, self.level, None)
        return self.game.problem_with(breakpoint_)

    @property
    def won_at(self) -> int | None:
        """The tick of victory as of the present frame, or None."""
        return self.frame.after.won_at

    @property
    def thinking_for(self) -> float:
        """Seconds that the thought under way has taken, 0.0 as long as that is not worth saying."""
        if self.game is None or not (self.game.running or self._stepping is not None):
            return 0.0
        pause = self.pace.period if self.game.running else 0.0
        seconds = perf_counter() - self._waiting_since - pause
        return seconds if seconds > _NOTICEABLE else 0.0

    # -- level and program ---------------------------------------------------------------------

    def open_level(self, level: Level, source: Source, text: str) -> None:
        """Go to a level with a program; its robots stand at the start."""
        self._end_game()
        self.state = ProgramState()
        self.level = self.opened = level
        self.frame = start_frame(level)
        self.source = source
        self.apply(text)

    def open_program(self, source: Source, text: str) -> None:
        """Think with another program from the next tick on."""
        self.source = source
        self.apply(text)

    def saved_as(self, source: Source) -> None:
        """The text in the editor is that of `source` from now on."""
        self.source = source
        self._changed()

    def apply(self, text: str) -> None:
        """Compile a text in the background and use it; an older compilation is given up."""
        if self._program is not None and self._program.text == text:
            self._spawn(_nothing, "compile", exclusive=True)
            self._use(self._program)
            return
        self.state = self.state.compiling(text)
        self._changed()
        self._spawn(partial(self._compile, text), "compile", exclusive=True)

    # -- moving --------------------------------------------------------------------------------

    def toggle_run(self) -> None:
        """Run, or stop whatever is under way."""
        if self.busy:
            self.pause()
        else:
            self.run()

    def run(self) -> None:
        """Let the robots go on, as soon as there is a program."""
        if self.game is None:
            self._run_when_ready = self.state.phase in ("fresh", "compiling")
        elif not self.game.running:
            self._waiting_since = perf_counter()
            self._spawn(partial(self._run, self.game), "move", exclusive=True)
        self._changed()

    def pause(self) -> None:
        """Stop running, and stop a thought under way."""
        self._run_when_ready = False
        if self.game is not None:
            self.game.pause()
        if self._stepping is not None:
            self._stepping = self._runs_until = None
            self._spawn(_nothing, "move", exclusive=True)
        self._changed()

    def step(self, ticks: int = 1) -> None:
        """Go some ticks on; while running, stop after them. Quick presses are worked off."""
        if self._stepping is not None and self._runs_until is None:
            most = max(self._steps_owed, _MOST_OWED * ticks)
            self._steps_owed = min(self._steps_owed + ticks, most)
        elif self.game is not None:
            self.game.pause()
            self._steps_owed, self._runs_until = ticks, None
            self._begin(self._step)

    def run_until(self, tick: int) -> None:
        """Run flat out up to a tick, a breakpoint or victory."""
        self.pause()
        self._runs_until = tick
        self._begin(lambda game: game.run_until(tick=tick))

    async def replay(self, place: Place) -> None:
        """Go again where an earlier session of this level stood; a pause ends that on the way.

        Raises:
            ProgramError: A program can't be compiled any more.
        """
        ends = [(await compile_program(text), end) for text, end in place.stretches()]
        self.restart()
        self._spawn(_nothing, "compile", exclusive=True)
        self._use(ends[0][0])
        self._runs_until = place.tick
        self._begin(partial(self._replay, ends))

    def back(self, ticks: int = 1) -> None:
        """Return by so many ticks, as far as history reaches."""
        self.pause()
        if self.game is not None:
            self.game.back(ticks)

    def go_to(self, tick: int) -> None:
        """Go to a tick of history.

        Raises:
            NoSuchTickError: History does not hold it.
        """
        self.pause()
        if self.game is not None:
            self.game.go_to(tick)

    def change_course(self) -> None:
        """Go over to the other future, and think with its program.

        Raises:
            NoSuchTickError: There is no other future.
        """
        self.pause()
        if self.game is not None:
            self._spawn(_nothing, "compile", exclusive=True)
            self.game.change_course()
            self._think_with(self.game.program)
            self._changed()

    def change_level(self, level: Level, poses: Mapping[str, Pose]) -> None:
        """Go on in a changed level, with robots put elsewhere, from the present tick on."""
        if self.game is not None:
            self.game.change_level(level, poses)
        else:
            self.level, self.frame = level, start_frame(level)
            self._changed()

    def restart(self) -> None:
        """Begin the level again, standing still."""
        self.pause()
        if self.game is not None:
            self.game.restart()

    def faster(self) -> None:
        """Choose the next higher speed."""
        self.pace.faster()
        self._changed()

    def slower(self) -> None:
        """Choose the next lower speed."""
        self.pace.slower()
        self._changed()

    async def query(self, predicate: str, frame: Frame) -> Table:
        """Rows of a predicate at a frame.

        Raises:
            Superseded: The program changed meanwhile, or there is none yet.
            QueryError: The predicate has no rows of its own, or failed.
        """
        if self.game is None:
            raise Superseded
        return (await self.game.query(predicate, frame)).table

    def release(self, close: Work) -> None:
        """Free something in the background."""
        self._spawn(close, "close", exclusive=False)

    async def close(self) -> None:
        """Stop all work."""
        game, self.game = self.game, None
        if game is not None:
            await game.close()

    # -- inside --------------------------------------------------------------------------------

    async def _compile(self, text: str) -> None:
        try:
            program = await compile_program(text, partial(self._compiled, text))
        except ProgramError as error:
            self._run_when_ready = False
            self.state = replace(self.state, phase="mistake", mistakes=error.diagnostics)
            self._changed()
            return
        self._use(program)

    def _compiled(self, text: str, done: int, of_all: int) -> None:
        if self.state.phase == "compiling" and self.state.tried == text:
            self.state = replace(self.state, compiled=(done, of_all))
            self._changed()

    def _use(self, program: Program) -> None:
        from logical_robots_tui.game import Game  # takes time that the first picture needs

        self._think_with(program)
        self._used(program)
        if self.game is None:
            game = self.game = Game(self.level, program, breakpoints=self.breakpoints)
            game.pace = self.pace
            game.listen(lambda frame: self._show(game, frame))
            self.frame = game.frame
            if self._run_when_ready:
                self._run_when_ready = False
                self.run()
        else:
            self.game.use(program)
        self._changed()

    def _think_with(self, program: Program) -> None:
        self._program = program
        self.state = ProgramState.of_applied(program.text, program.warnings)

    def _show(self, game: Game, frame: Frame) -> None:
        if game is self.game:
            self.frame, self.level = frame, game.level
            self._waiting_since = perf_counter()
            self._changed()

    async def _run(self, game: Game) -> None:
        try:
            await game.run()
            self._tell_hits(game)
        finally:
            self._changed()

    def _begin(self, work: Callable[[Game], Coroutine[Any, Any, object]]) -> None:
        """Go on in the background by something that pausing ends."""
        if self.game is not None:
            self._stepping = object()
            self._waiting_since = perf_counter()
            move = partial(self._move, self.game, work, self._stepping)
            self._spawn(move, "move", exclusive=True)

    async def _move(
        self, game: Game, work: Callable[[Game], Coroutine[Any, Any, object]], token: object
    ) -> None:
        try:
            await work(game)
            self._tell_hits(game)
        except Superseded:
            pass
        finally:
            if self._stepping is token:
                self._stepping = self._runs_until = None
            self._changed()

    async def _step(self, game: Game) -> None:
        token = self._stepping
        while self._steps_owed and self._stepping is token:
            self._steps_owed -= 1
            frame = await game.step()
            if self._hits(game) or game.won_at == frame.tick:
                self._steps_owed = 0

    async def _replay(self, ends: list[tuple[Program, int]], game: Game) -> None:
        for program, end in ends:
            self._use(program)
            while game.frame.tick < end:
                await game.run_until(tick=end)

    def _hits(self, game: Game) -> tuple[Hit, ...]:
        """The breakpoints that stop the robots at the present tick."""
        return tuple(hit for hit in game.hits if self.breakpoints.is_on(hit.breakpoint))

    def _tell_hits(self, game: Game) -> None:
        if game is self.game and (hits := self._hits(game)):
            self._stopped(hits)

    def _end_game(self) -> None:
        self.pause()
        game, self.game = self.game, None
        if game is not None:
            self._spawn(game.close, "close", exclusive=False)


async def _nothing() -> None:
    """Take the place of work that is to end."""
