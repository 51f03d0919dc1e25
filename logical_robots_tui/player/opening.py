"""Opening the game: what a player begins with, and has in an open game."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.pace import SPEEDS
from logical_robots_tui.game.source import ProgramSource, load_program, programs_for
from logical_robots_tui.game.victory import level_key
from logical_robots_tui.player.best_runs import BestRuns
from logical_robots_tui.player.board import BoardRecorder
from logical_robots_tui.player.drafts import Autosave, Drafts, UnsavedText, program_draft
from logical_robots_tui.player.learning import Learning
from logical_robots_tui.player.library import Library
from logical_robots_tui.player.recorder import LAST_LEVEL, SPEED, TOUR, ProgressRecorder
from logical_robots_tui.player.recovery import Bookmark, Offering, OpenGames, offer_to_end_games
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.session_state import ProgramText, Ui
from logical_robots_tui.progress import Progress
from logical_robots_tui.world import Level, LevelError, list_levels, load_level
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.progress.board import Board


class Permissions(NamedTuple):
    """Everything on one's own machine; less on a shared or public one, or in a class.

    `programs` are an editor, or the shell after suspending.
    """

    programs: bool = True
    clipboard: bool = True


class Opening(NamedTuple):
    """What the game opens with.

    `sources` are by team, "" without teams; `text` is the player's version of the program,
    `welcome` starts the tour. The event loop must have the clock's time. In a class the teacher
    sees on the board what the player does.
    """

    level: Level
    sources: Mapping[str, ProgramSource]
    data_dir: Path
    text: str | None = None
    welcome: bool = False
    permissions: Permissions = Permissions()
    replay: Replay | None = None
    games: OpenGames | None = None
    clock: Clock = CLOCK
    board: Board | None = None
    is_class: bool = False


def open_game(
    progress: Progress,
    data_dir: Path,
    level_name: str | None = None,
    programs: Sequence[str] = (),
    teams: Mapping[str, str] | None = None,
    *,
    start: int = 0,
    permissions: Permissions = Permissions(),  # noqa: B008 - immutable
    games: OpenGames | None = None,
    board: Board | None = None,
    is_class: bool = False,
) -> Opening:
    """Return what a game opens with: by default the last level, with the player's last program.

    `programs` follow the order of teams. Raises InputError if the level or a program can't be used.
    """
    level = load_level(level_name) if level_name else initial_level(progress)
    if start:
        from logical_robots_tui.game.measuring import named_start_of

        level = named_start_of(level, start)
    folder = data_dir / "programs"
    sources, text = initial_programs(progress, level, programs, teams or {}, folder)
    return Opening(
        level=level,
        sources=sources,
        data_dir=data_dir,
        text=text,
        welcome=not level_name and progress.fact(TOUR) is None,
        permissions=permissions,
        games=games,
        board=board,
        is_class=is_class,
    )


def open_replay(replay: Replay, data_dir: Path) -> Opening:
    return Opening(
        level=level_of(replay),
        sources=sources_of(replay, data_dir / "programs"),
        data_dir=data_dir,
        replay=replay,
    )


def level_of(replay: Replay) -> Level:
    """Return a replay's first level; the shipped level if it is the same."""
    level = replay.levels[0]
    try:
        shipped = load_level(replay.name)
    except LevelError:
        return level
    return shipped if alike(shipped, level) else level


def sources_of(replay: Replay, folder: Path) -> dict[str, ProgramSource]:
    """Return each team's last program ("" without teams), the player's or shipped if equal."""
    name = re.sub(r"[^\w.-]+", "-", replay.texts[-1].name, flags=re.ASCII)[:40] or "replay"
    texts = replay.programs[replay.texts[-1].tick]
    if "" in texts:
        teams = [team.name for team in replay.levels[-1].teams]
        texts = dict.fromkeys(teams or [""], texts[""])
    return {
        team: _source_of(f"{name}-{team}" if team else name, part, folder)
        for team, part in texts.items()
    }


def _source_of(name: str, text: str, folder: Path) -> ProgramSource:
    try:
        source = load_program(name, folder)
        if source.text == text:
            return source
        name += "-in-replay"
    except InputError:
        pass
    return ProgramSource(name, text, folder / f"{name}.l", shipped=False)


def initial_level(progress: Progress) -> Level:
    """Return the level played last, or the first one; raise InputError if levels are missing."""
    names = list_levels()
    if not names:
        raise InputError("The levels are missing from this installation.", hint="Install it again.")
    last = progress.fact(LAST_LEVEL)
    if last is not None:
        with suppress(LevelError):  # it was deleted, broken, or renamed in a newer version
            return load_level(last)
    return load_level(names[0])


def initial_programs(
    progress: Progress, level: Level, names: Sequence[str], by_team: Mapping[str, str], folder: Path
) -> tuple[dict[str, ProgramSource], str | None]:
    """Return the programs to open, by team, and the player's last text of the first.

    `names` follow the order of the teams; by default the usual ones. In a level without teams
    the program is that of "". Raises InputError.
    """
    sources = programs_for(level, names, by_team, folder)
    first_team = next(iter(sources) if names or not by_team else iter(by_team))
    is_default = not (names or by_team) and bool(level.starter)
    text = progress.newest(level_key(level)) if is_default else None
    return {first_team: sources[first_team]} | sources, text


class LocalPlayer:
    """The player at this terminal: the session, and what keeps their work.

    `with_keys` says in a text how the commands in braces are given.

    Attributes:
        first_text: What `program` begins with.
    """

    def __init__(
        self,
        opening: Opening,
        recorder: ProgressRecorder,
        ui: Ui,
        program: ProgramText,
        on_change: Callable[[], None],
        with_keys: Callable[[str], str],
    ) -> None:
        self._opening, self._ui, self.recorder = opening, ui, recorder
        self._on_change = on_change
        session = self.session = Session(
            opening.level, opening.sources, ui.spawn, on_change, opening.clock
        )
        speed = recorder.progress.fact(SPEED)
        session.pace.speed = next((s for s in SPEEDS if str(s) == speed), session.pace.speed)
        self.first_text = session.source.text if opening.text is None else opening.text
        drafts = self.drafts = Drafts(opening.data_dir / "drafts")
        autosave = self.autosave = Autosave(
            drafts,
            state=lambda: UnsavedText(session.source, program.text, level_key(session.level)),
            draft=program_draft,
            warn=ui.warn,
            subject="Unsaved text",
        )
        library = self.library = Library(
            session, ui, recorder, drafts, autosave, program, opening.data_dir
        )
        self.board = BoardRecorder(
            opening.board, session, ui, recorder, on_change, is_class=opening.is_class
        )
        session.listeners.append(self.board)
        self.best_runs = BestRuns(session, ui, opening.data_dir / "best-runs")
        session.listeners.append(self.best_runs)
        self.learning = Learning(session, ui, recorder, program, library.open_program, with_keys)
        self.bookmark = Bookmark(session, drafts, ui, library.open_program, library.look_at)
        session.listeners.append(self.bookmark)

    def start(self) -> None:
        """Begin to record and to compile, once all listen to the session."""
        self.recorder.level_opened(self.session.opened)
        self.board.level_opened(self.session.opened)
        self.session.apply(self.first_text)

    def offerings(self, *extra: Offering) -> list[Offering]:
        """Return what to offer from earlier sessions, in order."""
        games = self._opening.games
        first = [] if games is None else [partial(offer_to_end_games, games, self._ui)]
        return [self.board.offer_notice, *first, self.library.offer, *extra, self.bookmark.offer]

    def shift_speed(self, steps: int) -> None:
        """Choose a faster speed, or with negative steps a slower one, also for later games."""
        pace = self.session.pace
        pace.shift(steps)
        self.recorder.set_fact(SPEED, str(pace.speed))
        self._on_change()

    async def close(self) -> None:
        self.autosave.stop()
        self.drafts.close()
        await self.board.close()
        await self.session.close()
        await self.recorder.close()
