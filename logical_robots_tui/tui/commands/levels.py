"""The commands for making levels; those of the level editor are given its edit mode."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.command import Group
from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.level_editor.mode import EditMode

levels = Group("Making levels")


@levels.command("Edit the level", "M")
def edit_level(screen: MainScreen) -> None:
    """Edit the labyrinth, even while the robots run; the same key ends it."""
    screen.editing.open()


@levels.command("New level…", "H")
async def new_level(screen: MainScreen) -> None:
    """Make a level: an empty room, a random labyrinth, or a copy of any level."""
    await screen.editing.make_level()


editing = Group("In the level editor", "level")


def _take(tool: str, mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.editor import Tool

    mode.editor.configure(tool=Tool(tool))


for _tool, _key, _help in (
    ("hand", "h", "Select and drag objects; turn and resize them by their ◆."),
    ("brush", "b", "Paint walls."),
    ("line", "l", "Draw a straight wall from one point to another."),
    ("rectangle", "r", "Draw a rectangle, filled or with a border."),
    ("fill", "f", "Fill a region with wall, or clear connected walls."),
    ("eraser", "e", "Erase walls."),
    ("robot", "o", "Place a robot."),
    ("beacon", "c", "Place a beacon."),
    ("area", "a", "Place an area; drag to size it."),
):
    editing.add(_tool, _tool.capitalize(), _help, partial(_take, _tool), _key)


@editing.command("Use the tool", "enter", bar="Use")
def use(mode: EditMode) -> None:
    """Act as the mouse button at the cursor: begin or end a stroke, take or drop an object."""
    mode.view.use()


@editing.command("Undo", "u", bar="Undo")
def undo(mode: EditMode) -> None:
    """Undo the last change."""
    if not mode.editor.cancel():
        what = mode.editor.undo()
        mode.ui.tell(f"Undone: {what}." if what else "There is nothing to undo.")


@editing.command("Redo", "U", bar="Redo", spare=5)
def redo(mode: EditMode) -> None:
    """Redo the change undone last."""
    what = mode.editor.redo()
    mode.ui.tell(f"Redone: {what}." if what else "There is nothing to redo.")


@editing.command("Narrower brush", "left_square_bracket")
def narrower_brush(mode: EditMode) -> None:
    """Make brush and border narrower."""
    mode.editor.settings = mode.editor.settings.wider(-1)


@editing.command("Wider brush", "right_square_bracket")
def wider_brush(mode: EditMode) -> None:
    """Make brush and border wider."""
    mode.editor.settings = mode.editor.settings.wider(1)


@editing.command("Wall or floor", "k")
def ink(mode: EditMode) -> None:
    """Draw and fill with wall or with floor."""
    mode.editor.configure(is_wall=not mode.editor.settings.is_wall)


@editing.command("Filled or border", "v")
def outline(mode: EditMode) -> None:
    """Draw rectangles filled, or only their border."""
    mode.editor.configure(is_filled=not mode.editor.settings.is_filled)


@editing.command("Grid", "g", bar="Grid", spare=6)
def grid(mode: EditMode) -> None:
    """Show or hide the grid."""
    settings = mode.editor.settings
    mode.editor.settings = replace(settings, is_grid_shown=not settings.is_grid_shown)


@editing.command("Grid size", "G")
def grid_size(mode: EditMode) -> None:
    """Choose the next size of the grid."""
    mode.editor.settings = mode.editor.settings.next_grid()


@editing.command("Next object", "tab")
def next_object(mode: EditMode) -> None:
    """Select the next robot, beacon or area."""
    mode.editor.select_next(1)
    mode.view.go_to(mode.editor.cursor)


@editing.command("Previous object", "shift+tab")
def previous_object(mode: EditMode) -> None:
    """Select the previous robot, beacon or area."""
    mode.editor.select_next(-1)
    mode.view.go_to(mode.editor.cursor)


@editing.command("Turn left", "comma")
def turn_left(mode: EditMode) -> None:
    """Turn the selected robot to its left."""
    mode.editor.turn(-1)


@editing.command("Turn right", "full_stop")
def turn_right(mode: EditMode) -> None:
    """Turn the selected robot to its right."""
    mode.editor.turn(1)


@editing.command("Properties…", "i", bar="Properties", spare=1)
def properties(mode: EditMode) -> None:
    """Edit name, colour, battery, switches and the like of the selected object."""
    from logical_robots_tui.tui.level_editor.forms import ThingForm

    ref = mode.editor.selected
    if ref is None or mode.editor.thing is None:
        mode.ui.warn(with_keys("Select an object first: click it, or press {next_object}."))
    else:
        mode.ui.show(ThingForm(mode.editor, ref, mode.session.put), lambda _: mode.redraw())


@editing.command("Duplicate", "d")
def duplicate(mode: EditMode) -> None:
    """Place a copy of the selected object."""
    mode.editor.duplicate()


@editing.command("Delete", "x", "delete", "backspace", bar="Delete", spare=4)
def delete(mode: EditMode) -> None:
    """Delete the selected object."""
    mode.editor.delete()


@editing.command("Level properties…", "m", bar="Level", spare=3)
def level_properties(mode: EditMode) -> None:
    """Edit the level's size, its texts, and what programs may see."""
    from logical_robots_tui.tui.level_editor.forms import LevelForm

    mode.ui.show(LevelForm(mode.editor), lambda _: mode.redraw())


@editing.command("Findings", "j", bar="Findings", spare=2)
async def findings(mode: EditMode) -> None:
    """List likely mistakes in the level, and go to one."""
    from logical_robots_tui.tui.level_editor.forms import FindingList

    if mode.findings is None:
        mode.ui.tell("Checking the level…")
        return
    if not mode.findings:
        mode.ui.tell("Nothing looks wrong.")
        return
    finding = await mode.ui.ask(FindingList(mode.findings))
    if finding is not None and finding.x is not None and finding.y is not None:
        mode.view.go_to((finding.x, finding.y))
    mode.redraw()


@editing.command("Test the level", "t", bar="Test")
def test(mode: EditMode) -> None:
    """Play the level from its start; the same key returns to the editor."""
    mode.test()


@editing.command("Save the level", "s", bar="Save")
async def save_level(mode: EditMode) -> None:
    """Save the level in its file."""
    from logical_robots_tui.tui.level_editor.saving import save

    mode.editor.finish()
    await save(mode)


@editing.command("Save the level as…", "S")
async def save_level_as(mode: EditMode) -> None:
    """Save the level under another name, as one of your own."""
    from logical_robots_tui.tui.level_editor.saving import save_as

    mode.editor.finish()
    await save_as(mode)


@editing.command("Discard changes", "X")
async def discard_changes(mode: EditMode) -> None:
    """Go back to the level as it is in its file."""
    from logical_robots_tui.tui.level_editor.saving import ask_to_throw_away

    await ask_to_throw_away(mode)


@editing.command("Leave the level editor", "escape", bar="Leave")
def stop_editing(mode: EditMode) -> None:
    """Cancel the stroke under way, or return to playing."""
    from logical_robots_tui.tui.level_editor.saving import ask_what_to_keep

    if mode.editor.cancel():
        return
    if mode.levels.is_saved:
        mode.leave()
    else:
        mode.ui.spawn(partial(ask_what_to_keep, mode), "dialog", exclusive=True)
