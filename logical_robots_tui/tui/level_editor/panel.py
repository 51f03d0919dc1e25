"""The labyrinth pane while a level is edited: keys, mouse, and what is drawn around and over it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.editing.editor import PAINTING, LevelEditor, Tool, handle_of, reach_of
from logical_robots_tui.editing.level_text import Entity
from logical_robots_tui.editing.strokes import Point
from logical_robots_tui.tui.commands.keymap import command, commands, key_bindings
from logical_robots_tui.tui.labyrinth.drawing.cells import BOLD, RGB, Cells, rgb_number, text_id
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT, Floats, Viewport
from logical_robots_tui.tui.layout.command_bar import Labels
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, count_of, one_line
from logical_robots_tui.world import Area

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane
    from logical_robots_tui.tui.level_editor.controller import LevelController


_CHOSEN = "$here-ink on $here"


class ToolLine(Labels):
    """The tools with their keys, and the settings of the current one; clickable."""

    DEFAULT_CSS = """
    ToolLine { dock: top; height: auto; background: $panel; text-wrap: nowrap; layer: picture; }
    """

    def __init__(self, controller: LevelController) -> None:
        super().__init__()
        self._controller = controller
        self._shown: object = None

    def follow(self) -> None:
        editor = self._controller.editor
        state = editor.settings, editor.edits.can_undo, editor.edits.can_redo
        if state != self._shown:
            self._shown = state
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
        settings = self._controller.editor.settings
        labels = []
        for tool in Tool:
            key, title = _key(tool.value), command(tool.value).title
            label = Content.assemble((key, INK.key), " ", (title, INK.text))
            if tool is settings.tool:
                label = Content.styled(f"{key} {title}", f"bold {_CHOSEN}")
            labels.append((tool.value, label))
        if settings.tool in PAINTING:
            width = settings.width * settings.grid
            labels.append(("wider_brush", _setting("[ ]", f"{count_of(width, 'unit')} wide")))
        if settings.tool in (Tool.LINE, Tool.RECTANGLE, Tool.FILL):
            labels.append(("ink", _setting(_key("ink"), "wall" if settings.is_wall else "floor")))
        if settings.tool is Tool.RECTANGLE:
            filled = "filled" if settings.is_filled else "border"
            labels.append(("outline", _setting(_key("outline"), filled)))
        labels.append(("grid_size", _setting(_key("grid_size"), f"grid {settings.grid}")))
        return labels


class InfoLine(Static):
    """Shows where the cursor is, what is selected, and what looks wrong."""

    DEFAULT_CSS = """
    InfoLine {
        dock: bottom; height: 1; width: 100%; background: $panel; text-wrap: nowrap; layer: picture;
    }
    """
    ALLOW_SELECT = False

    def __init__(self, controller: LevelController) -> None:
        super().__init__()
        self._controller, self._line = controller, Content("")

    def on_resize(self) -> None:
        if self._controller.is_on:
            self.follow()

    def follow(self) -> None:
        editor, levels = self._controller.editor, self._controller.levels
        findings, thing = self._controller.findings, editor.entity
        x, y = editor.cursor
        parts = [Content.styled(f"{x:.0f}, {y:.0f}", f"bold {INK.number}")]
        if not levels.saved.source or levels.edits.is_changed:
            parts.append(Content.styled("● not saved", INK.title))
        if findings:
            forbids = any(finding.forbids for finding in findings)
            style = f"bold {INK.bad}" if forbids else INK.warn
            parts.append(Content.styled(f"! {count_of(len(findings), 'finding')}", style))
        elif findings is not None:
            parts.append(Content.styled("✓ no problems", INK.good))
        ink = INK.text if thing else INK.dim
        for detail in (2, 1, 0):
            selection = Content.styled(_describe(thing, detail), ink)
            line = Content(" ").append(Content("   ").join([*parts, selection]))
            if not self.size.width or line.cell_length <= self.size.width:
                break
        if not line.is_same(self._line):
            self._line = line
            self.update(line, layout=False)


def _describe(thing: Entity | None, detail: int) -> str:
    """Name a thing, with its place and, if it has one, its radius as far as `detail` goes."""
    if thing is None:
        return "nothing selected"
    text = f"{type(thing).__name__} {clip(one_line(thing.name), 24)}"
    if detail:
        text += f" at {round(thing.x, 1):g}, {round(thing.y, 1):g}"
    if detail > 1 and isinstance(thing, Area):
        text += f", radius {round(thing.radius, 1):g}"
    return text


def _key(name: str) -> str:
    return command(name).key_name


def _setting(keys: str, text: str) -> Content:
    return Content.assemble((keys, INK.key), " ", (text, INK.number))


_FAR = 8  # cursor steps with shift


class EditPanel:
    """Shows an edited level in the labyrinth pane, and handles keys and mouse.

    `run` runs a command, `enter` focuses the pane, `switched` is called with whether keys edit
    now, and `changed` when the lines around the panes may have changed.
    """

    def __init__(
        self,
        controller: LevelController,
        pane: LabyrinthPane,
        *,
        run: Callable[[str], None],
        enter: Callable[[], None],
        switched: Callable[[bool], None],
        changed: Callable[[], None],
    ) -> None:
        self._controller, self._pane, self._run = controller, pane, run
        self._enter, self._switched, self._changed = enter, switched, changed
        self._tools, self._info = ToolLine(controller), InfoLine(controller)
        self._shown = False, False
        self._cursor: Point = (0.0, 0.0)
        self._keys = key_bindings(*commands("level"))
        controller.units = lambda: self._units

    def follow(self) -> None:
        is_on, pane = self._controller.is_on, self._pane
        if (state := (is_on, self._controller.is_testing)) != self._shown:
            if not self._tools.is_attached:
                pane.mount(self._tools, self._info)
            self._tools.display = self._info.display = is_on
            self._shown = state
            self._switch()
        if is_on:
            session, editor = self._controller.session, self._controller.editor
            pane.view.show(editor.level, session.frame, hurried=session.running)
            if editor.cursor != self._cursor:
                self._cursor = editor.cursor
                if (view := pane.view.view) is not None:
                    x, y = editor.cursor[0] - view.left, editor.cursor[1] - view.top
                    columns = _excess(x / view.units, view.columns)
                    rows = _excess(y / (view.units * CELL_ASPECT), view.rows)
                    if columns or rows:
                        pane.view.pan(columns, rows)
            self._tools.follow()
            self._info.follow()
            self._changed()

    def _switch(self) -> None:
        pane, (is_on, is_testing) = self._pane, self._shown
        if is_on:
            pane.view.overlay = self
            pane.keys.put_first(self._keys)
            pane.select(None)
            pane.briefing.close()
            pane.note("editing")
        else:
            pane.view.overlay = None
            pane.keys.put_first()
            key = command("test").key_name
            pane.note(f"test: {key} ends it" if is_testing else "")
            pane.view.redraw()
        self._switched(is_on)
        if is_on:
            self._enter()
        else:
            self._changed()

    def step(self, across: int, down: int, *, far: bool) -> None:
        """Move the cursor by a cell of the picture or of the grid, whichever is larger."""
        editor, view = self._controller.editor, self._pane.view.view
        if view is None:
            return
        times = _FAR if far else 1
        grid = editor.settings.grid
        wide = math.ceil(view.units / grid) * grid
        high = math.ceil(view.units * CELL_ASPECT / grid) * grid
        level = editor.level
        x, y = editor.cursor[0] + across * times * wide, editor.cursor[1] + down * times * high
        if editor.settings.is_grid_shown:
            x, y = round(x / grid) * grid, round(y / grid) * grid
        x, y = min(max(x, 0.0), level.width - 1.0), min(max(y, 0.0), level.height - 1.0)
        self.hover(x, y, is_held=True)

    @property
    def _units(self) -> float:
        view = self._pane.view.view
        return view.units if view else 1.0

    def press(self, x: float, y: float) -> None:
        editor = self._controller.editor
        editor.finish()
        editor.cursor = (x, y)
        editor.press(x, y, self._units)
        self.follow()

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        self._controller.editor.cursor = (x, y)
        if is_held:
            self._controller.editor.drag(x, y)
        self.follow()

    def release(self) -> None:
        self._controller.editor.release()
        self._controller.change_game()
        self.follow()

    def open(self) -> None:
        editor = self._controller.editor
        if editor.settings.tool is Tool.HAND and editor.entity is not None:
            self._run("properties")

    @property
    def cursor(self) -> Point:
        return self._controller.editor.cursor

    def paint(self, canvas: Canvas) -> None:
        cells, view, look = canvas
        editor = self._controller.editor
        if editor.settings.is_grid_shown:
            _dot_grid(canvas, editor)
        for finding in self._controller.findings or ():
            if finding.x is not None and finding.y is not None:
                canvas.put(view.cell(finding.x, finding.y), "!", _WARN)
        covered = _cover(view, editor)
        paints_wall = editor.settings.is_wall and editor.settings.tool is not Tool.ERASER
        accent = _ACCENT if paints_wall else _WIPE
        if covered is not None:
            _tint(cells, covered, accent)
            if look.is_plain:
                cells.text[covered] = text_id("*")
        for cell, sign in _corners(canvas, editor):
            (text, _), *_ = cells.row(*cell, cell[1] + 1)
            if not text.isalnum():
                canvas.put(cell, sign, _ACCENT)
        canvas.put(view.cell(*editor.cursor), "+", (0, 0, 0), accent)


def _excess(place: float, length: int) -> float:
    """Return how many cells to move a view so that a place is well inside; 0 if it is."""
    if 0 <= place < length:
        return 0.0
    return place - length * (0.25 if place < 0 else 0.75)


_LEAST_COLUMNS = 4  # between two dots of the grid
_UNSEEN = 28  # of 255, the largest difference of a cell's two colours that looks even
_ACCENT: RGB = (255, 180, 84)
_WIPE: RGB = (255, 123, 133)
_WARN: RGB = (242, 198, 95)
_BLANK = text_id(" ")


def _corners(canvas: Canvas, editor: LevelEditor) -> Iterator[tuple[tuple[int, int], str]]:
    """Yield the cells in sight around the selected thing, and of its handle, with their signs."""
    if (thing := editor.entity) is None:
        return
    view, is_plain = canvas.view, canvas.look.is_plain
    reach = reach_of(thing) + view.units * 0.8
    high = max(reach, view.units * 1.5)
    corners = ((-reach, -high), (reach, -high), (-reach, high), (reach, high))
    places = [(thing.x + x, thing.y + y) for x, y in corners]
    if (handle := handle_of(thing, view.units)) is not None:
        places.append(handle)
    for place, sign in zip(places, "++++*" if is_plain else "┌┐└┘◆", strict=False):
        if (cell := view.cell(*place)) is not None:
            yield cell, sign


def _dot_grid(canvas: Canvas, editor: LevelEditor) -> None:
    """Draw a dot at each crossing of grid lines; when zoomed out, only at every n-th."""
    cells, view, look = canvas
    level, grid = editor.level, editor.settings.grid
    times = next(
        (n for n in (1, 2, 4, 5, 10, 20, 50, 100) if n * grid >= _LEAST_COLUMNS * view.units), 200
    )
    spacing = grid * times
    columns = _cells_of(level.width, spacing, view.left, view.units, view.columns)
    rows = _cells_of(level.height, spacing, view.top, view.units * CELL_ASPECT, view.rows)
    where = np.ix_(rows, columns)
    style = cells.style[where]
    ink, paper = style >> 24 & 0xFFFFFF, style & 0xFFFFFF
    apart = np.zeros(style.shape, np.int64)
    for shift in (16, 8, 0):
        apart = np.maximum(apart, np.abs((ink >> shift & 0xFF) - (paper >> shift & 0xFF)))
    is_plain = (cells.text[where] == _BLANK) | (apart < _UNSEEN)
    dotted = np.zeros(cells.text.shape, np.bool_)
    dotted[where] = is_plain
    cells.text[dotted] = text_id("." if look.is_plain else "·")
    cells.style[dotted] = rgb_number(look.palette.rim) << 24 | cells.tone[dotted]


def _cells_of(
    length: int, spacing: int, first: float, units: float, count: int
) -> NDArray[np.intp]:
    places = np.arange(spacing, length, spacing)
    cells = np.floor((places - first) / units).astype(np.intp)
    return np.unique(cells[(cells >= 0) & (cells < count)])


def _cover(view: Viewport, editor: LevelEditor) -> NDArray[np.bool_] | None:
    settings, stroke = editor.settings, editor.stroke
    if settings.tool not in PAINTING:
        return None
    is_free = settings.tool in (Tool.BRUSH, Tool.ERASER) or stroke is None
    start = editor.cursor if is_free or stroke is None else stroke.start
    end = editor.cursor
    across = view.left + (np.arange(view.columns) + 0.5) * view.units
    down = view.top + (np.arange(view.rows) + 0.5) * view.units * CELL_ASPECT
    x, y = across[None, :], down[:, None]
    if settings.tool is Tool.RECTANGLE and stroke is not None:
        border = 0 if settings.is_filled else settings.width * settings.grid
        return _rectangle(x, y, start, end, view, border)
    half = max(settings.width * settings.grid / 2, view.units / 2)
    dx, dy = end[0] - start[0], end[1] - start[1]
    along = ((x - start[0]) * dx + (y - start[1]) * dy) / max(dx * dx + dy * dy, 1e-9)
    along = np.clip(along, 0, 1)
    far_x = np.maximum(np.abs(x - start[0] - along * dx) - view.units / 2, 0)
    far_y = np.maximum(np.abs(y - start[1] - along * dy) - view.units * CELL_ASPECT / 2, 0)
    inside: NDArray[np.bool_] = np.hypot(far_x, far_y) < half - view.units / 4
    return inside


def _rectangle(
    x: Floats, y: Floats, start: Point, end: Point, view: Viewport, border: int
) -> NDArray[np.bool_]:
    """Return the cells of a rectangle, or of its border, whose width is in map units."""
    half_x, half_y = view.units / 2, view.units * CELL_ASPECT / 2
    left, right = sorted((start[0], end[0]))
    top, bottom = sorted((start[1], end[1]))
    inside: NDArray[np.bool_] = (
        (x + half_x > left) & (x - half_x < right) & (y + half_y > top) & (y - half_y < bottom)
    )
    if not border:
        return inside
    near_x = (x - half_x < left + border) | (x + half_x > right - border)
    near_y = (y - half_y < top + border) | (y + half_y > bottom - border)
    on_border: NDArray[np.bool_] = inside & (near_x | near_y)
    return on_border


def _tint(cells: Cells, where: NDArray[np.bool_], colour: RGB) -> None:
    style = cells.style[where]
    mixed = style & BOLD
    for shift, target in zip((40, 32, 24, 16, 8, 0), colour * 2, strict=True):
        channel = style >> shift & 0xFF
        mixed |= (channel + (target - channel) * 2 // 5) << shift
    cells.style[where] = mixed
