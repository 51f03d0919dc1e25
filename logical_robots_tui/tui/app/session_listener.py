"""What is said of a session: each thing once, to whoever keeps something of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Hit
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["SessionListener"]


class SessionListener:
    """Hears what happens in a session; what it does not override means nothing to it."""

    def level_opened(self, level: Level) -> None:
        """The player has gone to a level."""

    def level_saved(self, level: Level) -> None:
        """The level at hand is in its file now as it is edited."""

    def level_changed(self) -> None:
        """The frame on the screen is in another version of the level than the one before."""

    def restarted(self) -> None:
        """The level begins again."""

    def program_used(self, program: Program) -> None:
        """The robots begin to think with a program."""

    def tick_shown(self, frame: Frame) -> None:
        """Another tick is on the screen."""

    def won(self, victory: Victory) -> None:
        """The robots have won by going on; once for each program and tick."""

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        """The robots have stopped at breakpoints."""
