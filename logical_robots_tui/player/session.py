"""The session: the current level, program and game, and the work in progress for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui import game, mind
from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.game.frame import ends
from logical_robots_tui.game.victory import victory_of
from logical_robots_tui.player.session_state import (
    Going,
    Movement,
    OpenLevel,
    ProgramState,
    SessionListener,
    Spawn,
    TeamSources,
    Work,
    nothing,
)
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.load import is_web_file

if TYPE_CHECKING:
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.world.world import Pose

_NOTICEABLE = 0.5  # seconds of thinking after which the screen shows it
_MOST_OWED = 5  # times as many steps as are requested at once may be pending


class Session:
    """One level under one program at a time; another level starts a new game.

    Listeners are notified of each event once, in order. `sources` are by team, "" without
    teams; `clock` paces the robots.
    """

    def __init__(
        self,
        level: Level,
        sources: Mapping[str, game.ProgramSource],
        spawn: Spawn,
        on_change: Callable[[], None],
        clock: Clock = CLOCK,
    ) -> None:
        self.clock = clock
        self.levels = OpenLevel(level)
        self.sources = TeamSources(sources)
        self.state = ProgramState()
        self.pace = game.Pace(clock=clock)
        self.game: game.Game | None = None
        self.frame = game.start_frame(level)
        self.breakpoints = game.Breakpoints()
        self.listeners: list[SessionListener] = []
        self.movement = Movement()
        self._spawn = spawn
        self._on_change = on_change
        self.program: mind.Program | None = None  # of the robots; none before the first compilation
        self._last_victory: tuple[Texts, int] | None = None
        self._written = self._checking = ""

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
        return self.movement.kind in ("run", "until")

    @property
    def busy(self) -> bool:
        return self.movement.kind != "rest"

    @property
    def awaits_program(self) -> bool:
        """Whether something waits for a program that is being compiled."""
        return self.movement.pending is not None

    @property
    def source(self) -> game.ProgramSource:
        """The program in the editor, the selected team's."""
        return self.sources.source

    @property
    def predicates(self) -> tuple[mind.Predicate, ...]:
        return self.program.predicates if self.program else ()

    @property
    def history(self) -> History | None:
        return self.game.history if self.game is not None else None

    def problem_with(self, breakpoint_: game.Breakpoint) -> str:
        """Return one sentence on why a breakpoint can't be hit, or ""."""
        if self.game is None:
            return game.mistake_in(breakpoint_, self.level, None)
        return self.game.problem_with(breakpoint_)

    @property
    def won_at(self) -> int | None:
        return self.frame.after.won_at

    @property
    def thinking_for(self) -> float:
        """Seconds that the current think has taken; 0.0 while not worth showing."""
        movement = self.movement
        if not movement.thinks:
            return 0.0
        seconds = self.clock.now() - movement.waiting_since
        seconds -= self.pace.period if movement.kind == "run" else 0.0
        return seconds if seconds > _NOTICEABLE else 0.0

    def open_level(
        self, level: Level, sources: Mapping[str, game.ProgramSource], text: str
    ) -> None:
        """Open a level at its start; `text` replaces that of the first program."""
        self.pause()
        if self.game is not None:
            self.release(self.game.close)
            self.game = None
        self.state = ProgramState()
        self.levels = OpenLevel(level)
        self.frame = game.start_frame(level)
        self.sources = TeamSources(sources)
        self._last_victory = None
        self._tell(lambda listener: listener.level_opened(level))
        self.apply(text)

    def look_at(self, team: str) -> None:
        """Show another team's program in the editor; the robots are not affected."""
        self.sources.team = team
        if self.game is not None:
            self.game.look_at(team)
            self._think_with(self.game.program)
        self._on_change()

    def open_program(self, source: game.ProgramSource, text: str) -> None:
        self.sources.source = source
        self.apply(text)

    def saved_as(self, source: game.ProgramSource) -> None:
        self.sources.source = source
        self._on_change()

    def level_saved_as(self, level: Level) -> None:
        self.levels.saved = level
        self._tell(lambda listener: listener.level_saved(level))

    def apply(self, text: str) -> None:
        """Compile a text in the background and use it; cancels an older compilation."""
        texts = self.sources.with_text(text)
        if self.program is not None and self.program.texts == texts:
            self._spawn(nothing, "compile", exclusive=True)
            self.use(self.program)
            return
        applied, warnings = self.state.applied, self.state.warnings
        self.state = ProgramState("compiling", text, applied, warnings=warnings)
        if self._checking not in ("", text):
            self._spawn(nothing, "check", exclusive=True)
        self._on_change()
        self._spawn(partial(self._compile, text, texts), "compile", exclusive=True)

    def check(self, text: str) -> None:
        """Find the errors of a text that is being written, in the background."""
        self._written = text
        if not self._checking and text not in (self.state.tried, self.state.applied):
            self._checking = text
            self._spawn(partial(self._check, text), "check", exclusive=True)

    def use(self, program: mind.Program) -> None:
        program = self._think_with(program)
        self._tell(lambda listener: listener.program_used(program))
        if self.game is None:
            points, clock, pace = self.breakpoints, self.clock, self.pace
            game_ = self.game = game.Game(
                self.level, program, breakpoints=points, clock=clock, pace=pace
            )
            game_.listen(lambda frame: self._show(game_, frame))
            self.frame = game_.frame
        else:
            self.game.use(program)
        if self.movement.pending is not None:
            self._begin(self.movement, self.movement.pending)
        self._on_change()

    def keep_program(self) -> None:
        """Go on with the robots' program rather than wait for another one, if there are both."""
        if self.awaits_program and self.game is not None and self.program is not None:
            self._spawn(nothing, "compile", exclusive=True)
            self.use(self.program)

    def toggle_run(self) -> None:
        if self.busy:
            self.pause()
        else:
            self.run()

    def run(self) -> None:
        if self.movement.kind != "run":
            self._begin(Movement("run"), lambda game_: game_.run())
        self._on_change()

    def pause(self) -> None:
        """Stop running, and cancel the current think."""
        if self.game is not None:
            self.game.pause()
        if self.movement.thinks:
            self._spawn(nothing, "move", exclusive=True)
        self.movement = Movement()
        self._on_change()

    def step(self, ticks: int = 1) -> None:
        """Compute some ticks; while running, stop after them. Quick presses add up."""
        movement = self.movement
        if movement.kind == "steps":
            movement.owed = min(movement.owed + ticks, max(movement.owed, _MOST_OWED * ticks))
        else:
            if self.game is not None:
                self.game.pause()
            self._begin(Movement("steps", ticks), self._step)

    def run_until(self, tick: int) -> None:
        """Run at full speed to a tick, a breakpoint or victory."""
        self.pause()
        self._begin(Movement("until"), lambda game_: game_.run_until(tick=tick))

    def go_through(self, program: mind.Program, work: Going) -> None:
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

    def change_branch(self) -> None:
        """Switch to the other branch and its program, or raise NoSuchTickError."""
        self.pause()
        if self.game is not None:
            self._spawn(nothing, "compile", exclusive=True)
            self.game.change_branch()
            self._think_with(self.game.program)
            self._on_change()

    def change_level(self, level: Level, poses: Mapping[str, Pose]) -> None:
        """Continue from the current tick in a changed level, with some robots moved."""
        if self.game is not None:
            self.game.change_level(level, poses)
        else:
            self.levels.shown, self.frame = level, game.start_frame(level)
            self._on_change()

    def place_robot(self, robot_name: str, pose: Pose) -> None:
        """Put a robot elsewhere at the end of the current tick; its start stays the same."""
        self.change_level(self.level, {robot_name: pose})

    def restart(self) -> None:
        self.pause()
        self._last_victory = None
        if self.game is not None:
            self.game.restart()
        self._tell(lambda listener: listener.restarted())

    def release(self, close: Work) -> None:
        self._spawn(close, "close", exclusive=False)

    async def close(self) -> None:
        game_, self.game = self.game, None
        if game_ is not None:
            await game_.close()

    async def _compile(self, text: str, texts: Texts) -> None:
        def show_progress(count: int, total: int) -> None:
            if self.state.phase == "compiling" and self.state.tried == text:
                self.state = self.state._replace(compiled=(count, total))
                self._on_change()

        try:
            program = await game.compile_program(texts, show_progress)
        except mind.ProgramError as error:
            mistakes = self.sources.mistakes(error)
            self.state = self.state._replace(phase="mistake", mistakes=mistakes)
            if self.awaits_program:
                self.movement = Movement()
                self._tell(lambda listener: listener.program_rejected())
            self._on_change()
            return
        self.use(program)

    async def _check(self, text: str) -> None:
        sources = self.sources
        try:
            program = await game.compile_program(sources.with_text(text))
            diagnostics = self._warnings(program.for_team(sources.team))
        except mind.ProgramError as error:
            diagnostics = sources.mistakes(error)
        finally:
            if self._checking == text:
                self._checking = ""
        if sources is not self.sources:
            return
        if self._written != text:
            self.check(self._written)
        elif text not in (self.state.tried, self.state.applied):
            self.state = self.state._replace(checked=text, diagnostics=diagnostics)
            self._on_change()

    def _warnings(self, program: mind.Program) -> tuple[mind.Diagnostic, ...]:
        return game.warnings_in(program, self.level, web=is_web_file(self.opened.source))

    def _think_with(self, program: mind.Program) -> mind.Program:
        program = self.program = self.sources.adopt(program)
        text, warnings = program.text, self._warnings(program)
        self.state = ProgramState("applied", text, text, warnings, warnings)
        return program

    def _show(self, game_: game.Game, frame: game.Frame) -> None:
        if game_ is not self.game:
            return
        is_next = frame.tick == self.frame.tick + 1
        is_changed = game_.level is not self.level
        self.frame, self.levels.shown = frame, game_.level
        self.movement.waiting_since = self.clock.now()
        self._tell(lambda listener: listener.tick_shown(frame))
        if is_changed:
            self._tell(lambda listener: listener.level_changed())
        if is_next and not game_.decide and (victory := victory_of(game_, self.opened)) is not None:
            victory_key = victory.program.texts, victory.tick
            if victory_key != self._last_victory:
                self._last_victory = victory_key
                self._tell(lambda listener: listener.won(victory))
        self._on_change()

    def _tell(self, notify: Callable[[SessionListener], None]) -> None:
        for listener in self.listeners:
            notify(listener)

    def _begin(self, movement: Movement, work: Going) -> None:
        """Begin work, if need be when the program has been compiled."""
        if self.state.phase in ("fresh", "compiling"):
            self.movement, movement.pending = movement, work
        elif self.game is not None:
            self.movement, movement.pending = movement, None
            movement.waiting_since = self.clock.now()
            move = partial(self._move, self.game, work, movement)
            self._spawn(move, "move", exclusive=True)

    async def _move(self, game_: game.Game, work: Going, movement: Movement) -> None:
        try:
            await work(game_)
            if game_ is self.game and (hits := self._hits(game_)):
                self._tell(lambda listener: listener.stopped(hits))
        except game.Superseded:
            pass
        finally:
            if self.movement is movement:
                self.movement = Movement()
            self._on_change()

    async def _step(self, game_: game.Game) -> None:
        movement = self.movement
        while movement.owed and self.movement is movement:
            movement.owed -= 1
            try:
                frame = await game_.step()
            except (
                game.Superseded
            ):  # by another program or a changed level, in which the step is due
                movement.owed += game_ is self.game
                continue
            if self._hits(game_) or ends(game_.level, frame):
                movement.owed = 0

    def _hits(self, game_: game.Game) -> tuple[game.Hit, ...]:
        return tuple(hit for hit in game_.hits if self.breakpoints.is_on(hit.breakpoint))
