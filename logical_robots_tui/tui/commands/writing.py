"""The commands for writing the program; the editor obeys their keys itself, and only it."""

from __future__ import annotations

from logical_robots_tui.tui.commands.command import Command

__all__ = ["WRITING", "WRITING_GROUP"]

WRITING_GROUP = "In the program"


def _command(name: str, title: str, text: str, *keys: str) -> Command:
    return Command(name, title, text, WRITING_GROUP, keys)


WRITING: tuple[Command, ...] = (
    _command(
        "complete",
        "Complete the word",
        "Offer predicates, functions and fields that fit.",
        "ctrl+space",
    ),
    _command("take_back", "Undo in the program", "Take back the last edit.", "ctrl+z"),
    _command("do_again", "Redo in the program", "Do again what was taken back.", "ctrl+y"),
    _command(
        "comment",
        "Comment lines",
        "Make the selected lines comments, or text again.",
        "ctrl+underscore",
    ),
    _command("indent", "Indent", "Indent; all selected lines at once.", "tab"),
    _command(
        "dedent",
        "Indent less",
        "Take a step of indentation back; from all selected lines at once.",
        "shift+tab",
    ),
    _command("cut", "Cut", "Cut what is selected, or the line.", "ctrl+x"),
    _command("copy", "Copy", "Copy what is selected.", "ctrl+c"),
    _command("paste", "Paste", "Put in what was cut or copied last.", "ctrl+v"),
    _command("select_line", "Select the line", "Select the line of the cursor.", "f6"),
    _command("text_start", "To the start of the program", "Go to its first line.", "ctrl+home"),
    _command("text_end", "To the end of the program", "Go to its last line.", "ctrl+end"),
    _command("delete_to_end", "Delete to the end", "Delete what follows in the line.", "ctrl+k"),
    _command(
        "delete_to_start", "Delete to the start", "Delete what precedes in the line.", "ctrl+u"
    ),
    _command("delete_word", "Delete the word", "Delete the word before the cursor.", "ctrl+w"),
)
"""What is asked for while one writes; from elsewhere the palette finds it."""
