"""Runs the tour on the main screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.tui.layout.arrangement import Arrangement
    from logical_robots_tui.tui.layout.pane import Pane
    from logical_robots_tui.tui.learning.tour import Tour

__all__ = ["TourController"]


class TourController:
    """Shows the parts of the screen during the tour.

    Args:
        mount: Shows the tour.
        arrangement: The panes.
        point_at: Brings a pane into view.
        ended: Called at the end.
    """

    def __init__(
        self,
        mount: Callable[[Tour], object],
        arrangement: Arrangement,
        point_at: Callable[[Pane], None],
        ended: Callable[[], None],
    ) -> None:
        self._mount, self._arrangement = mount, arrangement
        self._point_at, self._ended = point_at, ended
        self._tour: Tour | None = None

    def begin(self) -> None:
        """Start the tour, or restart it."""
        from logical_robots_tui.tui.learning.tour import Tour

        self._remove()
        if not self._arrangement.is_tiny:
            self._tour = Tour(moved=self._show, ended=self._come_home)
            self._mount(self._tour)

    def place(self) -> None:
        """Place the box, such as after a resize."""
        if self._tour is None:
            return
        if self._arrangement.is_tiny:
            self._come_home()
        else:
            self._tour.place()

    def end(self) -> None:
        """End the tour without moving the focus, because the player went on."""
        if self._tour is not None:
            self._remove()
            self._ended()

    def _come_home(self) -> None:
        self.end()
        home = self._arrangement.panes[0]
        self._point_at(home)
        home.enter()

    def _show(self) -> None:
        if self._tour is None:
            return  # it ended before it was mounted
        self._point_at(self._arrangement.panes[0])
        for pane in self._arrangement.panes:
            is_it = pane.command_id == self._tour.stop.place
            pane.set_class(is_it, "-pointed")
            if is_it:
                self._point_at(pane)
        self._tour.call_after_refresh(self.place)

    def _remove(self) -> None:
        tour, self._tour = self._tour, None
        for pane in self._arrangement.panes:
            pane.remove_class("-pointed")
        if tour is not None:
            tour.remove()
