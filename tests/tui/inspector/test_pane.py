"""The inspector follows the tick on the screen."""

import asyncio
from pathlib import Path
from typing import Unpack

import pytest
from textual.widgets import OptionList

from logical_robots_tui.game import Frame
from logical_robots_tui.mind import ResultTable
from logical_robots_tui.tui.inspector import pages, pane
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.inspector.pages.decision import DecisionPage
from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from logical_robots_tui.tui.inspector.pages.predicate import PredicatePage
from logical_robots_tui.tui.inspector.pages.robots import RobotsPage, _columns
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.questions import InspectorQuestions
from logical_robots_tui.tui.inspector.register import PAGES
from logical_robots_tui.tui.inspector.table import ValueTable
from logical_robots_tui.world import list_levels, load_level
from tests.tui.conftest import PAPER, STILL, Awaited, Opened, Size, at_both_sizes, opened

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


async def inspect(game: Opened, name: str, **awaited: Unpack[Awaited]) -> None:
    options = choice(game)
    await game.until(lambda: name in [option.id for option in options.options])
    options.highlighted = options.get_option_index(name)
    await game.wait(**awaited)


def test_every_page_is_registered_once_under_the_name_of_its_module() -> None:
    modules = {path.stem for path in Path(pages.__file__).parent.glob("*.py")} - {"__init__"}
    assert sorted(entry.id for entry in PAGES) == sorted(modules)
    assert len({entry.load() for entry in PAGES}) == len(PAGES)


async def test_the_inspector_follows_a_run(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # A predicate is inspected before the pages are loaded.
    monkeypatch.setattr(pane, "_LOADING_DELAY", 3600.0)
    text = f"{MORE}Idle(x) = x + 1;\nLate(x) :- Sensor(sensor:), sensor.clock > 0, x in [1, 2];\n"
    async with opened(data_dir, text=text, ready=True) as game:
        await inspect(game, "Ray", sees="Ray · tick 0 · 31 rows")

        # Inputs and predicates are listed with their kind, and with their number of rows.
        await game.until(lambda: any(_is_counted(entry, "Late", "0 ") for entry in listed(game)))
        entries = listed(game)
        titles = [page.title for page in PAGES if page.is_listed]
        assert entries[: len(titles)] == titles
        assert entries[len(titles)].startswith("◂ Sensor")
        assert entries[len(titles) + 1].startswith("◂ Memory")
        assert any(entry.startswith("• Robot :4") for entry in entries)
        assert "• FreedomMotion ƒ :1" in entries
        assert not [entry for entry in entries if "WeightedAverage" in entry]

        # Values are plain text in short form.
        await inspect(game, "Odd")
        await game.sees("Odd · tick 0 · 1 row", "[bold]x[/bold]", "{a: 1, b: [1, 2]}")
        assert game.shows("0.3 ")
        assert "\x1b" not in game.screen()
        await inspect(game, "Idle", sees="Idle · tick 0 · 0 calls of Solo")

        # A decision is told on one page.
        game.inspector.inspect("decision")
        decision = game.main.query_one("#decision", LinesView)
        await game.until(lambda: "No decision yet: press space." in decision.plain)
        await game.press("n", sees="Decision of Solo · tick 1")
        await game.until(lambda: "on the way" in decision.plain and "as given" in decision.plain)
        for words in ("sensor in", "memory before", "as driven", "memory after"):
            assert words in decision.plain
        assert '• memory  "I am a robot"' in decision.plain, "it has just changed"
        await game.press("p")

        # Rows follow step by step. Memory is empty in tick 1, and what the program made of it in
        # tick 2.
        await inspect(game, "Seen")
        await game.until(lambda: game.shows("Seen · tick 0 · 1 row") and game.shows('""'))
        await game.press("n")
        await game.until(lambda: any(_is_counted(entry, "Late", "2•") for entry in listed(game)))
        assert any(_is_counted(entry, "Names", "1 ") for entry in listed(game))
        await game.press("n")
        table = game.main.query_one("#rows", ValueTable)
        await game.until(lambda: game.tick == 2 and table.shown.changed == {(0, 1)})
        await game.until(lambda: game.shows("Seen · tick 2 · 1 row") and game.shows("I am a robot"))
        await game.press("n", until=lambda: game.tick == 3 and not table.shown.changed)
        await game.press("p", "p", "p", sees="Seen · tick 0 · 1 row")

        await inspect(game, "Names", until=lambda: game.editor.selected_text == "Names")
        await game.press("n", until=lambda: game.tick == 1)
        await game.press("K", sees=("SQLite's plan for Names", "ms of thought"))
        await game.press("escape", sees_no="SQLite's plan for Names")

        # It follows a run without holding it up.
        await inspect(game, "Ray")
        await game.press("space", until=lambda: game.tick > 4)
        await game.sees("Ray · 31 rows")  # the tick is at the top, which is newer
        await game.until(lambda: not any(entry.endswith(" 1 ") for entry in listed(game)))
        await game.press("space", sees=f"Ray · tick {game.tick} · ")
        await game.until(lambda: any(_is_counted(entry, "Names", "1 ") for entry in listed(game)))

        # A predicate that is gone shows again when it is back.
        await game.write(PAPER, sees="no predicate Ray")
        await game.write(text, sees="31 rows")


def _is_counted(entry: str, name: str, count: str) -> bool:
    return entry.startswith(f"• {name} ") and entry.endswith(f" {count}")


async def test_what_is_shown_is_about_the_robot_that_is_chosen(data_dir: Path) -> None:
    text = """
Half(x) = x / 2;
Robot(robot_name:, desire: {left_engine: Half(c), right_engine: Half(1 + c)}, memory: 1) :-
  Sensor(robot_name:, sensor:), c == sensor.clock;
"""
    async with opened(data_dir, level="team_goal", text=text, ready=True) as game:
        assert game.inspector.inspected == "robots", "the robots come first"
        await game.sees("Robots · tick 0")
        for words in ("radar, left to right", "● P", "● Q", "● R"):
            assert game.shows(words)
        await game.press("n", sees="Robots · tick 1")

        await inspect(game, "Half", sees="Half · tick 1 · 2 calls of P")
        table = game.main.query_one("#rows", ValueTable)
        assert table.shown.columns == ("x", "value")
        assert sorted(row[:2] for row in table.shown.rows) == [(1, 0.5), (2, 1)]
        game.inspector.choose("Q")
        await game.sees("Half · tick 1 · 2 calls of Q")
        await game.press("n", sees="Half · tick 2 · 2 calls of Q")
        await game.until(lambda: (3, 1.5) in table.shown.rows)
        table.focus()
        await game.press("at", sees="Choose a predicate")

        game.inspector.inspect("robots")
        await game.press("w", sees="Q: Robot")
        game.inspector.choose("P")
        await game.sees("P: Robot")
        proof = game.main.query_one(WhyView)
        assert any(line.node.values == ("P",) for line in proof.lines)
        assert not any(line.node.values == ("Q",) for line in proof.lines)


async def test_a_table_is_walked_by_key_and_click_and_shows_whole_values(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE, size=(80, 24), ready=True) as game:
        await game.press("3")
        await inspect(game, "Sensor", sees="robot_name")
        await game.press("enter", "right", sees=("sensor = {", "forward_distance:"))
        await game.sees('forward_object: "none"')
        game.inspector.enter()
        await inspect(game, "Ray", sees="31 rows")
        await game.press("enter", "down", "down", "right")
        table = game.main.query_one("#rows", ValueTable)
        third = table.pointed
        await game.until(lambda: table.pointed and table.pointed[0] == "d")
        await game.press("end", until=lambda: table.scroll_offset.y > 0)
        assert table.pointed != third
        await game.press("home", "n", sees="Ray · tick 1 · 31 rows")
        assert table.scroll_offset.y == 0
        await game.click("#rows", offset=(1, 3))
        await game.until(lambda: table.pointed and table.pointed[0] == "i")


async def test_slow_rows_hold_up_nothing(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = InspectorQuestions.rows

    async def late(
        questions: InspectorQuestions, predicate: str, robot: str, frame: Frame
    ) -> ResultTable:
        if predicate == "Robot":
            await asyncio.Event().wait()
        return await rows(questions, predicate, robot, frame)

    monkeypatch.setattr(InspectorQuestions, "rows", late)
    async with opened(data_dir, text=f"Big(x) :- x in Range(1500);\n{STILL}") as game:
        await run_beside(game, "Robot")
        await game.press("space")
        await inspect(game, "Big")
        await game.sees(f"Big · tick {game.tick} · first 1,000 rows, there are more")
        table = game.main.query_one("#rows", ValueTable)
        assert "these first 1,000; / asks" in table.missing
        table.focus()
        await game.press("J", until=lambda: "950 more rows side by side; J shows" in table.missing)
        await game.press("c", sees="side by side")


async def run_beside(game: Opened, slow: str) -> None:
    """Run the robots while the rows of a predicate are awaited, and look at another one."""
    await game.ready()
    await inspect(game, slow)
    await game.press("space", until=lambda: game.tick > 3)
    await inspect(game, "Sensor", sees="Sensor · 1 row")


@at_both_sizes
async def test_notices_are_shown_under_the_robots(data_dir: Path, size: Size) -> None:
    nobody = 'Robot(robot_name: "Solo", desire: {left_engine: 0.1, right_engine: null});\n'
    async with opened(data_dir, text=nobody, size=size, ready=True) as game:
        await game.press("n", "3", tick=1)
        message = game.session.frame.decisions[0].notices[0].message
        await game.sees(f"! Solo: {message[:20]}")


@pytest.mark.parametrize(("level", "is_shown"), [("09-doors", False), ("12-power-line", True)])
def test_a_column_that_no_robot_fills_is_left_out(level: str, is_shown: bool) -> None:
    columns, _ = _columns(load_level(level), 120)
    assert ("charge" in [column.title for column in columns]) == is_shown


async def test_pages_load_and_tell_minds(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pane, "_LOADING_DELAY", 0.2)
    own = '@Visible(Sensor, "own");\n@Visible(Memory, "own");\n'
    text = f"{own}{STILL}Clock(t) :- Sensor(sensor:), t = sensor.clock;\n"
    async with opened(data_dir, level="team_goal", text=text) as game:
        assert not game.inspector.query(PredicatePage)
        await game.later(0.3)
        assert game.inspector.query(PredicatePage)
        await game.ready()
        await inspect(game, "Clock", sees="in the mind of")
        await game.until(lambda: all(game.shows(name) for name in "PQR"))


WIDE = (156, 50)


def page_names(game: Opened) -> list[str]:
    shown = [page for page in game.inspector.query(".heading") if page.region]
    shown.sort(key=lambda heading: heading.region.x)
    return [type(heading.parent).__name__ for heading in shown]


ROBOTS, DECISION, ROWS = (page.__name__ for page in (RobotsPage, DecisionPage, PredicatePage))


async def test_a_page_and_the_robot_stand_side_by_side_where_there_is_room(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=MORE, size=WIDE, ready=True) as game:
        await game.press("n", "3", until=lambda: page_names(game) == [ROBOTS, DECISION])
        await inspect(game, "Names", until=lambda: page_names(game) == [ROWS, DECISION])
        await game.sees("Decision of P · tick 1", "Names · tick 1 · 3 rows")
        await game.press("n", sees=("Decision of P · tick 2", "Names · tick 2 · 3 rows"))

        # Another robot is shown beside the same rows; all robots beside the page of the decision.
        await game.press("1", "a", "a", sees="Decision of Q · tick 2")
        assert game.inspector.inspected == "Names"
        game.inspector.inspect("decision")
        await game.until(lambda: page_names(game) == [ROBOTS, DECISION])

        # Keys are about the page with the focus.
        game.inspector.open("Names")
        await game.until(lambda: page_names(game) == [ROWS, DECISION])
        await game.press("tab", "tab", until=lambda: game.inspector.inspected == "decision")
        await game.press("enter", until=lambda: game.app.screen is not game.main)
        await game.sees("Decision of Q")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        await game.resize(120, 40)
        await game.until(
            lambda: page_names(game) == [ROWS] and game.shows("Names · tick 2 · 3 rows")
        )
        await game.sees_no("Decision of")
        assert game.inspector.inspected == "Names"
        assert game.main.focused is not None
        assert game.main.focused.id == "choice"

        # The selection and the focus survive other sizes.
        await inspect(game, "Ray", sees="Ray · tick 2 · 93 rows")
        await game.press("enter", "down", "down")
        table = game.main.query_one("#rows", ValueTable)
        await game.until(lambda: table.pointed is not None and table.pointed[1] is not None)
        place = table.place
        for size, shown in [((80, 24), [ROWS]), (WIDE, [ROWS, DECISION]), ((120, 40), [ROWS])]:
            await game.resize(*size)
            await game.until(lambda shown=shown: page_names(game) == shown)  # type: ignore[misc] # once a turn
            assert game.inspector.inspected == "Ray"
            assert table.has_focus
            assert table.place == place


LATE = """\
Robot(robot_name:, desire: {left_engine: 0.2, right_engine: 0.2}, memory: "") :-
  Sensor(robot_name:);
Robot(robot_name:, desire: {left_engine: 0.1, right_engine: 0.1}, memory: "") :-
  Sensor(robot_name:, sensor:), sensor.clock > 2;
"""


def page(game: Opened) -> DiagnosisPage:
    return game.main.query_one(DiagnosisPage)


@at_both_sizes
async def test_a_run_is_scanned_and_a_finding_leads_to_its_tick(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, text=LATE, size=size, ready=True) as game:
        await game.run_until(4)
        await game.command("diagnose", until=lambda: page(game).view.has_focus)
        await game.sees("Scan the run up to tick 4", "enter Scan")
        await game.press("enter", until=lambda: page(game).diagnosis is not None)
        assert game.inspector.inspected == "diagnosis"
        await game.sees("warning, line 3, tick 3", "Ticks 1 to 4, not won.")
        await game.press("down")
        await game.until(lambda: game.editor.selected_text.startswith("Robot(robot_name:, des"))
        await game.press("enter", tick=3)

        # It is offered again when the run has gone on.
        await game.press("n", "n", sees="Scan again up to tick 5")
        await game.press("p", tick=4)
        assert not game.shows("This is about")

        # Findings about an earlier program or run say so.
        game.session.apply(f"{LATE}\n")
        await game.sees("This is about an earlier program. Ticks 1 to 4, not won.")
        await game.press("p", tick=3)
        await game.press("n", tick=4)
        game.session.apply(LATE)
        await game.sees("This is about an earlier run. Ticks 1 to 4, not won.")
        await game.press("home", "enter", sees_no="This is about")

        # What is about this level stays behind when another one is opened.
        await game.press("slash", *"Odd", "enter", sees="Odd is not defined")
        await game.press("escape", "greater_than_sign")
        first = list_levels()[0]
        await game.until(lambda: game.session.level.name == first and game.main.briefing.is_open)
        await game.press("b", until=lambda: not game.main.briefing.is_open)
        await game.sees("sensor.clock > 9, Robot")
        assert not game.shows("Odd is not defined")
        await game.command("diagnose", sees="Scan the run up to tick 0", sees_no="not won")
        assert page(game).diagnosis is None
