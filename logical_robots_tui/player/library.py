"""Opening levels, including the daily one, and programs; saving, and restoring drafts."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from datetime import date
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, load_program, save_program
from logical_robots_tui.game.source import programs_for, shipped_texts
from logical_robots_tui.player.drafts import Autosave, Draft, Drafts, Key, UnsavedText
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.recovery import Offers, short_name, when_saved
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.session_state import ProgramText, Ui
from logical_robots_tui.progress import Progress
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level, list_arenas, list_levels, load_level

if TYPE_CHECKING:
    from logical_robots_tui.world.levels.labyrinths import DailySize

_PROOF_PROGRAM = "the-long-hall"  # follows a wall, which leads everywhere where there are no loops
_TICKS_PER_CELL = 250
_MOST_DAILIES = 9


def daily_level(progress: Progress, day: date, size: DailySize) -> Level:
    """Return the labyrinth of a day, shown to be winnable, or raise InputError."""
    from logical_robots_tui.game.measuring import LateError, play_through
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world.levels.labyrinths import Daily

    program: Program | None = None
    for number in range(1, _MOST_DAILIES + 1):
        daily = Daily(day, size, number)
        level = load_level(daily.name)
        fact = f"won {daily.name}"
        if progress.fact(fact) is not None:
            return level
        program = program or Program.compile(shipped_texts()[_PROOF_PROGRAM])
        try:
            victory_run = play_through(level, program, _TICKS_PER_CELL * daily.cells)
        except LateError:
            message = "This computer is too busy to check that the labyrinth can be won."
            raise InputError(message, hint="Try again.") from None
        if victory_run.won_at is not None:
            progress.set_fact(fact, str(victory_run.won_at))
            return level
    raise InputError(f"No {size} labyrinth of {day.isoformat()} can be won.")


class Library:
    """Changes the level and program of a session without losing unsaved text."""

    def __init__(
        self,
        session: Session,
        ui: Ui,
        recorder: ProgressRecorder,
        drafts: Drafts,
        autosave: Autosave[UnsavedText],
        program: ProgramText,
        data_dir: Path,
    ) -> None:
        self._session, self._ui, self._recorder = session, ui, recorder
        self._drafts, self._autosave, self._program = drafts, autosave, program
        self.programs = data_dir / "programs"

    async def next_name(self) -> str | None:
        """Return the name of the level after this one, if there is one; arenas come last."""
        levels, arenas = await asyncio.to_thread(lambda: (list_levels(), list_arenas()))
        names = arenas if self._session.level.teams else [*levels, *arenas]
        name = self._session.level.name
        later_names = names[names.index(name) + 1 :] if name in names else names
        return later_names[0] if later_names else None

    async def next_level(self) -> None:
        name = await self.next_name()
        if name is None:
            self._ui.tell("This was the last level.")
            return
        await self.open_level(await asyncio.to_thread(load_level, name))

    async def open_daily(self) -> None:
        from logical_robots_tui.world.levels.labyrinths import DAILY_SIZES

        today = date.today()
        answers = [(size, size.capitalize()) for size in DAILY_SIZES]
        question = f"{today.isoformat()}: which size?"
        answer = await self._ui.choose("Labyrinth of the day", question, answers)
        if answer is None:
            return
        size = cast("DailySize", answer)
        level = await asyncio.to_thread(daily_level, self._recorder.progress, today, size)
        await self.open_level(level)

    async def open_level(self, level: Level) -> None:
        source = self._session.source
        sources = dict.fromkeys([team.name for team in level.teams] or [""], source)
        if level.teams or (level.starter and level.starter != source.name):
            try:
                sources = await asyncio.to_thread(programs_for, level, (), {}, self.programs)
            except InputError as error:
                self._ui.warn(str(error))
        source = next(iter(sources.values()))
        own_text = None
        if source.name == level.starter:
            own_text = await self._recorder.newest(level)
        self.open_with(level, sources, own_text)

    def open_with(
        self, level: Level, sources: Mapping[str, ProgramSource], own_text: str | None = None
    ) -> None:
        """Open a level with programs by team; `own_text` is the player's version of the first."""
        text = self._load_text_of(next(iter(sources.values())), own_text)
        self._session.open_level(level, sources, text)

    def look_at(self, team: str) -> None:
        source, applied = self._session.sources.source_and_text(team)
        self._load_text_of(source, applied, notify=False)
        self._session.look_at(team)

    def open_program(self, source: ProgramSource, text: str | None = None) -> None:
        """Edit and apply a program, with a given text or its draft's."""
        source = source._replace(team=self._session.sources.team)
        if text is None:
            text = self._load_text_of(source)
        elif source.draft == self._session.source.draft:
            self._program.put(text)
        else:
            self._autosave.flush()
            self._program.load(text)
        self._session.open_program(source, text)

    async def save_as(self, path: Path) -> None:
        """Save the program in a file and continue with that, or raise InputError."""
        old_source = self._session.source
        await asyncio.to_thread(save_program, path, self._program.text)
        self.saved(old_source, await asyncio.to_thread(load_program, path))

    def saved(self, old_source: ProgramSource, new_source: ProgramSource) -> None:
        """Continue with a saved program, unless the player has opened another one."""
        if self._session.source.draft == old_source.draft:
            self._drafts.drop(("program", old_source.draft))
            self._session.saved_as(new_source)
            self._autosave.edited()
            self._ui.tell(f"Saved as {one_line(new_source.name)} in {new_source.path.parent}.")

    def take_from_disk(self, source: ProgramSource) -> None:
        """Use a program changed on disk, unless the player has edited it, too."""
        session, name = self._session, one_line(source.name)
        if self._program.text == source.text:
            session.saved_as(source)  # the game may have just saved it
            self._autosave.edited()
        elif self._program.text == session.source.text:
            self._program.put(source.text)
            session.open_program(source, source.text)
            self._ui.tell(f"{name} has changed on disk and is applied.")
        else:
            session.saved_as(source)
            self._ui.warn(f"{name} has changed on disk; your text is kept here.")

    def _load_text_of(
        self, source: ProgramSource, own_text: str | None = None, *, notify: bool = True
    ) -> str:
        """Put a program's draft, or else the player's version, into the editor; return the text.

        The old text is kept; `notify` says whether to tell the player.
        """
        if source.draft == self._session.source.draft:
            return self._program.text
        self._autosave.flush()
        key: Key = "program", source.draft
        draft = self._drafts.get(key) or self._drafts.take(key)
        if draft is not None and draft.text != source.text:
            name = "program for this level"
            if draft.text != own_text:
                name = f"unsaved text of {one_line(source.name)}"
            if notify:
                self._ui.tell(f"Your {name} has been restored.")
            self._program.load(draft.text)
            return draft.text
        text = source.text if own_text is None else own_text
        if text != source.text and notify:
            self._ui.tell("Your program for this level has been restored.")
        self._program.load(text)
        return text

    async def offer(self, offers: Offers) -> None:
        """Offer unsaved texts of this program; those of others are offered next time."""
        last_path: str | None = None
        while drafts := await offers.at_hand(self._unsaved_drafts):
            path = last_path or self._session.source.draft
            draft = next((draft for draft in drafts if draft.path == path), drafts[0])
            if last_path not in (None, draft.path):
                return
            another = "another" if last_path else "your"
            question = (
                f"Continue with {another} unsaved text of {short_name(draft)} "
                f"from {when_saved(draft)}?"
            )
            answers = [("yes", "Yes, continue"), ("no", "No, set it aside"), ("show", "Show it")]
            answer = await offers.ask("Unsaved text", question, answers, text=draft.text)
            if answer == "yes":
                self._continue_with(draft)
            elif answer == "no":
                self._recorder.set_aside(draft)
                await asyncio.to_thread(self._drafts.put_away, draft)
            else:
                return
            last_path = draft.path

    async def _unsaved_drafts(self) -> list[Draft]:
        """Return the drafts that are neither in their files nor among the earlier versions."""
        try:
            drafts = await asyncio.to_thread(self._drafts.adopt, "program")
        except OSError as error:
            self._autosave.report(error)
            return []
        unsaved = []
        for draft in drafts:
            source = await asyncio.to_thread(ProgramSource.of_draft, draft.path, draft.name)
            is_version = await self._recorder.ask(partial(Progress.holds, text=draft.text))
            if source.text != draft.text and not is_version:
                unsaved.append(draft)
            else:
                await asyncio.to_thread(self._drafts.put_away, draft)
        return unsaved

    def _continue_with(self, draft: Draft) -> None:
        source, sources = ProgramSource.of_draft(draft.path, draft.name), self._session.sources
        if source.team != sources.team and source.team in sources.teams:
            self.look_at(source.team)
        self._autosave.flush()
        if old_draft := self._drafts.get(draft.key):
            self._recorder.set_aside(old_draft)
        self._drafts.take(draft.key, draft.text)
        if draft.path == self._session.source.draft:
            source = self._session.source
            self._program.put(draft.text)
        else:
            self._program.load(draft.text)
        self._session.open_program(source, draft.text)
