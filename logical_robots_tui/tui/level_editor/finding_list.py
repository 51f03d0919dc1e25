"""What looks wrong with a level, to choose from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.editing.checks import Finding
from logical_robots_tui.tui.layout.dialog import Dialog
from logical_robots_tui.tui.layout.listing import Listing
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.app import ComposeResult

__all__ = ["FindingList"]


class FindingList(Dialog[Finding]):
    """Lists findings; gives the one to go to.

    Args:
        findings: What looks wrong, at least one.
    """

    DEFAULT_CSS = """
    FindingList > #box { max-width: 90; padding: 1 2 0 2; }
    FindingList OptionList { height: auto; max-height: 16; }
    """

    def __init__(self, findings: Sequence[Finding]) -> None:
        super().__init__()
        self._findings = findings

    def compose(self) -> ComposeResult:
        """One line for each."""
        with Vertical(id="box") as box:
            box.border_title = "Findings"
            yield Listing(
                *(Option(_told(finding)) for finding in self._findings), markup=False, compact=True
            )
            yield Static("enter go there   ↑↓ choose   esc close", id="keys", markup=False)

    @on(OptionList.OptionSelected)
    def _chosen(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(self._findings[event.option_index])


def _told(finding: Finding) -> Content:
    style = INK.bad if finding.forbids else INK.warn
    place = ""
    if finding.x is not None and finding.y is not None:
        place = f"   {finding.x:.0f}, {finding.y:.0f}"
    return Content.assemble(("! ", style), (one_line(finding.text), INK.text), (place, INK.dim))
