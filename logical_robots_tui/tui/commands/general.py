"""The commands for panes and what they show, for help, and for leaving."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.command import Group
from logical_robots_tui.tui.terminal.textual_internals import rendered_lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.commands.help import Subject

looking = Group("View")


@looking.command("Labyrinth", "1")
def labyrinth(screen: MainScreen) -> None:
    """Go to the labyrinth."""
    screen.go_to(screen.labyrinth)


@looking.command("Editor", "2", "e", bar="Edit", spare=2)
def editor(screen: MainScreen) -> None:
    """Go to the text of the program."""
    screen.go_to(screen.program)


@looking.command("Inspector", "3", "i")
def inspector(screen: MainScreen) -> None:
    """Go to the inspector."""
    screen.go_to(screen.inspector)


@looking.command("Program of the next team")
def next_team(screen: MainScreen) -> None:
    """Show the program of another team, and the mind of its first robot."""
    robot = screen.team_choice.next_robot()
    if robot is None:
        screen.tell("This level has no teams.")
    else:
        screen.select(robot)


@looking.command("Hide the other teams")
def hide_teams(screen: MainScreen) -> None:
    """Hide what the other teams think, or show it again."""
    screen.team_choice.toggle_others()


@looking.command("Why", "w", bar="Why")
def why(screen: MainScreen) -> None:
    """Prove what the robot did at this tick, or why a predicate has its rows, as a tree."""
    screen.go_to(screen.inspector)
    screen.inspector.why()


@looking.command("Ask", "slash", bar="Ask", spare=4)
def ask(screen: MainScreen) -> None:
    """Ask any question in Logica about this tick."""
    screen.go_to(screen.inspector)
    screen.inspector.ask()


@looking.command("Watch", "V")
def watch(screen: MainScreen) -> None:
    """Show what is pinned: its value at this tick and in the ticks around it."""
    screen.go_to(screen.inspector)
    screen.inspector.go_to_pins()


@looking.command("Diagnosis")
def diagnose(screen: MainScreen) -> None:
    """Scan the whole run for likely mistakes."""
    screen.go_to(screen.inspector)
    screen.inspector.diagnose()


@looking.command("Leave the editor", "escape", bar="Leave", place="editor")
def leave(screen: MainScreen) -> None:
    """Go from the editor to the labyrinth, where single letters are commands."""
    if screen.arrangement.active is screen.labyrinth:
        screen.labyrinth.select(None)
        screen.labyrinth.close_overlays()
    screen.go_to(screen.labyrinth)


@looking.command("Next pane", "ctrl+n", "right_square_bracket", bar="Next pane", place="editor")
def next_pane(screen: MainScreen) -> None:
    """Go to the next pane; works in the editor too."""
    screen.go_to(screen.arrangement.beside_active(1))


@looking.command("Previous pane", "left_square_bracket")
def previous_pane(screen: MainScreen) -> None:
    """Go to the previous pane."""
    screen.go_to(screen.arrangement.beside_active(-1))


@looking.command("View", "f", bar="View", spare=2)
def view(screen: MainScreen) -> None:
    """Show the whole labyrinth, follow a robot, or show only what the robots sense."""
    screen.labyrinth.view.look_at_next()


@looking.command("Zoom in", "z")
def zoom_in(screen: MainScreen) -> None:
    """Show less of the labyrinth, larger."""
    screen.labyrinth.view.zoom(1)


@looking.command("Zoom out", "Z")
def zoom_out(screen: MainScreen) -> None:
    """Show more of the labyrinth."""
    screen.labyrinth.view.zoom(-1)


@looking.command("Next robot", "a")
def next_robot(screen: MainScreen) -> None:
    """Select the next robot: highlight its light, and show a card about it."""
    screen.labyrinth.view.select_next()


@looking.command("Enlarge the pane", "k", "ctrl+t")
def maximise(screen: MainScreen) -> None:
    """Give the focused pane the whole screen, or share it again."""
    screen.arrangement.toggle_large()
    screen.arrangement.show()


@looking.command("Hide the pane", "j")
def hide(screen: MainScreen) -> None:
    """Hide the focused pane; if one is hidden, show all again."""
    screen.go_to(screen.arrangement.hide(screen.arrangement.active))


def _resizing(columns: int, rows: int) -> Callable[[MainScreen], None]:
    def act(screen: MainScreen) -> None:
        screen.arrangement.change(columns, rows)
        screen.arrangement.show()

    return act


for _id, _title, _key, _help, _columns, _rows in (
    ("wider_program", "Wider program", "D", "Give the program more columns.", 4, 0),
    ("wider_labyrinth", "Wider labyrinth", "L", "Give the labyrinth more columns.", -4, 0),
    ("taller_inspector", "Taller inspector", "I", "Give the inspector more rows.", 0, 2),
    ("taller_labyrinth", "Taller labyrinth", "G", "Give the labyrinth more rows.", 0, -2),
):
    looking.add(_id, _title, _help, _resizing(_columns, _rows), _key)


@looking.command("Cones", "y")
def cones(screen: MainScreen) -> None:
    """Show or hide what the robots' radars reach."""
    screen.labyrinth.view.rays = not screen.labyrinth.view.rays


@looking.command("Single rays", "Y")
def single_rays(screen: MainScreen) -> None:
    """Show or hide each ray of the selected robot."""
    view = screen.labyrinth.view
    view.lines = not view.lines
    if view.lines and view.selected is None:
        view.select_next()


@looking.command("Trails", "u")
def trails(screen: MainScreen) -> None:
    """Show or hide where the robots came from."""
    screen.labyrinth.view.trails = not screen.labyrinth.view.trails


@looking.command("Drawing style", "d")
def drawing(screen: MainScreen) -> None:
    """Draw the labyrinth in quadrants, half blocks, sextants, or plain characters."""
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing

    ways = list(Drawing)
    view = screen.labyrinth.view
    view.drawing = ways[(ways.index(view.drawing) + 1) % len(ways)]
    screen.tell(f"Drawn in {view.drawing.value}.")


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
