"""Commands that change or search the text of the program, and its file as others change it."""

from __future__ import annotations

import asyncio
import os
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from textual.app import SuspendNotSupported
from textual.widgets.text_area import Selection

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.language.diagnostics import count_words, errors_in
from logical_robots_tui.language.services.editing import find_after
from logical_robots_tui.language.services.symbols import changed, renaming
from logical_robots_tui.language.source_text import line_of
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.paths import write_atomically
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.layout.dialogs import Find, LinePrompt
from logical_robots_tui.wording import clip, count_of, one_line

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic
    from logical_robots_tui.player.opening import Permissions
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.program.pane import ProgramPane

_LONGEST = 30
_RESTING = 0.5  # seconds without a key after which a text is checked


class ProgramController:
    def __init__(
        self,
        pane: ProgramPane,
        session: Session,
        ui: Dialogs,
        copies: Path,
        permissions: Permissions,
        enter: Callable[[], None],
    ) -> None:
        self._pane, self._session, self._ui, self._copies = pane, session, ui, copies
        self._permissions, self._enter = permissions, enter
        self._pattern = ""
        self._has_told_copy = False
        self._check: asyncio.TimerHandle | None = None
        self._noted = ("", "")
        self._seen_errors: list[Diagnostic] = []

    def edited(self) -> None:
        """Check the text soon after the last key."""
        if self._check is not None:
            self._check.cancel()

        def check() -> None:
            if self._pane.is_attached:
                self._session.check(self._pane.text)

        self._check = asyncio.get_running_loop().call_later(_RESTING, check)

    def note_on_text(self) -> str:
        """Return what to say, once for a text and once for its errors, if another one runs."""
        text, state = self._pane.text, self._session.state
        is_tried = text == state.tried
        if state.applied in (None, text) or (is_tried and state.phase == "compiling"):
            return ""
        note = with_keys("Runs the applied version; {apply} applies yours.")
        if errors := self._errors:
            advice = f"{count_words(errors)}, {_way_to(errors[0])}"
            note = f"Runs the applied version; yours has {advice}."
        previous, self._noted = self._noted, (text, note)
        return "" if previous == self._noted else note

    def complaint(self) -> str:
        state = self._session.state
        adjective = "" if state.applied is None else "new "
        error, *_ = self._errors or errors_in(state.mistakes)
        return f"The {adjective}program has an error, {_way_to(error)}: {error.message}"

    def news(self) -> str:
        """Return what to say of errors of the text that have arrived since the last call."""
        previous_errors, self._seen_errors = self._seen_errors, self._errors
        return self.complaint() if self._errors not in ([], previous_errors) else ""

    @property
    def _errors(self) -> list[Diagnostic]:
        """The errors of the text in the editor, as far as it has been compiled or checked."""
        text = self._pane.text
        tried, diagnostics = self._session.state.for_text(text).newest
        return errors_in(diagnostics) if text == tried else []

    def keep_copy(self, text: str) -> None:
        """Also write copied text to a file, because terminals don't confirm a copy."""
        if not self._write_copy(text):
            return
        if not self._has_told_copy:
            sent = "Sent to your terminal's clipboard, and into"
            head = sent if self._permissions.clipboard else "Kept in"
            self._ui.tell(f"{head} {self._copies}.")
        self._has_told_copy = True

    def _write_copy(self, text: str) -> bool:
        try:
            self._copies.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(self._copies, text)
        except OSError as error:
            self._ui.warn(f"The copied text can't be saved: {error.strerror}.")
            return False
        return True

    async def find(self) -> None:
        editor = self._pane.editor
        selected = editor.selected_text
        pattern = selected if selected and "\n" not in selected else self._pattern
        wish = await self._ui.ask(Find(pattern))
        if wish is None:
            return
        self._pattern = wish.text
        if wish.replacement is None:
            self.find_next()
            return
        count = self._pane.text.count(wish.text)
        growth = count * (len(wish.replacement) - len(wish.text))
        if len(self._pane.text) + growth > (limit := Limits().program_characters):
            self._ui.warn(f"With that the program would have more than {limit:,} characters.")
        elif count:
            self._pane.put(self._pane.text.replace(wish.text, wish.replacement))
            self._ui.tell(f"Replaced in {count_of(count, 'place')}.")
        elif find_after(self._pane.text, wish.text, (0, 0)) is not None:
            self._ui.tell("Nothing was replaced: it only occurs with different case.")
        else:
            self._ui.tell(self._nowhere())

    def find_next(self) -> None:
        editor = self._pane.editor
        if not self._pattern:
            self._ui.spawn(self.find, "dialog", exclusive=True)
            return
        is_match = editor.selected_text.lower() == self._pattern.lower()
        start = min(editor.selection)
        place = find_after(editor.text, self._pattern, start, inclusive=not is_match)
        if place is None:
            self._ui.tell(self._nowhere())
            return
        self._enter()
        editor.move_cursor(place, center=True)
        editor.selection = Selection((place[0], place[1] + len(self._pattern)), place)

    async def rename(self) -> None:
        editor, old = self._pane.editor, self._pane.text
        row, column = editor.cursor_location
        offset = line_of(old, row + 1) + column
        try:
            renaming(old, offset, name := editor.word)
            typed = await self._ui.ask(LinePrompt(f"Rename {name}", name))
            changes = renaming(old, offset, (typed or "").strip() or name)
        except InputError as error:
            self._ui.warn(error.message)
            return
        text = changed(old, changes)
        if changes and self._pane.text == old:
            self._pane.put(text)
        if changes and self._pane.text == text:
            self._ui.tell(f"Renamed in {count_of(len(changes), 'place')}.")

    def edit_elsewhere(self) -> None:
        if not self._permissions.programs:
            self._ui.warn("External editors are disabled here.")
            return
        self._session.pause()
        try:
            with self._pane.app.suspend():
                text = edit_outside(self._pane.text, os.environ)
        except SuspendNotSupported:
            self._ui.warn("This terminal can't be handed to another program.")
        except (OSError, ValueError, subprocess.CalledProcessError) as error:
            self._ui.warn(f"The editor failed: {error}. The text is unchanged.")
        else:
            if len(text) > (limit := Limits().program_characters):
                hint = f" It is kept in {self._copies}." if self._write_copy(text) else ""
                self._ui.warn(f"A program may have {limit:,} characters, not {len(text):,}.{hint}")
            elif text != self._pane.text:
                self._pane.put(text)
                self._session.apply(text)

    def _nowhere(self) -> str:
        return f"{clip(one_line(self._pattern), _LONGEST)} is not in this program."


def edit_outside(text: str, environ: Mapping[str, str]) -> str:
    """Return a text edited with ``VISUAL`` or ``EDITOR``, by default vi, even if that fails.

    Raises:
        OSError: The editor can't be started, or the file can't be written or read.
        ValueError: The editor's name can't be parsed.
        CalledProcessError: It failed, and left the text unchanged.
    """
    import shlex

    command = shlex.split(environ.get("VISUAL") or environ.get("EDITOR") or "vi")
    with tempfile.TemporaryDirectory(prefix="logical-robots-") as folder:
        path = Path(folder) / f"program{SUFFIX}"
        path.write_text(text, "utf-8")
        result = subprocess.run([*command, str(path)], check=False)  # noqa: S603 - named by the player
        edited_text = path.read_text("utf-8", errors="replace")
        if edited_text == text:
            result.check_returncode()
        return edited_text


def _way_to(error: Diagnostic) -> str:
    return with_keys(f"{{error}} goes to line {error.line}")


_PAUSE = 0.25  # seconds between two checks


class FileWatch:
    """Checks one file repeatedly, in a thread, because disks may be slow."""

    def __init__(
        self, source: Callable[[], ProgramSource], changed: Callable[[ProgramSource], None]
    ) -> None:
        self._current, self._changed = source, changed
        self._source: ProgramSource | None = None
        self._stamp: tuple[int, int] | None = None

    async def follow(self) -> None:
        while True:
            await asyncio.sleep(_PAUSE)
            source = self._current()
            if source.shipped:
                continue
            newer_source = await asyncio.to_thread(self.newer, source)
            if newer_source is not None and self._current() is source:
                self._changed(newer_source)

    def newer(self, source: ProgramSource) -> ProgramSource | None:
        """Return the program on disk if changed since the last check; the first compares texts."""
        if source is not self._source:
            self._source, self._stamp = source, None
        try:
            status = source.path.stat()
            stamp = status.st_mtime_ns, status.st_size
            if source.shipped or stamp == self._stamp:
                return None
            self._stamp = stamp
            newer_source = load_program(source.path)
        except (OSError, InputError):
            return None  # half written, or not text; a later check may succeed
        return newer_source if newer_source.text != source.text else None
