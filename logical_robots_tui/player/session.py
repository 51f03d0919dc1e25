"""The session: the current level, program and game, and the work in progress for them."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.game import (
    Breakpoints,
    Frame,
    Pace,
    Superseded,
    compile_program,
    mistake_in,
    start_frame,
    warnings_in,
)
from logical_robots_tui.game.frame import ends
from logical_robots_tui.game.victory import victory_of
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.player.session_state import (
    Movement,
    OpenLevel,
    ProgramState,
    TeamSources,
    nothing,
)
from logical_robots_tui.world.levels.load import is_web_file

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Mapping

    from logical_robots_tui.game import Breakpoint, Game, Hit, Source
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Predicate, Program
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.player.session_state import SessionListener, Spawn, Work
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.world import Pose

    Going = Callable[[Game], Coroutine[Any, Any, object]]


class Session:
    """One level under one program at a time; another level starts a new game.

    Listeners are notified of each event once, in order. `sources` are by team, "" without
    teams; `clock` paces the robots.
    """

    def __init__(
        self,
        level: Level,
        sources: Mapping[str, Source],
        spawn: Spawn,
        changed: Callable[[], None],
        clock: Clock = CLOCK,
    ) -> None:
        self.clock = clock
        self.levels = OpenLevel(level)
        self.sources = TeamSources(sources)
        self.state = ProgramState()
        self.pace = Pace(clock=clock)
        self.game: Game | None = None
        self.frame = start_frame(level)
        self.breakpoints = Breakpoints()
        self.listeners: list[SessionListener] = []
        self.movement = Movement()
        self._spawn = spawn
        self._changed = changed
        self._program: Program | None = None
        self._won: tuple[Texts, int] | None = None

    # -- queries -------------------------------------------------------------------------------

    @property
    def level(self) -> Level:
        return self.levels.shown

    @property
    def opened(self) -> Level:
        """The level as its file has it."""
        return self.levels.saved

    @property
    def running(self) -> bool:
        """Whether the robots run, or will run as soon as the program is compiled."""
        return self.movement.goes_on

    @property
    def busy(self) -> bool:
        return not self.movement.is_resting

    @property
    def source(self) -> Source:
        """The program in the editor: that of the selected team."""
        return self.sources.source

    @property
    def program(self) -> Program | None:
        """The robots' program, or None before the first compilation."""
        return self._program

    @property
    def predicates(self) -> tuple[Predicate, ...]:
        return self._program.predicates if self._program else ()

    @property
    def history(self) -> History | None:
        return self.game.history if self.game is not None else None

    def problem_with(self, breakpoint_: Breakpoint) -> str:
        """Return one sentence on why a breakpoint can't be hit, or ""."""
        if self.game is None:
            return mistake_in(breakpoint_, self.level, None)
        return self.game.problem_with(breakpoint_)

    @property
    def won_at(self) -> int | None:
        return self.frame.after.won_at

    @property
    def thinking_for(self) -> float:
        """Seconds that the current think has taken; 0.0 while not worth showing."""
        return self.movement.thinking_for(self.clock.now(), self.pace.period)

    # -- level and program ---------------------------------------------------------------------

    def open_level(self, level: Level, sources: Mapping[str, Source], text: str) -> None:
        """Open a level at its start; `text` replaces that of the first program."""
        self.pause()
        if self.game is not None:
            self.release(self.game.close)
            self.game = None
        self.state = ProgramState()
        self.levels = OpenLevel(level)
        self.frame = start_frame(level)
        self.sources = TeamSources(sources)
        self._won = None
        self._tell(lambda listener: listener.level_opened(level))
        self.apply(text)

    def look_at(self, team: str) -> None:
        """Show another team's program in the editor; the robots are not affected."""
        self.sources.team = team
        if self.game is not None:
            self.game.look_at(team)
            self._think_with(self.game.program)
        self._changed()

    def open_program(self, source: Source, text: str) -> None:
        self.sources.source = source
        self.apply(text)

    def saved_as(self, source: Source) -> None:
        self.sources.source = source
        self._changed()

    def level_saved_as(self, level: Level) -> None:
        self.levels.saved = level
        self._tell(lambda listener: listener.level_saved(level))

    def apply(self, text: str) -> None:
        """Compile a text in the background and use it; cancels an older compilation."""
        texts = self.sources.with_text(text)
        if self._program is not None and self._program.texts == texts:
            self._spawn(nothing, "compile", exclusive=True)
            self.use(self._program)
            return
        self.state = self.state.compiling(text)
        self._changed()
        self._spawn(partial(self._compile, text, texts), "compile", exclusive=True)

    def use(self, program: Program) -> None:
        from logical_robots_tui.game import Game  # loading it would delay the first picture

        program = self._think_with(program)
        self._tell(lambda listener: listener.program_used(program))
        if self.game is None:
            game = self.game = Game(
                self.level, program, breakpoints=self.breakpoints, clock=self.clock
            )
            game.pace = self.pace
            game.listen(lambda frame: self._show(game, frame))
            self.frame = game.frame
            if self.movement.kind == "awaiting":
                self.run()
        else:
            self.game.use(program)
        self._changed()

    # -- moving --------------------------------------------------------------------------------

    def toggle_run(self) -> None:
        if self.busy:
            self.pause()
        else:
            self.run()

    def run(self) -> None:
        if self.game is not None and self.movement.kind != "run":
            self._begin(Movement("run"), lambda game: game.run())
        elif self.game is None and self.state.phase in ("fresh", "compiling"):
            self.movement = Movement("awaiting")
        self._changed()

    def pause(self) -> None:
        """Stop running, and cancel the current think."""
        if self.game is not None:
            self.game.pause()
        if self.movement.thinks:
            self._spawn(nothing, "move", exclusive=True)
        self.movement = Movement()
        self._changed()

    def step(self, ticks: int = 1) -> None:
        """Compute some ticks; while running, stop after them. Quick presses add up."""
        if self.movement.kind == "steps":
            self.movement.owe(ticks)
        elif self.game is not None:
            self.game.pause()
            self._begin(Movement("steps", ticks), self._step)

    def run_until(self, tick: int) -> None:
        """Run at full speed to a tick, a breakpoint or victory."""
        self.pause()
        self._begin(Movement("until"), lambda game: game.run_until(tick=tick))

    def go_through(self, program: Program, work: Going) -> None:
        """Restart with a program and let `work` advance the game until paused."""
        self.restart()
        self._spawn(nothing, "compile", exclusive=True)
        self.use(program)
        self._begin(Movement("until"), work)

    def back(self, ticks: int = 1) -> None:
        self.pause()
        if self.game is not None:
            self.game.back(ticks)

    def go_to(self, tick: int) -> None:
        """Go to a tick of the history, or raise NoSuchTickError."""
        self.pause()
        if self.game is not None:
            self.game.go_to(tick)

    def change_course(self) -> None:
        """Switch to the other future and its program, or raise NoSuchTickError."""
        self.pause()
        if self.game is not None:
            self._spawn(nothing, "compile", exclusive=True)
            self.game.change_course()
            self._think_with(self.game.program)
            self._changed()

    def change_level(self, level: Level, poses: Mapping[str, Pose]) -> None:
        """Continue from the current tick in a changed level, with some robots moved."""
        if self.game is not None:
            self.game.change_level(level, poses)
        else:
            self.levels.shown, self.frame = level, start_frame(level)
            self._changed()

    def put(self, robot_name: str, pose: Pose) -> None:
        """Put a robot elsewhere at the end of the current tick; its start stays the same."""
        self.change_level(self.level, {robot_name: pose})

    def restart(self) -> None:
        self.pause()
        self._won = None
        if self.game is not None:
            self.game.restart()
        self._tell(lambda listener: listener.restarted())

    def faster(self) -> None:
        self.pace.faster()
        self._changed()

    def slower(self) -> None:
        self.pace.slower()
        self._changed()

    def release(self, close: Work) -> None:
        self._spawn(close, "close", exclusive=False)

    async def close(self) -> None:
        game, self.game = self.game, None
        if game is not None:
            await game.close()

    # -- inside --------------------------------------------------------------------------------

    async def _compile(self, text: str, texts: Texts) -> None:
        try:
            program = await compile_program(texts, partial(self._compiled, text))
        except ProgramError as error:
            if self.movement.kind == "awaiting":
                self.movement = Movement()
            mistakes = self.sources.mistakes(error)
            self.state = self.state._replace(phase="mistake", mistakes=mistakes)
            self._changed()
            return
        self.use(program)

    def _compiled(self, text: str, done: int, of_all: int) -> None:
        if self.state.phase == "compiling" and self.state.tried == text:
            self.state = self.state._replace(compiled=(done, of_all))
            self._changed()

    def _think_with(self, program: Program) -> Program:
        program = self._program = self.sources.seen(program)
        warnings = warnings_in(program, self.level, web=is_web_file(self.opened.source))
        self.state = ProgramState.of_applied(program.text, warnings)
        return program

    def _show(self, game: Game, frame: Frame) -> None:
        if game is not self.game:
            return
        is_next = frame.tick == self.frame.tick + 1
        is_changed = game.level is not self.level
        self.frame, self.levels.shown = frame, game.level
        self.movement.waiting_since = self.clock.now()
        self._tell(lambda listener: listener.tick_shown(frame))
        if is_changed:
            self._tell(lambda listener: listener.level_changed())
        if is_next and not game.decide and (victory := victory_of(game, self.opened)) is not None:
            won = victory.program.texts, victory.tick
            if won != self._won:
                self._won = won
                self._tell(lambda listener: listener.won(victory))
        self._changed()

    def _tell(self, what: Callable[[SessionListener], None]) -> None:
        for listener in self.listeners:
            what(listener)

    def _begin(self, movement: Movement, work: Going) -> None:
        if self.game is not None:
            self.movement = movement
            movement.waiting_since = self.clock.now()
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
            try:
                frame = await game.step()
            except Superseded:  # by another program or a changed level, in which the step is due
                movement.owed += game is self.game
                continue
            if self._hits(game) or ends(game.level, frame):
                movement.owed = 0

    def _hits(self, game: Game) -> tuple[Hit, ...]:
        return tuple(hit for hit in game.hits if self.breakpoints.is_on(hit.breakpoint))
