"""The state of a session: level, program, what the robots are doing, and who listens."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol, TypeAlias

from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.game import Frame, Hit, Source
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.mind import Diagnostic, Program, ProgramError
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.world import Level


class OpenLevel:
    """One level in its three versions, from opening it until another is opened.

    Args:
        level: The level as it was opened.

    Attributes:
        saved: The level as in its file, or as created.
        edits: The edited level, with undo and redo.
        shown: The level of the frame on the screen.
    """

    def __init__(self, level: Level) -> None:
        self.saved = self.shown = level
        self.edits = Edits(level)

    @property
    def edited(self) -> Level:
        """The level as edited."""
        return self.edits.level

    @property
    def has_changes(self) -> bool:
        """Whether the edited level differs from the file, or from the created level."""
        return not alike(self.edited, self.saved)

    @property
    def is_saved(self) -> bool:
        """Whether a file holds the edited level."""
        return bool(self.saved.source) and not self.has_changes


class TeamSources:
    """The programs of a level by team, of which one is looked at.

    Args:
        sources: By team in the order of the level; in a level without teams one of "".

    Attributes:
        team: The team that is looked at: the editor and questions are about its program.
        hides_others: Whether the player wants to see nothing of what the other teams think.
    """

    def __init__(self, sources: Mapping[str, Source]) -> None:
        self._sources = {team: each._replace(team=team) for team, each in sources.items()}
        self._texts = {team: source.text for team, source in sources.items()}
        self.team = next(iter(sources))
        self.hides_others = False

    @property
    def teams(self) -> tuple[str, ...]:
        """The teams, () if there is one program for all robots."""
        return tuple(filter(None, self._sources))

    @property
    def first(self) -> Source:
        """The program of the player's own team."""
        return next(iter(self._sources.values()))

    @property
    def source(self) -> Source:
        """The program of the team that is looked at."""
        return self._sources[self.team]

    @source.setter
    def source(self, source: Source) -> None:
        self._sources[self.team] = source._replace(team=self.team)

    def of(self, team: str) -> tuple[Source, str]:
        """Return the program of a team, and its text as last applied."""
        return self._sources[team], self._texts[team]

    def with_text(self, text: str) -> Texts:
        """Return the texts of all teams, with a new one of the team that is looked at."""
        return {**self._texts, self.team: text}

    def seen(self, program: Program) -> Program:
        """Note what the robots think with, and return it as that of the team looked at."""
        self._texts |= program.texts if program.teams else {}
        return program.for_team(self.team)

    def mistakes(self, error: ProgramError) -> tuple[Diagnostic, ...]:
        """Return the mistakes in the text in the editor, or that another team's has one."""
        if error.team in ("", self.team):
            return error.diagnostics
        first = error.diagnostics[0]
        words = f"in the program of {error.team}, line {first.line}: {first.message}"
        return (replace(first, line=1, column=1, message=words, excerpt=""),)


_MOST_OWED = 5  # steps that a held key may leave pending
_NOTICEABLE = 0.5  # seconds of thinking after which the screen shows it

Kind: TypeAlias = Literal["rest", "awaiting", "run", "steps", "until"]


@dataclass(slots=True, eq=False)
class Movement:
    """What is in progress. Each movement is a new object, so that work can recognise its own.

    A session changes from any kind to any other by replacing its movement.

    Attributes:
        kind: ``rest``; ``awaiting`` a program to run with; ``run`` at the game's speed;
            ``steps``, tick by tick; ``until`` a tick, at full speed.
        owed: The steps still to take.
        waiting_since: When the current think began, by the game's clock.
    """

    kind: Kind = "rest"
    owed: int = 0
    waiting_since: float = 0.0

    @property
    def is_resting(self) -> bool:
        """Whether nothing is in progress."""
        return self.kind == "rest"

    @property
    def goes_on(self) -> bool:
        """Whether the robots run, or will run as soon as there is a program."""
        return self.kind in ("awaiting", "run", "until")

    @property
    def thinks(self) -> bool:
        """Whether a think is in progress."""
        return self.kind in ("run", "steps", "until")

    def owe(self, steps: int) -> None:
        """Add steps, but not many more than were requested at once."""
        self.owed = min(self.owed + steps, max(self.owed, _MOST_OWED * steps))

    def thinking_for(self, now: float, period: float) -> float:
        """Return the seconds that the current think has taken; 0.0 while not worth showing.

        Args:
            now: The time by the game's clock.
            period: Seconds per tick while running.
        """
        if not self.thinks:
            return 0.0
        seconds = now - self.waiting_since - (period if self.kind == "run" else 0.0)
        return seconds if seconds > _NOTICEABLE else 0.0


async def nothing() -> None:
    """Take the place of work that is to end."""


class SessionListener:
    """Is notified of a session's events; ignores those that it does not override."""

    def level_opened(self, level: Level) -> None:
        """The player has opened a level."""

    def level_saved(self, level: Level) -> None:
        """The current level has been saved as edited."""

    def level_changed(self) -> None:
        """The frame on the screen has a different version of the level than the previous one."""

    def restarted(self) -> None:
        """The level has been restarted."""

    def program_used(self, program: Program) -> None:
        """The robots start to use a program."""

    def tick_shown(self, frame: Frame) -> None:
        """A tick has been shown on the screen."""

    def won(self, victory: Victory) -> None:
        """The robots have won while moving forward; once for each program and tick."""

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        """The robots have stopped at breakpoints."""


Phase: TypeAlias = Literal["fresh", "compiling", "applied", "mistake"]


class ProgramState(NamedTuple):
    """The state of the program.

    Attributes:
        phase: ``fresh`` before the first compilation, then the result of the last one.
        tried: The last compiled text.
        applied: The text that the robots use, or None.
        mistakes: Errors of `tried`, or warnings if it runs.
        warnings: Warnings of `applied`.
        compiled: The number of compiled predicates and of all, while compiling.
    """

    phase: Phase = "fresh"
    tried: str = ""
    applied: str | None = None
    mistakes: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    compiled: tuple[int, int] = (0, 0)

    @classmethod
    def of_applied(cls, text: str, warnings: tuple[Diagnostic, ...]) -> ProgramState:
        """Return the state when the robots start to use a text."""
        return cls("applied", text, text, warnings, warnings)

    def compiling(self, text: str) -> ProgramState:
        """Return the state when the compilation of a text starts."""
        return self._replace(phase="compiling", tried=text, mistakes=(), compiled=(0, 0))

    def seen_from(self, text: str) -> ProgramState:
        """Return the state to show while that text is in the editor.

        Errors of another text are dropped once the robots' text is back.
        """
        if self.phase != "mistake" or text == self.tried or text != self.applied:
            return self
        return self._replace(phase="applied", tried=text, mistakes=self.warnings)


class ProgramText(Protocol):
    """The editable text of the current program."""

    @property
    def text(self) -> str:
        """The text."""

    def load(self, text: str) -> None:
        """Load another program's text."""

    def put(self, text: str) -> None:
        """Replace the text of the same program; undo restores the old one."""
