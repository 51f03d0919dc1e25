"""The report of a sweep: each measure against what was varied, over time, and every case."""

import re
from html import unescape
from pathlib import Path
from statistics import median
from typing import Any

import pytest

from logical_robots_tui.lab import Results, sweep
from logical_robots_tui.lab.reporting import lines_of
from tests.lab.laboratory import FIRST_STEPS

TWO = FIRST_STEPS.replace("Near() = 40;", "Near() = 40;\nFar() = 90;").replace("< 90", "< Far()")
AHEAD = "Max{sensor.forward_distance :- Sensor(sensor:)}"


def run(
    folder: Path, *vary: dict[str, Any], ticks: int = 60, **more: Any
) -> tuple[Results, str, str]:
    """The results of an experiment, its page without markup, and what a terminal shows."""
    table = {"level": "01-first-steps", "program": TWO, "ticks": ticks}
    ahead = {"query": AHEAD, "every": 20, "reduce": "mean"}
    measure = {"won": "end", "distance": "end", "ahead": ahead}
    given = {"experiment": table, "vary": list(vary), "measure": measure, **more}
    results = sweep(given, folder / "out", workers=1, progress=False)
    page = results.report().read_text("utf-8")
    assert "<script" not in page
    assert not re.search(r"(href|src)=", page)
    assert results.report().read_text("utf-8") == page
    with results._folder.ledger() as ledger:
        lines = lines_of(results._folder.manifest(), ledger)
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
