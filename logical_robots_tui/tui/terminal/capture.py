"""Pictures and recordings of the screen, in the player's data folder."""

from __future__ import annotations

from contextlib import suppress
from datetime import datetime
from time import monotonic
from typing import TYPE_CHECKING, TextIO

from logical_robots_tui.tui.terminal.cast import Cast
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rich.segment import Segment
    from textual.geometry import Size
    from textual.timer import Timer

    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["Capture"]

_LOOKS = 15  # at the screen, a second, while it is recorded


class Capture:
    """Takes pictures of all that is shown, dialogs too, and records it.

    Args:
        screen: Whose app is shown.
        folder: Where the files go.
    """

    def __init__(self, screen: MainScreen, folder: Path) -> None:
        self._screen, self._folder = screen, folder
        self._recording: _Recording | None = None

    def picture(self) -> None:
        """Save what is shown as SVG and as text."""
        try:
            path = self._new_file(".svg")
            write_atomically(path, self._screen.app.export_screenshot())
            lines = ("".join(segment.text for segment in line).rstrip() for line in self._lines())
            write_atomically(path.with_suffix(".txt"), "\n".join(lines) + "\n")
        except OSError as error:
            self._screen.warn(f"The picture could not be saved: {error.strerror}.")
        else:
            self._screen.tell(f"Saved {path} and .txt.")

    def toggle_recording(self) -> None:
        """Begin to record the screen, or end it and tell where the recording is."""
        if self._recording is not None:
            self.close()
            return
        try:
            path = self._new_file(".cast")
            self._recording = _Recording(
                path, self._screen.app.size, self._screen.session.level.title
            )
        except OSError as error:
            self._screen.warn(f"Nothing can be recorded: {error.strerror}.")
            return
        self._recording.timer = self._screen.set_interval(1 / _LOOKS, self._look)
        self._screen.tell("Recording the screen; the same command ends it.")

    def close(self) -> None:
        """End a recording."""
        recording, self._recording = self._recording, None
        if recording is not None:
            try:
                recording.close()
            except OSError as error:
                self._tell_end(error)
            else:
                self._screen.tell(f"Recorded into {recording.path}.")

    def _look(self) -> None:
        if self._recording is None:
            return
        try:
            self._recording.show(self._lines())
        except OSError as error:
            recording, self._recording = self._recording, None
            with suppress(OSError):  # what could not be written can't be now
                recording.close()
            self._tell_end(error)

    def _tell_end(self, error: OSError) -> None:
        self._screen.warn(f"The recording ended: {error.strerror}.")

    def _lines(self) -> list[list[Segment]]:
        # Textual has no public way to see all layers of a screen.
        strips = self._screen.app.screen._compositor.render_strips()
        return [list(strip) for strip in strips[: self._screen.app.size.height]]

    def _new_file(self, ending: str) -> Path:
        self._folder.mkdir(parents=True, exist_ok=True)
        return self._folder / f"{datetime.now():%Y%m%d-%H%M%S-%f}{ending}"


class _Recording:
    """A recording under way.

    Args:
        path: Its file.
        size: Of the screen, in cells.
        title: What it is called.

    Raises:
        OSError: It can't be written.
    """

    def __init__(self, path: Path, size: Size, title: str) -> None:
        self.path = path
        self.timer: Timer | None = None
        self._file: TextIO = path.open("w", encoding="utf-8")
        self._cast = Cast(self._file.write, *size, one_line(title))
        self._began = monotonic()

    def show(self, lines: Sequence[Sequence[Segment]]) -> None:
        """What is shown now."""
        self._cast.show(monotonic() - self._began, lines)
        self._file.flush()

    def close(self) -> None:
        """Let go of the file.

        Raises:
            OSError: What was left to write can't be written.
        """
        if self.timer is not None:
            self.timer.stop()
        self._file.close()
