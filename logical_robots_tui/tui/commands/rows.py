"""What the commands for rows and values of the inspector do, where that takes the screen."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.inspector.table import ValueTable


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
        screen.app.push_screen(TextReader(f"How it is computed · tick {frame.tick}", text))
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
    from logical_robots_tui.paths import write_atomically
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
        screen.tell(f"Saved as {path}.csv and .json{_but(table)}.")


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
