"""What an experiment varies and measures, and how it stands in tables and its report."""

import re
from html import unescape
from pathlib import Path
from statistics import fmean, median
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui import Simulation, load_level
from logical_robots_tui.editing.level_text import write_web
from logical_robots_tui.lab import Results, sweep
from logical_robots_tui.lab.exporting import RunRecords, reduce_series
from logical_robots_tui.lab.reporting import lines_of
from logical_robots_tui.lab.sweeping import SampleTable, draw_samples, plan_sweep
from logical_robots_tui.lab.tasks import QueryMeasure, Reduction, Result, Series
from logical_robots_tui.toml_files import TomlFileError
from logical_robots_tui.world.levels.load import read_level
from tests.house.examples import blocks
from tests.installed import CHECKOUT
from tests.lab.laboratory import FIRST_STEPS, exported

CLOCK = "Max{sensor.clock :- Sensor(sensor:)}"


def plan(*vary: dict[str, Any], level: str = "01-first-steps", **more: Any) -> Any:
    table = {"level": level, "program": FIRST_STEPS, "ticks": 20} | more.pop("experiment", {})
    return plan_sweep({"experiment": table, "vary": list(vary), **more})


def varied(*vary: dict[str, Any], **more: Any) -> list[dict[str, Any]]:
    manifest, _ = plan(*vary, **more)
    return [cell.settings for cell in manifest.cells]


def wrong(*vary: dict[str, Any], **more: Any) -> str:
    with pytest.raises(TomlFileError) as caught:
        plan(*vary, **more)
    return "\n".join(caught.value.problems)


@given(st.integers(0, 99), st.integers(0, 9))
def test_between_whole_numbers_are_whole_ones_and_ends(low: int, size: int) -> None:
    points = draw_samples(SampleTable(300), {("N", True): [low, low + size]})
    assert {point["N", True] for point in points} == {*range(low, low + size + 1)}


def test_what_is_sampled_is_sampled_together_and_crossed_with_the_rest() -> None:
    found = varied(
        {"constant": "Near", "between": [20, 80]},
        {"level": "robots.*.heading", "between": [0.0, 90.0]},
        {"level": "title", "values": ["a", "b"]},
        sample={"count": 5},
    )
    assert len(found) == 10
    points = [(setting["Near"], setting["robots.*.heading"]) for setting in found]
    assert points[:5] == points[5:]
    assert len({*points}) == 5
    assert [setting["title"] for setting in found] == ["a"] * 5 + ["b"] * 5


@given(
    st.lists(st.integers(0, 99) | st.floats(0, 99), min_size=1, max_size=3, unique=True),
    st.text("abc é€#'", max_size=9),
)
def test_a_mapping_means_what_a_file_would(
    tmp_path_factory: pytest.TempPathFactory, values: list[float], text: str
) -> None:
    table = {"level": "01-first-steps", "program": FIRST_STEPS, "title": "t"}
    data = {
        "experiment": table,
        "vary": [{"constant": "Near", "values": values}],
        "case": [{"constants": {"Near": text}}],
    }
    manifest, inputs = plan_sweep(data)
    file = tmp_path_factory.mktemp("mapping") / "experiment.toml"
    file.write_text(manifest.specification, "utf-8")
    assert plan_sweep(file) == (manifest, inputs)


def test_a_range_includes_its_end() -> None:
    for bounds, values in (([0, 0.3, 0.1], [0.0, 0.1, 0.2, 0.3]), ([1, 4], [1, 2, 3, 4])):
        settings = varied({"constant": "Near", "range": bounds})
        assert [setting["Near"] for setting in settings] == values


def test_the_number_of_robots_can_be_varied() -> None:
    manifest, inputs = plan(
        {"level": "robots", "range": [1, 3]}, level="04-everybody-home", experiment={"ticks": 5}
    )
    for count, cell in enumerate(manifest.cells, 1):
        level = read_level(inputs[cell.level], "level")
        names = ["Ruby", "Jade", "Lapis"][:count]
        assert [robot.name for robot in level.robots] == names
        goal = next(area.victory_robots for area in level.areas if area.victory_robots)
        assert {*goal} == {*names}
    assert count == 3
    assert "The level has 3" in wrong({"level": "robots", "values": [4]}, level="04-everybody-home")


def test_the_sensors_can_be_varied(tmp_path: Path) -> None:
    rays = {"level": "sensors.rays", "values": [3, 31]}
    noise = {"level": "sensors.noise", "values": [0, 2.5]}
    manifest, inputs = plan(rays, noise)
    levels = [read_level(inputs[cell.level], "level") for cell in manifest.cells]
    pairs = [(level.sensors.rays, level.sensors.noise) for level in levels]
    assert pairs == [(3, 0), (3, 2.5), (31, 0), (31, 2.5)]
    assert {cell.settings["sensors.rays"] for cell in manifest.cells} == {3, 31}
    assert "an odd number, 3 to 361, not 4" in wrong({**rays, "values": [4]})
    web = tmp_path / "web.json"
    web.write_text(write_web(load_level("01-first-steps")))
    assert "can't say sensors" in wrong(rays, level=str(web))


def test_varied_starts_can_be_others(tmp_path: Path) -> None:
    table = {"level": "01-first-steps", "program": FIRST_STEPS, "ticks": 5, "starts": [101, 103]}
    results = sweep({"experiment": table}, tmp_path / "out", workers=1, progress=False)
    assert list(results.to_pandas()["start"]) == [0, 101, 102, 103]
    assert results.complete


@pytest.mark.parametrize(
    ("vary", "more", "said"),
    [
        ({"between": [1, 2]}, {}, "[sample] count = 20"),
        ({"between": [2, 1]}, {"sample": {"count": 2}}, "the smaller one first"),
        ({"values": [1]}, {"sample": {"count": 2}}, "needs a [[vary]]"),
        ({"values": [1], "between": [1, 2]}, {"sample": {"count": 2}}, "Give "),
        ({"values": [1]}, {"experiment": {"starts": [3, 1]}}, "starts are [from, to]"),
        ({"values": [1]}, {"experiment": {"until": "Nobody(x:)"}}, "Nobody"),
        ({"values": [1]}, {"measure": {"tick": {"query": "1"}}}, "take another name"),
        ({"values": [1]}, {"measure": {"a": {"query": "1", "reduce": "max"}}}, 'needs "every"'),
        ({"values": [1]}, {"measure": {"a": {"query": "1", "at": "end", "every": 2}}}, "either at"),
        ({"values": [1]}, {"measure": {"a": {"query": "1", "every": 2, "reduce": "x"}}}, "reduce"),
    ],
)
def test_what_is_not_varied_is_said(vary: dict[str, Any], more: dict[str, Any], said: str) -> None:
    assert said in wrong({"constant": "Near", **vary}, **more)


@given(st.lists(st.integers(-99, 99) | st.floats(-99, 99), min_size=1))
def test_a_series_is_reduced_to_one_number(numbers: list[float]) -> None:
    asked = QueryMeasure("a", "1", 1)
    result = Result("won", series={"a": Series((), (), "", tuple(enumerate(numbers, 1)))})
    ways: tuple[Reduction, ...] = ("last", "min", "max", "mean", "sum")
    expected = [numbers[-1], min(numbers), max(numbers), fmean(numbers), sum(numbers)]
    assert [reduce_series(result, asked, how) for how in ways] == expected
    # What could not be measured in every tick is not reduce_series.
    for measured in ((), ((1, None),), ((1, 2), (2, None))):
        result = Result("won", series={"a": Series((), (), "", measured)})
        assert reduce_series(result, asked, "max") is None
    assert reduce_series(Result("does not compile"), asked, "max") is None


def test_parameters_and_measures_stand_in_every_table(tmp_path: Path) -> None:
    table = {"ticks": 60, "until": "Sensor(sensor:), sensor.clock >= 35"}
    given: dict[str, Any] = {
        "experiment": {"level": "01-first-steps", "program": FIRST_STEPS, **table},
        "vary": [{"constant": "Near", "values": [20, 40]}],
        "measure": {
            "won": "end",
            "clock": {"query": CLOCK, "every": 10, "reduce": ["mean", "max"]},
            "final": {"query": CLOCK, "at": "end"},
            "alone": {"query": "Robot(robot_name:)"},
        },
    }
    results = sweep(given, tmp_path / "out", workers=1, progress=False)
    assert results.tables == ("runs", "series")
    for name in results.tables:
        columns = list(results.to_pandas(name).columns[:5])
        assert columns == ["run", "level", "program", "Near", "start"]
        assert (tmp_path / "out" / f"{name}.csv").exists()
    runs = results.to_pandas()
    measures = ["outcome", "won", "clock_mean", "clock_max", "final", "alone"]
    assert list(runs.columns[5:11]) == measures
    assert {*runs["outcome"]} == {"stopped"}
    assert {*runs["final"]} == {*runs["clock_max"]} == {35}
    clocks = results.to_pandas("series").query("measure == 'clock'")
    assert sorted({*clocks["tick"]})[:3] == [1, 10, 20]
    assert list(clocks.groupby("Near").number.mean()) == pytest.approx(list(runs["clock_mean"]))
    sweep(given, tmp_path / "another", workers=2, progress=False)
    assert exported(tmp_path / "another") == exported(tmp_path / "out")
    # What is only reduce_series anew is not run again.
    ledger = (tmp_path / "out" / "ledger.db").read_bytes()
    given["measure"]["clock"]["reduce"] = "sum"
    sweep(given, tmp_path / "out", workers=1, progress=False)
    assert (tmp_path / "out" / "ledger.db").read_bytes() == ledger
    assert "clock_sum" in Results(tmp_path / "out").to_pandas().columns


def test_steps_of_thinking_are_a_measure(tmp_path: Path) -> None:
    table = {"level": "06-breadcrumbs", "program": "breadcrumbs", "ticks": 20}
    spec = {"experiment": table, "measure": {"steps": "end"}}
    (steps,) = sweep(spec, tmp_path / "out", workers=1, progress=False).to_pandas()["steps"]
    total = 0
    with Simulation("06-breadcrumbs", "breadcrumbs") as simulation:
        for _ in range(20):
            simulation.step()
            total += simulation.steps
    assert steps == total / 20 > 300


@pytest.mark.slow
def test_a_thought_costs_what_a_page_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = blocks(CHECKOUT / "docs" / "cost.md")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block, file in zip(page, ("cost.l", "cost.toml"), strict=False):
        (tmp_path / file).write_text(block.text, "utf-8")
    for block in page:
        if block.language == "python":
            exec(compile(block.text, "cost.md", "exec"), names)
    (table,) = (block.text for block in page if block.language == "text")
    numbers = [[float(n) for n in line.split()[-3:]] for line in table.splitlines()[2:]]
    assert names["table"].values == pytest.approx(np.array(numbers), rel=0.2)  # of another SQLite
    assert "robots: 100" in (tmp_path / "cost.svg").read_text("utf-8")


TWO = FIRST_STEPS.replace("Near() = 40;", "Near() = 40;\nFar() = 90;").replace("< 90", "< Far()")
AHEAD = "Max{sensor.forward_distance :- Sensor(sensor:)}"


def run(
    folder: Path, *vary: dict[str, Any], ticks: int = 60, level: Any = "01-first-steps", **more: Any
) -> tuple[Results, str, str]:
    """The results of an experiment, its page without markup, and what a terminal shows."""
    table = {"level": level, "program": TWO, "ticks": ticks}
    ahead = {"query": AHEAD, "every": 20, "reduce": "mean"}
    measure = {"won": "end", "distance": "end", "ahead": ahead}
    given = {"experiment": table, "vary": list(vary), "measure": measure, **more}
    results = sweep(given, folder / "out", workers=1, progress=False)
    page = results.report().read_text("utf-8")
    assert "<script" not in page
    assert not re.search(r"(href|src)=", page)
    assert results.report().read_text("utf-8") == page
    with results._folder.ledger() as ledger:
        lines = lines_of(RunRecords(results._folder.manifest(), ledger))
    text = re.sub(r"<style.*?</style>|<[^>]+>", " ", page, flags=re.S)
    return results, unescape(text), "\n".join(lines)


def test_every_measure_stands_against_everything_that_was_varied(tmp_path: Path) -> None:
    near = {"constant": "Near", "values": [20, 50]}
    far = {"constant": "Far", "values": [80, 150]}
    results, page, lines = run(tmp_path, near, far, ticks=200, case=[{"constants": {"Near": 35}}])
    for measure in ("% of starts won", "distance", "ahead_mean"):
        for name in ("Near", "Far"):
            assert f"{measure}, over {name}" in page
    frame = results.to_pandas()
    grid = page[page.index("The grid") :]
    for _, row in frame.iterrows():
        assert f"distance {row['distance']:,.6g}; ahead_mean {row['ahead_mean']:,.6g}" in grid
    assert "as written" in grid
    for label in ("Near = 20, Far = 80", "Near = 50, Far = 150", "Near = 35 "):
        assert label in lines
    assert "ahead_mean, medians" in lines


def test_each_level_has_a_panel_in_which_only_numbers_are_joined_by_lines(tmp_path: Path) -> None:
    levels = ["01-first-steps", "02-open-space"]
    title = {"level": "title", "values": ["b", "a"]}
    run(tmp_path, {"constant": "Near", "values": [20, 50, 40]}, title, level=levels)
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    charts = re.findall("<svg.*?</svg>", page, re.DOTALL)
    for level in levels:
        for axis, kind in (("Near", "xy-graph"), ("title", "line-graph")):
            (chart,) = (c for c in charts if f"% of starts won, over {axis} in {level}" in c)
            assert kind in chart
            assert ('class="line reactive' in chart) == (axis == "Near")


def test_series_are_shown_with_medians_and_bands(tmp_path: Path) -> None:
    results, page, lines = run(tmp_path, {"constant": "Near", "values": [20, 50]})
    assert "ahead over time" in page
    assert "Near = 50, from (quartiles)" in page
    assert "ahead by tick, medians" in lines
    assert {*results.to_pandas("series")["tick"]} == {1, 20, 40, 60}
    frame = results.to_pandas()
    assert f"{median(frame['distance'][frame['Near'] == 20]):,.10g}" in page


@pytest.mark.slow
def test_many_values_are_taken_together(tmp_path: Path) -> None:
    near = {"constant": "Near", "between": [20.0, 80.0]}
    results, page, lines = run(tmp_path, near, sample={"count": 50})
    values = results.to_pandas()["Near"]
    labels = re.findall(r"^([\d.]+) to ([\d.]+) ", lines, re.M)
    assert len({*labels}) == 10
    assert labels[0] == (f"{values.min():.4g}", labels[1][0])
    assert labels[9][1] == f"{values.max():.4g}"
    assert "over Near" in page
    assert "Starts won, over Near" in lines


def test_names_and_values_are_text(tmp_path: Path) -> None:
    run(tmp_path, {"level": "title", "values": ["<b>bold</b>", "=1+1"]})
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "<b>bold" not in page
    assert "&lt;b&gt;bold" in page
