"""Edit mode: the state of an edited level, without its widgets."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING, Literal, Protocol

from logical_robots_tui.editing.checks import LevelFinding, check
from logical_robots_tui.editing.level_text import lost_in_web, write_native
from logical_robots_tui.editing.strokes import Point
from logical_robots_tui.game import is_shipped
from logical_robots_tui.player.autosave import Autosave
from logical_robots_tui.player.drafts import Draft, Drafts, Key
from logical_robots_tui.tui.level_editor.editor import LevelEditor
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level, LevelError, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.drawing import coarsest_cell
from logical_robots_tui.world.levels.load import is_web_file
from logical_robots_tui.world.levels.native import read_native

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs

_DRAFT_DELAY = 1.0  # seconds from a change to its draft on disk
_CHECK_DELAY = 0.3  # seconds without a change before a level is checked
_COARSEST = 10  # map units of the default grid, at most
_LEAST_WAIT = 0.01  # seconds in which a stroke is painted first
_AGAIN_AFTER = 0.04  # seconds between two changes of the game, at least
_SHARE = 3  # pause after a change, as a multiple of its duration


class EditView(Protocol):
    """Shows an edited level, and handles keys and mouse."""

    def enter(self) -> None:
        """Let keys and mouse edit."""

    def leave(self, *, is_testing: bool) -> None:
        """Let keys and mouse play, for a test or for good."""

    def remove(self) -> None:
        """Remove the view, because another level was opened."""

    def redraw(self) -> None:
        """Show what has changed."""

    def handles(self, key: str) -> bool:
        """Run the command of a key; return whether there is one."""

    def do(self, command_id: str) -> None:
        """Run a command."""

    def use(self) -> None:
        """Use the tool at the cursor."""

    def go_to(self, point: Point) -> None:
        """Move the cursor to a point in map units."""


class EditMode:
    """Editing the current level until another is opened; returning continues, with undo.

    `file` is where the player may save, or None; `findings` are None while being looked for;
    `saving` is held meanwhile.
    """

    def __init__(
        self,
        session: Session,
        ui: Dialogs,
        own: Path,
        drafts: Drafts,
        view: Callable[[EditMode], EditView],
        key: str = "",
    ) -> None:
        self.session, self.ui, self.own = session, ui, own
        self.levels = levels = session.levels
        saved = levels.saved
        self.file = Path(saved.source) if saved.source and not is_shipped(saved) else None
        self.findings: list[LevelFinding] | None = None
        self.is_on = self.is_testing = False
        self.saving = asyncio.Lock()
        self.editor = LevelEditor(levels.edits, lambda: session.frame.after, self._edited, ui.warn)
        self.autosave = Autosave(
            drafts,
            delay=_DRAFT_DELAY,
            state=self._unsaved,
            draft=lambda state: _draft_of(*state),
            failed=ui.warn,
            what="What you edit",
        )
        self._drafts = drafts
        self._path = saved.source or key or f"new {saved.name} {token_hex(4)}"
        self._is_unwanted = self._is_over = self._has_begun = self._is_change_due = False
        self._change_from = 0.0
        self._checked: Level | None = None
        self.view = view(self)

    def enter(self) -> None:
        """Let keys and mouse edit the level; restores unsaved changes."""
        self.is_on, self.is_testing = True, False
        self.view.enter()
        self.follow_game()
        if not self._has_begun:
            self._has_begun = True
            grid = min(coarsest_cell(self.levels.edited.walls), _COARSEST)
            self.editor.configure(grid=grid)
            self._bring_back()
        self._look_through()
        self.redraw()

    def leave(self) -> None:
        self.editor.finish()
        self.change_game()
        self.is_on = False
        self.view.leave(is_testing=self.is_testing)

    def test(self) -> None:
        self.is_testing = True
        self.leave()
        self.session.restart()
        self.session.run()

    def end_test(self) -> None:
        self.session.restart()
        self.enter()

    def end(self) -> None:
        self._is_over = True
        if self.is_on or self.is_testing:
            self.is_testing = False
            self.leave()
        self.autosave.stop()
        self.view.remove()

    def redraw(self) -> None:
        if self.is_on:
            self.view.redraw()

    def follow_game(self) -> None:
        """Adopt the level that the game shows now, as one undo step."""
        if not alike(self.levels.shown, self.levels.edited):
            self.editor.adopt(f"go to tick {self.session.frame.tick}", self.levels.shown)
            self._noted()

    def on_disk(self) -> Literal["same", "another", "none"]:
        """Compare the file with what was last read or saved. Blocks."""
        try:
            found = load_level(Path(self.levels.saved.source))
        except LevelError:
            return "none"  # there is no level that could be lost
        return "same" if alike(found, self.levels.saved) else "another"

    def saved(self, level: Level, saved: Level) -> None:
        """Note a save; `saved` has the name and source of the file."""
        self._tell_saved(level, saved)
        if self._is_over and level is not self.levels.edited:
            return  # the draft holds later changes
        self.autosave.drop(("level", self._path))
        if self._is_over:
            return
        self.file = Path(saved.source)
        self.session.level_saved_as(saved)
        if level is self.levels.edited:
            self.levels.edits.saved()
        self._path = saved.source
        self.autosave.edited()
        self.redraw()

    def _tell_saved(self, level: Level, saved: Level) -> None:
        if not is_web_file(saved.source):
            self.ui.tell(f"Saved as {one_line(saved.name)}.")
            return
        file = one_line(Path(saved.source).name)
        self.ui.tell(f"Saved as {file} for the web platform.")
        if lost := lost_in_web(replace(level, name=saved.name)):
            self.ui.warn(f"That format has no place for: {', '.join(lost)}.")

    def throw_away(self) -> None:
        """Revert to the level in its file; undo restores the changes."""
        self.editor.do("throw away", lambda _: self.levels.saved)
        self._is_unwanted = True
        self.autosave.drop(("level", self._path))

    def _bring_back(self) -> None:
        key: Key = "level", self._path
        draft = self._drafts.get(key) or self._drafts.take(key)
        if draft is None:
            return
        saved = self.levels.saved
        try:
            level = read_native(draft.text, saved.name, saved.source)
        except LevelError:
            return
        if not alike(level, saved):
            self.editor.do("bring back", lambda _: level)
            self.ui.tell("Your unsaved changes to the level have been restored.")

    def _unsaved(self) -> tuple[str, str, Level | None]:
        is_wanted = not (self.levels.is_saved or self._is_unwanted)
        return self._path, self.levels.saved.title, self.levels.edited if is_wanted else None

    def _edited(self) -> None:
        self._is_unwanted = False
        self._change_game_soon()
        self._noted()

    def _noted(self) -> None:
        self.autosave.edited()
        self._look_through()

    def _look_through(self) -> None:
        if self.levels.edited is not self._checked:
            self.ui.spawn(self._check, "findings", exclusive=True)

    async def _check(self) -> None:
        await asyncio.sleep(_CHECK_DELAY)
        level = self.levels.edited
        found = await asyncio.to_thread(check, level)
        if level is self.levels.edited:
            self._checked, self.findings = level, found
            self.redraw()

    def _change_game_soon(self) -> None:
        """Let the game follow a change: at once, or a little later if only walls changed."""
        before, after = self.levels.shown, self.levels.edited
        only_walls = (
            before.robots is after.robots
            and before.beacons is after.beacons
            and before.areas is after.areas
            and before.walls.shape == after.walls.shape
        )
        if not only_walls:
            self.change_game()
        elif not self._is_change_due:
            self._is_change_due = True
            self.ui.spawn(self._change_game_later, "live", exclusive=False)

    async def _change_game_later(self) -> None:
        await asyncio.sleep(max(self._change_from - self.session.clock.now(), _LEAST_WAIT))
        self._is_change_due = False
        self.change_game()

    def change_game(self) -> None:
        """Let the game have the edited level, which the picture may precede."""
        before, after = self.levels.shown, self.levels.edited
        if after is before or self._is_over:
            return
        began = self.session.clock.now()
        self.session.change_level(after, self.editor.poses.between(before, after))
        now = self.session.clock.now()
        self._change_from = now + max(_AGAIN_AFTER, _SHARE * (now - began))


def _draft_of(path: str, title: str, level: Level | None) -> Draft | Key:
    return ("level", path) if level is None else Draft("level", title, path, write_native(level))
