"""What a player sees and hears of a victory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.editing.delta import alike
from logical_robots_tui.tui.layout.layout import Layout
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.world import Level

__all__ = ["Celebration", "is_by_the_book"]


class Celebration:
    """Tells of a victory, once.

    Args:
        screen: Where to tell it.
    """

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen
        self._is_over = False

    def follow(self) -> None:
        """Celebrate if the robots have just won, and keep the banner true."""
        screen = self._screen
        won_at = screen.session.won_at
        if won_at is not None and not self._is_over and not screen.editing.is_on:
            self._is_over = True
            self._celebrate(won_at)
        screen.labyrinth.banner.follow(screen.journal)

    def _celebrate(self, won_at: int) -> None:
        screen = self._screen
        alone = len(screen.session.level.robots) == 1
        who = "You are there" if alone else "Everybody is there"
        screen.labyrinth.briefing.display = False
        history = screen.session.history
        if history is not None and not history.is_reliable_up_to(won_at):
            screen.tell("A thought was ended by the clock on the way: this victory is not kept.")
        elif is_by_the_book(screen.session):
            screen.journal.won(screen.session)
        else:
            screen.tell("The level was changed by hand: this victory is not kept.")
        screen.labyrinth.banner.celebrate(won_at, who, screen.journal)
        arrangement = screen.arrangement
        if arrangement.layout is Layout.NARROW and arrangement.active is not screen.labyrinth:
            screen.tell(f"★ {who}: {won_at} ticks ★")

    def measured(self, level: Level, found: Measures) -> None:
        """Say what a winner measures, unless the banner does."""
        screen = self._screen
        if level is not screen.session.level or not screen.labyrinth.banner.display:
            title = one_line(level.title)
            screen.tell(f"{title}: won from {found.wins} of {found.starts} shifted starts.")

    def forget(self) -> None:
        """Take the banner away; the next victory is celebrated again."""
        self._is_over = False
        self._screen.labyrinth.banner.display = False


def is_by_the_book(session: Session) -> bool:
    """Whether all up to the present frame happened in the level as it is in its file."""
    history = session.history
    if history is None:
        return session.level is session.opened
    tick = session.frame.tick
    return not history.is_changed_up_to(tick) and alike(history.level_at(0), session.opened)
