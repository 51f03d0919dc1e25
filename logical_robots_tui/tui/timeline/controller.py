"""Time travel: what the commands of the timeline do, the search for a tick, and replays."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import MARK_KINDS, NoSuchTickError, Superseded, compile_program
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from logical_robots_tui.game import Breakpoint, Game, Hit, ProgramSource, SearchResult
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.labyrinth.view import LabyrinthView
    from logical_robots_tui.world import Level

_SOUGHT = [kind for kind in MARK_KINDS if kind != "memory"]  # that of the selected robot only
_EVENTS = (
    "Events are victories, breakpoints, edits, switched areas, notices, stuck robots, and memory "
    "changes of a robot selected with {next_robot}. {first} and {last} go to either end."
)
_NO_PROGRAM = "There is no program yet."


class TimelineController(SessionListener):
    def __init__(self, session: Session, ui: Dialogs, view: LabyrinthView) -> None:
        self._session, self._ui, self._view = session, ui, view

    @property
    def _history(self) -> History | None:
        return self._session.history

    def go_to(self, tick: int) -> None:
        try:
            self._session.go_to(tick)
        except NoSuchTickError as error:
            self._ui.warn(f"{error}{self._elsewhere(tick)}")

    def first(self) -> None:
        if self._history is not None:
            self.go_to(self._history.first)

    def last(self) -> None:
        if self._history is not None:
            self.go_to(self._history.last)

    def to_mark(self, steps: Literal[-1, 1]) -> None:
        if self._history is None:
            return
        robot = self._view.selected
        tick = self._session.frame.tick
        mark_tick = self._history.marks.nearest(tick, steps, _SOUGHT, robot)
        if mark_tick is not None and mark_tick >= self._history.first:
            self.go_to(mark_tick)
        else:
            side = "after" if steps > 0 else "before"
            from logical_robots_tui.tui.commands.keymap import with_keys

            self._ui.tell(f"No event {side} tick {tick}. {with_keys(_EVENTS)}")

    async def ask_for_tick(self) -> None:
        history = self._history
        if history is None:
            self._ui.tell(_NO_PROGRAM)
            return

        def complaint(tick: int) -> str:
            if history.first <= tick <= history.last:
                return ""
            sentence = f"The history holds ticks {history.first} to {history.last}, not {tick}."
            if history.dropped > tick:
                sentence += " There was no room for more."
            return f"{sentence}{self._elsewhere(tick)}"

        chosen_tick = await self._ask("Go to tick", complaint)
        if chosen_tick is not None:
            self.go_to(chosen_tick)

    async def ask_how_far(self) -> None:
        current_tick = self._session.frame.tick

        def complaint(tick: int) -> str:
            return "" if tick > current_tick else f"The robots are already at tick {current_tick}."

        if self._history is None:
            self._ui.tell(_NO_PROGRAM)
            return
        last_tick = await self._ask("Run until tick", complaint)
        if last_tick is not None:
            self._session.run_until(last_tick)

    async def _ask(self, title: str, problem: Callable[[int], str]) -> int | None:
        from logical_robots_tui.tui.timeline.breakpoints import TickPrompt

        return await self._ui.ask(TickPrompt(title, self._session.frame.tick, problem))

    def change_branch(self) -> None:
        try:
            self._session.change_branch()
        except NoSuchTickError:
            self._say_there_is_none()
            return
        self._ui.tell("This is the other branch. The robots use its program.")

    def compare(self) -> None:
        game, history = self._session.game, self._history
        if game is None or history is None or history.other_ticks is None:
            self._say_there_is_none()
            return
        if history.divergence is None:
            known = min(history.last, history.other_ticks[-1])
            self._ui.tell(f"The two branches are equal as far as both are known, up to {known}.")
            return
        from logical_robots_tui.tui.timeline.divergence import DivergencePage

        if history.first <= history.divergence.tick <= history.last:
            self.go_to(history.divergence.tick)
        self._ui.show(DivergencePage(game, history.divergence))

    def _say_there_is_none(self) -> None:
        self._ui.tell(
            "There is no other branch yet. Go back, change the program, and run the robots."
        )

    def _elsewhere(self, tick: int) -> str:
        other = self._history.other_ticks if self._history is not None else None
        return " The other branch holds it." if other is not None and tick in other else ""

    def breakpoints(self) -> None:
        from logical_robots_tui.tui.timeline.breakpoints import BreakpointList

        self._ui.show(BreakpointList(self._session))

    def add_breakpoint(self, breakpoint_: Breakpoint) -> None:
        self._session.breakpoints.add(breakpoint_)
        trouble = self._session.problem_with(breakpoint_)
        if trouble:
            self._ui.warn(f"{breakpoint_.words}: {trouble}")
        else:
            self._ui.tell(f"The robots stop when {one_line(breakpoint_.words)}.")

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        for hit in hits:
            words = one_line(f"{hit.breakpoint.words}: {hit.values}")
            self._ui.tell(f"◉ Stopped at tick {hit.tick}. {words}")


_PATIENCE = 0.5  # seconds of a search before a message
_REPEAT = 4.0  # seconds until the next one


class TickSearch:
    """Goes to the next or previous tick in which a question holds.

    `inspected` returns the breakpoint at what the inspector shows.
    """

    def __init__(
        self,
        session: Session,
        ui: Dialogs,
        go_to: Callable[[int], None],
        inspected: Callable[[], Breakpoint | None],
    ) -> None:
        self._session, self._ui, self._go_to, self._inspected = session, ui, go_to, inspected
        self._question = ""
        self._ended: tuple[int, Breakpoint | None] | None = None

    def breakpoint_here(self) -> Breakpoint | None:
        """Return a breakpoint at the question, or None once the player has moved on."""
        if self._ended != (self._session.frame.tick, self._inspected()):
            return None
        from logical_robots_tui.game import Breakpoint

        return Breakpoint("rows", self._question)

    async def ask(self) -> None:
        from logical_robots_tui.tui.timeline.breakpoints import QuestionPrompt

        program = self._session.program
        if program is None:
            self._ui.tell(_NO_PROGRAM)
            return
        prompt = QuestionPrompt("Go to the next tick in which…", self._question, program)
        question = await self._ui.ask(prompt)
        if question is not None:
            self._question = question
            await self.go(1)

    async def go(self, direction: Literal[-1, 1]) -> None:
        """Go to the nearest later (1) or earlier (-1) tick in which the question holds."""
        session = self._session
        if not self._question:
            await self.ask()
            return
        session.pause()
        game = session.game
        if game is None:
            self._ui.tell(_NO_PROGRAM)
            return
        state_key, patient_until = self._state_key(game), session.clock.now() + _PATIENCE
        inspected, self._ended, progress = self._inspected(), None, ""

        def report(tick: int) -> None:
            nonlocal patient_until, progress
            if state_key != self._state_key(session.game):
                raise Superseded  # the player has moved on
            if session.clock.now() > patient_until:
                patient_until = session.clock.now() + _REPEAT
                self._ui.withdraw(progress)
                progress = f"Searching, at tick {tick}… Go to any tick to stop."
                self._ui.tell(progress)

        from logical_robots_tui.game import search_ticks

        try:
            outcome = await search_ticks(game, self._question, direction, report)
        except Superseded:
            return
        except ProgramError as error:
            message = error.first.message
            self._ui.warn(f"{self._question} can't be asked: {message}.")
            return
        finally:
            self._ui.withdraw(progress)
        if state_key != self._state_key(session.game):
            return
        if outcome.tick is not None:
            self._go_to(outcome.tick)
        else:
            self._say_there_is_none(outcome, direction)
        self._ended = session.frame.tick, inspected

    def _say_there_is_none(self, outcome: SearchResult, direction: Literal[-1, 1]) -> None:
        from logical_robots_tui.tui.commands.keymap import with_keys

        side = "after" if direction > 0 else "before"
        tick = self._session.frame.tick
        question = one_line(self._question)
        holds = "It holds here. " if outcome.holds_here else ""
        words = f"{holds}No {'other ' * bool(holds)}tick {side} {tick} is known in which it holds"
        trouble = f" It failed in some: {one_line(outcome.problem)}" if outcome.problem else ""
        hint = with_keys(" {search_ticks} asks for another query.")
        self._ui.tell(f"{words}: {question}.{trouble or hint}")

    def _state_key(self, game: Game | None) -> object:
        """Return everything that a search depends on; a change voids its result."""
        if game is None:
            return None
        return game, game.program, game.history.turns, game.frame.tick, self._question


@dataclass(eq=False)
class Replays:
    """Opens and saves replays; `open_level` opens a level with programs by team."""

    session: Session
    ui: Dialogs
    folder: Path
    programs: Path
    open_level: Callable[[Level, Mapping[str, ProgramSource]], None]

    async def choose(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, ReplayShelf

        replay = await self.ui.ask(Chooser["Replay"](ReplayShelf(self.folder), ""))
        if replay is not None:
            await self.open_with_level(replay)

    async def open_with_level(self, replay: Replay) -> None:
        from logical_robots_tui.player.opening import level_of, sources_of

        level = await asyncio.to_thread(level_of, replay)
        sources = await asyncio.to_thread(sources_of, replay, self.programs)
        self.open_level(level, sources)
        await self.open(replay)

    async def open(self, replay: Replay) -> None:
        """Replay in the current game, which must be at the replay's level; stop at its end."""
        try:
            programs = [await compile_program(texts) for texts in replay.programs.values()]
        except ProgramError as error:
            mistake = error.first
            self.ui.warn(f"A program of this replay no longer compiles: {mistake.message}")
            return
        self.session.go_through(programs[0], partial(self._follow, replay, programs))

    async def _follow(self, replay: Replay, programs: Sequence[Program], game: Game) -> None:
        from logical_robots_tui.game.replay import play_into

        verifier = await play_into(game, replay, programs, self.session.use)
        if verifier.difference is not None:
            tick, reason = verifier.difference
            self.ui.warn(
                f"The robots do what they did when this was recorded; now tick {tick:,} would be "
                f"different: {reason}"
            )
        else:
            self.ui.tell(f"Replay of {replay.last - replay.first:,} ticks: go to any of them.")

    async def save(self) -> None:
        from logical_robots_tui.editing.level_text import write_native
        from logical_robots_tui.game.replay import SUFFIX, gather
        from logical_robots_tui.paths import name_and_folder

        session = self.session
        session.pause()
        history = session.history
        if history is None or not history.last:
            raise InputError("There is nothing to save before the first tick. Run the robots.")
        name = session.source.name
        path = self.folder / f"{session.level.name}-{datetime.now():%Y%m%d-%H%M%S}{SUFFIX}"
        try:
            replay = await gather(history, write_native, lambda _program: name)
            size = await asyncio.to_thread(_write, path, replay)
        except Superseded:
            self.ui.warn("The timeline changed before the replay was saved. Save it again.")
        except OSError as error:
            self.ui.warn(f"The replay could not be saved: {error.strerror or error}.")
        else:
            self.ui.tell(f"Saved {name_and_folder(path)} ({size:,} bytes).")
            self.ui.deliver(path)


def _write(path: Path, replay: Replay) -> int:
    """Write a replay and return its bytes, or raise OSError."""
    from logical_robots_tui.paths import write_atomically

    content = replay.to_bytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, content)
    return len(content)
