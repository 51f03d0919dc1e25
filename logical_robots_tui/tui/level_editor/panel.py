"""The labyrinth pane while a level is edited: tools above, a line below, cursor and mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.keymap import command, commands
from logical_robots_tui.tui.level_editor.lines import InfoLine, ToolLine
from logical_robots_tui.tui.level_editor.mode import EditView
from logical_robots_tui.tui.level_editor.overlay import mark
from logical_robots_tui.tui.level_editor.pointer import Pointer

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.editing.strokes import Point
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
    from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane
    from logical_robots_tui.tui.level_editor.mode import EditMode

__all__ = ["EditPanel"]

_BACK_FROM_TEST = ("test", "stop_editing")


class EditPanel(EditView):
    """Shows a level that is edited, and takes keys and mouse.

    Args:
        mode: What edits.
        pane: Where.
        enter: Brings the pane to sight and gives it the keys.
        switched: Called with whether keys edit now.
        changed: Called when what stands around the panes may have changed.
    """

    def __init__(
        self,
        mode: EditMode,
        pane: LabyrinthPane,
        *,
        enter: Callable[[], None],
        switched: Callable[[bool], None],
        changed: Callable[[], None],
    ) -> None:
        self._mode, self._pane = mode, pane
        self._enter, self._switched, self._changed = enter, switched, changed
        self.pointer = Pointer(
            mode.editor,
            pane.view,
            moved=mode.redraw,
            released=mode.live.flush,
            opened=lambda: self.do("properties"),
        )
        self._tools = ToolLine(mode.editor)
        self._info = InfoLine(mode.editor)
        self._ids = dict.fromkeys(command("edit_level").keys, "stop_editing")
        self._ids |= {key: entry.id for entry in commands("level") for key in entry.keys}

    # -- in and out ----------------------------------------------------------------------------

    def enter(self) -> None:
        """Let keys and mouse edit."""
        pane = self._pane
        pane.select(None)
        pane.briefing.display = pane.banner.display = False
        pane.note("editing")
        if not self._tools.is_attached:
            pane.mount(self._tools, self._info)
        self._tools.display = self._info.display = True
        pane.view.overlay = self
        self._switched(True)
        self._enter()

    def leave(self, *, is_testing: bool) -> None:
        """Let keys and mouse play."""
        self._tools.display = self._info.display = False
        self._pane.view.overlay = None
        key = command("test").key_name
        self._pane.note(f"test: {key} ends it" if is_testing else "")
        self._pane.view.redraw()
        self._switched(False)
        self._changed()

    def remove(self) -> None:
        """Take away what is shown only while a level is edited."""
        for line in (self._tools, self._info):
            if line.is_attached:
                line.remove()

    # -- keys ----------------------------------------------------------------------------------

    def obeys(self, key: str) -> bool:
        """Do what a key means while a level is edited; whether it means anything."""
        if self._mode.is_testing and self._ids.get(key) in _BACK_FROM_TEST:
            self._mode.end_test()
            return True
        if not self._mode.is_on or not self._pane.has_focus:
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
        if self._mode.is_on:
            command(command_id).run(self._mode, self._mode.ui.spawn)
            self._mode.redraw()

    def use(self) -> None:
        """Use the tool at the cursor."""
        self.pointer.use()

    def go_to(self, point: Point) -> None:
        """Put the cursor somewhere."""
        self.pointer.go_to(point)

    # -- drawing -------------------------------------------------------------------------------

    @property
    def cursor(self) -> tuple[float, float]:
        """Where the player is at work, map units."""
        return self._mode.editor.cursor

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture of the level."""
        mark(cells, view, self._mode.editor, self._mode.findings or (), look)

    def redraw(self) -> None:
        """Show what has changed at once."""
        mode, session = self._mode, self._mode.session
        level = mode.levels.edited
        self._pane.view.show(level, session.frame, hurried=session.running)
        self._tools.follow()
        findings = mode.findings
        self._info.show(
            findings=None if findings is None else len(findings),
            forbidden=any(finding.forbids for finding in findings or ()),
            saved=bool(mode.levels.saved.source) and not mode.levels.edits.changed,
        )
        self._changed()
