"""What a player's game writes on the board, and what it knows of it."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Superseded
from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.game.victory import is_shipped, level_key
from logical_robots_tui.player.session_state import SessionListener, Ui, Work
from logical_robots_tui.wording import clip, one_line
from logical_robots_tui.world import list_arenas, load_level
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.recovery import Offers
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.progress.board import Board, BoardMembership, BoardStanding, GhostEntry
    from logical_robots_tui.progress.ladder import Challenger, Ladder
    from logical_robots_tui.world import Level

T = TypeVar("T")

NOTICE = (
    "In this class the teacher sees which level you play, how often you run it, what you win, and "
    "errors and notices of your last run. Your program is shown only while you ask for help."
)
"""What players are told at login."""

NO_BOARD = "There is no board: nobody else plays on this server."

MOST_NAME = 20  # characters
_LONGEST_TROUBLE = 200  # characters
_MOST_PENDING = 20  # victories, each with a run
_SECONDS = 1.0  # between two reports of what the player does
_HEARTBEAT = 60.0  # seconds between reports while nothing happens


def board_name(text: str) -> str | None:
    """Return the name that a player wrote, None for anonymous; raise InputError if it is none."""
    from logical_robots_tui.progress.board import ANONYMOUS

    name = " ".join(text.split())
    if not name.isprintable():
        raise InputError("A name has only letters, digits and signs.")
    if len(name) > MOST_NAME:
        raise InputError(f"A name has at most {MOST_NAME} characters.")
    return None if name.casefold() in ("", ANONYMOUS) else name


@dataclass(slots=True)
class _PendingEntry:
    level: Level
    text: str
    measures: Measures
    ghost: Replay | None = None


class BoardRecorder(SessionListener):
    """Enters the player's victories, and in a class what they do; nothing here delays a key.

    Without a board it does nothing. `on_change` is called when one of the attributes changed.

    Attributes:
        membership: What the player has chosen; None before that, or before it is known.
        standings: The bests of all who won the level at hand, if this player did; else empty.
        asks_for_help: Whether the teacher is asked to look.
    """

    def __init__(
        self,
        board: Board | None,
        session: Session,
        ui: Ui,
        recorder: ProgressRecorder,
        on_change: Callable[[], None],
        *,
        is_class: bool,
    ) -> None:
        self.membership: BoardMembership | None = None
        self.standings: Sequence[BoardStanding] = ()
        self.asks_for_help = False
        self.is_class = is_class
        self._board, self._session, self._ui = board, session, ui
        self._recorder, self._on_change = recorder, on_change
        self._pending: deque[_PendingEntry] = deque(maxlen=_MOST_PENDING)
        self._activity: dict[str, object] = {}
        self._is_reporting = self._is_closed = False
        self._runs, self._trouble = 0, ""
        self._is_new_run = True
        self._complaint = ""
        self._heartbeat: asyncio.TimerHandle | None = None

    @property
    def is_on(self) -> bool:
        return self._board is not None

    @property
    def board(self) -> Board:
        """The board; InputError without one."""
        if self._board is None:
            raise InputError(NO_BOARD)
        return self._board

    @property
    def must_ask(self) -> bool:
        """Whether a victory waits for the player to choose a name."""
        return bool(self._pending) and self.membership is None and not self._complaint

    # -- what happens ------------------------------------------------------------------------

    def level_opened(self, level: Level) -> None:
        from logical_robots_tui.progress.board import timestamp

        self.standings = ()
        self._runs, self._is_new_run = 0, True
        self._spawn(partial(self._load, level))
        self._report(level=level.name, since=timestamp(), runs=0, trouble="", is_open=True)
        if self.is_class and self._board is not None and self._heartbeat is None:
            self._show_program(None)  # a game that was killed may have shown one
            self._beat()

    def restarted(self) -> None:
        self._is_new_run = True

    def program_used(self, program: Program) -> None:
        self._is_new_run = True
        if self.asks_for_help:
            self._show_program(program.first.text)

    def program_rejected(self) -> None:
        mistakes = self._session.state.mistakes
        if self.asks_for_help:
            self._show_program(self._session.state.tried)
        if mistakes:
            first = mistakes[0]
            self._note_trouble(f"Line {first.line}: {first.message}")

    def tick_shown(self, frame: Frame) -> None:
        if not self.is_class:
            return
        if self._is_new_run and frame.tick:
            self._is_new_run, self._trouble = False, ""
            self._runs += 1
            self._report(runs=self._runs, trouble="")
        for decision in frame.decisions:
            for notice in decision.notices:
                self._note_trouble(f"{decision.robot_name}: {notice.message}")
                return
        history = self._session.history
        for mark in history.marks.marks_at(frame.tick) if history is not None else ():
            if words := trouble(mark):
                self._note_trouble(words)

    def won(self, victory: Victory) -> None:
        from logical_robots_tui.progress.board import timestamp

        self._runs, self._is_new_run = 0, True
        self._report(runs=0, won_level=victory.level.name, won=timestamp(), trouble="")
        if (
            victory.verdict == "counts"
            and victory.measures is not None
            and _has_board(victory.level)
        ):
            self._spawn(partial(self._enter, victory, victory.measures))

    def _beat(self) -> None:
        """Report that the game is still open, and do so again after a while."""
        self._report()
        self._heartbeat = asyncio.get_running_loop().call_later(_HEARTBEAT, self._beat)

    async def close(self) -> None:
        if self._heartbeat is not None:
            self._heartbeat.cancel()
        if self.is_class and self._board is not None:
            self._activity |= {"is_open": False, "help_since": None}
            self._is_closed = True
            if self.asks_for_help:
                await self._attempt(self._board.show_program, None)
            await self._flush()

    async def offer_notice(self, offers: Offers) -> None:
        """Tell a player of a class what the teacher sees."""
        if self.is_class and self._board is not None:
            await offers.ask("A class", NOTICE, [("ok", "OK")])

    # -- what the player does ----------------------------------------------------------------

    async def join(self, membership: BoardMembership) -> None:
        """Choose how to be on the board, or leave it; victories that wait are entered.

        Raises InputError if the board can't be used, or another player has the name.
        """
        await asyncio.to_thread(self.board.join, membership)
        self.membership = membership
        while self._pending:
            victory = self._pending.popleft()
            if membership.is_listed:
                await self._add(victory)
        await self._load(self._session.opened)

    async def ask_for_help(self, text: str) -> None:
        """Show the program's text to the teacher, or if it is shown take it back.

        Raises InputError outside a class, or if the board can't be used.
        """
        from logical_robots_tui.progress.board import timestamp

        if not self.is_class:
            raise InputError("Nobody watches this game: it is not played in a class.")
        wants_help = not self.asks_for_help
        await asyncio.to_thread(self.board.show_program, text if wants_help else None)
        self.asks_for_help = wants_help
        self._report(help_since=timestamp() if wants_help else None)

    async def standings_of(self, level: Level) -> Sequence[BoardStanding]:
        """Return the bests of all who won a level; empty without a board that can be read."""
        if self._board is None or not _has_board(level):
            return ()
        return await self._attempt(_of_level, self._board.standings, level) or ()

    async def ghosts(self) -> Sequence[GhostEntry]:
        """Return whom the player may race in the level at hand, or raise InputError."""
        board, level = self.board, self._session.opened
        if self._recorder.record.state != "won":
            raise InputError(f"Win {level.title} first; then you can race others.")
        return await asyncio.to_thread(_of_level, board.ghosts, level)

    async def ghost(self, entry: GhostEntry) -> Replay:
        """Return the run of an entry, or raise InputError."""
        from logical_robots_tui.game.replay import read_replay

        content = await asyncio.to_thread(self.board.ghost, entry.number)
        if content is None:
            raise InputError("This run is no longer shared.")
        return await asyncio.to_thread(read_replay, content, "The run")

    async def hand_in(self, text: str) -> None:
        """Let a program play in the ladder of the arena at hand, or raise InputError."""
        ladder = self._ladder()
        membership = await asyncio.to_thread(self.board.membership)
        if membership is None or not membership.is_listed:
            raise InputError("You are not on the board", hint="Choose a name there first.")
        await asyncio.to_thread(ladder.hand_in, text)

    async def challengers(self) -> list[Challenger]:
        """Return who plays in the ladder of the arena at hand, or raise InputError."""
        return await asyncio.to_thread(self._ladder().challengers)

    async def match(self, opponent: Challenger) -> Replay:
        """Return the player's match in the ladder at hand, or raise InputError."""
        from logical_robots_tui.game.replay import read_replay

        content = await asyncio.to_thread(self._ladder().match, self.board.player, opponent.player)
        if content is None:
            hint = "Hand in a program, and choose somebody else's once it has a rank."
            raise InputError("There is no match of yours against this program", hint=hint)
        return await asyncio.to_thread(read_replay, content, "The match")

    def _ladder(self) -> Ladder:
        from logical_robots_tui.progress.ladder import Ladder

        board, level = self.board, self._session.opened
        if level.name not in list_arenas() or not alike(level, load_level(level.name)):
            raise InputError(f"{level.title} has no ladder", hint="Open an arena.")
        return Ladder(board, level.name)

    # -- in the background -------------------------------------------------------------------

    async def _load(self, level: Level) -> None:
        self.membership = await self._attempt(self.board.membership)
        key = level_key(level)
        record = await self._recorder.ask(lambda progress: progress.record(key))
        if record.state == "won":
            standings = await self.standings_of(level)
            if level is self._session.opened:
                self.standings = standings
        self._on_change()

    async def _enter(self, victory: Victory, measures: Measures) -> None:
        if self.membership is None:
            self.membership = await self._attempt(self.board.membership)
        if self.membership is not None and not self.membership.is_listed:
            return
        entry = _PendingEntry(victory.level, victory.program.text, measures)
        if self.membership is None:
            self._pending.append(entry)
            self._on_change()
        else:
            await self._add(entry)
            await self._load(victory.level)
        if self.membership is None or self.membership.shares:
            entry.ghost = await self._replay(victory)  # takes long, so the entry does not wait
        if entry.ghost is not None and self.membership is not None and self.membership.shares:
            await self._add(entry)

    async def _replay(self, victory: Victory) -> Replay | None:
        from logical_robots_tui.editing.level_text import write_native
        from logical_robots_tui.game.replay import gather

        history = self._session.history
        if history is None or history.first:
            return None
        try:
            return await gather(
                history, write_native, lambda _: "", with_programs=False, last=victory.tick
            )
        except (Superseded, InputError):  # the robots went another way meanwhile
            return None

    async def _add(self, victory: _PendingEntry) -> None:
        assert self.membership is not None
        await self._attempt(_add, self.board, self.membership, victory)

    async def _attempt(self, work: Callable[..., T], *values: object) -> T | None:
        """Run work in a thread; None, with a warning that is given once, if the board fails."""
        try:
            return await asyncio.to_thread(work, *values)
        except InputError as error:
            if str(error) != self._complaint:
                self._complaint = str(error)
                self._ui.warn(f"{error}. The game goes on without it.")
            return None

    def _show_program(self, text: str | None) -> None:
        if self._board is None:
            return
        self._spawn(partial(self._attempt, self._board.show_program, text))
        if text is None:
            self._report(help_since=None)

    def _spawn(self, work: Work) -> None:
        if self._board is not None:
            self._ui.spawn(work, "board", exclusive=False)

    def _note_trouble(self, words: str) -> None:
        if words != self._trouble:
            self._trouble = words
            self._report(trouble=clip(one_line(words), _LONGEST_TROUBLE))

    def _report(self, **values: object) -> None:
        """Tell the class's board, at most once a second."""
        if not self.is_class or self._board is None or self._is_closed:
            return
        self._activity |= values
        if not self._is_reporting:
            self._is_reporting = True
            self._ui.spawn(self._report_now, "activity", exclusive=False)

    async def _report_now(self) -> None:
        await self._flush()
        asyncio.get_running_loop().call_later(_SECONDS, self._report_rest)

    def _report_rest(self) -> None:
        self._is_reporting = False
        if self._activity:
            self._report()

    async def _flush(self) -> None:
        activity, self._activity = self._activity, {}
        await self._attempt(partial(self.board.report, **activity))


def _has_board(level: Level) -> bool:
    """Return whether everybody has the level: a shipped one, or a labyrinth of a day."""
    from logical_robots_tui.world.levels.labyrinths import Daily

    return is_shipped(level) or Daily.parse(level.name) is not None


def _of_level(query: Callable[[str], list[T]], level: Level) -> list[T]:
    from logical_robots_tui.game.run import level_digest

    return query(level_digest(level))


def _add(board: Board, membership: BoardMembership, victory: _PendingEntry) -> None:
    from logical_robots_tui.game.run import level_digest, simulation_digest

    ghost = victory.ghost if membership.shares else None
    board.add(
        victory.level.name,
        level_digest(victory.level),
        simulation_digest().hex(),
        victory.text,
        victory.measures,
        None if ghost is None else ghost.to_bytes(),
    )
