"""The inspector follows the tick on the screen."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from textual.widgets import OptionList

from logical_robots_tui.tui.inspector import pages, pane
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.pages.predicate import PredicatePage
from logical_robots_tui.tui.inspector.register import PAGES
from logical_robots_tui.tui.inspector.table import ValueTable
from tests.tui.conftest import PAPER, SLOW, opened

if TYPE_CHECKING:
    from tests.tui.conftest import Opened

MORE = (
    PAPER
    + """
Ray(i, d) :- Sensor(sensor:), x in sensor.radar, i = x.angle, d = x.distance;
Names(robot_name) :- Sensor(robot_name:);
Seen(robot_name:, memory:) :- Memory(robot_name:, memory:);
Odd("[bold]x[/bold]\\x1b", {a: 1, b: [1, 2]}, 0.1 + 0.2);
"""
)


def choice(game: Opened) -> OptionList:
    return game.main.query_one("#choice", OptionList)


def listed(game: Opened) -> list[str]:
    options = choice(game)
    return [str(options.get_option_at_index(i).prompt) for i in range(options.option_count)]


async def inspect(game: Opened, name: str) -> None:
    options = choice(game)
    await game.until(lambda: any(name in entry for entry in listed(game)))
    options.highlighted = options.get_option_index(name)


def test_every_page_is_registered_once_under_the_name_of_its_module() -> None:
    modules = {path.stem for path in Path(pages.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(entry.id for entry in PAGES) == sorted(modules)
    assert len({entry.load() for entry in PAGES}) == len(PAGES)


async def test_pages_are_loaded_soon_after_the_start(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pane, "_LOADING_DELAY", 0.2)
    async with opened(data_dir) as game:
        assert not game.inspector.query(PredicatePage)
        await game.later(0.3)
        assert game.inspector.query(PredicatePage)


async def test_a_predicate_is_inspected_before_the_pages_are_loaded(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pane, "_LOADING_DELAY", 3600.0)
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Ray")
        await game.sees("Ray · tick 0 · 31 rows")


async def test_the_robots_come_first(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal") as game:
        await game.ready()
        assert game.inspector.inspected == "robots"
        await game.sees("Robots · tick 0")
        for words in ("radar, left to right", "● P", "● Q", "● R"):
            await game.sees(words)
        await game.press("n")
        await game.sees("Robots · tick 1")


async def test_each_predicate_has_its_number_of_rows_and_a_mark_if_they_changed(
    data_dir: Path,
) -> None:
    text = MORE + "Late(x) :- Sensor(sensor:), sensor.clock > 0, x in [1, 2];"
    async with opened(data_dir, text=text) as game:
        await game.ready()
        await game.until(lambda: any(_is_counted(each, "Late", "0 ") for each in listed(game)))
        await game.press("n")
        await game.until(lambda: any(_is_counted(each, "Late", "2•") for each in listed(game)))
        assert any(_is_counted(each, "Names", "1 ") for each in listed(game))


def _is_counted(entry: str, name: str, count: str) -> bool:
    return entry.startswith(f"• {name} ") and entry.endswith(f" {count}")


async def test_values_that_changed_are_brought_out(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Seen")
        await game.press("n", "n")
        table = game.main.query_one("#rows", ValueTable)
        # Memory is empty in tick 1, and what the program made of it in tick 2.
        await game.until(lambda: game.tick == 2)
        await game.until(lambda: table.shown.changed == {(0, 1)})
        await game.press("n")
        await game.until(lambda: game.tick == 3 and not table.shown.changed)


async def test_the_definition_of_a_predicate_is_shown_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Names")
        await game.until(lambda: game.editor.selected_text == "Names")


async def test_inputs_and_predicates_are_listed_with_their_kind(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await game.until(lambda: any(each.startswith("• Robot :4") for each in listed(game)))
        entries = listed(game)
        titles = [page.title for page in PAGES if page.is_listed]
        assert entries[: len(titles)] == titles
        assert entries[len(titles)].startswith("◂ Sensor")
        assert entries[len(titles) + 1].startswith("◂ Memory")
        assert "• FreedomMotion ƒ :1" in entries
        assert not [entry for entry in entries if "WeightedAverage" in entry]


async def test_rows_follow_step_by_step(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Seen")
        await game.sees("Seen · tick 0 · 1 row")
        await game.sees('""')
        await game.press("n", "n")
        await game.sees("Seen · tick 2 · 1 row")
        await game.sees("I am a robot")
        await game.press("p", "p")
        await game.sees("Seen · tick 0 · 1 row")


async def test_a_function_shows_the_values_that_it_had_for_the_chosen_robot(data_dir: Path) -> None:
    text = """
Half(x) = x / 2;
Robot(robot_name:, desire: {left_engine: Half(c), right_engine: Half(1 + c)}, memory: 1) :-
  Sensor(robot_name:, sensor:), c == sensor.clock;
"""
    async with opened(data_dir, level="team_goal", text=text) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await inspect(game, "Half")
        await game.sees("Half · tick 1 · 2 calls of P")
        table = game.main.query_one("#rows", ValueTable)
        assert table.shown.columns == ("x", "value")
        assert sorted(row[:2] for row in table.shown.rows) == [(1, 0.5), (2, 1)]
        game.inspector.choose("Q")
        await game.sees("Half · tick 1 · 2 calls of Q")
        await game.press("n")
        await game.sees("Half · tick 2 · 2 calls of Q")
        await game.until(lambda: (3, 1.5) in table.shown.rows)
        table.focus()
        await game.press("at")
        await game.sees("Choose a predicate")


async def test_a_function_that_was_not_called_has_no_calls(data_dir: Path) -> None:
    async with opened(data_dir, text=f"Idle(x) = x + 1;\n{MORE}") as game:
        await game.ready()
        await inspect(game, "Idle")
        await game.sees("Idle · tick 0 · 0 calls of Solo")


async def test_a_predicate_with_more_rows_than_are_shown_says_so(data_dir: Path) -> None:
    async with opened(data_dir, text=f"Big(x) :- x in Range(1500);\n{MORE}") as game:
        await game.ready()
        await inspect(game, "Big")
        await game.sees("Big · tick 0 · first 1,000 rows, there are more")
        table = game.main.query_one("#rows", ValueTable)
        assert "these first 1,000; / asks" in table.missing
        table.focus()
        await game.press("J")
        await game.until(lambda: "950 more rows side by side; J shows" in table.missing)
        await game.press("c")
        await game.sees("side by side")


async def test_values_are_plain_text_in_short_form(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Odd")
        await game.sees("Odd · tick 0 · 1 row")
        await game.sees("[bold]x[/bold]")
        await game.sees("{a: 1, b: [1, 2]}")
        await game.sees("0.3 ")
        assert "\x1b" not in game.screen()


async def test_the_value_under_the_cursor_is_shown_in_full(data_dir: Path) -> None:
    async with opened(data_dir, size=(80, 24)) as game:
        await game.ready()
        await game.press("3")
        await inspect(game, "Sensor")
        await game.sees("robot_name")
        await game.press("enter", "right")
        await game.sees("sensor = {")
        await game.sees("forward_distance:")
        await game.sees('forward_object: "none"')


async def test_the_table_is_walked_by_key_and_click(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await game.press("3")
        await inspect(game, "Ray")
        await game.sees("31 rows")
        await game.press("enter", "down", "down", "right")
        table = game.main.query_one("#rows", ValueTable)
        third = table.pointed
        await game.until(lambda: table.pointed and table.pointed[0] == "d")
        await game.press("end")
        await game.until(lambda: table.scroll_offset.y > 0)
        assert table.pointed != third
        await game.press("home", "n")
        await game.sees("Ray · tick 1 · 31 rows")
        assert table.scroll_offset.y == 0
        await game.click("#rows", offset=(1, 3))
        await game.until(lambda: table.pointed and table.pointed[0] == "i")


async def test_the_inspector_follows_a_run_without_holding_it_up(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Ray")
        await game.press("space")
        await game.until(lambda: game.tick > 20)
        await game.sees("Ray · 31 rows")  # the tick is at the top, which is newer
        await game.press("space")
        await game.sees(f"Ray · tick {game.tick} · ")


async def test_a_slow_predicate_does_not_hold_up_the_game(data_dir: Path) -> None:
    text = PAPER + SLOW.split("Robot(")[0]
    async with opened(data_dir, text=text) as game:
        await game.ready()
        await inspect(game, "Many")
        await game.press("space")
        await game.until(lambda: game.tick > 10)
        await inspect(game, "Sensor")
        await game.sees("Sensor · 1 row")


async def test_a_predicate_that_is_gone_says_so_and_shows_again_when_it_is_back(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Ray")
        await game.sees("31 rows")
        await game.write(PAPER)
        await game.sees("no predicate Ray")
        await game.write(MORE)
        await game.sees("31 rows")


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_notices_are_shown_under_the_robots(data_dir: Path, size: tuple[int, int]) -> None:
    nobody = 'Robot(robot_name: "Solo", desire: {left_engine: 0.1, right_engine: null});\n'
    async with opened(data_dir, text=nobody, size=size) as game:
        await game.ready()
        await game.press("n", "3")
        await game.until(lambda: game.tick == 1)
        message = game.session.frame.decisions[0].notices[0].message
        await game.sees(f"! Solo: {message[:20]}")


async def test_a_row_that_names_no_robot_says_in_whose_mind_it_holds(data_dir: Path) -> None:
    own = '@Visible(Sensor, "own");\n@Visible(Memory, "own");\n'
    text = own + PAPER + "\nClock(t) :- Sensor(sensor:), t = sensor.clock;\n"
    async with opened(data_dir, level="team_goal", text=text) as game:
        await game.ready()
        await inspect(game, "Clock")
        await game.sees("in the mind of")
        await game.until(lambda: all(game.shows(name) for name in "PQR"))


async def test_the_sql_the_plan_and_the_cost_of_predicates_are_told(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE) as game:
        await game.ready()
        await inspect(game, "Names")
        await game.press("K")
        await game.sees("SQLite's plan for Names")
        await game.sees("Milliseconds")
        await game.press("escape")
        await game.until(lambda: not game.shows("SQLite's plan for Names"))


async def test_a_decision_is_told_on_one_page(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE, size=(120, 60)) as game:
        await game.ready()
        game.inspector.inspect("decision")
        view = game.main.query_one("#decision", LinesView)
        await game.until(lambda: "No decision yet: press space." in view.plain)
        await game.press("n")
        await game.sees("Decision of Solo · tick 1")
        await game.until(lambda: "on the way" in view.plain and "as given" in view.plain)
        for words in ("sensor in", "memory before", "as driven", "memory after"):
            assert words in view.plain
        assert '• memory  "I am a robot"' in view.plain, "it has just changed"
