"""The commands for help, for the look of the screen, and for leaving."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.command import Group
from logical_robots_tui.tui.terminal.textual_internals import rendered_lines

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.commands.help import Subject

__all__ = ["general"]

general = Group("General")


@general.command("Help", "question_mark", "f1", bar="Help")
def help_(screen: MainScreen) -> None:
    """Show all keys and what the signs in the labyrinth mean."""
    from logical_robots_tui.tui.commands.help import Help

    labyrinth: Subject = "editing" if screen.editing.is_on else "labyrinth"
    subjects: tuple[Subject, ...] = (labyrinth, "editor", "inspector")
    about = subjects[screen.arrangement.panes.index(screen.arrangement.active)]
    if screen.focused is screen.timeline:
        about = "timeline"
    screen.app.push_screen(Help(screen.labyrinth.view.drawing, about))


@general.command("Commands", "ctrl+p", bar="Commands", place="anywhere", spare=4)
def palette(screen: MainScreen) -> None:
    """Find any command by typing a part of its name."""
    from logical_robots_tui.tui.commands.help import CommandProvider, EditingProvider, Palette

    provider = EditingProvider if screen.editing.is_on else CommandProvider
    screen.app.push_screen(Palette([provider], placeholder="Find a command…"))


@general.command("Theme…")
def theme(screen: MainScreen) -> None:
    """Choose the colours of the screen, dark or light; the choice is kept."""
    from textual.theme import ThemeProvider

    from logical_robots_tui.tui.commands.help import Palette

    screen.app.push_screen(Palette([ThemeProvider], placeholder="Find a theme…"))


@general.command("Screenshot")
def screenshot(screen: MainScreen) -> None:
    """Save the screen as SVG and as text, in the data folder."""
    # By then the palette is gone.
    screen.call_after_refresh(_save_picture, screen)


def _save_picture(screen: MainScreen) -> None:
    from logical_robots_tui.writing import write_atomically

    path = screen.data_dir / "screens" / f"{datetime.now():%Y%m%d-%H%M%S-%f}.svg"
    strips = rendered_lines(screen.app.screen)[: screen.app.size.height]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, screen.app.export_screenshot())
        text = "".join(f"{strip.text.rstrip()}\n" for strip in strips)
        write_atomically(path.with_suffix(".txt"), text)
    except OSError as error:
        screen.warn(f"The picture could not be saved: {error.strerror}.")
    else:
        screen.tell(f"Saved {path} and .txt.")


@general.command("Guided tour")
def tour(screen: MainScreen) -> None:
    """Explain the parts of the screen, one by one."""
    screen.tour.begin()


@general.command("Redraw", "ctrl+l")
def redraw(screen: MainScreen) -> None:
    """Paint the whole screen again."""
    from logical_robots_tui.tui.terminal.diff_app import DiffApp

    if isinstance(screen.app, DiffApp):
        screen.app.redraw()
    screen.refresh(layout=True, repaint=True)


@general.command("Quit", "q", bar="Quit", spare=1)
def quit_(screen: MainScreen) -> None:
    """Leave the game. Unsaved text is kept and offered the next time."""
    screen.quit()
