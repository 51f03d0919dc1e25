"""The ledger and its folder: recorded once, compared, locked; damage gets a sentence."""

import re
import resource
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

import pytest
from hypothesis import given

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.exporting import RunRecords, export_runs
from logical_robots_tui.lab.folder import Entry, Folder, Ledger, LedgerError
from logical_robots_tui.lab.sweeping import plan_sweep
from tests.damage import Change, changed, changes
from tests.lab.laboratory import write_experiment
from tests.mind.hostile.bounds import bounded_memory, bounded_work

WON, LOST = '{"outcome":"won","ticks":3}', '{"outcome":"out of ticks","ticks":3}'


def entry(job: str, result: str = WON, engine: str = "") -> Entry:
    return Entry(job, f"run of {job}{engine}", result, 0.5, "here/1")


def test_failures_count_until_a_run_is_recorded_once_and_a_second_result_is_compared(
    tmp_path: Path,
) -> None:
    with closing(Ledger(tmp_path / "l.db", "e")) as ledger:
        ledger.fail("a", "died", "here/1")
        ledger.fail("a", "late", "here/1")
        assert ledger.failures() == {"a": ["died", "late"]}
        assert ledger.record([entry("a"), entry("b")]) == {"a": "won", "b": "won"}
        assert ledger.failures() == {}
        ledger.record([entry("a")])
        assert ledger.differences() == []
        assert ledger.record([entry("a", LOST)]) == {"a": "won"}
        assert ledger.differences() == ["run of a"]
        assert ledger.outcomes() == {"a": "won", "b": "won"}
        assert ledger.results()["a"].ticks == 3


def test_results_of_another_engine_are_not_mixed_unless_asked(tmp_path: Path) -> None:
    file = tmp_path / "l.db"
    with closing(Ledger(file, "old")) as ledger:
        ledger.record([entry("a"), entry("b")])
    with pytest.raises(LedgerError, match="--mixed"):
        Ledger(file, "new")
    with closing(Ledger(file, "new", mixed=True)) as ledger:
        ledger.record([entry("a", LOST, "new")])
        assert ledger.outcomes() == {"a": "out of ticks", "b": "won"}
        assert ledger.engines() == {"a": "new", "b": "old"}
        assert ledger.differences() == []


def test_a_ledger_that_is_damaged_newer_or_has_a_view_gets_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "l.db"
    file.write_bytes(b"no ledger at all" * 100)
    with pytest.raises(LedgerError, match="It is damaged"):
        Ledger(file, "e")
    file.unlink()
    with closing(sqlite3.connect(file)) as other:
        other.execute("PRAGMA user_version = 99")
    with pytest.raises(LedgerError, match="A newer version wrote this ledger"):
        Ledger(file, "e")
    file.unlink()
    with closing(Ledger(file, "e")) as ledger:
        ledger.record([entry("a")])
    with closing(sqlite3.connect(file)) as other:
        other.execute("CREATE VIEW endless AS SELECT 1")
    with pytest.raises(LedgerError, match="It is damaged"):
        Ledger(file, "e")


def test_a_full_disk_gets_a_sentence_and_loses_nothing(tmp_path: Path) -> None:
    file = tmp_path / "l.db"
    with closing(Ledger(file, "e")) as ledger:
        ledger.record([entry("a")])
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, hard))
        try:
            with pytest.raises(LedgerError, match="disk is full"):
                ledger.record(
                    [entry(str(i), WON[:-1] + ',"x":"' + "x" * 9000 + '"}') for i in range(99)]
                )
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert ledger.outcomes() == {"a": "won"}
    with closing(Ledger(file, "e")) as ledger:
        assert ledger.record([entry("b")]) == {"b": "won"}


def test_damaged_inputs_and_manifests_get_a_sentence(tmp_path: Path) -> None:
    folder = Folder(tmp_path / "out")
    with pytest.raises(InputError, match="There is no manifest"):
        folder.manifest()
    with folder.lock():
        written = folder.write(*plan_sweep(write_experiment(tmp_path)))
    assert folder.manifest() == written
    program = written.cells[0].program
    assert [*written.files.values()] == ["01-first-steps.toml", "first.l", "first-2.l"]
    assert "Near() = 20;" in folder.text(program)
    (folder.path / "inputs" / written.files[program]).write_text("Robot();")
    with pytest.raises(InputError, match="This input is damaged"):
        folder.text(program)
    for text, problem in (("format", "newer version"), ("kind", "This manifest is damaged")):
        (folder.path / "manifest.json").write_text(f'{{"{text}": 7}}')
        with pytest.raises(InputError, match=problem):
            folder.manifest()


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Folder:
    path = tmp_path_factory.mktemp("swept")
    folder = Folder(path / "out")
    with folder.lock():
        manifest = folder.write(*plan_sweep(write_experiment(path)))
    with folder.ledger() as ledger:
        job = manifest.job(manifest.cells[0], 0)
        ledger.record([Entry(job, manifest.run(job), WON, 1.0, "here")])
    return folder


MANIFESTS: dict[str, Callable[[bytes], bytes]] = {
    "deeply nested": lambda told: b"[" * 100_000,
    "nested in it": lambda m: m.replace(b'"title":', b'"more": ' + b"[" * 99_999 + b',"title":'),
    "many starts": lambda told: re.sub(rb'"starts": \d+', b'"starts": 1000000000', told),
    "fewer than no starts": lambda told: re.sub(rb'"starts": \d+', b'"starts": -5', told),
    "another measure": lambda told: told.replace(b'"won"', b'"speed"'),
    "a path": lambda told: re.sub(rb'"level": "[0-9a-f]+"', b'"level": "../../etc/passwd"', told),
    "a path of a file": lambda told: told.replace(b'"first.l"', b'"../first.l"'),
    "long": lambda told: b"[" + b"[]," * 9_000_000 + b"1]",
}


@pytest.mark.parametrize("how", MANIFESTS)
def test_a_forged_manifest_is_refused(swept: Folder, tmp_path: Path, how: str) -> None:
    told = (swept.path / "manifest.json").read_bytes()
    forged = MANIFESTS[how](told)
    assert forged != told
    (tmp_path / "manifest.json").write_bytes(forged)
    with bounded_memory(), pytest.raises(InputError, match="This manifest is damaged"):
        Folder(tmp_path).manifest()


def test_an_export_names_damaged_inputs_and_ledgers(swept: Folder, tmp_path: Path) -> None:
    folder = Folder(shutil.copytree(swept.path, tmp_path / "copy"))
    manifest = folder.manifest()
    (folder.path / "inputs" / manifest.files[manifest.cells[0].level]).write_text("another")
    with folder.ledger() as ledger, pytest.raises(InputError, match="This input is damaged"):
        export_runs(folder, RunRecords(manifest, ledger))
    file = tmp_path / "ledger.db"
    with closing(sqlite3.connect(swept.path / "ledger.db")) as whole:
        whole.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    content = (swept.path / "ledger.db").read_bytes()
    file.write_bytes(content.replace(b"CREATE TABLE results", b"CREATE \xa0ABLE results"))
    with pytest.raises(LedgerError, match="It is damaged"):
        Ledger(file, "engine").outcomes()


@pytest.mark.sampled
@given(changes=changes())
def test_a_manifest_that_was_changed_is_read_or_refused(
    swept: Folder, tmp_path_factory: pytest.TempPathFactory, changes: list[Change]
) -> None:
    told = (swept.path / "manifest.json").read_bytes()
    folder = Folder(tmp_path_factory.mktemp("changed"))
    (folder.path / "manifest.json").write_bytes(changed(told, changes))
    with bounded_memory(), bounded_work(), suppress(InputError):
        manifest = folder.manifest()
        with folder.ledger() as ledger:
            export_runs(folder, RunRecords(manifest, ledger))


@pytest.mark.sampled
@given(changes=changes())
def test_a_ledger_that_was_changed_is_read_or_refused(
    swept: Folder, tmp_path_factory: pytest.TempPathFactory, changes: list[Change]
) -> None:
    copy = shutil.copytree(swept.path, tmp_path_factory.mktemp("changed") / "copy")
    (copy / "ledger.db").write_bytes(changed((swept.path / "ledger.db").read_bytes(), changes))
    folder = Folder(copy)
    with bounded_memory(), bounded_work(), suppress(InputError), folder.ledger() as ledger:
        export_runs(folder, RunRecords(folder.manifest(), ledger))
        ledger.seconds()
        ledger.differences()
