"""What the commands for looking, for rows and for help do."""

from __future__ import annotations

from datetime import datetime
from functools import cached_property
from typing import TYPE_CHECKING

from logical_robots_tui.tui.app.quitting import leave
from logical_robots_tui.tui.commands.screen_actions import ScreenActions
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.terminal.diff_app import SparingApp
from logical_robots_tui.writing import write_atomically

if TYPE_CHECKING:
    from logical_robots_tui.tui.commands.help import Subject
    from logical_robots_tui.tui.inspector.rows import RowCommands

__all__ = ["LookingActions"]


class LookingActions(ScreenActions):
    """One method for each command of views, panes, rows and help."""

    @cached_property
    def _rows(self) -> RowCommands:
        from logical_robots_tui.tui.inspector.rows import RowCommands

        return RowCommands(self._screen, self._screen.data_dir / "rows")

    def labyrinth(self) -> None:
        """Go to the labyrinth."""
        self._screen.go_to(self._screen.labyrinth)

    def editor(self) -> None:
        """Go to the program's text."""
        self._screen.go_to(self._screen.program)

    def inspector(self) -> None:
        """Go to the inspector."""
        self._screen.go_to(self._screen.inspector)

    def why(self) -> None:
        """Say why."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.why()

    def ask(self) -> None:
        """Type a query."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.ask()

    def watch(self) -> None:
        """Show what is pinned."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.go_to_pins()

    def diagnose(self) -> None:
        """Show what stands out in the whole run."""
        self._screen.go_to(self._screen.inspector)
        self._screen.inspector.diagnose()

    def pin(self) -> None:
        """Pin what the cursor is on."""
        self._rows.pin()

    def open_value(self) -> None:
        """Open a value as a tree."""
        self._rows.open_value()

    def origin(self) -> None:
        """Say where a value in a memory comes from."""
        self._rows.origin()

    def graph(self) -> None:
        """Show which predicate uses which."""
        self._screen.spawn(self._rows.graph, "library", exclusive=True)

    def machinery(self) -> None:
        """Show how predicates are computed."""
        self._screen.spawn(self._rows.machinery, "machinery", exclusive=True)

    def only_robot(self) -> None:
        """Show the rows of one robot."""
        self._rows.only_robot()

    def sort(self) -> None:
        """Sort by the column under the cursor."""
        self._rows.sort()

    def search_rows(self) -> None:
        """Show only rows with a text."""
        self._screen.spawn(self._rows.search, "library", exclusive=True)

    def turn(self) -> None:
        """Turn the table on its side."""
        self._rows.turn()

    def copy_rows(self) -> None:
        """Copy the rows."""
        self._rows.copy()

    def save_rows(self) -> None:
        """Save the rows."""
        self._rows.save()

    def stop_here(self) -> None:
        """Stop when what is inspected changes."""
        self._rows.stop_here()

    def leave(self) -> None:
        """Go to the labyrinth and close what lies over it."""
        if self._screen.arrangement.active is self._screen.labyrinth:
            self._screen.labyrinth.select(None)
            self._screen.labyrinth.banner.display = False
            self._screen.labyrinth.briefing.display = False
        self._screen.go_to(self._screen.labyrinth)

    def next_pane(self) -> None:
        """Go to the next pane."""
        self._screen.go_to(self._screen.arrangement.beside_active(1))

    def previous_pane(self) -> None:
        """Go to the pane before."""
        self._screen.go_to(self._screen.arrangement.beside_active(-1))

    def maximise(self) -> None:
        """Give the pane that is worked in all the room, or no longer."""
        self._screen.arrangement.toggle_large()
        self._screen.arrangement.show()

    def hide(self) -> None:
        """Hide the pane that is worked in, or show all again."""
        self._screen.go_to(self._screen.arrangement.hide(self._screen.arrangement.active))

    def wider(self) -> None:
        """Give the program more columns."""
        self._resize(columns=4)

    def narrower(self) -> None:
        """Give the labyrinth more columns."""
        self._resize(columns=-4)

    def higher(self) -> None:
        """Give the inspector more rows."""
        self._resize(rows=2)

    def lower(self) -> None:
        """Give the labyrinth more rows."""
        self._resize(rows=-2)

    def _resize(self, columns: int = 0, rows: int = 0) -> None:
        self._screen.arrangement.change(columns, rows)
        self._screen.arrangement.show()

    def view(self) -> None:
        """Look at the next thing."""
        self._screen.labyrinth.view.look_at_next()

    def zoom_in(self) -> None:
        """Show less, larger."""
        self._screen.labyrinth.view.zoom(1)

    def zoom_out(self) -> None:
        """Show more."""
        self._screen.labyrinth.view.zoom(-1)

    def next_robot(self) -> None:
        """Select the next robot."""
        self._screen.labyrinth.view.select_next()

    def rays(self) -> None:
        """Show or hide what the radars reach."""
        self._screen.labyrinth.view.rays = not self._screen.labyrinth.view.rays

    def ray_lines(self) -> None:
        """Draw each ray of the selected robot, or none."""
        view = self._screen.labyrinth.view
        view.lines = not view.lines
        if view.lines and view.selected is None:
            view.select_next()

    def trails(self) -> None:
        """Show or hide where the robots came from."""
        self._screen.labyrinth.view.trails = not self._screen.labyrinth.view.trails

    def drawing(self) -> None:
        """Draw in the next way."""
        ways = list(Drawing)
        view = self._screen.labyrinth.view
        view.drawing = ways[(ways.index(view.drawing) + 1) % len(ways)]
        self._screen.tell(f"Drawn in {view.drawing.value}.")

    def briefing(self) -> None:
        """Show or hide what the level asks for."""
        if not self._screen.labyrinth.briefing.toggle():
            self._screen.tell("This level says nothing about itself.")

    @property
    def _worked_in(self) -> Subject:
        """Where the player works: in a pane, on the level, or on the timeline."""
        screen = self._screen
        if screen.focused is screen.timeline:
            return "timeline"
        labyrinth: Subject = "editing" if screen.editing.is_on else "labyrinth"
        subjects: tuple[Subject, ...] = (labyrinth, "editor", "inspector")
        return subjects[screen.arrangement.panes.index(screen.arrangement.active)]

    def help(self) -> None:
        """Show the help."""
        from logical_robots_tui.tui.commands.help import Help

        self._screen.app.push_screen(Help(self._screen.labyrinth.view.drawing, self._worked_in))

    def palette(self) -> None:
        """Find a command by its name."""
        from logical_robots_tui.tui.commands.palette import CommandProvider, Palette

        self._screen.app.push_screen(Palette([CommandProvider], placeholder="Find a command…"))

    def theme(self) -> None:
        """Choose a theme."""
        from textual.theme import ThemeProvider

        from logical_robots_tui.tui.commands.palette import Palette

        self._screen.app.push_screen(Palette([ThemeProvider], placeholder="Find a theme…"))

    def screenshot(self) -> None:
        """Save what is shown, once the palette is gone."""
        self._screen.call_after_refresh(self._save_picture)

    def _save_picture(self) -> None:
        screen = self._screen
        path = screen.data_dir / "screens" / f"{datetime.now():%Y%m%d-%H%M%S-%f}.svg"
        # Textual has no public way to see all layers of a screen.
        strips = screen.app.screen._compositor.render_strips()[: screen.app.size.height]
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(path, screen.app.export_screenshot())
            text = "".join(f"{strip.text.rstrip()}\n" for strip in strips)
            write_atomically(path.with_suffix(".txt"), text)
        except OSError as error:
            screen.warn(f"The picture could not be saved: {error.strerror}.")
        else:
            screen.tell(f"Saved {path} and .txt.")

    def redraw(self) -> None:
        """Paint the whole screen again."""
        if isinstance(self._screen.app, SparingApp):
            self._screen.app.redraw()
        self._screen.refresh(layout=True, repaint=True)

    def quit(self) -> None:
        """Leave the game."""
        leave(self._screen)
