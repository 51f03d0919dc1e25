"""Bringing what is edited into the game that runs, and what the game shows into the editor."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

from logical_robots_tui.editing.delta import alike

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.timer import Timer

    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.level_editor.editor import LevelEditor
    from logical_robots_tui.world import Level

__all__ = ["Live"]

_LEAST_WAIT = 0.01  # seconds in which a stroke is painted first
_AGAIN_AFTER = 0.04  # seconds between two changes of the game, at least
_SHARE = 3  # of what a change takes, before the next one


class Live:
    """Keeps the game in the level that is edited.

    While walls are painted the picture is ahead of the game, which follows as fast as it can:
    a large level takes a moment.

    Args:
        screen: Whose game.
        editor: What is edited.
        adopted: Called when the game went to a tick in which the level was another one.
    """

    def __init__(
        self, screen: MainScreen, editor: LevelEditor, adopted: Callable[[], None]
    ) -> None:
        self._screen = screen
        self._editor = editor
        self._adopted = adopted
        self._applied = editor.level
        self._next_at = 0.0
        self._timer: Timer | None = None
        self._is_over = False

    def edited(self) -> None:
        """The level has changed; the game follows at once, or soon if only walls did."""
        if self._is_over:
            return
        before, after = self._applied, self._editor.level
        only_walls = (
            before.robots is after.robots
            and before.beacons is after.beacons
            and before.areas is after.areas
            and before.walls.shape == after.walls.shape
        )
        if not only_walls:
            self.flush()
        elif self._timer is None:
            wait = max(self._next_at - perf_counter(), _LEAST_WAIT)
            self._timer = self._screen.set_timer(wait, self.flush)

    def flush(self) -> None:
        """Bring the game up to date now."""
        self._drop_timer()
        before, after = self._applied, self._editor.level
        if after is before or self._is_over:
            return
        began = perf_counter()
        self._applied = after
        self._screen.session.change_level(after, self._editor.poses.between(before, after))
        now = perf_counter()
        self._next_at = now + max(_AGAIN_AFTER, _SHARE * (now - began))

    def stop(self) -> None:
        """The game is another one: bring nothing into it."""
        self._drop_timer()
        self._is_over = True

    def shown(self, level: Level) -> Level:
        """The level to draw, given that of the game."""
        if level is not self._applied:
            self._follow(level)
        return self._editor.level

    def _drop_timer(self) -> None:
        if self._timer is not None:
            self._timer.stop()
            self._timer = None

    def _follow(self, level: Level) -> None:
        """The game went elsewhere: what it shows is what is edited now; undo leads back."""
        if not alike(level, self._applied):
            tick = self._screen.session.frame.tick
            self._editor.edits.do(f"go to tick {tick}", level)
            self._editor.selected = None
            self._applied = self._editor.level
            self._adopted()
        else:
            self._applied = level
