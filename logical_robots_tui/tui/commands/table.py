"""Every command of the game, in the order of the help. To import it loads no widgets and no game.

A row is the command's id, title, keys, what it does, and its sentence in the help. `s` is the
main screen, `e` the controller of the level editor. It takes as few lines as it needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands import general
from logical_robots_tui.tui.commands.command import CommandGroup

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.level_editor.controller import LevelController

# fmt: off

running: CommandGroup[MainScreen] = CommandGroup("Running")
running.add("run", "Run or pause", "space f5", general.run,
    "Run the robots or pause them; also stops a calculation that is still running.",
    bar="Run", place="anywhere", also="start play pause stop go")
running.add("step", "Step", "n full_stop f8", general.step, "Compute one tick.", bar="Step")
running.add("back", "Step back", "p comma", lambda s: s.session.back(),
    "Go back one tick.", bar="Back", spare=2)
running.add("restart", "Restart", "r", lambda s: s.session.restart(),
    "Start the level again at tick 0, with the same program.", bar="Restart")
running.add("slower", "Slower", "minus", lambda s: s.player.shift_speed(-1),
    "Choose the next lower speed.", bar="-", spare=3, also="speed")
running.add("faster", "Faster", "plus equals_sign", lambda s: s.player.shift_speed(1),
    "Choose the next higher speed; the highest is unlimited.", bar="Speed", spare=3, also="speed")

time: CommandGroup[MainScreen] = CommandGroup("Time")
time.add("step_ten", "Ten steps", "N", lambda s: general.step(s, 10), "Go forward ten ticks.")
time.add("back_ten", "Ten steps back", "P", lambda s: s.session.back(10), "Go back ten ticks.")
time.add("first", "First tick", "left_parenthesis", lambda s: s.timeline_controller.first(),
    "Go to the first tick, or the earliest that the history still holds.", also="start beginning")
time.add("last", "Last tick", "right_parenthesis", lambda s: s.timeline_controller.last(),
    "Go to the last tick of the history.", also="end")
time.add("go_to", "Go to tick…", "g", lambda s: s.timeline_controller.ask_for_tick(),
    "Go to any tick of the history.", worker="dialog")
time.add("run_until", "Run until tick…", "U", general.run_until,
    "Run at full speed to a tick, or to victory or a breakpoint if that comes first.",
    worker="dialog")
time.add("previous_mark", "Previous event", "left_curly_bracket",
    lambda s: s.timeline_controller.to_mark(-1),
    "Go back to the previous event, which may be a change of the selected robot's memory.")
time.add("next_mark", "Next event", "right_curly_bracket",
    lambda s: s.timeline_controller.to_mark(1), "Go forward to the next event in the history.")
time.add("search_ticks", "Search ticks…", "Q", lambda s: s.search.ask(),
    "Type a query in Logica, and go to the next tick in which it holds.", worker="seek")
time.add("next_match", "Next match", "semicolon", lambda s: s.search.go(1),
    "Go to the next tick in which your last query holds.", worker="seek")
time.add("previous_match", "Previous match", "colon", lambda s: s.search.go(-1),
    "Go to the previous tick in which your last query holds.", worker="seek")
time.add("breakpoints", "Breakpoints", "B", lambda s: s.timeline_controller.breakpoints(),
    "List, add, switch off or delete breakpoints: events and queries that end a run.",
    also="stop debug")
time.add("other_branch", "Other branch", "F", lambda s: s.timeline_controller.change_branch(),
    "Switch to the branch that was left when the program changed, and to its program.",
    also="branch")
time.add("compare", "Compare branches", "C", lambda s: s.timeline_controller.compare(),
    "Go to the first tick in which the two branches differ, and show how and why.")
time.add("save_replay", "Save a replay", "", lambda s: s.replays.save(),
    "Save all ticks of the timeline in a file, to play again, to verify or to share.",
    worker="replay", also="export record share")
time.add("open_replay", "Open a replay…", "", lambda s: s.replays.choose(),
    "Play a saved replay again, and go to any of its ticks.", worker="replay", also="load playback")
time.add("timeline", "Timeline", "T", lambda s: s.set_focus(s.timeline),
    "Focus the timeline; arrows, page up and down, home and end move along it.")

programs: CommandGroup[MainScreen] = CommandGroup("Program and level")
programs.add("apply", "Apply the program", "ctrl+r f4", lambda s: s.session.apply(s.program.text),
    "Compile the text in the editor. Running robots use it from the next tick on, others wait.",
    bar="Apply", place="anywhere", also="compile use")
programs.add("error", "Go to the error", "ctrl+g", lambda s: general.program(s).go_to_mistake(),
    "Go to the place where the program can't be compiled.")
programs.add("definition", "Go to the definition", "ctrl+right_square_bracket f12",
    general.definition, "Go to the definition of the predicate under the cursor.",
    bar="Definition", place="editor", spare=7)
programs.add("find", "Find and replace", "ctrl+f ctrl+o", lambda s: s.program_controller.find(),
    "Find text in the program, or replace it everywhere.",
    bar="Find", place="editor", spare=5, worker="dialog", also="search")
programs.add("find_next", "Find next", "f3", lambda s: s.program_controller.find_next(),
    "Go to the next match.")
programs.add("external_editor", "External editor", "E",
    lambda s: s.program_controller.edit_elsewhere(),
    "Edit the text in the editor that $VISUAL or $EDITOR names.", also="vim nano")
programs.add("wrap", "Wrap lines", "",
    lambda s: general.toggle(s.program.editor, "soft_wrap"),
    "Wrap lines of the program that are too long for the pane, or cut them.")
programs.add("rename", "Rename a name", "", lambda s: s.program_controller.rename(),
    "Rename the predicate under the cursor everywhere, or the variable in its rule.",
    worker="dialog")
programs.add("level", "Choose a level", "l", lambda s: s.library_controller.choose_level(),
    "Show all levels and what you have won, or type the path of a level file.",
    bar="Level", spare=2, worker="dialog", also="open map labyrinth")
programs.add("next_level", "Next level", "greater_than_sign", lambda s: s.library.next_level(),
    "Go to the level after this one.", worker="dialog")
programs.add("daily", "Labyrinth of the day", "", lambda s: s.library.open_daily(),
    "Open the labyrinth that everybody has today, in one of three sizes.", worker="dialog",
    also="today challenge")
programs.add("program", "Choose a program", "o", lambda s: s.library_controller.choose_program(),
    "Choose a program, or type the path of a program file.", bar="Open", spare=4, worker="dialog",
    also="open load")
programs.add("save", "Save the program", "ctrl+s", lambda s: s.library_controller.save(),
    "Save the program in its file, or under a new name if the file is not yours.",
    bar="Save", place="editor", worker="dialog")
programs.add("save_as", "Save the program as…", "s f2", lambda s: s.library_controller.save_as(),
    "Save the text in the editor as a program of yours, under any name.",
    bar="Save as", spare=9, worker="dialog", also="export")
programs.add("upload", "Upload a file…", "ctrl+u", lambda s: s.run_action("app.upload"),
    "Choose a program, a level or a replay to keep and open; the page takes dropped "
    "ones, too.", worker="dialog", needs="browser", also="open import load drop")
programs.add("download", "Download the program", "",
    lambda s: s.ui.deliver(s.program.text, f"{s.session.source.name}.l"),
    "Download the text in the editor, saved or not.", needs="browser", also="export")
programs.add("revert", "Revert to the file", "", lambda s: s.program.put(s.session.source.text),
    "Reload the program from its file; undo restores your text.")
programs.add("versions", "Earlier versions", "v", lambda s: s.learning.choose_version(),
    "List your earlier programs for this level, and restore one.",
    bar="Versions", spare=8, worker="dialog", also="history undo earlier")
programs.add("reset", "Reset to the starter", "x", lambda s: s.player.learning.reset(),
    "Restore the level's starter program; yours is kept as an earlier version.", worker="dialog",
    also="restart starter")

learning: CommandGroup[MainScreen] = CommandGroup("Learning")
learning.add("briefing", "Briefing", "b", general.briefing, "Show or hide the task of the level.",
    also="task goal")
learning.add("hint", "Hints", "h", lambda s: s.learning.hints(),
    "Reveal the hints of the level, one at a time.", bar="Hint", also="help")
learning.add("lesson", "Lesson", "t", lambda s: s.learning.lesson(),
    "Read what the level teaches and, when you have won, what to try next.", bar="Lesson", spare=6,
    also="learn")
learning.add("questions", "Questions of the lesson", "", lambda s: s.learning.questions(),
    "Answer the questions of the lesson, each with a query.", also="quiz exercise ask")
learning.add("results", "Results", "m", lambda s: s.announcer.results(),
    "Compare your best results with those of the reference programs.", bar="Results", spare=7,
    also="score best")
learning.add("board", "Board…", "", lambda s: s.board.join(),
    "Choose under which name the players of this server see your results, or leave the board.",
    worker="board", needs="board", also="name anonymous class histogram rank")
learning.add("hand_in", "Hand in to the ladder", "", lambda s: s.board.hand_in(),
    "Let the program in the editor play all others in the ladder of this arena.",
    worker="board", needs="board", also="arena tournament compete")
learning.add("ladder", "Ladder…", "", lambda s: s.board.show_ladder(),
    "Show who is how strong in this arena, and watch your matches.", worker="board",
    needs="board", also="arena tournament rank board")
learning.add("ask_help", "Ask for help", "", lambda s: s.board.ask_for_help(),
    "Tell the teacher of a class that you are stuck, and show them your program, or stop that.",
    worker="board", needs="class", also="teacher stuck question")
learning.add("copy_result", "Copy my result", "", general.copy_result,
    "Copy the result of your last victory here as a line of text to share.", also="share export")
learning.add("solution", "Reference programs", "W", lambda s: s.learning.solution(),
    "Read the program that the lesson explains, and others; asks first if you have not won.",
    worker="dialog", also="answer")
learning.add("stop_measuring", "Stop the robustness test", "", general.stop_measuring,
    "Stop trying the program from varied starts.")

making: CommandGroup[MainScreen] = CommandGroup("Making levels")
making.add("edit_level", "Edit the level", "M", lambda s: s.editing.toggle(),
    "Edit the labyrinth, even while the robots run; the same key ends it.", also="map walls")
making.add("new_level", "New level…", "H", lambda s: s.editing.make_level(),
    "Make a level: an empty room, a random labyrinth, or a copy of any level.", worker="dialog",
    also="create map")
making.add("download_level", "Download the level", "", general.download_level,
    "Download the level as it is now, saved or not.", needs="browser", also="export")

editing: CommandGroup[LevelController] = CommandGroup("In the level editor", "level")
editing.add("hand", "Hand", "h", lambda e: e.take("hand"),
    "Select and drag objects; turn and resize them by their ◆.")
editing.add("brush", "Brush", "b", lambda e: e.take("brush"), "Paint walls.")
editing.add("line", "Line", "l", lambda e: e.take("line"),
    "Draw a straight wall from one point to another.")
editing.add("rectangle", "Rectangle", "r", lambda e: e.take("rectangle"),
    "Draw a rectangle, filled or with a border.")
editing.add("fill", "Fill", "f", lambda e: e.take("fill"),
    "Fill a region with wall, or clear connected walls.")
editing.add("eraser", "Eraser", "e", lambda e: e.take("eraser"), "Erase walls.")
editing.add("robot", "Robot", "o", lambda e: e.take("robot"), "Place a robot.")
editing.add("beacon", "Beacon", "c", lambda e: e.take("beacon"), "Place a beacon.")
editing.add("area", "Area", "a", lambda e: e.take("area"), "Place an area; drag to size it.")
editing.add("use", "Use the tool", "enter", lambda e: e.use(),
    "Act as the mouse button at the cursor: begin or end a stroke, take or drop an object.",
    bar="Use")
editing.add("undo", "Undo", "u", lambda e: e.undo(), "Undo the last change.", bar="Undo")
editing.add("redo", "Redo", "U", lambda e: e.redo(), "Redo the change undone last.",
    bar="Redo", spare=5)
editing.add("narrower_brush", "Narrower brush", "left_square_bracket",
    lambda e: e.editor.widen(-1), "Make brush and border narrower.")
editing.add("wider_brush", "Wider brush", "right_square_bracket",
    lambda e: e.editor.widen(1), "Make brush and border wider.")
editing.add("ink", "Wall or floor", "k",
    lambda e: e.editor.configure(is_wall=not e.editor.settings.is_wall),
    "Draw and fill with wall or with floor.")
editing.add("outline", "Filled or border", "v",
    lambda e: e.editor.configure(is_filled=not e.editor.settings.is_filled),
    "Draw rectangles filled, or only their border.")
editing.add("grid", "Grid", "g", lambda e: e.editor.toggle_grid(), "Show or hide the grid.",
    bar="Grid", spare=6)
editing.add("grid_size", "Grid size", "G", lambda e: e.editor.choose_next_grid(),
    "Choose the next size of the grid.")
editing.add("next_object", "Next object", "tab", lambda e: e.editor.select_next(1),
    "Select the next robot, beacon or area.")
editing.add("previous_object", "Previous object", "shift+tab", lambda e: e.editor.select_next(-1),
    "Select the previous robot, beacon or area.")
editing.add("turn_left", "Turn left", "comma", lambda e: e.editor.turn(-1),
    "Turn the selected robot to its left.")
editing.add("turn_right", "Turn right", "full_stop", lambda e: e.editor.turn(1),
    "Turn the selected robot to its right.")
editing.add("properties", "Properties…", "i", lambda e: e.edit_thing(),
    "Edit name, colour, battery, switches and the like of the selected object.",
    bar="Properties", spare=1)
editing.add("duplicate", "Duplicate", "d", lambda e: e.editor.duplicate(),
    "Place a copy of the selected object.")
editing.add("delete", "Delete", "x delete backspace", lambda e: e.editor.delete(),
    "Delete the selected object.", bar="Delete", spare=4)
editing.add("level_properties", "Level properties…", "m", lambda e: e.edit_level(),
    "Edit the level's size, its texts, and what programs may see.", bar="Level", spare=3)
editing.add("findings", "Findings", "j", lambda e: e.list_findings(),
    "List likely mistakes in the level, and go to one.", bar="Findings", spare=2, worker="dialog")
editing.add("test", "Test the level", "t", lambda e: e.test(),
    "Play the level from its start; the same key returns to the editor.", bar="Test")
editing.add("save_level", "Save the level", "s", lambda e: e.save(),
    "Save the level in its file.", bar="Save", worker="dialog")
editing.add("save_level_as", "Save the level as…", "S", lambda e: e.save_as(),
    "Save the level under another name, as one of your own.", worker="dialog")
editing.add("discard_changes", "Discard changes", "X", lambda e: e.discard(),
    "Go back to the level as it is in its file.", worker="dialog")
editing.add("stop_editing", "Leave the level editor", "escape", lambda e: e.stop(),
    "Cancel the stroke under way, or return to playing.", bar="Leave")

view: CommandGroup[MainScreen] = CommandGroup("View")
view.add("map", "Map", "1", lambda s: s.go_to(s.labyrinth), "Go to the map.")
view.add("editor", "Editor", "2 e", general.program,
    "Go to the text of the program.", bar="Edit", spare=2)
view.add("inspector", "Inspector", "3 i", lambda s: s.go_to(s.inspector), "Go to the inspector.")
view.add("next_team", "Program of the next team", "", general.next_team,
    "Show the program of another team, and the mind of its first robot.")
view.add("hide_teams", "Hide the other teams", "", lambda s: s.team_choice.toggle_others(),
    "Hide or show what the other teams' robots think.")
view.add("why", "Why", "w", lambda s: s.inspector.why(),
    "Prove what the robot did at this tick, or the row under the cursor, as a tree.", bar="Why",
    also="explain proof")
view.add("ask", "Ask", "slash", lambda s: s.inspector.go_to("ask"),
    "Answer a query in Logica about this tick.", bar="Ask", spare=4, also="query question")
view.add("watch", "Watch", "V", lambda s: s.inspector.go_to("watch"),
    "Show pinned values at this tick and in the ticks around it.")
view.add("diagnose", "Diagnosis", "", lambda s: s.inspector.go_to("diagnosis"),
    "Scan the whole run for likely mistakes.", also="problems lint")
view.add("leave", "Leave the editor", "escape", general.leave,
    "Go from the editor to the map, where single letters are commands.",
    bar="Leave", place="editor")
view.add("next_pane", "Next pane", "ctrl+n f10 right_square_bracket",
    lambda s: s.go_to(s.arrangement.beside_active(1)),
    "Go to the next pane; works in the editor too.", bar="Next pane", place="editor")
view.add("previous_pane", "Previous pane", "left_square_bracket",
    lambda s: s.go_to(s.arrangement.beside_active(-1)), "Go to the previous pane.")
view.add("view", "View", "f", lambda s: s.labyrinth.view.look_at_next(),
    "Show the whole map, follow a robot, or show only what the robots sense.",
    bar="View", spare=2, also="camera follow")
view.add("zoom_in", "Zoom in", "z", lambda s: s.labyrinth.view.zoom(1),
    "Show less of the map, larger.")
view.add("zoom_out", "Zoom out", "Z", lambda s: s.labyrinth.view.zoom(-1),
    "Show more of the map.")
view.add("next_robot", "Next robot", "a", lambda s: s.labyrinth.view.select_next(),
    "Select the next robot: highlight its light, and show a card about it.")
view.add("maximise", "Enlarge the pane", "k ctrl+t", lambda s: s.arrangement.toggle_large(),
    "Give the focused pane the whole screen, or share it again.", also="zoom full")
view.add("hide", "Hide the pane", "j", lambda s: s.go_to(s.arrangement.hide(s.arrangement.active)),
    "Hide the focused pane; if one is hidden, show all again.")
view.add("wider_program", "Wider program", "D", lambda s: s.arrangement.change(4, 0),
    "Give the program more columns.")
view.add("wider_map", "Wider map", "L", lambda s: s.arrangement.change(-4, 0),
    "Give the map more columns.")
view.add("taller_inspector", "Taller inspector", "I", lambda s: s.arrangement.change(0, 2),
    "Give the inspector more rows.")
view.add("taller_map", "Taller map", "underscore",
    lambda s: s.arrangement.change(0, -2),
    "Give the map more rows.")
view.add("cones", "Cones", "y", lambda s: general.toggle(s.labyrinth.view, "rays"),
    "Show or hide what the robots' radars reach.")
view.add("single_rays", "Single rays", "Y", general.single_rays,
    "Show or hide each ray of the selected robot.")
view.add("trails", "Trails", "u", lambda s: general.toggle(s.labyrinth.view, "trails"),
    "Show or hide where the robots came from.")
view.add("ghost", "Ghost", "G", lambda s: s.ghost.toggle(),
    "Show or hide the robots of your best run of this level, faintly, to race against.",
    worker="ghost", also="best run race compare")
view.add("race_replay", "Race a replay…", "", lambda s: s.ghost.choose(),
    "Show the robots of a saved replay of this level, faintly, to race against.",
    worker="ghost", also="ghost compare")
view.add("race_player", "Race a player…", "", lambda s: s.board.choose_ghost(),
    "Show the best run of another player of this server, faintly, to race against.",
    worker="ghost", needs="board", also="ghost compare board")
view.add("drawing", "Drawing style", "d", general.drawing,
    "Draw the map in quadrants, half blocks, sextants, or plain characters.")

inspecting: CommandGroup[MainScreen] = CommandGroup("Rows and values")
inspecting.add("pin", "Pin or unpin", "at", lambda s: s.inspector.pin(),
    "Pin the value under the cursor, a predicate, a query, or a robot's memory, to watch it.")
inspecting.add("open_value", "Open the value", "X", lambda s: s.inspector.open_value(),
    "Show the value under the cursor, or the inputs of a decision, as a tree.")
inspecting.add("origin", "Origin", "less_than_sign", lambda s: s.inspector.origin(),
    "Trace the value under the cursor to the ticks, rules and readings that it comes from.")
inspecting.add("other_values", "Other values…", "exclamation_mark",
    lambda s: s.inspector.active.change_values_here(),
    "Try another value for this line of a proof, and see which rules fail then.",
    worker="dialog")
inspecting.add("graph", "Dependency graph", "R", general.graph,
    "Show which predicate uses which, and open one of them.", worker="dialog")
inspecting.add("sql", "SQL and query plan", "K", general.sql,
    "Show what each predicate costs, and SQL and query plan of the one inspected.", worker="sql",
    also="query plan")
inspecting.add("only_robot", "Rows of one robot", "O",
    general.of_table(lambda s, table: table.toggle_robot(s.inspector.robot)),
    "Show only the rows of the selected robot, or all again.")
inspecting.add("sort", "Sort rows", "A", general.of_table(lambda _, table: table.sort()),
    "Sort by the column under the cursor: ascending, then descending, then not at all.")
inspecting.add("search_rows", "Search rows…", "number_sign", general.search_rows,
    "Show only the rows that contain a string.", worker="dialog")
inspecting.add("transpose", "Transpose the table", "J",
    general.of_table(lambda _, table: table.transpose()),
    "Show each column as a line, or as a column again.")
inspecting.add("copy_rows", "Copy rows", "c", general.copy_rows,
    "Copy the rows as CSV, to the terminal's clipboard and into a file.", also="export csv")
inspecting.add("save_rows", "Save rows", "S", general.save_rows,
    "Save the rows as CSV and as JSON.", also="export csv json")
inspecting.add("break_here", "Break here", "asterisk", general.break_here,
    "Set a breakpoint: this predicate or column changes, or the query holds.")

various: CommandGroup[MainScreen] = CommandGroup("General")
various.add("help", "Help", "question_mark f1", general.help_,
    "Show all keys and what the symbols on the map mean.", bar="Help")
various.add("palette", "Commands", "ctrl+p", general.palette,
    "Find any command by typing a part of its name.", bar="Commands", place="anywhere", spare=4)
various.add("theme", "Theme…", "", lambda s: s.run_action("app.themes"),
    "Choose the colours of the screen, dark or light; the choice is kept.",
    worker="dialog",
    also="colours colors dark light")
various.add("settings", "Settings…", "", lambda s: s.run_action("app.settings"),
    "Change the settings and see at once what they do; they are kept in your file.",
    worker="dialog",
    also="config options preferences")
# Once the palette is gone.
various.add("screenshot", "Screenshot", "",
    lambda s: s.call_after_refresh(general.save_picture, s),
    "Save the screen as SVG and as text, in the data folder.", also="picture export svg")
various.add("tour", "Guided tour", "", lambda s: s.tour.begin(),
    "Explain the parts of the screen, one by one.", also="tutorial introduction")
various.add("redraw", "Redraw", "ctrl+l", general.redraw, "Paint the whole screen again.",
    also="refresh repaint")
various.add("quit", "Quit", "q", lambda s: s.quit(),
    "Leave the game. Unsaved text is kept and offered the next time.", bar="Quit", spare=1,
    also="exit close")

writing: CommandGroup[MainScreen] = CommandGroup("In the program", "text")
writing.add("complete", "Complete the word", "ctrl+space", general.complete,
    "Offer predicates, functions and fields that fit.", bar="Complete", place="editor", spare=6)
writing.add("copy", "Copy", "ctrl+c", general.copy, "Copy the selection.")
writing.add("delete_to_end", "Delete to line end", "ctrl+k",
    lambda s: general.editor(s).action_delete_to_end_of_line_or_delete_line(),
    "Delete the rest of the line.", worker="writing")
writing.add("delete_to_start", "Delete to line start", "ctrl+u",
    lambda s: general.editor(s).action_delete_to_start_of_line(),
    "Delete the line up to the cursor.")
writing.add("undo_edit", "Undo in the program", "ctrl+z", lambda s: general.editor(s).action_undo(),
    "Undo the last edit.")
writing.add("redo_edit", "Redo in the program", "ctrl+y", lambda s: general.editor(s).action_redo(),
    "Redo the edit undone last.")
writing.add("comment", "Comment lines", "ctrl+underscore",
    lambda s: general.editor(s).action_toggle_comment(), "Comment or uncomment lines.")
writing.add("indent", "Indent", "tab", lambda s: general.editor(s).action_indent(),
    "Complete the word that is begun, or indent the selected lines.")
writing.add("dedent", "Unindent", "shift+tab", lambda s: general.editor(s).action_dedent(),
    "Unindent the selected lines.")
writing.add("cut", "Cut", "ctrl+x", lambda s: general.editor(s).action_cut(),
    "Cut the selection, or the line.")
writing.add("paste", "Paste", "ctrl+v", lambda s: general.editor(s).action_paste(),
    "Paste what was cut or copied last.")
writing.add("select_all", "Select all", "ctrl+a f7", lambda s: general.editor(s).select_all(),
    "Select the whole text of the program.")
writing.add("move_up", "Move lines up", "alt+up",
    lambda s: general.editor(s).action_move_lines(-1), "Move the selected lines up.")
writing.add("move_down", "Move lines down", "alt+down",
    lambda s: general.editor(s).action_move_lines(1), "Move the selected lines down.")
writing.add("duplicate_lines", "Duplicate lines", "ctrl+d",
    lambda s: general.editor(s).action_duplicate_lines(), "Duplicate the selected lines.")
writing.add("select_line", "Select the line", "f6",
    lambda s: general.editor(s).action_select_line(), "Select the cursor's line.")
writing.add("text_start", "Start of the program", "ctrl+home",
    lambda s: general.editor(s).action_go_to("start"), "Go to the first line.")
writing.add("text_end", "End of the program", "ctrl+end",
    lambda s: general.editor(s).action_go_to("end"), "Go to the last line.")
writing.add("delete_word", "Delete the word", "ctrl+w alt+backspace",
    lambda s: general.editor(s).action_delete_word_left(), "Delete the word on the left.")

_GROUPS = (running, time, programs, learning, making, editing, view, inspecting, various, writing)

COMMANDS = tuple(entry for group in _GROUPS for entry in group.commands)
