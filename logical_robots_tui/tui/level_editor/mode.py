"""Edit mode: the labyrinth pane while a level is edited."""

from __future__ import annotations

import asyncio
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.editing.checks import check
from logical_robots_tui.editing.delta import alike
from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.game import is_shipped
from logical_robots_tui.game.drafts import Draft
from logical_robots_tui.tui.commands.keymap import command, commands
from logical_robots_tui.tui.level_editor.editor import LevelEditor
from logical_robots_tui.tui.level_editor.lines import InfoLine, ToolLine
from logical_robots_tui.tui.level_editor.live import Live
from logical_robots_tui.tui.level_editor.overlay import mark
from logical_robots_tui.tui.level_editor.pointer import Pointer
from logical_robots_tui.tui.recovery.autosave import Autosave
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.world import LevelError, load_level
from logical_robots_tui.world.drawing import coarsest_cell
from logical_robots_tui.world.native import read_native

if TYPE_CHECKING:
    from logical_robots_tui.editing.checks import Finding
    from logical_robots_tui.game.drafts import Drafts, Key
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
    from logical_robots_tui.world import Level

__all__ = ["EditMode"]

_DRAFT_DELAY = 1.0  # seconds from a change to its draft on disk
_BACK_FROM_TEST = ("test", "stop_editing")
_CHECK_DELAY = 0.3  # seconds without a change before a level is looked through
_COARSEST = 10  # map units: a grid as coarse as the level's drawing, but not coarser


class EditMode:
    """Editing the level at hand, from the first stroke until the level is left.

    Leaving and coming back goes on where one was; undo reaches back to the beginning.

    Args:
        screen: Where the level is.
        own: Folder of the player's levels.
        drafts: Where it is kept while it is not saved.
        key: Under which it was kept before, if it has no file.

    Attributes:
        base: The level as it is in its file, or as it was made.
        file: Its file if the player may save there, else None.
        findings: What looks wrong, or None while that is being looked at.
        is_on: Whether keys and mouse edit.
        is_testing: Whether the level is only played for a moment.
        saving: Held while the level is written to its file.
    """

    def __init__(self, screen: MainScreen, own: Path, drafts: Drafts, key: str = "") -> None:
        base = screen.session.opened
        self.screen = screen
        self.own = own
        self.base = base
        self.file = Path(base.source) if base.source and not is_shipped(base) else None
        self.findings: list[Finding] | None = None
        self.is_on = self.is_testing = False
        self.saving = asyncio.Lock()
        self.editor = LevelEditor(
            screen.session.level,
            lambda: screen.session.frame.after,
            self._edited,
            screen.warn,
        )
        self.live = Live(screen, self.editor, self._adopted)
        self.autosave = Autosave(
            drafts,
            delay=_DRAFT_DELAY,
            state=self._unsaved,
            draft=lambda state: _draft_of(*state),
            failed=screen.warn,
            what="What you edit",
        )
        self._drafts = drafts
        self._path = base.source or key or f"new {base.name} {token_hex(4)}"
        self._is_unwanted = self._is_over = False
        self.pointer = Pointer(self)
        self._tools = ToolLine(self.editor)
        self._info = InfoLine(self.editor)
        self._checked: Level | None = None
        self._ids = dict.fromkeys(command("edit_level").keys, "stop_editing")
        self._ids |= {key: entry.id for entry in commands("level") for key in entry.keys}

    @property
    def has_changes(self) -> bool:
        """Whether the level differs from its file, or from how it was made."""
        level = self.editor.level
        return level is not self.base and not alike(level, self.base)

    @property
    def is_saved(self) -> bool:
        """Whether a file says the same."""
        return bool(self.base.source) and not self.has_changes

    # -- in and out ----------------------------------------------------------------------------

    def enter(self) -> None:
        """Let keys and mouse edit the level; what was not saved of it comes back."""
        screen, pane = self.screen, self.screen.labyrinth
        self.is_on, self.is_testing = True, False
        screen.arrangement.active = pane
        screen.arrangement.show()
        pane.select(None)
        pane.briefing.display = pane.banner.display = False
        pane.note("editing")
        if not self._tools.is_attached:
            grid = min(coarsest_cell(self.editor.level.walls), _COARSEST)
            self.editor.configure(grid=grid)
            pane.mount(self._tools, self._info)
            self._bring_back()
        self._tools.display = self._info.display = True
        pane.view.overlay = self
        screen.set_focus(pane)
        self._look_through()
        self.redraw()

    def leave(self) -> None:
        """Let keys and mouse play again; what was changed stays in the game."""
        self.editor.finish()
        self.live.flush()
        self.is_on = False
        pane = self.screen.labyrinth
        self._tools.display = self._info.display = False
        pane.view.overlay = None
        pane.note("")
        pane.view.redraw()
        self.screen.redraw_lines()

    def end(self) -> None:
        """The level is left; what is not saved stays in its draft."""
        self._is_over = True
        self.live.stop()
        if self.is_on or self.is_testing:
            self.leave()
        self.autosave.stop()
        for line in (self._tools, self._info):
            if line.is_attached:
                line.remove()

    def test(self) -> None:
        """Play the level from its start, for a moment."""
        self.leave()
        self.is_testing = True
        self.screen.labyrinth.note(f"test: {command('test').key_name} ends it")
        self._restart()
        self.screen.session.run()

    def _end_test(self) -> None:
        self._restart()
        self.enter()

    def _restart(self) -> None:
        self.screen.session.restart()
        self.screen.celebration.forget()

    # -- keys ----------------------------------------------------------------------------------

    def obeys(self, key: str) -> bool:
        """Do what a key means while a level is edited; whether it means anything."""
        if self.is_testing and self._ids.get(key) in _BACK_FROM_TEST:
            self._end_test()
            return True
        if not self.is_on or not self.screen.labyrinth.has_focus:
            return False
        if key.removeprefix("shift+") in ("left", "right", "up", "down"):
            self.pointer.move(key)
        elif key in self._ids:
            self.do(self._ids[key])
        else:
            return False
        return True

    def do(self, command_id: str) -> None:
        """Do a command."""
        if self.is_on:
            command(command_id).run(self, self.screen.spawn)
            self.redraw()

    # -- what becomes of it --------------------------------------------------------------------

    def on_disk(self) -> Literal["same", "another", "none"]:
        """Which level the file holds by now, compared with what was read or saved. Blocks."""
        try:
            found = load_level(Path(self.base.source))
        except LevelError:
            return "none"  # nothing of a level can be lost
        return "same" if alike(found, self.base) else "another"

    def saved(self, level: Level, saved: Level) -> None:
        """The level is saved.

        Args:
            level: What was saved.
            saved: The same with the name and source of the file.
        """
        self.screen.tell(f"Saved as {one_line(saved.name)}.")
        if self._is_over and level is not self.editor.level:
            return  # the draft holds what was done since
        self.autosave.drop(("level", self._path))
        if self._is_over:
            return
        if saved.source != self.base.source:
            self.screen.journal.open(saved)
        self.base, self.file = saved, Path(saved.source)
        self.screen.session.opened = saved
        if level is self.editor.level:
            self.editor.edits.saved()
        self._path = saved.source
        self.autosave.edited()
        self.redraw()

    def throw_away(self) -> None:
        """Go back to the level as it is in its file; undo brings the changes back."""
        self.editor.do("throw away", lambda _: self.base)
        self._is_unwanted = True
        self.autosave.drop(("level", self._path))

    # -- drawing -------------------------------------------------------------------------------

    def shown(self, level: Level) -> Level:
        """The level to draw, given that of the game."""
        return self.live.shown(level) if self.is_on else level

    @property
    def cursor(self) -> tuple[float, float]:
        """Where the player is at work, map units."""
        return self.editor.cursor

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture of the level."""
        mark(cells, view, self.editor, self.findings or (), look)

    def redraw(self) -> None:
        """Show what has changed at once."""
        if not self.is_on:
            return
        session = self.screen.session
        level = self.live.shown(session.level)
        self.screen.labyrinth.view.show(level, session.frame, hurried=session.running)
        self._tools.follow()
        findings = self.findings
        self._info.show(
            findings=None if findings is None else len(findings),
            forbidden=any(finding.forbids for finding in findings or ()),
            saved=bool(self.base.source) and not self.editor.edits.changed,
        )
        self.screen.redraw_lines()

    # -- inside --------------------------------------------------------------------------------

    def _bring_back(self) -> None:
        key: Key = "level", self._path
        draft = self._drafts.get(key) or self._drafts.take(key)
        if draft is None:
            return
        try:
            level = read_native(draft.text, self.base.name, self.base.source)
        except LevelError:
            return
        if not alike(level, self.base):
            self.editor.do("bring back", lambda _: level)
            self.screen.tell("Your unsaved changes of the level are back.")

    def _unsaved(self) -> tuple[str, str, Level | None]:
        """Path, title, and the level if that is to be kept."""
        is_wanted = not (self.is_saved or self._is_unwanted)
        return self._path, self.base.title, self.editor.level if is_wanted else None

    def _edited(self) -> None:
        self._is_unwanted = False
        self.live.edited()
        self._adopted()

    def _adopted(self) -> None:
        """Whatever the way, the level is another one."""
        self.autosave.edited()
        self._look_through()

    def _look_through(self) -> None:
        if self.editor.level is not self._checked:
            self.screen.spawn(self._check, "findings", exclusive=True)

    async def _check(self) -> None:
        await asyncio.sleep(_CHECK_DELAY)
        level = self.editor.level
        found = await asyncio.to_thread(check, level)
        if level is self.editor.level:
            self._checked, self.findings = level, found
            self.redraw()


def _draft_of(path: str, title: str, level: Level | None) -> Draft | Key:
    return ("level", path) if level is None else Draft("level", title, path, write_native(level))
