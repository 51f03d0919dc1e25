"""Every command of the game, each declared once.

A declaration yields the key binding, the entry in the command bar, the entry in the palette and
the line in the help.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.binding import Binding

from logical_robots_tui.tui.command import Command, key_name

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["COMMANDS", "GROUPS", "Command", "bindings", "command", "key_name"]

_GAME, _PROGRAM, _LEARN = "Running", "Program and level", "Learning"
_VIEW, _HELP = "Looking", "Help and leaving"
GROUPS = (_GAME, _PROGRAM, _LEARN, _VIEW, _HELP)

COMMANDS: tuple[Command, ...] = (
    Command(
        "run",
        "Run or pause",
        "Let the robots go on by themselves, or stop them; also stops a thought under way.",
        _GAME,
        ("space", "f5"),
        bar="Run",
        place="anywhere",
    ),
    Command(
        "step",
        "Step",
        "Compute one tick.",
        _GAME,
        ("n", "full_stop", "f8"),
        bar="Step",
    ),
    Command("back", "Step back", "Return to the tick before.", _GAME, ("p", "comma"), bar="Back"),
    Command(
        "restart",
        "Restart",
        "Begin the level again at tick 0, with the same program.",
        _GAME,
        ("r",),
        bar="Restart",
        spare=1,
    ),
    Command(
        "slower",
        "Slower",
        "Choose the next lower speed.",
        _GAME,
        ("minus",),
        bar="-",
    ),
    Command(
        "faster",
        "Faster",
        "Choose the next higher speed; the last one is flat out.",
        _GAME,
        ("plus", "equals_sign"),
        bar="Speed",
    ),
    Command(
        "apply",
        "Apply the program",
        "Compile the text in the editor and let the robots think with it from the next tick on.",
        _PROGRAM,
        ("ctrl+r", "f4"),
        bar="Apply",
        place="anywhere",
        spare=2,
    ),
    Command(
        "mistake",
        "Go to the mistake",
        "Put the cursor where the program can't be compiled.",
        _PROGRAM,
        ("ctrl+g",),
    ),
    Command(
        "definition",
        "Go to the definition",
        "Put the cursor where the predicate under it is defined.",
        _PROGRAM,
        ("ctrl+right_square_bracket", "f12"),
    ),
    Command(
        "find",
        "Find and replace",
        "Find a text in the program, or replace it everywhere.",
        _PROGRAM,
        ("ctrl+o", "slash"),
    ),
    Command(
        "find_next",
        "Find the next one",
        "Go to the next place of what was looked for last.",
        _PROGRAM,
        ("f3",),
    ),
    Command(
        "external",
        "Edit elsewhere",
        "Edit the text in the editor that $VISUAL or $EDITOR names, and come back with it.",
        _PROGRAM,
        ("E",),
    ),
    Command(
        "rename",
        "Rename the predicate",
        "Give the predicate under the cursor another name, wherever it is used.",
        _PROGRAM,
        (),
    ),
    Command(
        "level",
        "Choose a level",
        "See all levels and what you have won, pick one, or type the path of a level file.",
        _PROGRAM,
        ("l",),
        bar="Level",
    ),
    Command(
        "next_level",
        "Next level",
        "Go on to the level after this one.",
        _PROGRAM,
        ("greater_than_sign",),
    ),
    Command(
        "program",
        "Choose a program",
        "Pick a program, or type the path of a program file.",
        _PROGRAM,
        ("o",),
        bar="Open",
    ),
    Command(
        "save",
        "Save the program as…",
        "Save the text in the editor as a program of your own.",
        _PROGRAM,
        ("s", "f2"),
        bar="Save",
        spare=3,
    ),
    Command(
        "revert",
        "Back to the program's file",
        "Put the text of the file into the editor again; undo brings yours back.",
        _PROGRAM,
        (),
    ),
    Command(
        "versions",
        "Earlier versions",
        "Look through your earlier programs for this level, and bring one back.",
        _PROGRAM,
        ("v",),
        bar="Versions",
        spare=8,
    ),
    Command(
        "reset",
        "Reset to the starter",
        "Put the level's starter program back, after asking; yours is kept as an earlier version.",
        _PROGRAM,
        ("x",),
    ),
    Command("briefing", "Briefing", "Show or hide what the level asks for.", _LEARN, ("b",)),
    Command(
        "hint",
        "Hints",
        "Reveal the hints of the level, one at a time.",
        _LEARN,
        ("h",),
        bar="Hint",
        spare=5,
    ),
    Command(
        "lesson",
        "Lesson",
        "Read what the level teaches and, when you have won, what to try next.",
        _LEARN,
        ("t",),
        bar="Lesson",
        spare=6,
    ),
    Command(
        "results",
        "Results",
        "Compare your best results with those of the reference program.",
        _LEARN,
        ("m",),
        bar="Results",
        spare=7,
    ),
    Command(
        "solution",
        "Reference program",
        "Read the program that wins the level as its lesson says; asks before you have won.",
        _LEARN,
        ("w",),
    ),
    Command(
        "stop_measuring",
        "Stop trying shifted starts",
        "End the trials that tell how robust a program is.",
        _LEARN,
        (),
    ),
    Command("labyrinth", "Labyrinth", "Go to the labyrinth.", _VIEW, ("1",)),
    Command("editor", "Editor", "Go to the program's text.", _VIEW, ("2", "e"), bar="Edit"),
    Command("inspector", "Inspector", "Go to the inspector.", _VIEW, ("3", "i")),
    Command(
        "leave",
        "Leave the editor",
        "Go from the editor to the labyrinth, where single letters are commands.",
        _VIEW,
        ("escape",),
        bar="Leave",
        place="editor",
    ),
    Command(
        "next_pane",
        "Next pane",
        "Go to the next pane; works in the editor too.",
        _VIEW,
        ("ctrl+n", "right_square_bracket"),
        bar="Next pane",
        place="editor",
    ),
    Command(
        "previous_pane", "Previous pane", "Go to the pane before.", _VIEW, ("left_square_bracket",)
    ),
    Command(
        "maximise",
        "Enlarge the pane",
        "Give the pane you work in all the room, or share it again.",
        _VIEW,
        ("k", "ctrl+t"),
    ),
    Command(
        "hide",
        "Hide the pane",
        "Hide the pane you work in; if one is hidden, show all again.",
        _VIEW,
        ("j",),
    ),
    Command(
        "wider", "Wider program", "Give the program more columns.", _VIEW, ("left_parenthesis",)
    ),
    Command(
        "narrower",
        "Wider labyrinth",
        "Give the labyrinth more columns.",
        _VIEW,
        ("right_parenthesis",),
    ),
    Command(
        "higher",
        "Higher inspector",
        "Give the inspector more rows.",
        _VIEW,
        ("left_curly_bracket",),
    ),
    Command(
        "lower",
        "Higher labyrinth",
        "Give the labyrinth more rows.",
        _VIEW,
        ("right_curly_bracket",),
    ),
    Command(
        "view",
        "View",
        "Look at the whole labyrinth, follow a robot, or see only what the robots sense.",
        _VIEW,
        ("f",),
        bar="View",
        spare=2,
    ),
    Command("zoom_in", "Zoom in", "Show less of the labyrinth, larger.", _VIEW, ("z",)),
    Command("zoom_out", "Zoom out", "Show more of the labyrinth.", _VIEW, ("Z",)),
    Command(
        "next_robot",
        "Next robot",
        "Select the next robot: its light is brought out, and a card tells of it.",
        _VIEW,
        ("g",),
    ),
    Command("rays", "Cones", "Show or hide what the robots' radars reach.", _VIEW, ("y",)),
    Command(
        "ray_lines",
        "Rays one by one",
        "Draw each ray of the selected robot, or none.",
        _VIEW,
        ("Y",),
    ),
    Command("trails", "Trails", "Show or hide where the robots came from.", _VIEW, ("u",)),
    Command(
        "drawing",
        "Way of drawing",
        "Draw the labyrinth in quadrants, in half blocks, in sextants, or in plain characters.",
        _VIEW,
        ("d",),
    ),
    Command(
        "help",
        "Help",
        "Show all keys and what the signs in the labyrinth mean.",
        _HELP,
        ("question_mark", "f1"),
        bar="Help",
    ),
    Command(
        "palette",
        "Commands",
        "Find any command by typing a part of its name.",
        _HELP,
        ("ctrl+p",),
        bar="Commands",
        place="anywhere",
        spare=4,
    ),
    Command("tour", "Guided tour", "Walk once round the parts of the screen.", _HELP, ()),
    Command("redraw", "Redraw", "Paint the whole screen again.", _HELP, ("ctrl+l",)),
    Command(
        "quit",
        "Quit",
        "Leave the game. Text that is not saved is kept and offered the next time.",
        _HELP,
        ("q",),
        bar="Quit",
    ),
)

_BY_ID = {entry.id: entry for entry in COMMANDS}


def command(command_id: str) -> Command:
    """The command of that name."""
    return _BY_ID[command_id]


def bindings() -> Iterator[Binding]:
    """The key bindings of all commands."""
    for entry in COMMANDS:
        if entry.keys:
            yield Binding(
                ",".join(entry.keys),
                f"command('{entry.id}')",
                entry.title,
                tooltip=entry.help,
                show=False,
                id=entry.id,
            )
