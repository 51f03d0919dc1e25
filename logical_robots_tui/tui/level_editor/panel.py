"""The labyrinth pane while a level is edited: tools above, a line below, cursor and mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.content import Content
from textual.widget import Widget

from logical_robots_tui.tui.commands.keymap import command, commands
from logical_robots_tui.tui.layout.command_bar import CommandChosen
from logical_robots_tui.tui.level_editor.mode import EditView
from logical_robots_tui.tui.level_editor.overlay import mark
from logical_robots_tui.tui.level_editor.pointer import Pointer
from logical_robots_tui.tui.level_editor.tools import PAINTING, Tool
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import Area, Beacon, Robot

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual import events

    from logical_robots_tui.editing.records import Thing
    from logical_robots_tui.editing.strokes import Point
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
    from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane
    from logical_robots_tui.tui.level_editor.editor import LevelEditor
    from logical_robots_tui.tui.level_editor.mode import EditMode

__all__ = ["EditPanel", "InfoLine", "ToolLine"]

_BACK_FROM_TEST = ("test", "stop_editing")


class EditPanel(EditView):
    """Shows an edited level, and handles keys and mouse.

    Args:
        mode: The edit mode.
        pane: The labyrinth pane.
        enter: Brings the pane into view and focuses it.
        switched: Called with whether keys edit now.
        changed: Called when the lines around the panes may have changed.
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
        """Remove everything that is only shown while a level is edited."""
        for line in (self._tools, self._info):
            if line.is_attached:
                line.remove()

    # -- keys ----------------------------------------------------------------------------------

    def handles(self, key: str) -> bool:
        """Run the editing command of a key; return whether there is one."""
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
        """Run a command."""
        if self._mode.is_on:
            command(command_id).run(self._mode, self._mode.ui.spawn)
            self._mode.redraw()

    def use(self) -> None:
        """Use the tool at the cursor."""
        self.pointer.use()

    def go_to(self, point: Point) -> None:
        """Move the cursor to a point."""
        self.pointer.go_to(point)

    # -- drawing -------------------------------------------------------------------------------

    @property
    def cursor(self) -> tuple[float, float]:
        """The cursor in map units."""
        return self._mode.editor.cursor

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture of the level."""
        mark(cells, view, self._mode.editor, self._mode.findings or (), look)

    def redraw(self) -> None:
        """Show what has changed, at once."""
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


_CHOSEN = "$here-ink on $here"


class ToolLine(Widget):
    """The tools with their keys, and the settings of the current one; clickable."""

    DEFAULT_CSS = """
    ToolLine { dock: top; height: auto; background: $panel; text-wrap: nowrap; layer: picture; }
    """
    ALLOW_SELECT: ClassVar[bool] = False

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__()
        self._editor = editor
        self._places: list[tuple[int, int, int, str]] = []
        self._shown: object = None

    def follow(self) -> None:
        """Show what has changed."""
        now = self._editor.settings, self._editor.edits.can_undo, self._editor.edits.can_redo
        if now != self._shown:
            self._shown = now
            self.refresh(layout=True)

    def get_content_height(self, container: object, viewport: object, width: int) -> int:
        """Return as many lines as the labels take."""
        return len(self._lines(width))

    def render(self) -> Content:
        """Return the labels."""
        return Content("\n").join(self._lines(self.size.width))

    def on_click(self, event: events.Click) -> None:
        """Run what was clicked."""
        event.stop()
        for row, first, stop, name in self._places:
            if event.y == row and first <= event.x < stop:
                self.post_message(CommandChosen(name))

    def _lines(self, width: int) -> list[Content]:
        self._places = []
        lines = [Content("")]
        for name, label in self._labels():
            used = lines[-1].cell_length
            if used and used + 2 + label.cell_length > width:
                lines.append(Content(""))
                used = 0
            first = used + 1
            lines[-1] = lines[-1].append(" ").append(label)
            self._places.append((len(lines) - 1, first, first + label.cell_length, name))
        return lines

    def _labels(self) -> list[tuple[str, Content]]:
        settings = self._editor.settings
        found = [(tool.value, self._tool(tool)) for tool in Tool]
        if settings.tool in PAINTING:
            width = settings.width * settings.grid
            found.append(("wider_brush", _setting("[ ]", f"{width} unit{'s' * (width != 1)} wide")))
        if settings.tool in (Tool.LINE, Tool.RECTANGLE, Tool.FILL):
            found.append(("ink", _setting(_key("ink"), "wall" if settings.is_wall else "floor")))
        if settings.tool is Tool.RECTANGLE:
            filled = "filled" if settings.is_filled else "border"
            found.append(("outline", _setting(_key("outline"), filled)))
        found.append(("grid_size", _setting(_key("grid_size"), f"grid {settings.grid}")))
        return found

    def _tool(self, tool: Tool) -> Content:
        entry = command(tool.value)
        if tool is self._editor.settings.tool:
            return Content.styled(f"{_key(tool.value)} {entry.title}", f"bold {_CHOSEN}")
        return Content.assemble((_key(tool.value), INK.key), " ", (entry.title, INK.text))


class InfoLine(Widget):
    """Where the cursor is, what is selected, and what looks wrong."""

    DEFAULT_CSS = """
    InfoLine { dock: bottom; height: 1; background: $panel; text-wrap: nowrap; layer: picture; }
    """
    ALLOW_SELECT: ClassVar[bool] = False

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__()
        self._editor = editor
        self._line = Content("")

    def show(self, *, findings: int | None, forbidden: bool, saved: bool) -> None:
        """Show the state.

        Args:
            findings: The number of likely mistakes, or None while they are being looked for.
            forbidden: Whether one of them keeps the level from being loaded.
            saved: Whether the level is saved.
        """
        editor = self._editor
        x, y = editor.cursor
        thing = editor.thing
        told = [Content.styled(f"{x:.0f}, {y:.0f}", f"bold {INK.number}")]
        if not saved:
            told.append(Content.styled("● not saved", INK.title))
        if findings:
            style = f"bold {INK.bad}" if forbidden else INK.warn
            told.append(Content.styled(f"! {findings} finding{'s' * (findings != 1)}", style))
        elif findings == 0:
            told.append(Content.styled("✓ sound", INK.good))
        told.append(Content.styled(described(thing), INK.text if thing else INK.dim))
        line = Content(" ").append(Content("   ").join(told))
        if line.markup != self._line.markup:
            self._line = line
            self.refresh()

    def render(self) -> Content:
        """Return the line."""
        return self._line


def described(thing: Thing | None) -> str:
    """Describe a thing in a few words."""
    if thing is None:
        return "nothing selected"
    name = clip(one_line(thing.name), 24)
    place = f"at {thing.x:g}, {thing.y:g}"
    if isinstance(thing, Robot):
        return f"Robot {name} {place}"
    if isinstance(thing, Beacon):
        return f"Beacon {name} {place}"
    assert isinstance(thing, Area)
    return f"Area {name} {place}, radius {thing.radius:g}"


def _key(name: str) -> str:
    return command(name).key_name


def _setting(keys: str, text: str) -> Content:
    return Content.assemble((keys, INK.key), " ", (text, INK.number))
