"""What other sessions left, or have open: unsaved levels, the place in a game, open games."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Protocol, TypeAlias, TypeVar

import msgspec

from logical_robots_tui import game
from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.game.pace import SPEEDS
from logical_robots_tui.paths import is_file
from logical_robots_tui.player.drafts import Draft, Drafts, acquire, release
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.session_state import SessionListener, Ui
from logical_robots_tui.progress.old_texts import texts_of
from logical_robots_tui.wording import clip, one_line
from logical_robots_tui.world import Level, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.native import read_native

T = TypeVar("T")

_LOOK_SECONDS, _LOOKS = 0.25, 40
"""How often, and how many times, to look whether other games have ended."""


Offering: TypeAlias = "Callable[[Offers], Awaitable[None]]"
"""Offers what an earlier session left, if it left something."""


class Offers(Protocol):
    """Asks the player when nothing else needs attention.

    `at_hand` returns what `find` finds while nothing covers the game, `ask` the name of the answer,
    or None; the answer ``show`` shows `text`.
    """

    async def at_hand(self, find: Callable[[], Awaitable[T]]) -> T: ...

    async def ask(
        self, title: str, question: str, answers: Sequence[tuple[str, str]], *, text: str = ""
    ) -> str | None: ...


def short_name(draft: Draft) -> str:
    return f"“{clip(one_line(draft.name), 40)}”"


def when_saved(draft: Draft) -> str:
    return f"{draft.saved.astimezone():%H:%M, %d %B}"


async def offer(
    offers: Offers,
    drafts: Sequence[Draft],
    store: Drafts,
    resume: Callable[[Level, Draft], Awaitable[None]],
) -> None:
    """Offer the levels that can be restored, newest first, until one is taken."""
    for draft in drafts:
        level = await asyncio.to_thread(_read, draft)
        if level is None:
            await asyncio.to_thread(store.put_away, draft)
            continue
        question = f"Continue editing the level {short_name(draft)} from {when_saved(draft)}?"
        answers = [("yes", "Yes, continue"), ("no", "No, set it aside")]
        answer = await offers.ask("Unsaved level", question, answers)
        if answer != "no":
            if answer == "yes":
                await resume(level, draft)
            return
        await asyncio.to_thread(store.put_away, draft)


def _read(draft: Draft) -> Level | None:
    """Return the file's level, or the edited one if the file is gone; None if not needed."""
    try:
        path = Path(draft.path)
        if path.is_absolute() and is_file(path):
            base = load_level(path)
            level = read_native(draft.text, base.name, base.source)
            return None if alike(base, level) else base
        name = draft.path.removeprefix("new ").rpartition(" ")[0]
        return read_native(draft.text, name or path.stem, "")
    except InputError:
        return None


async def offer_to_end_games(games: OpenGames, ui: Ui, offers: Offers) -> None:
    """Offer to end the player's other games, such as one whose connection hangs."""
    start_times = await offers.at_hand(partial(asyncio.to_thread, games.other_games))
    if not start_times:
        return
    since = f"{start_times[0].astimezone():%H:%M, %d %B}"
    subject, pronoun = "Another game has been open", "it"
    if len(start_times) > 1:
        subject, pronoun = f"{len(start_times)} other games are open, one of them", "them"
    question = f"{subject} since {since}. End {pronoun}? Unsaved text there is kept."
    answers = [("no", "No, leave it open"), ("yes", "Yes, end it")]
    if await offers.ask("Another game", question, answers) != "yes":
        return
    await asyncio.to_thread(games.end_others)
    for _ in range(_LOOKS):
        await asyncio.sleep(_LOOK_SECONDS)
        if not await asyncio.to_thread(games.other_games):
            return
    ui.warn("It has not ended yet. Unsaved text there is offered the next time.")


@dataclass(frozen=True, slots=True)
class GamePosition:
    """A tick, and how to get there: the same level and programs give the same ticks.

    Attributes:
        level: Name of a shipped level, otherwise the path of its file.
        title: The level's title.
        program: Name of the last program if it is a shipped one, otherwise the path of its file.
        tick: Number of the tick, at least 1.
        programs: The first tick that programs decided, and their texts, in order.
        speed: The speed in ticks per second; None is full speed.
    """

    level: str
    title: str
    program: str
    tick: int
    programs: tuple[tuple[int, Mapping[str, str]], ...]
    speed: float | None = 40.0

    def as_text(self) -> str:
        return json.dumps(asdict(self), ensure_ascii=False)

    @classmethod
    def from_text(cls, text: str) -> GamePosition:
        """Parse a position, or raise ValueError."""
        try:
            fields = json.loads(text)
            fields["programs"] = [
                [begin, texts_of(texts) if isinstance(texts, str) else texts]
                for begin, texts in fields["programs"]
            ]
            if fields.get("speed") not in SPEEDS:
                del fields["speed"]
            position = msgspec.convert(fields, cls)
        except (KeyError, TypeError, ValueError, msgspec.ValidationError) as error:
            raise ValueError("this is not a place in a game") from error
        begins = [begin if texts else 0 for begin, texts in position.programs]
        if begins[:1] != [1] or begins != sorted(set(begins)) or begins[-1] > position.tick:
            raise ValueError("the programs of this place are out of order")
        return position

    def segments(self) -> list[tuple[Mapping[str, str], int]]:
        ends = [begin - 1 for begin, _ in self.programs[1:]]
        texts = (texts for _, texts in self.programs)
        return list(zip(texts, [*ends, self.tick], strict=True))


def position_of(game_: game.Game, level: Level, source: game.ProgramSource) -> GamePosition | None:
    """Return the position of a game; None at the start, or if the level was edited on the way."""
    history, tick = game_.history, game_.frame.tick
    if tick == 0 or history.level_at(0) is not level or history.is_changed_up_to(tick):
        return None
    programs = tuple((begin, program.texts) for begin, program in history.programs(tick))
    program = source.name if source.shipped else str(source.path)
    return GamePosition(game.level_key(level), level.title, program, tick, programs)


class Bookmark(SessionListener):
    """Saves the position of an interrupted session, and offers it to a later one."""

    def __init__(
        self,
        session: Session,
        drafts: Drafts,
        ui: Ui,
        open_program: Callable[[game.ProgramSource, str | None], None],
        look_at: Callable[[str], None],
    ) -> None:
        self._session, self._drafts, self._ui = session, drafts, ui
        self._open_program, self._look_at = open_program, look_at
        self._offers: Offers | None = None

    def flush(self) -> None:
        """Write the current place. Safe in a signal handler; never raises."""
        session = self._session
        if session.game is None:
            return
        position = position_of(session.game, session.opened, session.sources.first)
        if position is not None:
            position = replace(position, speed=session.pace.speed)
            with suppress(OSError):  # nobody is there to be told
                text = position.as_text()
                self._drafts.keep(Draft("place", position.title, position.level, text))

    async def offer(self, offers: Offers) -> None:
        """Offer to continue in the level at hand; in another one when it is opened."""
        self._offers = offers
        key = game.level_key(self._session.level)
        with suppress(OSError):  # no folder, no bookmark
            drafts = await offers.at_hand(partial(asyncio.to_thread, self._drafts.adopt, "place"))
            draft = next((draft for draft in drafts if draft.path == key), None)
            if draft is not None:
                await self._ask(offers, draft)

    def level_opened(self, level: Level) -> None:
        if self._offers is not None:
            self._ui.spawn(partial(self.offer, self._offers), "bookmark", exclusive=False)

    async def _ask(self, offers: Offers, draft: Draft) -> None:
        try:
            position = GamePosition.from_text(draft.text)
        except ValueError:
            self._drafts.put_away(draft)
            return
        question = (
            f"{short_name(draft)} was cut off at tick {position.tick}, {when_saved(draft)}. "
            "Continue exactly there?"
        )
        answers = [("yes", "Yes, continue"), ("no", "No, from the start")]
        answer = await offers.ask("Cut off", question, answers)
        self._drafts.put_away(draft)
        if answer == "yes":
            try:
                await self._go_to(position)
            except LogicalRobotsError as error:
                self._ui.warn(f"Can't continue at tick {position.tick}: {error}")

    async def _go_to(self, position: GamePosition) -> None:
        """Go to a position; restored unsaved text stays in the editor."""
        last, sources = position.programs[-1][1], self._session.sources
        first = next(iter(last))
        if first != sources.team and first in sources.teams:
            self._look_at(first)
        try:
            source = await asyncio.to_thread(game.load_program, position.program)
        except InputError:
            source = self._session.source
        source = source._replace(team=sources.team)
        is_unsaved = self._drafts.get(("program", source.draft)) is not None
        self._open_program(source, None if is_unsaved else last.get(sources.team, last[first]))
        self._session.pace.speed = position.speed
        ends = [(await game.compile_program(texts), end) for texts, end in position.segments()]

        async def replay(game_: game.Game) -> None:
            for program, end in ends:
                self._session.use(program)
                while game_.frame.tick < end:
                    await game_.run_until(tick=end)

        self._session.go_through(ends[0][0], replay)


MOST_GAMES = 4
"""Games that one player may have open at the same time, of at most four processes each."""


class OpenGames:
    """A player's open games, with this process until it ends; may raise InputError, OSError."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        for number in range(MOST_GAMES):
            handle = acquire(self._file(number))
            if handle is not None:
                self._number, self._handle = number, handle  # closing it would free the place
                break
        else:
            hint = "Leave one of them first; a game whose connection broke ends within a minute."
            raise InputError(f"You have {MOST_GAMES} games open, the most allowed", hint=hint)
        self._request(self._number).unlink(missing_ok=True)
        os.ftruncate(self._handle, 0)
        os.write(self._handle, datetime.now(UTC).isoformat(timespec="seconds").encode())

    def other_games(self) -> list[datetime]:
        """Return the start times of the player's other games, oldest first."""
        start_times = []
        for number in range(MOST_GAMES):
            if number == self._number or not self._file(number).exists():
                continue
            with suppress(OSError, ValueError):
                handle = acquire(self._file(number))
                if handle is not None:
                    release(handle)
                    continue
                start_times.append(datetime.fromisoformat(self._file(number).read_text("ascii")))
        return sorted(start_times)

    def end_others(self) -> None:
        """Ask the player's other games to end, without waiting for them."""
        for number in range(MOST_GAMES):
            if number != self._number and self._file(number).exists():
                with suppress(OSError):
                    self._request(number).touch()

    @property
    def is_to_end(self) -> bool:
        return self._request(self._number).exists()

    def _file(self, number: int) -> Path:
        return self._folder / f".game-{number}"

    def _request(self, number: int) -> Path:
        return self._folder / f".end-game-{number}"
