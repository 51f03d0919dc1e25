"""The suite looks after itself: what a run costs, what a change touches, edits meanwhile."""

from collections.abc import Mapping

import pytest

from tests.changed import Nearness, nearest
from tests.costs import BOUNDS, Bound, folder_of

pytest_plugins = ["pytester"]

CONFTEST = """
from tests import conftest, costs

def pytest_addoption(parser):
    parser.addoption("--all", action="store_true")

def pytest_configure(config):
    config.option.numprocesses = 0
    costs.register(config, is_quick=not config.option.all)
    config.pluginmanager.register(conftest._Sources(config))
"""
PLAYS_A_TICK = """
from logical_robots_tui import World, load_level

def test_it():
    World(load_level("01-first-steps")).act({})
"""
EDITS_A_SOURCE = """
from pathlib import Path

def test_it():
    Path("logical_robots_tui/b.py").write_text("b = 2")
    raise AssertionError

def test_another():
    pass
"""


def test_a_run_tells_what_it_has_cost(pytester: pytest.Pytester) -> None:
    pytester.makeconftest(CONFTEST)
    pytester.makepyfile(PLAYS_A_TICK)
    run = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-W", "ignore")
    run.assert_outcomes(passed=1)
    run.stdout.re_match_lines([r"processor seconds: \d+; slowest folders: \. \d+"])


@pytest.mark.parametrize("is_whole", [False, True])
def test_a_quick_run_that_does_too_much_fails_and_says_what(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, is_whole: bool
) -> None:
    monkeypatch.setitem(BOUNDS, "ticks played", Bound(0, "it takes time"))
    pytester.makeconftest(CONFTEST)
    pytester.makepyfile(PLAYS_A_TICK)
    options = ["--all"] if is_whole else []
    run = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-W", "ignore", *options)
    run.assert_outcomes(passed=1)
    assert (run.ret == pytest.ExitCode.OK) is is_whole
    complaint = "A quick run does too much: 1 ticks played, more than 0: it takes time. Most in "
    assert any(line.startswith(complaint) for line in run.outlines) is not is_whole


def test_a_run_ends_if_its_sources_are_edited_meanwhile(pytester: pytest.Pytester) -> None:
    (pytester.mkpydir("logical_robots_tui") / "b.py").write_text("b = 1", encoding="utf-8")
    pytester.makeconftest(CONFTEST)
    pytester.makepyfile(EDITS_A_SOURCE)
    run = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-W", "ignore")
    run.assert_outcomes(failed=1)
    assert run.ret == pytest.ExitCode.INTERRUPTED
    run.stdout.fnmatch_lines(["*b.py: edited while the tests ran; run them again*"])


@pytest.mark.parametrize(
    ("test", "folder"),
    [
        ("tests/world/test_world.py::test_it[a/b]", "world"),
        ("tests/tui/inspector/test_why.py::test_it", "tui/inspector"),
        ("tests/mind/hostile/test_budget.py::test_it", "mind"),
        ("tests/test_values.py::test_it", "."),
    ],
)
def test_the_cost_of_a_test_counts_for_its_folder(test: str, folder: str) -> None:
    assert folder_of(test) == folder


@pytest.fixture(scope="module")
def nearness() -> Nearness:
    return Nearness()


@pytest.mark.parametrize(
    ("path", "test"),
    [
        ("logical_robots_tui/tui/inspector/pages/why.py", "tests/tui/inspector/test_why.py"),
        ("logical_robots_tui/mind/tuning/passes.py", "tests/mind/test_passes.py"),
        ("logical_robots_tui/lab/grading.py", "tests/lab/test_grade.py"),
        ("tests/world/making.py", "tests/world/test_world.py"),
        ("tests/world/test_world.py", "tests/world/test_world.py"),
        ("levels/01-first-steps.toml", "tests/levels/test_levels.py"),
        ("README.md", "tests/house/test_readme.py"),
    ],
)
def test_a_change_leads_to_the_tests_that_are_near(
    nearness: Nearness, path: str, test: str
) -> None:
    distances = nearness.of(path)
    assert sorted(distances.values()).index(distances[test]) < 8


def test_the_nearest_tests_are_chosen_until_they_cost_too_much(nearness: Nearness) -> None:
    path = "logical_robots_tui/world/dynamics.py"
    by_distance = nearest([path], nearness, {}, 1e9)
    costs: Mapping[str, float] = {f"{test}::test_it": 1.0 for test in by_distance}
    assert nearest([path], nearness, costs, 3.5) == by_distance[:3]
    assert nearest([path], nearness, costs, 0.5) == by_distance[:1]
    assert nearest([], nearness, costs, 3.5) == []
