"""The runner of the benchmarks, with tiny benchmarks."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.__main__ import SUITE
from benchmarks.measure import Effort, Measurement, Target, at_least, at_most, need
from benchmarks.runner import Suite, run


def number(value: float, target: Target | None = None) -> Measurement:
    return Measurement("a tick", "one robot", value, "ms", value, value, target)


def fast(effort: Effort) -> Iterator[Measurement]:
    yield number(effort.repeats, at_most(10))


def slow(_: Effort) -> Iterator[Measurement]:
    yield number(1.58, at_most(1.3))


def idle(_: Effort) -> Iterator[Measurement]:
    yield Measurement("a run", "one robot", 900, "ticks/s", 800, 950, at_least(1000))


def needy(_: Effort) -> Iterator[Measurement]:
    yield number(1)
    need("sshd", None)
    yield number(2)


def broken(_: Effort) -> Iterator[Measurement]:
    yield number(3)
    raise ValueError("no screen\nand its second line")


def test_what_is_missing_or_fails_is_named_and_the_rest_goes_on(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for benchmark, status, words in (
        (needy, 0, "needy skipped: no sshd"),
        (broken, 1, "broken failed: ValueError: no screen\n"),
    ):
        assert run(Suite({benchmark.__name__: benchmark, "fast": fast}), []) == status
        told = capsys.readouterr()
        assert words in told.out
        assert "Targets: 1, all met." in told.out
        assert ("Traceback" in told.err) is bool(status)
        assert "Traceback" not in told.out


def test_missed_targets_are_listed_at_the_end_and_are_no_failure(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(Suite({"slow": slow, "fast": fast, "idle": idle}), []) == 0
    assert (
        "Targets: 2 of 3 missed:\n"
        "  a tick, one robot: 1.58 ms, wanted at most 1.3\n"
        "  a run, one robot: 900 ticks/s, wanted at least 1,000\n"
    ) in capsys.readouterr().out


def test_json_holds_what_there_is(tmp_path: Path) -> None:
    path = tmp_path / "numbers.json"
    suite = Suite({"broken": broken, "needy": needy, "slow": slow})
    assert run(suite, ["--json", str(path)]) == 1
    found = json.loads(path.read_text(encoding="utf-8"))
    assert [one["value"] for one in found["measurements"]] == [3, 1, 1.58]
    assert found["measurements"][2]["target"] == {"relation": "at most", "number": 1.3}
    assert found["failed"] == {"broken": "ValueError: no screen"}
    assert found["skipped"] == {"needy": "no sshd"}
    assert [*found["seconds"]] == ["broken", "needy", "slow"]


def test_an_earlier_run_is_compared_though_it_had_fewer_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "numbers.json")
    run(Suite({"needy": needy}), ["--json", path])
    run(Suite({"slow": slow, "idle": idle}), ["--compare", path])
    out = capsys.readouterr().out
    assert "+58%" in out
    assert "new" in out


def test_a_benchmark_runs_by_default_or_only_when_it_is_named(
    capsys: pytest.CaptureFixture[str],
) -> None:
    benchmarks = {"fast": fast, "idle": idle, "slow": slow}
    suite = Suite(benchmarks, named=frozenset({"slow"}), thorough=frozenset({"idle"}))
    for arguments, count in (([], 2), (["--quick"], 1), (["--quick", "slow", "idle"], 2)):
        run(suite, arguments)
        assert f"Benchmarks: {count}, in" in capsys.readouterr().out
    with pytest.raises(SystemExit) as end:
        run(suite, ["fats"])
    assert end.value.code == 2
    assert "no such benchmark: fats" in capsys.readouterr().err


def test_benchmarks_that_are_left_out_exist() -> None:
    assert SUITE.named | SUITE.thorough <= SUITE.benchmarks.keys()
