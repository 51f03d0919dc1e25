"""What commands of the main screen do, where that takes more than one call."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from logical_robots_tui.tui.terminal.textual_internals import rendered_lines

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.commands.help import Subject
    from logical_robots_tui.tui.program.editor import Editor
    from logical_robots_tui.tui.program.pane import ProgramPane


def program(screen: MainScreen) -> ProgramPane:
    screen.go_to(screen.program)
    return screen.program


def editor(screen: MainScreen) -> Editor:
    return program(screen).editor


def run(screen: MainScreen) -> None:
    screen.briefing.close()
    state = screen.session.state
    if screen.session.game is None and state.phase == "mistake":
        screen.warn(f"The program has an error in line {state.mistakes[0].line}.")
    screen.session.toggle_run()


def step(screen: MainScreen, ticks: int = 1) -> None:
    screen.briefing.close()
    screen.session.step(ticks)


async def run_until(screen: MainScreen) -> None:
    screen.briefing.close()
    await screen.timeline_controller.ask_how_far()


def definition(screen: MainScreen) -> None:
    from logical_robots_tui.wording import one_line

    word = program(screen).go_to_definition()
    if word:
        screen.tell(f"{one_line(word)} is not defined in this program.")


def wrap(screen: MainScreen) -> None:
    screen.program.editor.soft_wrap = not screen.program.editor.soft_wrap


def complete(screen: MainScreen) -> None:
    # Where the cursor is on the screen is known once the pane is there.
    screen.call_after_refresh(editor(screen).action_complete)


def copy(screen: MainScreen) -> None:
    if editor(screen).selected_text:
        screen.program.editor.action_copy()
    else:
        screen.tell("Select something to copy first.")


def briefing(screen: MainScreen) -> None:
    if not screen.briefing.toggle():
        screen.tell("This level has no briefing.")


def copy_result(screen: MainScreen) -> None:
    from logical_robots_tui.game.victory import result_line

    measures = screen.recorder.latest
    if measures is None or screen.recorder.is_reference:
        screen.tell("There is no result to copy: win this level first.")
        return
    line = result_line(screen.session.opened, measures)
    screen.app.copy_to_clipboard(line)
    screen.program_controller.keep_copy(line)
    screen.tell(line)


def stop_measuring(screen: MainScreen) -> None:
    if not screen.recorder.stop_measuring():
        screen.tell("No robustness test is running.")


def next_team(screen: MainScreen) -> None:
    robot = screen.team_choice.next_robot()
    if robot is None:
        screen.tell("This level has no teams.")
    else:
        screen.select(robot)


def leave(screen: MainScreen) -> None:
    if screen.arrangement.active is screen.labyrinth:
        screen.labyrinth.select(None)
        screen.briefing.close()
    screen.go_to(screen.labyrinth)


def cones(screen: MainScreen) -> None:
    screen.labyrinth.view.rays = not screen.labyrinth.view.rays


def single_rays(screen: MainScreen) -> None:
    view = screen.labyrinth.view
    view.lines = not view.lines
    if view.lines and view.selected is None:
        view.select_next()


def trails(screen: MainScreen) -> None:
    screen.labyrinth.view.trails = not screen.labyrinth.view.trails


def drawing(screen: MainScreen) -> None:
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing

    drawings = list(Drawing)
    view = screen.labyrinth.view
    view.drawing = drawings[(drawings.index(view.drawing) + 1) % len(drawings)]
    screen.tell(f"Drawn in {view.drawing.value}.")


def help_(screen: MainScreen) -> None:
    from logical_robots_tui.tui.commands.help import Help

    map_subject: Subject = "editing" if screen.editing.is_on else "map"
    subjects: tuple[Subject, ...] = (map_subject, "editor", "inspector")
    subject = subjects[screen.arrangement.panes.index(screen.arrangement.active)]
    if screen.focused is screen.timeline:
        subject = "timeline"
    screen.app.push_screen(Help(screen.labyrinth.view.drawing, subject))


def palette(screen: MainScreen) -> None:
    from logical_robots_tui.tui.commands.help import CommandProvider, EditingProvider, PaletteScreen

    provider = EditingProvider if screen.editing.is_on else CommandProvider
    screen.app.push_screen(PaletteScreen([provider], placeholder="Find a command…"))


def save_picture(screen: MainScreen) -> None:
    """Save the screen as it is after the next refresh, when the palette is gone."""
    screen.call_after_refresh(_save_picture, screen)


def _save_picture(screen: MainScreen) -> None:
    from logical_robots_tui.paths import write_atomically

    path = screen.data_dir / "screens" / f"{datetime.now():%Y%m%d-%H%M%S-%f}.svg"
    strips = rendered_lines(screen.app.screen)[: screen.app.size.height]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Without it some drawers, librsvg among them, drop the spaces at the ends of a piece.
        svg = screen.app.export_screenshot().replace("<svg ", '<svg xml:space="preserve" ', 1)
        write_atomically(path, svg)
        text = "".join(f"{strip.text.rstrip()}\n" for strip in strips)
        write_atomically(path.with_suffix(".txt"), text)
    except OSError as error:
        screen.warn(f"The picture could not be saved: {error.strerror}.")
    else:
        screen.tell(f"Saved {path} and .txt.")


def redraw(screen: MainScreen) -> None:
    from logical_robots_tui.tui.terminal.diff_app import DiffApp

    if isinstance(screen.app, DiffApp):
        screen.app.redraw()
    screen.refresh(layout=True, repaint=True)
