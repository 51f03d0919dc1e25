"""Editing a level, without the widgets: drafts, checks, the game that follows, saving."""

from __future__ import annotations

import asyncio
import os
import re
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import is_shipped
from logical_robots_tui.player.drafts import Autosave, Draft, Drafts, Key
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level, LevelError, list_shipped, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.load import is_web_file

if TYPE_CHECKING:
    from logical_robots_tui.editing.checks import LevelFinding
    from logical_robots_tui.editing.editor import LevelEditor
    from logical_robots_tui.player.recovery import Offers
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import OpenLevel
    from logical_robots_tui.tui.app.ui import Dialogs

_DRAFT_DELAY = 1.0  # seconds from a change to its draft on disk
_CHECK_DELAY = 0.3  # seconds without a change before a level is checked
_COARSEST = 10  # map units of the default grid, at most
_LEAST_WAIT = 0.01  # seconds in which a stroke is painted first
_AGAIN_AFTER = 0.04  # seconds between two changes of the game, at least
_SHARE = 3  # pause after a change, as a multiple of its duration


class LevelController(SessionListener):
    """Edits the session's level until another is opened; returning continues, with undo.

    What editing needs is loaded when it first begins, with `editor`.

    Attributes:
        is_on: Whether keys and mouse edit the level.
        is_testing: Whether it is being played for a test.
        units: Gives the map units per column of the view; a thing can be picked from that far away.
        levels: The level that is or was edited last, in its versions.
        file: Where the player may save, or None.
        findings: Likely mistakes; None while they are looked for.
    """

    editor: LevelEditor

    def __init__(
        self,
        session: Session,
        ui: Dialogs,
        folder: Path,
        drafts: Drafts,
        open_level: Callable[[Level], Awaitable[None]],
        changed: Callable[[], None],
    ) -> None:
        self.session, self.ui, self.changed = session, ui, changed
        self._folder, self._drafts, self._open_level = folder, drafts, open_level
        self.units: Callable[[], float] = lambda: 1.0
        self._saving = asyncio.Lock()
        self._autosave = Autosave(
            drafts,
            delay=_DRAFT_DELAY,
            state=self._unsaved_state,
            draft=_draft_of,
            warn=ui.warn,
            subject="The edited level",
        )
        self.levels = session.levels
        self._reset()

    def _reset(self) -> None:
        self.is_on = self.is_testing = False
        self.file: Path | None = None
        self.findings: list[LevelFinding] | None = None
        self.has_begun = self._is_unwanted = self._is_change_due = False
        self._path = ""
        self._change_from = 0.0
        self._checked: Level | None = None

    @property
    def level(self) -> Level:
        """The level to draw: that of the visible frame, or its edited version."""
        return self.levels.edited if self.is_on else self.session.level

    # -- beginning and ending ------------------------------------------------------------------

    def toggle(self) -> None:
        """Edit the level, or end that; a stroke under way is kept."""
        if not self.is_on:
            self.open()
            return
        self.editor.finish()
        self.stop()

    def open(self, key: str = "") -> None:
        """Let keys and mouse edit the level, with the draft of a key from a crashed session."""
        begins = not self.has_begun
        if begins:
            from logical_robots_tui.editing.editor import LevelEditor
            from logical_robots_tui.world.levels.native import coarsest_cell

            levels, session = self.levels, self.session
            saved = levels.saved
            self.has_begun = True
            self.file = Path(saved.source) if saved.source and not is_shipped(saved) else None
            self._path = saved.source or key or f"new {saved.name} {os.urandom(4).hex()}"
            self.editor = LevelEditor(
                levels.edits, lambda: session.frame.after, self._edited, self.ui.warn
            )
            self.editor.configure(grid=min(coarsest_cell(levels.edited.walls), _COARSEST))
        self.is_on, self.is_testing = True, False
        self.changed()
        self._follow_game()
        if begins:
            self._bring_back()
        self._look_through()
        self.changed()

    def leave(self) -> None:
        self.editor.finish()
        self.change_game()
        self.is_on = False
        self.changed()

    def stop(self) -> None:
        """Cancel the stroke under way, or end editing; asks what to keep."""
        if self.editor.cancel():
            return
        if self.levels.is_saved:
            self.leave()
        else:
            self.ui.spawn(self._ask_what_to_keep, "dialog", exclusive=True)

    def test(self) -> None:
        """Play the level from its start, or return from that."""
        if self.is_testing:
            self.session.restart()
            self.open()
            return
        self.is_testing = True
        self.leave()
        self.session.restart()
        self.session.run()

    async def make_level(self) -> None:
        from logical_robots_tui.tui.level_editor.forms import NewLevelForm
        from logical_robots_tui.tui.library.level_screen import own_levels

        own_names = await asyncio.to_thread(own_levels, self._folder)
        names = [*dict.fromkeys([*await asyncio.to_thread(list_shipped), *own_names])]
        form = NewLevelForm(names, self.session.level.name, self._folder)
        if await self.ui.ask(form) and form.level is not None:
            await self._open_level(form.level)
            self.open()

    def level_opened(self, level: Level) -> None:
        """End editing for another level; unsaved changes stay in a draft."""
        if self.has_begun:
            self.editor.finish()
            self._autosave.stop()
            self._reset()
            self.changed()
        self.levels = self.session.levels

    def level_changed(self) -> None:
        if self.is_on:
            self._follow_game()

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        if self.has_begun:
            self._autosave.flush()

    def close(self) -> None:
        if self.has_begun:
            self._autosave.stop()

    # -- commands ------------------------------------------------------------------------------

    def undo(self) -> None:
        if not self.editor.cancel():
            operation = self.editor.undo()
            self.ui.tell(f"Undone: {operation}." if operation else "There is nothing to undo.")

    def redo(self) -> None:
        operation = self.editor.redo()
        self.ui.tell(f"Redone: {operation}." if operation else "There is nothing to redo.")

    def take(self, tool: str) -> None:
        from logical_robots_tui.editing.editor import Tool

        self.editor.configure(tool=Tool(tool))

    def use(self) -> None:
        """Act as the mouse button at the cursor."""
        if self.editor.stroke is None:
            self.editor.press(*self.editor.cursor, self.units())
        else:
            self.editor.release()
            self.change_game()

    def edit_thing(self) -> None:
        from logical_robots_tui.tui.commands.keymap import with_keys
        from logical_robots_tui.tui.level_editor.forms import ThingForm

        ref = self.editor.selected
        if ref is None or self.editor.entity is None:
            self.ui.warn(with_keys("Select an object first: click it, or press {next_object}."))
        else:
            self.ui.show(
                ThingForm(self.editor, ref, self.session.place_robot), lambda _: self.changed()
            )

    def edit_level(self) -> None:
        from logical_robots_tui.tui.level_editor.forms import LevelForm

        self.ui.show(LevelForm(self.editor), lambda _: self.changed())

    async def list_findings(self) -> None:
        from logical_robots_tui.tui.level_editor.forms import FindingList

        if not self.findings:
            is_checking = self.findings is None
            self.ui.tell("Checking the level…" if is_checking else "Nothing looks wrong.")
            return
        finding = await self.ui.ask(FindingList(self.findings))
        if finding is not None and finding.x is not None and finding.y is not None:
            self.editor.cursor = (finding.x, finding.y)
        self.changed()

    # -- saving --------------------------------------------------------------------------------

    async def save(self) -> bool:
        """Save the level in its file, or else under a new name; return whether it was saved."""
        from logical_robots_tui.editing.files import is_made_here

        self.editor.finish()
        file = self.file
        if file is None:
            return await self.save_as()
        name = one_line(file.name)
        if not self.levels.is_saved and not await asyncio.to_thread(is_made_here, file):
            answers = [("other", "Save under another name"), ("same", f"Replace {name}")]
            question = f"{name} was not made by this game. Replace it?"
            answer = await self.ui.choose("Save the level", question, answers)
            if answer != "same":
                return answer == "other" and await self.save_as()
        # Not cancelled, because the game must learn that the file was written.
        is_saved = await asyncio.shield(asyncio.create_task(self._save_in(file)))
        if is_saved is None:
            self.ui.warn(f"{name} was changed by another program. Save under another name.")
            return await self.save_as()
        return is_saved

    async def _save_in(self, file: Path) -> bool | None:
        """Save in a file; return whether that worked, or None if another program changed it."""
        from logical_robots_tui.editing.files import save_level

        async with self._saving:
            levels, path = self.levels, self._path
            try:
                disk_level = await asyncio.to_thread(load_level, Path(levels.saved.source))
            except LevelError:
                disk_level = None  # there is no level that could be lost
            if disk_level is not None and not alike(disk_level, levels.saved):
                return None
            if levels.is_saved and disk_level is not None:
                self.ui.tell("It is already saved.")
                return True
            level = levels.edited
            self.ui.tell("Saving…")
            try:
                saved = await asyncio.to_thread(save_level, level, file)
            except InputError as error:
                self.ui.warn(str(error))
                return False
            self.saved(levels, path, level, saved)
            return True

    async def save_as(self) -> bool:
        from logical_robots_tui.editing.entities import set_words
        from logical_robots_tui.tui.library.save_dialog import SaveLevel

        self.editor.finish()
        levels, path = self.levels, self._path
        if self.file is not None:
            sibling = self.file.with_stem(f"{self.file.stem}-2")
            name = sibling.stem if sibling.parent == self._folder else str(sibling)
        elif not levels.saved.source:  # a new level is named after its title
            words = re.findall(r"[^\W_]+", levels.edited.title.lower())
            name = "-".join(words) or levels.saved.name
        else:
            name = f"my-{levels.saved.name.lstrip('0123456789-') or levels.saved.name}"
        saved = await self.ui.ask(SaveLevel(levels.edited, name, self._folder, self.file))
        if saved is None:
            return False
        self.editor.do("title", lambda level: set_words(level, title=saved.title))
        self.saved(levels, path, levels.edited, saved)
        return True

    def saved(self, levels: OpenLevel, path: str, level: Level, saved: Level) -> None:
        """Note that `level` was saved; `saved` has the name and source of the file."""
        from logical_robots_tui.editing.level_text import lost_in_web

        if is_web_file(saved.source):
            self.ui.tell(f"Saved as {one_line(Path(saved.source).name)} for the web platform.")
            if lost := lost_in_web(replace(level, name=saved.name)):
                self.ui.warn(f"That format has no place for: {', '.join(lost)}.")
        else:
            self.ui.tell(f"Saved as {one_line(saved.name)}.")
        is_over = levels is not self.levels
        if is_over and level is not levels.edited:
            return  # the draft holds later changes
        self._autosave.drop(("level", path))
        if is_over:
            return
        self.file, self._path = Path(saved.source), saved.source
        self.session.level_saved_as(saved)
        if level is levels.edited:
            levels.edits.mark_saved()
        self._autosave.edited()
        self.changed()

    async def _ask_what_to_keep(self) -> None:
        """Wait for saving to end, ask what to do with unsaved changes, and leave editing."""
        async with self._saving:
            is_saved = self.levels.is_saved
        if is_saved:
            self.leave()
            return
        answers = [("save", "Save")] if self.file is not None else []
        answers += [("keep", "Keep as a level"), ("game", "Just for this game")]
        answers.append(("away", "Throw away"))
        question = "What should happen to your changes to the level?"
        answer = await self.ui.choose("Leave editing", question, answers)
        if answer == "away":
            self._throw_away()
        elif (answer == "save" and not await self.save()) or (
            answer == "keep" and not await self.save_as()
        ):
            return
        if answer is not None:
            self.leave()

    async def discard(self) -> None:
        if not self.levels.has_changes:
            self.ui.tell("Nothing has changed.")
            return
        answers = [("no", "No, keep them"), ("yes", "Yes, throw them away")]
        question = "Throw all changes away? Undo restores them until you leave the level."
        if await self.ui.choose("Throw away", question, answers) == "yes":
            self._throw_away()
            self.changed()

    def _throw_away(self) -> None:
        """Revert to the level in its file; undo restores the changes."""
        self.editor.do("throw away", lambda _: self.levels.saved)
        self._is_unwanted = True
        self._autosave.drop(("level", self._path))

    # -- drafts --------------------------------------------------------------------------------

    async def offer(self, offers: Offers) -> None:
        try:
            drafts = await offers.at_hand(partial(asyncio.to_thread, self._drafts.adopt, "level"))
        except OSError:
            return  # current edits can't be kept either, which is reported then
        if drafts:
            from logical_robots_tui.player.recovery import offer

            await offer(offers, drafts, self._drafts, self._go_on)

    async def _go_on(self, level: Level, draft: Draft) -> None:
        await self._open_level(level)
        self.open(draft.path)

    def _bring_back(self) -> None:
        key: Key = "level", self._path
        draft = self._drafts.get(key) or self._drafts.take(key)
        if draft is None:
            return
        from logical_robots_tui.world.levels.native import read_native

        saved = self.levels.saved
        try:
            level = read_native(draft.text, saved.name, saved.source)
        except LevelError:
            return
        if not alike(level, saved):
            self.editor.do("bring back", lambda _: level)
            self.ui.tell("Your unsaved changes to the level have been restored.")

    def _unsaved_state(self) -> tuple[str, str, Level | None]:
        is_wanted = not (self.levels.is_saved or self._is_unwanted)
        return self._path, self.levels.saved.title, self.levels.edited if is_wanted else None

    # -- following -----------------------------------------------------------------------------

    def _follow_game(self) -> None:
        """Adopt the level that the game shows now, as one undo step."""
        if not alike(self.levels.shown, self.levels.edited):
            self.editor.adopt(f"go to tick {self.session.frame.tick}", self.levels.shown)
            self._noted()

    def _edited(self) -> None:
        """Let the game follow a change: at once, or a little later if only walls changed."""
        self._is_unwanted = False
        old_level, new_level = self.levels.shown, self.levels.edited
        only_walls = (
            old_level.robots is new_level.robots
            and old_level.beacons is new_level.beacons
            and old_level.areas is new_level.areas
            and old_level.walls.shape == new_level.walls.shape
        )
        if not only_walls:
            self.change_game()
        elif not self._is_change_due:
            self._is_change_due = True
            self.ui.spawn(self._change_game_later, "live", exclusive=False)
        self._noted()

    def _noted(self) -> None:
        self._autosave.edited()
        self._look_through()

    def _look_through(self) -> None:
        if self.levels.edited is not self._checked:
            self.ui.spawn(self._check, "findings", exclusive=True)

    async def _check(self) -> None:
        from logical_robots_tui.editing.checks import check

        await asyncio.sleep(_CHECK_DELAY)
        level = self.levels.edited
        findings = await asyncio.to_thread(check, level)
        if level is self.levels.edited:
            self._checked, self.findings = level, findings
            self.changed()

    async def _change_game_later(self) -> None:
        levels = self.levels
        await asyncio.sleep(max(self._change_from - self.session.clock.now(), _LEAST_WAIT))
        if levels is self.levels:
            self._is_change_due = False
            self.change_game()

    def change_game(self) -> None:
        """Let the game have the edited level, which the picture may precede."""
        old_level, new_level = self.levels.shown, self.levels.edited
        if new_level is old_level:
            return
        start = self.session.clock.now()
        self.session.change_level(new_level, self.editor.poses.between(old_level, new_level))
        end = self.session.clock.now()
        self._change_from = end + max(_AGAIN_AFTER, _SHARE * (end - start))


def _draft_of(state: tuple[str, str, Level | None]) -> Draft | Key:
    from logical_robots_tui.editing.level_text import write_native

    path, title, level = state
    return ("level", path) if level is None else Draft("level", title, path, write_native(level))
