"""The session: level, program and game at hand, and the work under way for them."""

from __future__ import annotations

from functools import partial
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
from logical_robots_tui.game.victory import victory_of
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.tui.app.session_state import Movement, OpenLevel, nothing
from logical_robots_tui.tui.program.state import ProgramState

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping

    from logical_robots_tui.game import Breakpoint, Game, Hit, Place, Source
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Predicate, Program, Table
    from logical_robots_tui.tui.app.session_listener import SessionListener
    from logical_robots_tui.tui.app.ui import Spawn, Work
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.changing import Pose

    Going = Callable[[Game], Coroutine[Any, Any, object]]

__all__ = ["Session"]


class Session:
    """One level under one program at a time; another level begins a new game.

    What happens is said once, to each listener in turn.

    Args:
        level: Where to begin.
        source: The program to begin with.
        spawn: Starts work in the background.
        changed: Called after everything that the screen may want to show.

    Attributes:
        levels: The level at hand: in its file, edited, and on the screen.
        listeners: Who is told what happens.
        movement: What the robots do.
    """

    def __init__(
        self,
        level: Level,
        source: Source,
        *,
        spawn: Spawn,
        changed: Callable[[], None],
    ) -> None:
        self.levels = OpenLevel(level)
        self.source = source
        self.state = ProgramState()
        self.pace = Pace()
        self.game: Game | None = None
        self.frame = start_frame(level)
        self.breakpoints = Breakpoints()
        self.listeners: list[SessionListener] = []
        self.movement = Movement()
        self._spawn = spawn
        self._changed = changed
        self._program: Program | None = None
        self._won: tuple[str, int] | None = None

    # -- looking -------------------------------------------------------------------------------

    @property
    def level(self) -> Level:
        """The level of the frame on the screen."""
        return self.levels.shown

    @property
    def opened(self) -> Level:
        """The level as it is in its file."""
        return self.levels.saved

    @property
    def running(self) -> bool:
        """Whether the robots go on by themselves, or will as soon as the program is compiled."""
        return self.movement.goes_on

    @property
    def busy(self) -> bool:
        """Whether something is under way that the player may want to stop."""
        return not self.movement.is_resting

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
        return self.movement.thinking_for(self.pace.period)

    # -- level and program ---------------------------------------------------------------------

    def open_level(self, level: Level, source: Source, text: str) -> None:
        """Go to a level with a program; its robots stand at the start."""
        self.pause()
        if self.game is not None:
            self.release(self.game.close)
            self.game = None
        self.state = ProgramState()
        self.levels = OpenLevel(level)
        self.frame = start_frame(level)
        self.source = source
        self._won = None
        self._tell(lambda listener: listener.level_opened(level))
        self.apply(text)

    def open_program(self, source: Source, text: str) -> None:
        """Think with another program from the next tick on."""
        self.source = source
        self.apply(text)

    def saved_as(self, source: Source) -> None:
        """The text in the editor is that of `source` from now on."""
        self.source = source
        self._changed()

    def level_saved_as(self, level: Level) -> None:
        """The level at hand is saved, with the name and source of its file."""
        self.levels.saved = level
        self._tell(lambda listener: listener.level_saved(level))

    def apply(self, text: str) -> None:
        """Compile a text in the background and use it; an older compilation is given up."""
        if self._program is not None and self._program.text == text:
            self._spawn(nothing, "compile", exclusive=True)
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
        if self.game is not None and self.movement.kind != "run":
            self._begin(Movement("run"), lambda game: game.run())
        elif self.game is None and self.state.phase in ("fresh", "compiling"):
            self.movement = Movement("awaiting")
        self._changed()

    def pause(self) -> None:
        """Stop running, and stop a thought under way."""
        if self.game is not None:
            self.game.pause()
        if self.movement.thinks:
            self._spawn(nothing, "move", exclusive=True)
        self.movement = Movement()
        self._changed()

    def step(self, ticks: int = 1) -> None:
        """Go some ticks on; while running, stop after them. Quick presses are worked off."""
        if self.movement.kind == "steps":
            self.movement.owe(ticks)
        elif self.game is not None:
            self.game.pause()
            self._begin(Movement("steps", ticks), self._step)

    def run_until(self, tick: int) -> None:
        """Run flat out up to a tick, a breakpoint or victory."""
        self.pause()
        self._begin(Movement("until"), lambda game: game.run_until(tick=tick))

    async def replay(self, place: Place) -> None:
        """Go again where an earlier session of this level stood; a pause ends that on the way.

        Raises:
            ProgramError: A program can't be compiled any more.
        """
        ends = [(await compile_program(text), end) for text, end in place.stretches()]
        self.restart()
        self._spawn(nothing, "compile", exclusive=True)
        self._use(ends[0][0])
        self._begin(Movement("until"), partial(self._replay, ends))

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
            self._spawn(nothing, "compile", exclusive=True)
            self.game.change_course()
            self._think_with(self.game.program)
            self._changed()

    def change_level(self, level: Level, poses: Mapping[str, Pose]) -> None:
        """Go on in a changed level, with robots put elsewhere, from the present tick on."""
        if self.game is not None:
            self.game.change_level(level, poses)
        else:
            self.levels.shown, self.frame = level, start_frame(level)
            self._changed()

    def restart(self) -> None:
        """Begin the level again, standing still."""
        self.pause()
        self._won = None
        if self.game is not None:
            self.game.restart()
        self._tell(lambda listener: listener.restarted())

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
            if self.movement.kind == "awaiting":
                self.movement = Movement()
            self.state = self.state._replace(phase="mistake", mistakes=error.diagnostics)
            self._changed()
            return
        self._use(program)

    def _compiled(self, text: str, done: int, of_all: int) -> None:
        if self.state.phase == "compiling" and self.state.tried == text:
            self.state = self.state._replace(compiled=(done, of_all))
            self._changed()

    def _use(self, program: Program) -> None:
        from logical_robots_tui.game import Game  # takes time that the first picture needs

        self._think_with(program)
        self._tell(lambda listener: listener.program_used(program))
        if self.game is None:
            game = self.game = Game(self.level, program, breakpoints=self.breakpoints)
            game.pace = self.pace
            game.listen(lambda frame: self._show(game, frame))
            self.frame = game.frame
            if self.movement.kind == "awaiting":
                self.run()
        else:
            self.game.use(program)
        self._changed()

    def _think_with(self, program: Program) -> None:
        self._program = program
        self.state = ProgramState.of_applied(program.text, program.warnings)

    def _show(self, game: Game, frame: Frame) -> None:
        if game is not self.game:
            return
        is_next = frame.tick == self.frame.tick + 1
        is_changed = game.level is not self.level
        self.frame, self.levels.shown = frame, game.level
        self.movement.has_thought()
        self._tell(lambda listener: listener.tick_shown(frame))
        if is_changed:
            self._tell(lambda listener: listener.level_changed())
        if is_next and (victory := victory_of(game, self.opened)) is not None:
            won = victory.program.text, victory.tick
            if won != self._won:
                self._won = won
                self._tell(lambda listener: listener.won(victory))
        self._changed()

    def _tell(self, what: Callable[[SessionListener], None]) -> None:
        for listener in self.listeners:
            what(listener)

    def _begin(self, movement: Movement, work: Going) -> None:
        """Go on in the background by something that pausing ends."""
        if self.game is not None:
            self.movement = movement
            move = partial(self._move, self.game, work, movement)
            self._spawn(move, "move", exclusive=True)

    async def _move(self, game: Game, work: Going, movement: Movement) -> None:
        try:
            await work(game)
            if game is self.game and (hits := self._hits(game)):
                self._tell(lambda listener: listener.stopped(hits))
        except Superseded:
            pass
        finally:
            if self.movement is movement:
                self.movement = Movement()
            self._changed()

    async def _step(self, game: Game) -> None:
        movement = self.movement
        while movement.owed and self.movement is movement:
            movement.owed -= 1
            frame = await game.step()
            if self._hits(game) or game.won_at == frame.tick:
                movement.owed = 0

    async def _replay(self, ends: list[tuple[Program, int]], game: Game) -> None:
        for program, end in ends:
            self._use(program)
            while game.frame.tick < end:
                await game.run_until(tick=end)

    def _hits(self, game: Game) -> tuple[Hit, ...]:
        """The breakpoints that stop the robots at the present tick."""
        return tuple(hit for hit in game.hits if self.breakpoints.is_on(hit.breakpoint))
