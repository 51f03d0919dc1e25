"""The commands of the game in lines of text, and playing in them."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from typing import TYPE_CHECKING

from logical_robots_tui.cli.line_game import MOST, Command, LineGame

if TYPE_CHECKING:
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session_state import Opening

# fmt: off
COMMANDS = (
    Command("run", "[N]", LineGame.run,
        f"run until victory or a stop, for at most N ticks ({MOST:,} by default)"),
    Command("step", "[N]", LineGame.step, "one tick forward, or N ticks"),
    Command("back", "[N]", LineGame.back, "one tick back, or N ticks"),
    Command("goto", "N", LineGame.go_to, "go to a tick of the past"),
    Command("other", "", LineGame.change_course,
        "switch to the future that was left when the program changed"),
    Command("restart", "", LineGame.restart, "start again at tick 0"),
    Command("where", "", LineGame.where, "positions of the robots, and who is in a goal"),
    Command("look", "[ROBOT]", LineGame.look,
        "walls, beacons, robots and areas by direction and distance from a robot"),
    Command("robot", "NAME", LineGame.choose_robot,
        "choose the robot that look, why and origin are about"),
    Command("stop", "QUESTION", LineGame.stop_at,
        "stop runs when a predicate has rows, or a question in Logica holds; repeat to remove it"),
    Command("why", "[tree] [P]", LineGame.why,
        "explain what the robot did in this tick, or a predicate; tree gives the whole proof"),
    Command("ask", "QUESTION", LineGame.ask, "answer a question in Logica about this tick"),
    Command("origin", "[PART]", LineGame.origin,
        "trace back the robot's memory, or a part such as desire.left_engine"),
    Command("diagnose", "", LineGame.diagnose, "scan the ticks so far for likely mistakes"),
    Command("program", "", LineGame.show_program, "the program, with the numbers of its lines"),
    Command("line", "N [TEXT]", LineGame.replace_line,
        "replace line N of the program, or delete it"),
    Command("insert", "N TEXT", LineGame.insert_line, "insert a line before line N"),
    Command("save", "[NAME]", LineGame.save,
        "save the program as a file of your own, which you can edit"),
    Command("apply", "", LineGame.apply,
        "continue with the program as you changed it, here or in its file"),
    Command("open", "PROGRAM", LineGame.open_program, "continue with another program"),
    Command("versions", "[N]", LineGame.versions,
        "list your earlier programs for this level, or go back to one"),
    Command("reset", "", LineGame.reset,
        "put the starter program back; yours becomes an earlier version"),
    Command("briefing", "", LineGame.brief, "the task, and second goals"),
    Command("hint", "", LineGame.hint, "reveal the next hint"),
    Command("lesson", "", LineGame.lesson,
        "what the level teaches and, when you have won, what to try next"),
    Command("solution", "", LineGame.solution, "the reference programs"),
    Command("results", "", LineGame.results, "your best results beside the reference programs"),
    Command("next", "", LineGame.next_level, "open the next level"),
    Command("level", "[NAME]", LineGame.open_level, "open a level, or list the levels"),
    Command("daily", "", LineGame.open_daily, "open the labyrinth of today"),
    Command("help", "", LineGame.help, "this list"),
    Command("quit", "", LineGame.quit, "leave; so does the end of the input"),
)
# fmt: on


def play(opening: Opening, recorder: ProgressRecorder) -> int:
    """Play in lines of text until the player leaves; return the exit status.

    Raises ProgramFileError if a program can't be compiled.
    """
    return asyncio.run(LineGame(opening, recorder, COMMANDS).play())


def table() -> Iterator[str]:
    """Yield the commands as a table in Markdown."""
    yield from ("", "| type | what it does |", "|---|---|")
    for each in COMMANDS:
        yield f"| `{each.typed}` | {each.help} |"
    yield ""
