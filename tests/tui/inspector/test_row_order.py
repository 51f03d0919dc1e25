"""The table of the inspector: sorted, searched, of one robot, turned, copied, saved, stopped at."""

import csv
import json
from pathlib import Path

from textual.widgets import Input

from logical_robots_tui.tui.inspector import table as tables
from logical_robots_tui.tui.inspector.table import RowOrder, TableRows, ValueTable, arrange, as_csv
from tests.short import AHEAD
from tests.tui.conftest import Opened, opened

ROWS = TableRows(
    ("robot_name", "n", "what"),
    (("Ada", 2, {"a": [1]}), ("Bo", 1, "x,y"), ("Ada", None, "Zed")),
    frozenset({(1, 1)}),
)


def test_rows_are_sorted_and_chosen() -> None:
    nothing = set[tuple[int, int]]()
    for order, rows, changed in (
        (RowOrder(robot="Bo"), (1,), {(0, 1)}),
        (RowOrder(sort="n"), (2, 1, 0), {(1, 1)}),  # of mixed values
        (RowOrder(sort="n", descending=True), (0, 1, 2), {(1, 1)}),
        (RowOrder(search="zED"), (2,), nothing),
        (RowOrder(search="a: [1"), (0,), nothing),  # in every value
    ):
        arranged = arrange(ROWS, order)
        assert arranged.rows == tuple(ROWS.rows[number] for number in rows)
        assert arranged.changed == changed


def test_turned_on_its_side() -> None:
    found = arrange(ROWS, RowOrder(sideways=True))
    assert found.columns == ("", "1", "2", "3")
    assert found.rows[1] == ("n", 2, 1, None)
    assert found.changed == {(1, 2)}


def test_csv_and_json_hold_every_value() -> None:
    lines = list(csv.reader(as_csv(ROWS).splitlines()))
    assert lines[0] == ["robot_name", "n", "what"]
    assert json.loads(lines[1][2]) == {"a": [1]}
    assert lines[2][2] == "x,y"
    assert json.loads(tables.as_json(ROWS))[0] == {"robot_name": "Ada", "n": 2, "what": {"a": [1]}}


def test_what_changed_since_the_tick_before() -> None:
    before = (("Ada", 1), ("Bo", 2))
    assert tables.changed_cells((("Bo", 2), ("Ada", 5)), before) == {(1, 1)}
    assert tables.changed_cells((("Ada", 1), ("Bo", 2), ("Cy", 3)), before) == {(2, 0), (2, 1)}
    assert tables.changed_cells(before, before) == frozenset()


TEXT = "Near(robot_name:, t: sensor.clock, list: [1]) :- Sensor(robot_name:, sensor:);\n" + AHEAD


def table(game: Opened) -> ValueTable:
    return game.main.query_one("#rows", ValueTable)


async def test_keys_save_copy_sort_filter_turn_and_search_rows(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=TEXT, ready=True) as game:
        game.inspector.inspect("Near")
        await game.until(lambda: len(table(game).shown.rows) == 3)
        (data_dir / "rows").write_text("a file in the way")
        await game.press("S", sees="can't be saved")
        (data_dir / "rows").unlink()
        await game.press("S")
        path = data_dir / "rows" / "Near-tick-0.csv"
        await game.until(path.exists)
        await game.until(path.with_suffix(".json").exists)
        assert path.read_text() == as_csv(table(game).shown)
        await game.press("c")
        copied = data_dir / "copied.txt"
        await game.until(copied.exists)
        assert game.app.clipboard == copied.read_text() == path.read_text()

        game.inspector.choose("Q")
        await game.press("O", until=lambda: [row[0] for row in table(game).shown.rows] == ["Q"])
        await game.sees("only Q")
        await game.press("O", until=lambda: len(table(game).shown.rows) == 3)
        table(game).focus()
        await game.press("A", "A")
        await game.until(lambda: [row[0] for row in table(game).shown.rows] == ["R", "Q", "P"])
        await game.press("J")
        await game.until(lambda: table(game).shown.rows[0] == ("robot_name", "R", "Q", "P"))
        await game.press("right", until=lambda: table(game).pointed == ("robot_name", "R"))
        await game.press("J", "number_sign", until=lambda: game.app.screen.query(Input))
        await game.press("R", "enter")
        await game.until(lambda: [row[0] for row in table(game).shown.rows] == ["R"])

        # One key stops at a predicate.
        game.inspector.enter()
        await game.press("asterisk")
        await game.settled()
        (set_now,) = game.session.breakpoints
        assert (set_now.event, set_now.subject, set_now.column) == ("change", "Near", "")
        await game.press("space", until=lambda: not game.session.running and game.tick == 1)
