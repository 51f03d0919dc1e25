"""Going to other levels and programs, saving, and drafts that come back.

Dialogs are loaded when they are asked for, so that the first picture comes sooner.
"""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Source, load_program
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.world import list_levels, load_level

if TYPE_CHECKING:
    from logical_robots_tui.game.drafts import Draft, Key
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.world import Level

__all__ = ["Library"]


class Library:
    """Changes the level and the program of a screen without losing what was typed.

    Args:
        screen: Whose level and program.
        own: Folder of the player's programs.
    """

    def __init__(self, screen: MainScreen, own: Path) -> None:
        self._screen = screen
        self._own = own

    # -- levels --------------------------------------------------------------------------------

    async def choose_level(self) -> None:
        """Ask for a level and go there."""
        from logical_robots_tui.tui.library.level_screen import LevelScreen, NewLevel

        screen = self._screen
        drawing, own = screen.labyrinth.view.drawing, screen.editing.own
        choice = LevelScreen(screen.session.opened, screen.journal, drawing, own)
        level = await screen.app.push_screen_wait(choice)
        if isinstance(level, NewLevel):
            from logical_robots_tui.tui.level_editor.new_level import make_level

            await make_level(screen, own)
        elif level is not None:
            await self.open_level(level)

    async def next_level(self) -> None:
        """Go to the level after this one, or say that it was the last."""
        names = await asyncio.to_thread(list_levels)
        here = self._screen.session.level.name
        following = names[names.index(here) + 1 :] if here in names else names[:1]
        if not following:
            self._screen.tell("This was the last level.")
            return
        try:
            level = await asyncio.to_thread(load_level, following[0])
        except InputError as error:
            self._screen.warn(str(error))
            return
        await self.open_level(level)

    async def open_level(self, level: Level) -> None:
        """Go to a level, with the program that it starts with if it names one."""
        session = self._screen.session
        source = session.source
        if level.starter and level.starter != source.name:
            try:
                source = await asyncio.to_thread(load_program, level.starter, self._own)
            except InputError as error:
                self._screen.warn(str(error))
        kept = None
        if source.name == level.starter:
            kept = await self._screen.journal.newest(level)
        text = self._leave_text_for(source, kept)
        self._screen.journal.open(level)
        session.open_level(level, source, text)
        self._screen.begin_level()

    # -- programs ------------------------------------------------------------------------------

    async def choose_program(self) -> None:
        """Ask for a program and think with it."""
        from logical_robots_tui.tui.library.chooser import Chooser
        from logical_robots_tui.tui.library.shelves import ProgramShelf

        chooser = Chooser[Source](ProgramShelf(self._own), self._screen.session.source.name)
        source = await self._screen.app.push_screen_wait(chooser)
        if source is not None:
            self.open_program(source)

    def open_program(self, source: Source, text: str | None = None) -> None:
        """Edit and apply a program: a text of it, or the draft that there is."""
        if text is None:
            text = self._leave_text_for(source)
        elif source.path == self._screen.session.source.path:
            self._screen.replace_text(text)
        else:
            self._screen.autosave.flush()
            self._screen.put_text(text)
        self._screen.session.open_program(source, text)

    async def save(self) -> None:
        """Ask for a name and save the text under it."""
        from logical_robots_tui.tui.library.save_dialog import SaveAs

        session = self._screen.session
        former, text = session.source, self._screen.text
        saved = await self._screen.app.push_screen_wait(SaveAs(former, text, self._own))
        if saved is not None:
            self._screen.drafts.drop(("program", str(former.path)))
            session.saved_as(saved)
            self._screen.autosave.edited()
            self._screen.tell(f"Saved as {one_line(saved.name)}.")

    def take_from_disk(self, source: Source) -> None:
        """Go on with a program whose file was changed by another program.

        What the player typed meanwhile stays; the command for it takes the file's text.
        """
        session, name = self._screen.session, one_line(source.name)
        if self._screen.text == source.text:
            session.saved_as(source)  # it may be the game that has just saved it
            self._screen.autosave.edited()
        elif self._screen.text == session.source.text:
            self._screen.replace_text(source.text)
            session.open_program(source, source.text)
            self._screen.tell(f"{name} has changed on disk and is applied.")
        else:
            session.saved_as(source)
            self._screen.warn(f"{name} has changed on disk; your text is kept here.")

    def _leave_text_for(self, source: Source, kept: str | None = None) -> str:
        """Put the text of a program, or its draft, into the editor; what was there is kept.

        Args:
            source: The program.
            kept: What the player made of it before, to take if there is no draft.

        Returns:
            The text put there.
        """
        screen = self._screen
        if source.path == screen.session.source.path:
            return screen.text
        screen.autosave.flush()
        key: Key = "program", str(source.path)
        draft = screen.drafts.get(key) or screen.drafts.take(key)
        if draft is not None and draft.text != source.text:
            name = "program for this level"
            if draft.text != kept:
                name = f"unsaved text of {one_line(source.name)}"
            screen.tell(f"Your {name} is back.")
            screen.put_text(draft.text)
            return draft.text
        text = source.text if kept is None else kept
        if text != source.text:
            screen.tell("Your program for this level is back.")
        screen.put_text(text)
        return text

    # -- drafts --------------------------------------------------------------------------------

    async def offer(self) -> None:
        """Offer the text that an earlier session left unsaved, if there is any."""
        screen = self._screen
        drafts = await screen.offers.at_hand(self._left_unsaved)
        if not drafts:
            return
        here = str(screen.session.source.path)
        draft = next((draft for draft in drafts if draft.path == here), drafts[0])
        answers = [("yes", "Yes, continue"), ("no", "No, put it away"), ("show", "Show it")]
        when = draft.saved.astimezone()
        name = clip(one_line(draft.name), 40)
        question = f"Continue with your unsaved text of “{name}” from {when:%H:%M, %d %B}?"
        answer = await screen.offers.ask("Unsaved text", question, answers, text=draft.text)
        if answer == "yes":
            self._continue_with(draft)
        elif answer == "no":
            await asyncio.to_thread(screen.drafts.put_away, draft.key)

    async def _left_unsaved(self) -> list[Draft]:
        try:
            drafts = await asyncio.to_thread(self._screen.drafts.adopt, "program")
        except OSError as error:
            self._screen.autosave.report(error)
            return []
        return [draft for draft in drafts if await self._is_unsaved(draft)]

    def _continue_with(self, draft: Draft) -> None:
        screen = self._screen
        source = screen.session.source
        screen.autosave.flush()
        screen.drafts.take(draft.key)
        if draft.path == str(source.path):
            screen.replace_text(draft.text)
        else:
            source = self._source_of(draft)
            screen.put_text(draft.text)
        screen.session.open_program(source, draft.text)

    def _source_of(self, draft: Draft) -> Source:
        """The program that a draft belongs to, even if its file is gone."""
        try:
            return load_program(draft.path)
        except InputError:
            return Source(draft.name, "", Path(draft.path), shipped=False)

    async def _is_unsaved(self, draft: Draft) -> bool:
        """Whether a draft holds what is neither in its file nor among the earlier versions."""
        source = await asyncio.to_thread(self._source_of, draft)
        kept = await self._screen.journal.ask(lambda progress: progress.holds(draft.text))
        if source.text != draft.text and not kept:
            return True
        await asyncio.to_thread(self._screen.drafts.put_away, draft.key)
        return False
