"""What the commands for rows and values of the inspector do."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.game import Pin
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

_NO_PIN = (
    "Choose a predicate, ask a question, or put the cursor on a value of it in a row that another "
    "column tells from the rest; then pin it."
)
_NOT_TRACED = (
    "Put the cursor on a value of the program: in a table, in a proof, on a pin, or in the tree "
    "that {open_value} opens."
)


def pin(screen: MainScreen) -> None:
    from logical_robots_tui.game import Pin
    from logical_robots_tui.tui.inspector.under_cursor import pin_here
    from logical_robots_tui.wording import one_line

    inspector = screen.inspector
    if inspector.pages.pins.has_focus:
        inspector.pages.pins.action_remove()
        return
    query = _question_asked(screen)
    found = Pin(query) if query else None
    found = found or pin_here(inspector.inspected, inspector.shown_table, inspector.robot)
    if found is None or inspector.is_function:
        screen.tell(_NO_PIN)
    elif inspector.pages.pins.toggle(found):
        where = with_keys("{watch} shows what is pinned.")
        screen.tell(f"Pinned: {one_line(found.words)}. {where}")
    else:
        screen.tell(f"No longer pinned: {one_line(found.words)}.")


def open_value(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.under_cursor import branches_here, branches_of, traced_pin
    from logical_robots_tui.tui.inspector.widgets.value_tree import ValueTree

    inspector, frame = screen.inspector, screen.session.frame
    view = inspector.pages.why.view

    def trace(pin: Pin) -> bool:
        """Trace a value of the tree; return whether it is one of the program's."""
        asked = traced_pin(pin, inspector.robot, screen.session.frame.tick)
        if asked is not None:
            screen.point_at(inspector)
            inspector.trace(asked)
        return asked is not None

    if view.has_focus and view.pointed is not None and view.pointed.values:
        title, branches = branches_of(view.pointed)
    else:
        title, branches = branches_here(
            inspector.inspected, inspector.shown_table, inspector.robot, frame
        )
    if inspector.is_function:  # a call can't be found again in another tick
        branches = [replace(branch, pin=None) for branch in branches]
    if branches:
        title = f"{title} · tick {frame.tick}"
        screen.app.push_screen(ValueTree(title, branches, inspector.pages.pins.toggle, trace))
    else:
        screen.tell("Put the cursor on a value, or choose Decision.")


def origin(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.page import NO_PROGRAM

    inspector = screen.inspector
    if screen.session.game is None:
        screen.tell(NO_PROGRAM)
        return
    asked = inspector.traced_here(screen.session.frame.tick)
    if asked is None and inspector.pages.origin.asked is None:
        screen.tell(with_keys(_NOT_TRACED))
        return
    screen.point_at(inspector)
    inspector.trace(asked)


async def other_values(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.predicate_list import WHY
    from logical_robots_tui.tui.inspector.question_prompt import ValuesPrompt

    inspector = screen.inspector
    page, program = inspector.pages.why, screen.session.program
    asked = page.question_here if inspector.inspected == WHY else None
    if asked is None or program is None:
        screen.tell(with_keys("Put the cursor on a line of a proof; {why} makes one."))
        return
    program = program.for_team(screen.session.level.team_of(inspector.robot))
    found = await screen.app.push_screen_wait(ValuesPrompt(program, *asked))
    if found is not None:
        page.ask(found)


async def graph(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.page import NO_PROGRAM
    from logical_robots_tui.tui.inspector.predicate_graph import Graph

    program = screen.session.program
    if program is None:
        screen.tell(NO_PROGRAM)
        return
    known = program.predicate(screen.inspector.inspected)
    chosen = await screen.app.push_screen_wait(Graph(program, known.name if known else "Robot"))
    predicate = program.predicate(chosen) if chosen is not None else None
    if predicate is not None and predicate.kind == "prelude":
        screen.tell(f"{predicate.reason} It is in the prelude.")
    elif predicate is not None:
        screen.go_to(screen.inspector)
        screen.inspector.open(predicate.name)


async def sql(screen: MainScreen) -> None:
    from logical_robots_tui.game import Superseded
    from logical_robots_tui.tui.inspector.page import NO_PROGRAM
    from logical_robots_tui.tui.inspector.predicate_graph import query_plan_text
    from logical_robots_tui.tui.learning.reader import Reader

    inspector, frame = screen.inspector, screen.session.frame
    try:
        inquiry, program = inspector.questions.about()
        found = await inquiry.query_plans(program, frame)
    except Superseded:
        found = []
    if found:
        text = query_plan_text(found, inspector.inspected)
        screen.app.push_screen(Reader(f"How it is computed · tick {frame.tick}", text))
    else:
        screen.tell(NO_PROGRAM)


def only_robot(screen: MainScreen) -> None:
    if (table := _table(screen)) is not None:
        robot = "" if table.how.robot else screen.inspector.robot
        screen.inspector.rearrange(replace(table.how, robot=robot))


def sort(screen: MainScreen) -> None:
    if (table := _table(screen)) is None:
        return
    how, column = table.how, table.column
    if how.sideways or not column:
        screen.tell("Put the cursor on a column of a table that is not transposed.")
    elif how.sort != column:
        screen.inspector.rearrange(replace(how, sort=column, descending=False))
    elif not how.descending:
        screen.inspector.rearrange(replace(how, descending=True))
    else:
        screen.inspector.rearrange(replace(how, sort="", descending=False))


async def search_rows(screen: MainScreen) -> None:
    from logical_robots_tui.tui.layout.dialogs import LinePrompt

    if (table := _table(screen)) is not None:
        question = "Only rows with this text; nothing shows all"
        text = await screen.app.push_screen_wait(LinePrompt(question, table.how.search))
        if text is not None:
            screen.inspector.rearrange(replace(table.how, search=text))


def transpose(screen: MainScreen) -> None:
    if (table := _table(screen)) is not None:
        screen.inspector.rearrange(replace(table.how, sideways=not table.how.sideways))


def copy_rows(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.widgets.table import as_csv
    from logical_robots_tui.wording import count_of

    if (table := _table(screen)) is not None:
        text, count = as_csv(table.shown), len(table.shown.rows)
        screen.app.copy_to_clipboard(text)
        screen.tell(f"{count_of(count, 'row')} copied{_but(table)}.")
        screen.program_controller.keep_copy(text)


def save_rows(screen: MainScreen) -> None:
    from logical_robots_tui.tui.inspector.widgets.table import as_csv, as_json
    from logical_robots_tui.writing import write_atomically

    if (table := _table(screen)) is None:
        return
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
        screen.tell(f"Saved as {path}.csv and .json{_but(table)}.")


def break_here(screen: MainScreen) -> None:
    from logical_robots_tui.game import Breakpoint

    inspector = screen.inspector
    if query := _question_asked(screen):
        screen.timeline_controller.add_breakpoint(Breakpoint("rows", query))
        return
    if inspector.inspected not in {p.name for p in screen.session.predicates if p.has_rows}:
        screen.tell("Choose a predicate or ask a question first.")
        return
    table = inspector.pages.table
    column = table.column if table.has_focus else ""
    screen.timeline_controller.add_breakpoint(
        Breakpoint("change", inspector.inspected, table.how.robot, column)
    )


def _question_asked(screen: MainScreen) -> str:
    from logical_robots_tui.tui.inspector.predicate_list import ASK

    inspector = screen.inspector
    return inspector.pages.ask.asked if inspector.inspected == ASK else ""


def _table(screen: MainScreen) -> ValueTable | None:
    table = screen.inspector.shown_table
    if table is None:
        screen.tell("There is no table: choose a predicate in the inspector.")
    return table


def _but(table: ValueTable) -> str:
    return f"; {table.missing}" if table.missing else ""
