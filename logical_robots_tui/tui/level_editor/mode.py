"""Edit mode: a level while it is edited, without the widgets that show it."""

from __future__ import annotations

import asyncio
from pathlib import Path
from secrets import token_hex
from time import perf_counter
from typing import TYPE_CHECKING, Literal, Protocol

from logical_robots_tui.editing.checks import check
from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.game import is_shipped
from logical_robots_tui.game.drafts import Draft
from logical_robots_tui.tui.level_editor.editor import LevelEditor
from logical_robots_tui.tui.recovery.autosave import Autosave
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.world import LevelError, load_level
from logical_robots_tui.world.drawing import coarsest_cell
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.native import read_native

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.editing.checks import Finding
    from logical_robots_tui.editing.strokes import Point
    from logical_robots_tui.game.drafts import Drafts, Key
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.app.ui import Spawn, Ui
    from logical_robots_tui.world import Level

__all__ = ["EditMode", "EditView", "Live"]

_DRAFT_DELAY = 1.0  # seconds from a change to its draft on disk
_CHECK_DELAY = 0.3  # seconds without a change before a level is looked through
_COARSEST = 10  # map units: a grid as coarse as the level's drawing, but not coarser


class EditView(Protocol):
    """Shows a level that is edited, and takes the player's keys and mouse."""

    def enter(self) -> None:
        """Keys and mouse edit from now on."""

    def leave(self, *, is_testing: bool) -> None:
        """Keys and mouse play, perhaps only for a moment."""

    def remove(self) -> None:
        """The level is left."""

    def redraw(self) -> None:
        """Show what has changed."""

    def obeys(self, key: str) -> bool:
        """Do what a key means; whether it means anything."""

    def do(self, command_id: str) -> None:
        """Do a command."""

    def use(self) -> None:
        """Use the tool at the cursor."""

    def go_to(self, point: Point) -> None:
        """Put the cursor somewhere, map units."""


class EditMode:
    """Editing the level at hand, from the first stroke until the level is left.

    Leaving and coming back goes on where one was; undo reaches back to the beginning.

    Args:
        session: Where the level is.
        ui: Where to say and ask.
        own: Folder of the player's levels.
        drafts: Where it is kept while it is not saved.
        view: Makes what shows it.
        key: Under which it was kept before, if it has no file.

    Attributes:
        levels: The level in its file, as it is edited, and on the screen.
        file: Its file if the player may save there, else None.
        findings: What looks wrong, or None while that is being looked at.
        is_on: Whether keys and mouse edit.
        is_testing: Whether the level is only played for a moment.
        saving: Held while the level is written to its file.
    """

    def __init__(
        self,
        session: Session,
        ui: Ui,
        own: Path,
        drafts: Drafts,
        view: Callable[[EditMode], EditView],
        key: str = "",
    ) -> None:
        self.session, self.ui, self.own = session, ui, own
        self.levels = levels = session.levels
        saved = levels.saved
        self.file = Path(saved.source) if saved.source and not is_shipped(saved) else None
        self.findings: list[Finding] | None = None
        self.is_on = self.is_testing = False
        self.saving = asyncio.Lock()
        self.editor = LevelEditor(levels.edits, lambda: session.frame.after, self._edited, ui.warn)
        self.live = Live(session, self.editor, ui.spawn)
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
        self._is_unwanted = self._is_over = self._has_begun = False
        self._checked: Level | None = None
        self.view = view(self)

    @property
    def is_saved(self) -> bool:
        """Whether a file says the same."""
        return self.levels.is_saved

    # -- in and out ----------------------------------------------------------------------------

    def enter(self) -> None:
        """Let keys and mouse edit the level; what was not saved of it comes back."""
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
        """Let keys and mouse play again; what was changed stays in the game."""
        self.editor.finish()
        self.live.flush()
        self.is_on = False
        self.view.leave(is_testing=self.is_testing)

    def test(self) -> None:
        """Play the level from its start, for a moment."""
        self.is_testing = True
        self.leave()
        self.session.restart()
        self.session.run()

    def end_test(self) -> None:
        """Come back from playing."""
        self.session.restart()
        self.enter()

    def end(self) -> None:
        """The level is left; what is not saved stays in its draft."""
        self._is_over = True
        self.live.stop()
        if self.is_on or self.is_testing:
            self.is_testing = False
            self.leave()
        self.autosave.stop()
        self.view.remove()

    def redraw(self) -> None:
        """Show what has changed at once."""
        if self.is_on:
            self.view.redraw()

    # -- what becomes of it --------------------------------------------------------------------

    def follow_game(self) -> None:
        """The game went elsewhere: what it shows is what is edited now; undo leads back."""
        if not alike(self.levels.shown, self.levels.edited):
            self.editor.adopt(f"go to tick {self.session.frame.tick}", self.levels.shown)
            self._noted()

    def on_disk(self) -> Literal["same", "another", "none"]:
        """Which level the file holds by now, compared with what was read or saved. Blocks."""
        try:
            found = load_level(Path(self.levels.saved.source))
        except LevelError:
            return "none"  # nothing of a level can be lost
        return "same" if alike(found, self.levels.saved) else "another"

    def saved(self, level: Level, saved: Level) -> None:
        """The level is saved.

        Args:
            level: What was saved.
            saved: The same with the name and source of the file.
        """
        self.ui.tell(f"Saved as {one_line(saved.name)}.")
        if self._is_over and level is not self.levels.edited:
            return  # the draft holds what was done since
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

    def throw_away(self) -> None:
        """Go back to the level as it is in its file; undo brings the changes back."""
        self.editor.do("throw away", lambda _: self.levels.saved)
        self._is_unwanted = True
        self.autosave.drop(("level", self._path))

    # -- inside --------------------------------------------------------------------------------

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
            self.ui.tell("Your unsaved changes of the level are back.")

    def _unsaved(self) -> tuple[str, str, Level | None]:
        """Path, title, and the level if that is to be kept."""
        is_wanted = not (self.is_saved or self._is_unwanted)
        return self._path, self.levels.saved.title, self.levels.edited if is_wanted else None

    def _edited(self) -> None:
        self._is_unwanted = False
        self.live.edited()
        self._noted()

    def _noted(self) -> None:
        """Whatever the way, the level is another one."""
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


def _draft_of(path: str, title: str, level: Level | None) -> Draft | Key:
    return ("level", path) if level is None else Draft("level", title, path, write_native(level))


_LEAST_WAIT = 0.01  # seconds in which a stroke is painted first
_AGAIN_AFTER = 0.04  # seconds between two changes of the game, at least
_SHARE = 3  # of what a change takes, before the next one


class Live:
    """Keeps the game in the level that is edited.

    While walls are painted the picture is ahead of the game, which follows as fast as it can:
    a large level takes a moment.

    Args:
        session: Whose game.
        editor: What is edited.
        spawn: Starts work in the background.
    """

    def __init__(self, session: Session, editor: LevelEditor, spawn: Spawn) -> None:
        self._session, self._editor, self._spawn = session, editor, spawn
        self._levels = session.levels
        self._next_at = 0.0
        self._is_due = self._is_over = False

    def edited(self) -> None:
        """The level has changed; the game follows at once, or soon if only walls did."""
        before, after = self._levels.shown, self._levels.edited
        only_walls = (
            before.robots is after.robots
            and before.beacons is after.beacons
            and before.areas is after.areas
            and before.walls.shape == after.walls.shape
        )
        if not only_walls:
            self.flush()
        elif not self._is_due:
            self._is_due = True
            self._spawn(self._flush_soon, "live", exclusive=False)

    def flush(self) -> None:
        """Bring the game up to date now."""
        before, after = self._levels.shown, self._levels.edited
        if after is before or self._is_over:
            return
        began = perf_counter()
        self._session.change_level(after, self._editor.poses.between(before, after))
        now = perf_counter()
        self._next_at = now + max(_AGAIN_AFTER, _SHARE * (now - began))

    def stop(self) -> None:
        """The game is another one: bring nothing into it."""
        self._is_over = True

    async def _flush_soon(self) -> None:
        await asyncio.sleep(max(self._next_at - perf_counter(), _LEAST_WAIT))
        self._is_due = False
        self.flush()
