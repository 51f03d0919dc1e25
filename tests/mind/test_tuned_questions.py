"""Questions asked of all robots together, or of several moments, mean what they mean alone."""

from contextlib import closing
from functools import cache
from pathlib import Path
from typing import Any, Literal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.explain.diagnosis.sites import check_up
from logical_robots_tui.game import Run, load_program
from logical_robots_tui.mind import CompiledQuery, Limits, Mind, Program, ResultTable
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.values import SensorRow, Value
from logical_robots_tui.world import load_level
from tests.mind.rows import ROBOT, VISIBILITIES, nearly_same, row, slow

MORE = (
    "Sensor(robot_name:, sensor:), ray in sensor.radar, ray.distance < 12",
    "Sensor(robot_name:, sensor:), near == Min{ray.distance :- ray in sensor.radar}, near < 30",
    "Memory(robot_name:, memory:), memory.never == 1",
    "Count{r.label :- Sensor(sensor:), r in sensor.radar} > 2",
    "~Robot(desire:), 1 < 2",
)
SEES = {3: (40, "robot", "Bo"), 9: (12, "wall", "wall"), 11: (50, "beacon", "B")}


def in_any_order(table: ResultTable) -> list[Any]:
    viewers = table.viewers or ("",) * len(table.rows)
    rows = ([viewer, *row] for viewer, row in zip(viewers, table.rows, strict=True))
    return sorted(rows, key=lambda row: repr([*map(shortened, row)]))


def shortened(value: Any) -> Any:
    return round(value, 6) if isinstance(value, float) else value


@pytest.mark.parametrize(
    ("name", "tick"),
    [
        ("05-lighthouse", 20),
        slow("06-breadcrumbs", 200),
        slow("10-distributed-mapping", 120),
        slow("13-swarm", 20),
    ],
)
async def test_every_predicate_of_our_programs_can_be_asked_so(name: str, tick: int) -> None:
    level = load_level(name)
    program = Program.compile(load_program(level.solution).text)
    run = Run(level, program)
    frame = await run.frame(tick)
    await run.close()
    visible = level.visibility
    questions = [p.name for p in program.predicates if p.has_rows and p.kind == "program"]
    together = rows = 0
    with (
        closing(Mind(program, visible.memory, visible.sensor, frozen=True)) as quick,
        closing(Mind(program, visible.memory, visible.sensor, plain=True)) as plain,
    ):
        quick.think(frame.sensors, frame.memories_before)
        for text in (*questions, *MORE):
            question = program.question(text)
            moment = frame.sensors, frame.memories_before
            expected = plain.ask(question, *moment)
            in_order = quick.ask(question, *moment)
            assert in_order.columns == expected.columns
            assert nearly_same(in_order.rows, expected.rows)
            assert in_order.viewers == expected.viewers
            found = quick.ask(question, *moment, in_order=False)
            assert found.columns == expected.columns
            assert nearly_same(in_any_order(found), in_any_order(expected))
            together += bool(question.tuned and question.tuned.together)
            rows += len(expected.rows)
    assert together > len(questions) / 2
    assert rows > 12


def test_questions_read_the_columns_that_the_program_reads_and_no_others() -> None:
    text = (
        "Phase(robot_name:, p: memory.phase) :- Memory(robot_name:, memory:);\n"
        f"{ROBOT}m = Sum{{p :- Phase(robot_name:, p:)}};"
    )
    program = Program.compile(text)
    known = program.question("Memory(memory:), memory.phase == 3")
    new = program.question("Memory(memory:), memory.other == 4")
    both = program.question("Memory(memory:), memory.other == 4, memory.phase == 3")
    assert fields(known) == {"field_0=phase"}
    assert fields(new) == set()
    memories = {"Ada": {"phase": 3, "other": 5}, "Bo": {"phase": 3, "other": 4}}
    rows = [row("Ada"), row("Bo")]
    with closing(Mind(program, frozen=True)) as mind:
        for _ in range(2):
            mind.think(rows, memories)
            assert mind.ask(known, rows, memories, in_order=False).viewers == ("Ada", "Bo")
            assert mind.ask(new, rows, memories, in_order=False).viewers == ("Bo",)
            assert mind.ask(both, rows, memories, in_order=False).viewers == ("Bo",)


def fields(question: CompiledQuery) -> set[str]:
    assert question.tuned is not None
    return {name for name in question.tuned.columns.get("Memory", ()) if "=" in name}


def test_a_table_is_filled_once_for_all_who_read_it(monkeypatch: pytest.MonkeyPatch) -> None:
    program = Program.compile(
        f"Ahead(robot_name:, d: sensor.forward_distance) :- Sensor(robot_name:, sensor:);\n"
        f"{ROBOT}m = Sum{{d :- Ahead(robot_name:, d:)}};"
    )
    question = program.question("Sensor(robot_name:, sensor:), sensor.clock > 1")
    filled: list[str] = []
    fill = Database.fill

    def counted(database: Database, table: str, *rest: Any) -> None:
        filled.append(table)
        fill(database, table, *rest)

    monkeypatch.setattr(Database, "fill", counted)
    with closing(Mind(program, frozen=True)) as mind:
        counts = []
        for _ in range(4):
            rows, memories = (row("Ada", sees=SEES), row("Bo")), {"Ada": 1}
            mind.think(rows, memories)
            mind.ask(question, rows, memories, in_order=False)
            mind.query("Robot", rows, memories)
            counts.append(filled.count("Sensor"))
            filled.clear()
    assert counts == [2, 1, 1, 1]


def test_more_rows_than_are_shown_are_cut_off_either_way() -> None:
    program = Program.compile(f"Many(x) :- x in Range(2000);\n{ROBOT}m = 1;")
    question = program.question("Many(x), Sensor(robot_name:)")
    rows = [row("Ada"), row("Bo")]
    with closing(Mind(program)) as mind:
        for in_order in (True, False):
            table = mind.ask(question, rows, {}, in_order=in_order)
            assert (len(table.rows), table.truncated) == (mind.limits.rows, True)


Rows = list[dict[str, Value]]

TEXT = Path(__file__).with_name("moments.l").read_text("utf-8")
ROBOTS = ("Ada", "Bo", "Cy")
SIGHTS = st.dictionaries(
    st.integers(0, 30),
    st.tuples(st.integers(1, 199), st.sampled_from(["robot", "beacon"]), st.sampled_from(ROBOTS)),
    max_size=3,
)
MEMORIES = st.one_of(
    st.just(""), st.none(), st.text(max_size=3), st.fixed_dictionaries({"n": st.integers(0, 4)})
)
MOMENTS = st.lists(
    st.tuples(
        st.tuples(
            *(
                st.builds(lambda name, sees: row(name, sees=sees), st.just(n), SIGHTS)
                for n in ROBOTS
            )
        ),
        st.fixed_dictionaries(dict.fromkeys(ROBOTS, MEMORIES)),
    ),
    min_size=1,
    max_size=15,
)


@cache
def probes() -> Program:
    return check_up(Program.compile(TEXT)).program


def sorted_views(views: list[Rows] | None) -> list[list[str]] | None:
    return None if views is None else [sorted(map(repr, rows)) for rows in views]


@pytest.mark.parametrize(("memory", "sensor"), VISIBILITIES)
@settings(deadline=None)
@given(moments=MOMENTS)
def test_the_rows_at_several_moments_are_those_at_each(
    memory: Literal["own", "seen", "all"],
    sensor: Literal["own", "all"],
    moments: list[tuple[tuple[SensorRow, ...], dict[str, Value]]],
) -> None:
    names = [*probes().statements]
    single: dict[tuple[str, int], list[Rows]] = {}
    with closing(Mind(probes(), memory, sensor)) as mind:
        for number, (rows, memories) in enumerate(moments):
            for name, views in mind.predicate_rows(names, rows, memories):
                assert views is not None
                single.setdefault((name, number), []).append(views)
        several = {
            (name, number): views for name, number, views in mind.predicate_rows_at(names, moments)
        }
    assert {key: sorted_views(views) for key, views in several.items()} == {
        key: sorted_views(views) for key, views in single.items()
    }


def test_a_predicate_that_fails_is_told_of_each_moment() -> None:
    moment = tuple(row(name) for name in ROBOTS), {name: {"n": 3} for name in ROBOTS}
    name = next(iter(probes().statements))
    with closing(Mind(probes(), limits=Limits(rows=0))) as mind:
        assert [*mind.predicate_rows_at([name], [moment] * 2)] == [(name, 0, None), (name, 1, None)]
