"""The laboratory from Python: from a file or a mapping to tables, as the commands do it."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from logical_robots_tui import lab
from logical_robots_tui.errors import InputError
from logical_robots_tui.lab import Results, coordinating, grade, sweep, tournament
from logical_robots_tui.lab.coordinating import Coordinator, Engine
from logical_robots_tui.toml_files import TomlFileError
from tests.cli.running import Command
from tests.lab.laboratory import (
    FIRST_STEPS,
    SENSOR,
    STILL,
    exported,
    recorded,
    write_experiment,
    write_files,
)
from tests.processes import run_command


def experiment(**changes: Any) -> dict[str, Any]:
    table = {"level": "01-first-steps", "program": FIRST_STEPS, "starts": 1, "ticks": 60}
    return {
        "experiment": table | changes,
        "vary": [{"constant": "Near", "values": range(20, 60, 20)}],
    }


def test_a_file_gives_the_folder_of_the_command(tmp_path: Path, command: Command) -> None:
    file = write_experiment(tmp_path)
    assert command("sweep", file, "-o", tmp_path / "theirs").status == 0
    results = sweep(file, tmp_path / "mine", workers=1, progress=False)
    assert exported(tmp_path / "mine") == exported(tmp_path / "theirs")
    assert (results.done, results.due, results.failed, results.complete) == (4, 0, 0, True)
    assert repr(results).endswith("mine: 4 runs>")
    # A script needs no guard against its workers.
    script = tmp_path / "script.py"
    call = "print(sweep('experiment.toml', 'out', workers=1).done, 'runs')\n"
    script.write_text(f"from logical_robots_tui.lab import sweep\n{call}")
    done = run_command([sys.executable, script], cwd=tmp_path)
    assert done.stdout == "4 runs\n", done.stderr
    assert exported(tmp_path / "out") == exported(tmp_path / "mine")


def test_a_mapping_may_have_paths_ranges_and_arrays(tmp_path: Path) -> None:
    (tmp_path / "first.l").write_text(FIRST_STEPS)
    given = experiment(program=tmp_path / "first.l", starts=np.int64(0), title=None)
    given["vary"] = ({"constant": "Near", "values": np.linspace(20, 40, 3)},)
    frame = sweep(given, tmp_path / "out", workers=1, progress=False).to_pandas()
    assert list(frame["Near"]) == [20, 30, 40]
    assert frame["won"].dtype == bool


def test_an_interrupted_call_goes_on_later(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    work = coordinating.Coordinator.work

    def stop(self: Coordinator, engine: Engine, *_: object) -> None:
        def show() -> None:
            if recorded(tmp_path / "out"):
                raise KeyboardInterrupt

        work(self, engine, lambda: False, show)

    monkeypatch.setattr(coordinating.Coordinator, "work", stop)
    with pytest.raises(KeyboardInterrupt):
        sweep(experiment(), tmp_path / "out", workers=1)
    monkeypatch.undo()
    left = Results(tmp_path / "out")
    assert 0 < left.due < 4
    assert not left.complete
    assert len(left.to_pandas()) == 4 - left.due
    again = sweep(experiment(), tmp_path / "out", workers=1, progress=False)
    sweep(experiment(), tmp_path / "once", workers=2, progress=False)
    assert again.complete
    assert exported(tmp_path / "out") == exported(tmp_path / "once")


def test_what_is_wrong_with_a_mapping_is_said_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(TomlFileError) as caught:
        sweep(experiment(tics=3) | {"vary": [{"values": [1]}]}, tmp_path / "out")
    keys, vary = caught.value.problems
    assert keys == 'experiment.tics: "tics" is not a known key. Did you mean "ticks"?'
    assert vary.startswith("vary[0]: Name either")
    assert not (tmp_path / "out").exists()
    with pytest.raises(InputError, match="no manifest"):
        Results(tmp_path / "out")


def test_progress_is_said_on_standard_error_and_tables_are_frames_and_arrow(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("logical_robots_tui.lab._LINE_SECONDS", 0.0)
    results = sweep(experiment(title="Mine"), tmp_path / "out", workers=1)
    out, err = capsys.readouterr()
    assert not out
    assert "Mine: 4 of 4 runs, " in err.splitlines()[-1]
    monkeypatch.setitem(sys.modules, "ipykernel", sys)  # a notebook draws on one line
    monkeypatch.setattr("logical_robots_tui.lab._REDRAW_SECONDS", 0.0)
    sweep(experiment(title="Mine"), tmp_path / "another", workers=1)
    *earlier, last = capsys.readouterr().err.splitlines(keepends=True)
    assert "4 of 4 runs" in last
    assert {line[-1] for line in earlier} == {"\r"}
    frame = results.to_pandas()
    assert list(frame.columns[1:6]) == ["level", "program", "Near", "start", "outcome"]
    assert results.to_arrow().to_pandas().equals(frame)
    assert Results(tmp_path / "out").to_pandas("runs").equals(frame)
    with pytest.raises(KeyError):
        results.to_pandas("series")
    assert results.report() == tmp_path / "out" / "report.html"


def test_a_class_is_graded_to_a_gradebook(tmp_path: Path) -> None:
    folder = write_files(tmp_path / "class", {"ada/first-steps.l": FIRST_STEPS})
    assignment = {"assignment": {"starts": 0}, "level": [{"name": "01-first-steps", "points": 10}]}
    results = grade(assignment, folder, tmp_path / "out", workers=1, progress=False)
    assert results.tables[0] == "gradebook"
    frame = results.to_pandas()
    assert list(frame["id"]) == ["ada"]
    assert frame["points"].notna().all()
    assert (tmp_path / "out" / "gradebook.csv").exists()


def test_no_module_hides_a_function() -> None:
    package = Path(lab.__file__).parent
    assert {path.stem for path in package.glob("*.py")}.isdisjoint(lab.__all__)


def test_a_tournament_plays_all_its_rounds(tmp_path: Path) -> None:
    powers = {"ada.l": 1, "ben.l": 0.5, "cem.l": 0}
    programs = {name: STILL.format(power, '""', SENSOR) for name, power in powers.items()}
    players = write_files(tmp_path / "players", programs)
    arena = {"tournament": {"level": "16-high-ground", "format": "swiss", "starts": 0, "ticks": 5}}
    results = tournament(arena, players, tmp_path / "out", workers=1, progress=False)
    assert results.complete
    assert (results.tables, len(results.to_pandas())) == (("ranking", "pairs", "cycles", "runs"), 3)
    assert results.done == 3, "seats are equal there"
