"""The lines around the picture of an edited level: the tools above, a summary below."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.content import Content
from textual.widget import Widget

from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.layout.command_bar import Labels
from logical_robots_tui.tui.level_editor.tools import PAINTING, Tool
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import counted
from logical_robots_tui.world import Area, Beacon, Robot

if TYPE_CHECKING:
    from logical_robots_tui.editing.level_text import Thing
    from logical_robots_tui.tui.level_editor.editor import LevelEditor

_CHOSEN = "$here-ink on $here"


class ToolLine(Labels):
    """The tools with their keys, and the settings of the current one; clickable."""

    DEFAULT_CSS = """
    ToolLine { dock: top; height: auto; background: $panel; text-wrap: nowrap; layer: picture; }
    """

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__()
        self._editor = editor
        self._shown: object = None

    def follow(self) -> None:
        now = self._editor.settings, self._editor.edits.can_undo, self._editor.edits.can_redo
        if now != self._shown:
            self._shown = now
            self.refresh(layout=True)

    def get_content_height(self, container: object, viewport: object, width: int) -> int:
        return len(self._lines(width))

    def render(self) -> Content:
        return Content("\n").join(self._lines(self.size.width))

    def _lines(self, width: int) -> list[Content]:
        self.places = []
        lines = [Content("")]
        for name, label in self._labels():
            used = lines[-1].cell_length
            if used and used + 2 + label.cell_length > width:
                lines.append(Content(""))
                used = 0
            first = used + 1
            lines[-1] = lines[-1].append(" ").append(label)
            self.places.append((len(lines) - 1, first, first + label.cell_length, name))
        return lines

    def _labels(self) -> list[tuple[str, Content]]:
        settings = self._editor.settings
        found = [(tool.value, self._tool(tool)) for tool in Tool]
        if settings.tool in PAINTING:
            width = settings.width * settings.grid
            found.append(("wider_brush", _setting("[ ]", f"{counted(width, 'unit')} wide")))
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
    """Shows where the cursor is, what is selected, and what looks wrong."""

    DEFAULT_CSS = """
    InfoLine { dock: bottom; height: 1; background: $panel; text-wrap: nowrap; layer: picture; }
    """
    ALLOW_SELECT: ClassVar[bool] = False

    def __init__(self, editor: LevelEditor) -> None:
        super().__init__()
        self._editor = editor
        self._line = Content("")

    def show(self, *, findings: int | None, forbidden: bool, saved: bool) -> None:
        """Show findings, None while sought; a `forbidden` level can't be loaded."""
        editor = self._editor
        x, y = editor.cursor
        thing = editor.thing
        told = [Content.styled(f"{x:.0f}, {y:.0f}", f"bold {INK.number}")]
        if not saved:
            told.append(Content.styled("● not saved", INK.title))
        if findings:
            style = f"bold {INK.bad}" if forbidden else INK.warn
            told.append(Content.styled(f"! {counted(findings, 'finding')}", style))
        elif findings == 0:
            told.append(Content.styled("✓ no problems", INK.good))
        told.append(Content.styled(described(thing), INK.text if thing else INK.dim))
        line = Content(" ").append(Content("   ").join(told))
        if line.markup != self._line.markup:
            self._line = line
            self.refresh()

    def render(self) -> Content:
        return self._line


def described(thing: Thing | None) -> str:
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
