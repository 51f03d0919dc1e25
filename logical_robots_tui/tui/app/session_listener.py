"""Events of a session, and who is notified of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Hit
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["SessionListener"]


class SessionListener:
    """Is notified of a session's events; ignores those that it does not override."""

    def level_opened(self, level: Level) -> None:
        """The player has opened a level."""

    def level_saved(self, level: Level) -> None:
        """The current level has been saved as edited."""

    def level_changed(self) -> None:
        """The frame on the screen has a different version of the level than the previous one."""

    def restarted(self) -> None:
        """The level has been restarted."""

    def program_used(self, program: Program) -> None:
        """The robots start to use a program."""

    def tick_shown(self, frame: Frame) -> None:
        """A tick has been shown on the screen."""

    def won(self, victory: Victory) -> None:
        """The robots have won while moving forward; once for each program and tick."""

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        """The robots have stopped at breakpoints."""
