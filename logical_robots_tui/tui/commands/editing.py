"""The commands for editing levels. Most of their keys act only while a level is edited."""

from __future__ import annotations

from logical_robots_tui.tui.commands.command import Command

__all__ = ["EDITING", "GROUPS", "MAKING", "WHILE_EDITING"]

_LEVELS, WHILE_EDITING = "Making levels", "While editing a level"
GROUPS = (_LEVELS, WHILE_EDITING)

MAKING: tuple[Command, ...] = (
    Command(
        "edit_level",
        "Edit the level",
        "Change the labyrinth, also while the robots run; the same key ends it.",
        _LEVELS,
        ("M",),
    ),
    Command(
        "new_level",
        "New level…",
        "Make a level: an empty room, a labyrinth drawn by lot, or a copy of any level.",
        _LEVELS,
        ("H",),
    ),
)
"""What can be asked for at any time."""


def _command(
    name: str, title: str, text: str, *keys: str, bar: str = "", spare: int = 0
) -> Command:
    return Command(name, title, text, WHILE_EDITING, keys, bar=bar, spare=spare)


EDITING: tuple[Command, ...] = (
    _command("hand", "Hand", "Select and drag things; turn them and size them by their ◆.", "h"),
    _command("brush", "Brush", "Paint walls.", "b"),
    _command("line", "Line", "Draw a straight wall from one point to another.", "l"),
    _command("rectangle", "Rectangle", "Draw a rectangle, filled or with a border.", "r"),
    _command(
        "fill", "Fill", "Fill a region with wall, or take away walls that hang together.", "f"
    ),
    _command("eraser", "Eraser", "Wipe walls away.", "e"),
    _command("robot", "Robot", "Place a robot.", "o"),
    _command("beacon", "Beacon", "Place a beacon.", "c"),
    _command("area", "Area", "Place an area; drag to size it.", "a"),
    _command(
        "use",
        "Use the tool",
        "Do at the cursor what a mouse button does: begin or end a stroke, take or drop a thing.",
        "enter",
        bar="Use",
    ),
    _command("undo", "Undo", "Undo the last change.", "u", bar="Undo"),
    _command("redo", "Redo", "Do again what was undone.", "U", bar="Redo", spare=5),
    _command("thinner", "Narrower brush", "Make brush and border narrower.", "left_square_bracket"),
    _command("thicker", "Wider brush", "Make brush and border wider.", "right_square_bracket"),
    _command("ink", "Wall or floor", "Draw lines, rectangles and fillings in wall or floor.", "k"),
    _command("outline", "Filled or border", "Draw rectangles filled, or their border only.", "v"),
    _command("grid", "Grid", "Show the grid, or hide it.", "g", bar="Grid", spare=6),
    _command("grid_size", "Size of the grid", "Choose the next size of the squares drawn in.", "G"),
    _command("next_thing", "Next thing", "Select the next robot, beacon or area.", "tab"),
    _command("previous_thing", "Thing before", "Select the one before.", "shift+tab"),
    _command("turn_left", "Turn left", "Turn the selected robot to its left.", "comma"),
    _command("turn_right", "Turn right", "Turn the selected robot to its right.", "full_stop"),
    _command(
        "properties",
        "Properties…",
        "Change name, colour, battery, switches and the like of the selected thing.",
        "i",
        bar="Properties",
        spare=1,
    ),
    _command("duplicate", "Duplicate", "Place another one like the selected thing.", "d"),
    _command(
        "delete",
        "Delete",
        "Take the selected thing away.",
        *("x", "delete", "backspace"),
        bar="Delete",
        spare=4,
    ),
    _command(
        "level_properties",
        "Properties of the level…",
        "Change its size, its texts, and what programs may see.",
        "m",
        bar="Level",
        spare=3,
    ),
    _command(
        "findings",
        "Findings",
        "List what looks wrong with the level, and go there.",
        "j",
        bar="Findings",
        spare=2,
    ),
    _command(
        "test",
        "Play it",
        "Play the level as it is from its start; the same key comes back to editing.",
        "t",
        bar="Test",
    ),
    _command("save_level", "Save the level", "Save the level in its file.", "s", bar="Save"),
    _command("save_level_as", "Save the level as…", "Save it as a level of your own.", "S"),
    _command(
        "throw_away", "Throw the changes away", "Go back to the level as it is in its file.", "X"
    ),
    _command(
        "stop_editing",
        "Stop editing",
        "End a stroke under way, or go back to playing.",
        "escape",
        bar="Leave",
    ),
)
"""What can be asked for while a level is edited."""
