"""What a session is made of: level, program, movement, listeners, and the work for them."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol, TypeAlias

from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.world import Level
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Game, Hit, ProgramSource
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.mind import Diagnostic, Program, ProgramError
    from logical_robots_tui.mind.program import Texts


class OpenLevel:
    """One level in three versions: as in its file, edited with undo, and as on the screen."""

    def __init__(self, level: Level) -> None:
        self.saved = self.shown = level
        self.edits = Edits(level)

    @property
    def edited(self) -> Level:
        return self.edits.level

    @property
    def has_changes(self) -> bool:
        return not alike(self.edited, self.saved)

    @property
    def is_saved(self) -> bool:
        return bool(self.saved.source) and not self.has_changes


class TeamSources:
    """A level's programs by team ("" without teams), in order; editor and questions use one."""

    def __init__(self, sources: Mapping[str, ProgramSource]) -> None:
        self._sources = {team: source._replace(team=team) for team, source in sources.items()}
        self._texts = {team: source.text for team, source in sources.items()}
        self.team = next(iter(sources))
        self.hides_others = False

    @property
    def teams(self) -> tuple[str, ...]:
        return tuple(filter(None, self._sources))

    @property
    def first(self) -> ProgramSource:
        return next(iter(self._sources.values()))

    @property
    def source(self) -> ProgramSource:
        return self._sources[self.team]

    @source.setter
    def source(self, source: ProgramSource) -> None:
        self._sources[self.team] = source._replace(team=self.team)

    def source_and_text(self, team: str) -> tuple[ProgramSource, str]:
        return self._sources[team], self._texts[team]

    def with_text(self, text: str) -> Texts:
        return {**self._texts, self.team: text}

    def adopt(self, program: Program) -> Program:
        """Store all teams' texts, and return the selected team's program."""
        self._texts |= program.texts if program.teams else {}
        return program.for_team(self.team)

    def mistakes(self, error: ProgramError) -> tuple[Diagnostic, ...]:
        """Return the errors in the editor's text, or a note about another team's error."""
        if error.team in ("", self.team):
            return error.diagnostics
        first = error.first
        words = f"In the program of {error.team}, line {first.line}: {first.message}"
        return (replace(first, line=1, column=1, message=words, excerpt="", fix=None),)


Kind: TypeAlias = Literal["rest", "run", "steps", "until"]
Going: TypeAlias = "Callable[[Game], Coroutine[Any, Any, object]]"


@dataclass(slots=True, eq=False)
class Movement:
    """What is in progress. Each is a new object, so that work can recognise its own.

    ``until`` is at full speed; `waiting_since` is by the game's clock. `pending` is work that
    begins when the program has been compiled.
    """

    kind: Kind = "rest"
    owed: int = 0
    waiting_since: float = 0.0
    pending: Going | None = None

    @property
    def thinks(self) -> bool:
        return self.kind != "rest" and self.pending is None


async def nothing() -> None:
    """Take the place of work that is to end."""


class SessionListener:
    """Receives a session's events; each method does nothing unless overridden.

    A level is saved as edited, and changed when the frame on the screen has another version of it
    than the one before. A program is rejected if the robots waited for it and it has errors. They
    have won while moving forward; that is told once for each program and tick. They have stopped
    at breakpoints.
    """

    def level_opened(self, level: Level) -> None: ...
    def level_saved(self, level: Level) -> None: ...
    def level_changed(self) -> None: ...
    def restarted(self) -> None: ...
    def program_used(self, program: Program) -> None: ...
    def program_rejected(self) -> None: ...
    def tick_shown(self, frame: Frame) -> None: ...
    def won(self, victory: Victory) -> None: ...
    def stopped(self, hits: tuple[Hit, ...]) -> None: ...


Phase: TypeAlias = Literal["fresh", "compiling", "applied", "mistake"]


class ProgramState(NamedTuple):
    """The state of the program; `tried` was compiled last, the robots use `applied`.

    `mistakes` are errors of `tried`, or warnings if it runs; `compiled` is (done, total).
    `checked` is a text that is being written, compiled only for its `diagnostics`.
    """

    phase: Phase = "fresh"
    tried: str = ""
    applied: str | None = None
    mistakes: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    compiled: tuple[int, int] = (0, 0)
    checked: str | None = None
    diagnostics: tuple[Diagnostic, ...] = ()

    @property
    def newest(self) -> tuple[str, tuple[Diagnostic, ...]]:
        """The text compiled last, for any purpose, with its diagnostics."""
        if self.checked is None:
            return self.tried, self.mistakes
        return self.checked, self.diagnostics

    def for_text(self, text: str) -> ProgramState:
        """Return the state for an editor's text; errors vanish once the robots' text is back."""
        if self.checked is not None and text in (self.tried, self.applied):
            return self._replace(checked=None, diagnostics=()).for_text(text)
        if self.phase != "mistake" or text == self.tried or text != self.applied:
            return self
        return self._replace(phase="applied", tried=text, mistakes=self.warnings)


class ProgramText(Protocol):
    """The editable text of the current program; undo restores what `put` replaces."""

    @property
    def text(self) -> str: ...
    def load(self, text: str) -> None: ...
    def put(self, text: str) -> None: ...


Work: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"
"""A function and not a coroutine, because one that is cancelled early would never be awaited."""


class Spawn(Protocol):
    """Starts background work; exclusive work cancels the other work of its group."""

    def __call__(self, work: Work, group: str, *, exclusive: bool) -> None: ...


class Ui(Protocol):
    """Messages, questions and background work for whoever changes what a player has.

    `choose` asks a question and returns the name of the answer, or None; only for background work.
    """

    def tell(self, message: str) -> None: ...
    def warn(self, message: str) -> None: ...
    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None: ...

    async def choose(
        self, title: str, question: str, answers: Sequence[tuple[str, str]]
    ) -> str | None: ...


class Background:
    def __init__(self) -> None:
        self._tasks: dict[asyncio.Task[None], str] = {}

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Start background work; exclusive work cancels the other work of its group."""
        for task, task_group in self._tasks.items():
            if exclusive and task_group == group:
                task.cancel()
        task = asyncio.ensure_future(work())
        self._tasks[task] = group
        task.add_done_callback(self._tasks.pop)

    async def drain(self, *, skip: str) -> None:
        """Wait for all work but groups whose name begins with `skip`; raise what it raises."""
        while tasks := [task for task, group in self._tasks.items() if not group.startswith(skip)]:
            for task in (await asyncio.wait(tasks))[0]:
                if not task.cancelled():
                    task.result()

    async def close(self) -> None:
        """Cancel all work, and wait for its end."""
        tasks = [*self._tasks]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
