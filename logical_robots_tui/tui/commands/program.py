"""The commands for programs and levels, for text, and for learning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.command import Group

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.program.editor import Editor

program = Group("Program and level")


@program.command("Apply the program", "ctrl+r", "f4", bar="Apply", place="anywhere")
def apply(screen: MainScreen) -> None:
    """Compile the text in the editor; the robots use it from the next tick on."""
    screen.session.apply(screen.program.text)


@program.command("Go to the mistake", "ctrl+g")
def mistake(screen: MainScreen) -> None:
    """Go to the place where the program can't be compiled."""
    screen.go_to(screen.program)
    screen.program.go_to_mistake()


@program.command("Go to the definition", "ctrl+right_square_bracket", "f12")
def definition(screen: MainScreen) -> None:
    """Go to the definition of the predicate under the cursor."""
    from logical_robots_tui.tui.theme.safe_text import one_line

    screen.go_to(screen.program)
    word = screen.program.go_to_definition()
    if word:
        screen.tell(f"{one_line(word)} is not defined in this program.")


@program.command("Find and replace", "ctrl+f", "ctrl+o")
async def find(screen: MainScreen) -> None:
    """Find a text in the program, or replace it everywhere."""
    await screen.program_controller.find()


@program.command("Find next", "f3")
def find_next(screen: MainScreen) -> None:
    """Go to the next match."""
    screen.program_controller.find_next()


@program.command("Select all", "f7")
def select_all(screen: MainScreen) -> None:
    """Select the whole text of the program."""
    _editor(screen).select_all()


@program.command("External editor", "E")
def external_editor(screen: MainScreen) -> None:
    """Edit the text in the editor that $VISUAL or $EDITOR names."""
    screen.program_controller.edit_elsewhere()


@program.command("Wrap lines")
def wrap(screen: MainScreen) -> None:
    """Wrap lines of the program that are too long for the pane, or cut them."""
    screen.program.editor.soft_wrap = not screen.program.editor.soft_wrap


@program.command("Rename the predicate")
async def rename(screen: MainScreen) -> None:
    """Rename the predicate under the cursor wherever it is used."""
    await screen.program_controller.rename()


@program.command("Choose a level", "l", bar="Level", spare=2)
async def level(screen: MainScreen) -> None:
    """Show all levels and what you have won, or type the path of a level file."""
    await screen.library.choose_level()


@program.command("Next level", "greater_than_sign")
async def next_level(screen: MainScreen) -> None:
    """Go to the level after this one."""
    await screen.library.next_level()


@program.command("Labyrinth of the day")
async def daily(screen: MainScreen) -> None:
    """Open the labyrinth that everybody has today, in one of three sizes."""
    await screen.library.open_daily()


@program.command("Choose a program", "o", bar="Open", spare=4)
async def program_(screen: MainScreen) -> None:
    """Choose a program, or type the path of a program file."""
    await screen.library.choose_program()


@program.command("Save the program", "ctrl+s", bar="Save", place="editor")
async def save(screen: MainScreen) -> None:
    """Save the text in the editor in its file, or under a name if that is not your own."""
    await screen.library.save()


@program.command("Save the program as…", "s", "f2", bar="Save as", spare=9)
async def save_as(screen: MainScreen) -> None:
    """Save the text in the editor as a program of your own, under any name."""
    await screen.library.save_as()


@program.command("Revert to the file")
def revert(screen: MainScreen) -> None:
    """Replace the text in the editor by that of its file; undo brings yours back."""
    screen.program.put(screen.session.source.text)


@program.command("Earlier versions", "v", bar="Versions", spare=8)
async def versions(screen: MainScreen) -> None:
    """List your earlier programs for this level, and restore one."""
    await screen.learning.choose_version()


@program.command("Reset to the starter", "x")
async def reset(screen: MainScreen) -> None:
    """Restore the level's starter program; yours is kept as an earlier version."""
    await screen.learning.reset()


learning = Group("Learning")


@learning.command("Briefing", "b")
def briefing(screen: MainScreen) -> None:
    """Show or hide the task of the level."""
    if not screen.labyrinth.briefing.toggle():
        screen.tell("This level has no briefing.")


@learning.command("Hints", "h", bar="Hint")
def hint(screen: MainScreen) -> None:
    """Reveal the hints of the level, one at a time."""
    screen.learning.hints()


@learning.command("Lesson", "t", bar="Lesson", spare=6)
def lesson(screen: MainScreen) -> None:
    """Read what the level teaches and, when you have won, what to try next."""
    screen.learning.lesson()


@learning.command("Results", "m", bar="Results", spare=7)
def results(screen: MainScreen) -> None:
    """Compare your best results with those of the reference programs."""
    screen.labyrinth.banner.toggle(screen.recorder)
    screen.go_to(screen.labyrinth)


@learning.command("Copy my result")
def copy_result(screen: MainScreen) -> None:
    """Copy the result of your last victory here as a line of text to share."""
    from logical_robots_tui.game.victory import result_line

    measures = screen.recorder.latest
    if measures is None or screen.recorder.is_reference:
        screen.tell("There is no result to copy: win this level first.")
        return
    line = result_line(screen.session.opened, measures)
    screen.app.copy_to_clipboard(line)
    screen.program_controller.keep_copy(line)
    screen.tell(line)


@learning.command("Reference programs", "W")
async def solution(screen: MainScreen) -> None:
    """Read the program that the lesson explains, and others; asks first if you have not won."""
    await screen.learning.solution()


@learning.command("Stop the robustness test")
def stop_measuring(screen: MainScreen) -> None:
    """Stop trying the program from shifted starts."""
    if not screen.recorder.stop_measuring():
        screen.tell("No robustness test is running.")


writing = Group("In the program", "text")


def _editor(screen: MainScreen) -> Editor:
    screen.go_to(screen.program)
    return screen.program.editor


@writing.command("Complete the word", "ctrl+space")
def complete(screen: MainScreen) -> None:
    """Offer predicates, functions and fields that fit."""
    # Where the cursor is on the screen is known once the pane is there.
    screen.call_after_refresh(_editor(screen).action_complete)


@writing.command("Copy", "ctrl+c")
def copy(screen: MainScreen) -> None:
    """Copy the selection."""
    editor = _editor(screen)
    if editor.selected_text:
        editor.action_copy()
    else:
        screen.tell("Select something to copy first.")


@writing.command("Delete to line end", "ctrl+k")
def delete_to_end(screen: MainScreen) -> None:
    """Delete what follows the cursor in its line."""
    delete = _editor(screen).action_delete_to_end_of_line_or_delete_line
    screen.spawn(delete, "writing", exclusive=False)


@writing.command("Delete to line start", "ctrl+u")
def delete_to_start(screen: MainScreen) -> None:
    """Delete what precedes the cursor in its line."""
    _editor(screen).action_delete_to_start_of_line()


def _doing(action: str) -> Callable[[MainScreen], None]:
    def act(screen: MainScreen) -> None:
        getattr(_editor(screen), f"action_{action}")()

    return act


for _id, _title, _key, _action, _help in (
    ("undo_edit", "Undo in the program", "ctrl+z", "undo", "Undo the last edit."),
    ("redo_edit", "Redo in the program", "ctrl+y", "redo", "Redo the edit undone last."),
    (
        "comment",
        "Comment lines",
        "ctrl+underscore",
        "toggle_comment",
        "Comment or uncomment lines.",
    ),
    ("indent", "Indent", "tab", "indent", "Indent the selected lines."),
    ("dedent", "Unindent", "shift+tab", "dedent", "Unindent the selected lines."),
    ("cut", "Cut", "ctrl+x", "cut", "Cut the selection, or the line."),
    ("paste", "Paste", "ctrl+v", "paste", "Paste what was cut or copied last."),
    ("select_line", "Select the line", "f6", "select_line", "Select the cursor's line."),
    ("text_start", "Start of the program", "ctrl+home", "go_to_start", "Go to the first line."),
    ("text_end", "End of the program", "ctrl+end", "go_to_end", "Go to the last line."),
    (
        "delete_word",
        "Delete the word",
        "ctrl+w",
        "delete_word_left",
        "Delete the word on the left.",
    ),
):
    writing.add(_id, _title, _help, _doing(_action), _key)
