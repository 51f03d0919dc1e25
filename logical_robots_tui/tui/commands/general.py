"""What commands of the main screen do, where that takes more than one call."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING

from logical_robots_tui.tui.terminal.textual_internals import rendered_lines

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.commands.help import Subject
    from logical_robots_tui.tui.inspector.table import ValueTable
    from logical_robots_tui.tui.program.editor import Editor
    from logical_robots_tui.tui.program.pane import ProgramPane


def program(screen: MainScreen) -> ProgramPane:
    screen.go_to(screen.program)
    return screen.program


def editor(screen: MainScreen) -> Editor:
    return program(screen).editor


def run(screen: MainScreen) -> None:
    was_busy = screen.session.busy
    screen.briefing.close()
    screen.session.toggle_run()
    is_hidden = screen.arrangement.covers(screen.labyrinth)
    if screen.session.busy and is_hidden and screen.program.has_focus_within:
        screen.go_to(screen.labyrinth)
    screen.arrangement.note("" if was_busy else _note_on_program(screen))


def step(screen: MainScreen, ticks: int = 1) -> None:
    screen.briefing.close()
    screen.arrangement.note(_note_on_program(screen))
    screen.session.step(ticks)


def _note_on_program(screen: MainScreen) -> str:
    session, controller = screen.session, screen.program_controller
    is_broken = session.game is None and session.state.phase == "mistake"
    return controller.complaint() if is_broken else controller.note_on_text()


async def run_until(screen: MainScreen) -> None:
    screen.briefing.close()
    screen.arrangement.note(_note_on_program(screen))
    await screen.timeline_controller.ask_how_far()


def definition(screen: MainScreen) -> None:
    from logical_robots_tui.wording import one_line

    word = program(screen).go_to_definition()
    if word:
        screen.tell(f"{one_line(word)} is not defined in this program.")


def toggle(part: object, name: str) -> None:
    setattr(part, name, not getattr(part, name))


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
    if measures is None:
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
    if not screen.is_typing:
        screen.session.keep_program()
    if screen.arrangement.active is screen.labyrinth:
        screen.labyrinth.select(None)
        screen.briefing.close()
    screen.go_to(screen.labyrinth)


def single_rays(screen: MainScreen) -> None:
    view = screen.labyrinth.view
    view.lines = not view.lines
    if view.lines and view.selected is None:
        view.select_next()


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
    from logical_robots_tui.paths import name_and_folder, write_atomically

    path = screen.data_dir / "screens" / f"{datetime.now():%Y%m%d-%H%M%S-%f}.svg"
    strips = rendered_lines(screen.app.screen)[: screen.app.size.height]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Without it some drawers, librsvg among them, drop the spaces at the ends of a piece.
        svg = screen.app.export_screenshot(title=screen.app.TITLE).replace(
            "<svg ", '<svg xml:space="preserve" ', 1
        )
        write_atomically(path, svg)
        text = "".join(f"{strip.text.rstrip()}\n" for strip in strips)
        write_atomically(path.with_suffix(".txt"), text)
    except OSError as error:
        screen.warn(f"The picture could not be saved: {error.strerror}.")
    else:
        screen.tell(f"Saved {name_and_folder(path)}, and .txt.")
        screen.ui.deliver(path)


def download_level(screen: MainScreen) -> None:
    from logical_robots_tui.editing.level_text import write_native

    level = screen.editing.levels.edited
    screen.ui.deliver(write_native(level), f"{level.name}.toml")


def redraw(screen: MainScreen) -> None:
    from logical_robots_tui.tui.terminal.diff_app import DiffApp

    if isinstance(screen.app, DiffApp):
        screen.app.redraw()
    screen.refresh(layout=True, repaint=True)


async def graph(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.predicate_graph import Graph
    from logical_robots_tui.tui.inspector.questions import NO_PROGRAM

    program = screen.session.program
    if program is None:
        screen.tell(NO_PROGRAM)
        return
    inspected = program.predicate(screen.inspector.inspected)
    name = await screen.ui.ask(Graph(program, inspected.name if inspected else "Robot"))
    predicate = program.predicate(name) if name is not None else None
    if predicate is not None and predicate.kind == "prelude":
        screen.tell(f"{predicate.reason} It is in the prelude.")
    elif predicate is not None:
        screen.go_to(screen.inspector)
        screen.inspector.open(predicate.name)


async def sql(screen: MainScreen) -> None:
    from logical_robots_tui.game import Superseded
    from logical_robots_tui.tui.inspector.predicate_graph import query_plan_text
    from logical_robots_tui.tui.inspector.questions import NO_PROGRAM
    from logical_robots_tui.tui.learning.reader import TextReader

    inspector, frame = screen.inspector, screen.session.frame
    try:
        inquiry, program = inspector.questions.context()
        plans = await inquiry.query_plans(program, frame)
    except Superseded:
        plans = []
    if plans:
        text = query_plan_text(plans, inspector.inspected)
        thought = f" · {frame.think_milliseconds:.1f} ms of thought" * bool(frame.tick)
        title = f"How it is computed · tick {frame.tick}{thought}"
        screen.app.push_screen(TextReader(title, text))
    else:
        screen.tell(NO_PROGRAM)


def of_table(act: Callable[[MainScreen, ValueTable], None]) -> Callable[[MainScreen], None]:
    """Return a command that acts on the table of the active page, or says that it has none."""

    def command(screen: MainScreen) -> None:
        if (table := _table(screen)) is not None:
            act(screen, table)

    return command


async def search_rows(screen: MainScreen) -> None:
    from logical_robots_tui.tui.layout.dialogs import LinePrompt

    if (table := _table(screen)) is not None:
        question = "Only rows with this text (empty: all rows)"
        text = await screen.ui.ask(LinePrompt(question, table.row_order.search))
        if text is not None:
            table.rearrange(replace(table.row_order, search=text))


@of_table
def copy_rows(screen: MainScreen, table: ValueTable) -> None:
    from logical_robots_tui.tui.inspector.table import as_csv
    from logical_robots_tui.wording import count_of

    text, count = as_csv(table.shown), len(table.shown.rows)
    screen.app.copy_to_clipboard(text)
    screen.tell(f"{count_of(count, 'row')} copied{_but(table)}.")
    screen.program_controller.keep_copy(text)


@of_table
def save_rows(screen: MainScreen, table: ValueTable) -> None:
    from logical_robots_tui.paths import name_and_folder, write_atomically
    from logical_robots_tui.tui.inspector.table import as_csv, as_json

    folder = screen.data_dir / "rows"
    name = re.sub(r"\W+", "-", screen.inspector.inspected).strip("-")
    path = folder / f"{name}-tick-{screen.session.frame.tick}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_atomically(path.with_suffix(".csv"), as_csv(table.shown))
        write_atomically(path.with_suffix(".json"), as_json(table.shown))
    except OSError as error:
        screen.warn(f"The rows can't be saved in {folder}: {error.strerror}.")
    else:
        csv_file = name_and_folder(path.with_suffix(".csv"))
        screen.tell(f"Saved {csv_file}, and .json{_but(table)}.")
        screen.ui.deliver(path.with_suffix(".csv"))


def break_here(screen: MainScreen) -> None:
    trigger = screen.search.breakpoint_here() or screen.inspector.active.breakpoint_here()
    if trigger is None:
        screen.tell("Choose a predicate with rows, or type a query first.")
    else:
        screen.timeline_controller.add_breakpoint(trigger)


def _table(screen: MainScreen) -> ValueTable | None:
    table = screen.inspector.active.table_here
    if table is None:
        screen.tell("There is no table: choose a predicate in the inspector.")
    return table


def _but(table: ValueTable) -> str:
    return f"; {table.missing}" if table.missing else ""
