"""Lists to choose from, which change and are hidden while keys and clicks come in for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.widgets import OptionList

if TYPE_CHECKING:
    from textual import events

__all__ = ["Listing"]


class Listing(OptionList):
    """A list that does nothing where there is nothing; Textual's would end the game."""

    def on_click(self, event: events.Click) -> None:
        """Keep back a click that is meant for a line that has just gone."""
        line = event.style.meta.get("option")
        if line is not None and line >= self.option_count:
            event.prevent_default()

    def action_page_up(self) -> None:
        """Go up by a page, if one is seen."""
        if self.scrollable_content_region:
            super().action_page_up()  # type: ignore[no-untyped-call] # so it is in Textual

    def action_page_down(self) -> None:
        """Go down by a page, if one is seen."""
        if self.scrollable_content_region:
            super().action_page_down()  # type: ignore[no-untyped-call] # this, too
