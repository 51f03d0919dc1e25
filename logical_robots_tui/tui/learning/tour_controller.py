"""Leads the tour round the main screen and brings the player back."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.learning.tour import Tour

__all__ = ["TourGuide"]


class TourGuide:
    """Shows what the tour speaks of.

    Args:
        screen: Where it takes place.
    """

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen
        self._tour: Tour | None = None

    def begin(self) -> None:
        """Begin the tour, again if it is under way."""
        from logical_robots_tui.tui.learning.tour import Tour

        self._remove()
        if not self._screen.arrangement.is_tiny:
            self._tour = Tour(moved=self._show, ended=self._come_home)
            self._screen.mount(self._tour)

    def place(self) -> None:
        """Put the box where it belongs, such as after the screen has another size."""
        if self._tour is None:
            return
        if self._screen.arrangement.is_tiny:
            self._come_home()
            return
        part = self._screen.query_one(f"#{self._tour.stop.place}")
        self._tour.place(part.region, self._screen.region)

    def end(self) -> None:
        """The player went on without it: leave everything as it is."""
        if self._tour is not None:
            self._remove()
            self._screen.journal.tour_seen()

    def _come_home(self) -> None:
        self.end()
        self._screen.go_to(self._screen.labyrinth)

    def _show(self) -> None:
        if self._tour is None:
            return  # it was ended before it stood
        self._screen.point_at(self._screen.labyrinth)
        for pane in self._screen.arrangement.panes:
            is_it = pane.command_id == self._tour.stop.place
            pane.set_class(is_it, "-pointed")
            if is_it:
                self._screen.point_at(pane)
        self._screen.call_after_refresh(self.place)

    def _remove(self) -> None:
        tour, self._tour = self._tour, None
        for pane in self._screen.arrangement.panes:
            pane.remove_class("-pointed")
        if tour is not None:
            tour.remove()
