"""The panes as they stand on the screen: which are shown, and how large."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.layout import Grid, Layout, Shares, grid_for

if TYPE_CHECKING:
    from textual.containers import Container
    from textual.geometry import Size

    from logical_robots_tui.tui.pane import Pane

__all__ = ["Arrangement"]


class Arrangement:
    """Gives each pane its place.

    Args:
        container: What holds the panes.
        panes: Labyrinth, program and inspector.
    """

    def __init__(self, container: Container, panes: tuple[Pane, Pane, Pane]) -> None:
        self._container = container
        self._panes = panes
        self._hidden: set[Pane] = set()
        self._shares = Shares()
        self.is_one_large = False
        """Whether the pane that is worked in has all the room."""

    def show(self, layout: Layout, size: Size, active: Pane) -> None:
        """Arrange the panes.

        Args:
            layout: For this size.
            size: Of the terminal.
            active: The pane that is worked in; it is never hidden.
        """
        self._hidden.discard(active)
        for pane in self._panes:
            if layout.is_roomy and not self.is_one_large:
                pane.display = pane not in self._hidden
            else:
                pane.display = layout is not Layout.TINY and pane is active
        if not layout.is_roomy:
            return
        grid = grid_for(layout, *size, self._shares)
        self._shares = grid.shares
        self._lay_out(layout, grid)

    def toggle_large(self) -> bool:
        """Give the pane that is worked in all the room, or no longer; whether it has it now."""
        self.is_one_large = not self.is_one_large
        return self.is_one_large

    def hide(self, pane: Pane) -> Pane:
        """Hide a pane and return where to go on; if one is hidden already, show all instead."""
        if self._hidden:
            self._hidden.clear()
            return pane
        self._hidden.add(pane)
        # Not into the program: the next key would be a letter of it.
        labyrinth, _, inspector = self._panes
        return inspector if pane is labyrinth else labyrinth

    def change(self, columns: int, rows: int) -> None:
        """Give the program more columns, or the inspector more rows, at the next ``show``."""
        self._shares = self._shares.changed(columns, rows)

    def _lay_out(self, layout: Layout, grid: Grid) -> None:
        labyrinth, program, inspector = self._panes
        beside = layout is Layout.WIDE and labyrinth.display and program.display
        rows = []
        if beside:
            rows.append("1fr")
        else:
            rows += ["1fr" for pane in (labyrinth, program) if pane.display]
        if inspector.display:
            rows.append(str(grid.inspector) if rows else "1fr")
        styles = self._container.styles
        styles.grid_size_columns = 2 if beside else 1
        styles.grid_size_rows = len(rows)
        styles.grid_columns = f"1fr {grid.program}" if beside else "1fr"
        styles.grid_rows = " ".join(rows)
        inspector.styles.column_span = 2 if beside else 1
