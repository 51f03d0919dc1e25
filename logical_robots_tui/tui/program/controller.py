"""What a player asks for that changes or searches the text of the program."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from textual.app import SuspendNotSupported
from textual.widgets.text_area import Selection

from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.tui.program.completion import definitions
from logical_robots_tui.tui.program.text_operations import find_after, is_predicate_name, rename
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["Scribe", "edited"]

_LONGEST = 30


class Scribe:
    """Finds, replaces and renames.

    Args:
        screen: Where the editor is.
        copies: The file that holds what was copied last.
    """

    def __init__(self, screen: MainScreen, copies: Path) -> None:
        self._screen, self._copies = screen, copies
        self._wanted = ""
        self._is_copy_told = False

    def keep_copy(self, text: str) -> None:
        """Keep what was copied in a file, too: no terminal says whether it took it."""
        try:
            self._copies.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(self._copies, text)
        except OSError as error:
            self._screen.warn(f"What was copied can't be kept: {error.strerror}.")
            return
        if not self._is_copy_told:
            sent = "Sent to your terminal's clipboard, and into"
            head = sent if self._screen.freedoms.clipboard else "Kept in"
            self._screen.tell(f"{head} {self._copies}.")
        self._is_copy_told = True

    async def find(self) -> None:
        """Ask what to find, and go there or replace it."""
        from logical_robots_tui.tui.program.find_dialog import Find

        screen, editor = self._screen, self._screen.program.editor
        chosen = editor.selected_text
        begin = chosen if chosen and "\n" not in chosen else self._wanted
        wish = await screen.app.push_screen_wait(Find(begin))
        if wish is None:
            return
        self._wanted = wish.wanted
        if wish.instead is None:
            self.find_next()
            return
        count = screen.text.count(wish.wanted)
        if count:
            screen.replace_text(screen.text.replace(wish.wanted, wish.instead))
            screen.tell(f"Replaced in {count} place{'s' * (count != 1)}.")
        elif find_after(screen.text, wish.wanted, (0, 0)) is not None:
            screen.tell("Nothing was replaced: it is there with other capitals only.")
        else:
            screen.tell(self._nowhere())

    def find_next(self) -> None:
        """Go to the next place of what was looked for last; ask for it if nothing was."""
        screen, editor = self._screen, self._screen.program.editor
        if not self._wanted:
            screen.spawn(self.find, "dialog", exclusive=True)
            return
        selection, begin = editor.selection, min(editor.selection)
        found = find_after(editor.text, self._wanted, begin, there=True)
        if found == begin and max(selection) == self._end_of(found):
            found = find_after(editor.text, self._wanted, begin)  # that one is found already
        if found is None:
            screen.tell(self._nowhere())
            return
        screen.go_to(screen.program)
        editor.move_cursor(found, center=True)
        editor.selection = Selection(self._end_of(found), found)

    async def rename(self) -> None:
        """Ask for another name of the predicate under the cursor, and use it everywhere."""
        from logical_robots_tui.tui.layout.line_dialog import LinePrompt

        screen, old = self._screen, self._screen.program.editor.word
        if old not in definitions(screen.text):
            screen.tell("Put the cursor on a predicate of this program first.")
            return
        typed = await screen.app.push_screen_wait(LinePrompt("Rename the predicate", old))
        new = (typed or "").strip()
        if not new or new == old:
            return
        if not is_predicate_name(new):
            screen.warn("A predicate's name begins with a capital letter.")
            return
        if new in definitions(screen.text):
            screen.warn(f"{clip(new, _LONGEST)} is the name of another predicate here.")
            return
        text, count = rename(screen.text, old, new)
        screen.replace_text(text)
        screen.tell(f"Renamed in {count} place{'s' * (count != 1)}.")

    def edit_elsewhere(self) -> None:
        """Hand the terminal to the player's own editor until that ends, and take its text."""
        screen = self._screen
        if not screen.freedoms.programs:
            screen.warn("External editors are disabled here.")
            return
        screen.session.pause()
        try:
            with screen.app.suspend():
                text = edited(screen.text, os.environ)
        except SuspendNotSupported:
            screen.warn("This terminal can't be handed to another program.")
        except (OSError, ValueError, subprocess.CalledProcessError) as error:
            screen.warn(f"The editor failed: {error}. The text is as it was.")
        else:
            if text != screen.text:
                screen.replace_text(text)
                screen.session.apply(text)

    def _end_of(self, found: tuple[int, int]) -> tuple[int, int]:
        return found[0], found[1] + len(self._wanted)

    def _nowhere(self) -> str:
        return f"{clip(one_line(self._wanted), _LONGEST)} is not in this program."


def edited(text: str, environ: Mapping[str, str]) -> str:
    """Return a text as the player's own editor leaves it, even if that ends badly.

    Args:
        text: To begin with.
        environ: Names the editor, as ``VISUAL`` or ``EDITOR``; vi if neither does.

    Raises:
        OSError: The editor can't be started, or the file not be written or read.
        ValueError: Its name can't be understood.
        CalledProcessError: It ended badly, and left the text as it was.
    """
    command = shlex.split(environ.get("VISUAL") or environ.get("EDITOR") or "vi")
    with tempfile.TemporaryDirectory(prefix="logical-robots-") as folder:
        path = Path(folder) / f"program{SUFFIX}"
        path.write_text(text, "utf-8")
        ended = subprocess.run([*command, str(path)], check=False)  # noqa: S603 - named by the player
        left = path.read_text("utf-8", errors="replace")
        if left == text:
            ended.check_returncode()
        return left
