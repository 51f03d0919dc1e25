"""Files of earlier versions are brought up to date, wholly or not at all."""

from __future__ import annotations

import contextlib
import sqlite3
from pathlib import Path

import pytest

from logical_robots_tui.progress import Progress
from logical_robots_tui.progress.store import MIGRATIONS, prepare

VERSION_1 = Path(__file__).parent / "version-1.sql"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "progress.sqlite"


def test_a_file_of_the_first_version_is_brought_up_to_date(file: Path) -> None:
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.executescript(VERSION_1.read_text("utf-8"))
        assert connection.execute("PRAGMA user_version").fetchone() == (1,)
    progress = Progress(file, pytest.fail)
    record = progress.record("01-first-steps")
    assert (record.state, record.hints, record.versions) == ("won", 2, 2)
    assert (record.bests.ticks, record.bests.size, record.bests.wins) == (1255, 2, 19)
    assert record.bests.rules == 1
    assert record.bests.goals == ()
    assert progress.record("02-open-space").state == "in work"
    assert progress.newest("01-first-steps") == "Robot(later);"
    assert progress.fact("tour") == "seen"
    progress.keep("02-open-space", "new")
    with contextlib.closing(sqlite3.connect(file)) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (len(MIGRATIONS),)


def test_records_follow_their_levels_to_other_numbers(file: Path) -> None:
    arena, own = "/opt/levels/arenas/13-high-ground.toml", "/home/ada/09-the-gate.toml"
    before = ["09-the-gate", "11-power-line", "12-swarm", "10-distributed-mapping", arena, own]
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        prepare(connection, MIGRATIONS[:-1])
        for level in before:
            connection.execute("INSERT INTO level (name, hints) VALUES (?, 1)", (level,))
            connection.execute(
                "INSERT INTO version (level, digest, text, turn, kept) VALUES (?, '', ?, 1, '')",
                (level, level),
            )
            connection.execute("INSERT INTO answer VALUES (?, 'Who?', ?)", (level, level))
        connection.execute("INSERT INTO fact VALUES ('level', '11-power-line')")
    progress = Progress(file, pytest.fail)
    after = ["11-the-gate", "12-power-line", "13-swarm", before[3], arena.replace("13", "14"), own]
    assert [progress.newest(level) for level in after] == before
    assert [progress.record(level).hints for level in after] == [1] * len(before)
    assert [progress.record(level).answers for level in after] == [(("Who?", e),) for e in before]
    assert [progress.newest(level) for level in before[:3]] == [None] * 3
    assert progress.fact("level") == "12-power-line"


def test_a_step_of_migration_is_done_wholly_or_not_at_all(file: Path) -> None:
    Progress(file, pytest.fail).keep("level", "text")
    step = ("ALTER TABLE level ADD COLUMN stars INTEGER", "UPDATE version SET text = text || '!'")
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        with pytest.raises(sqlite3.OperationalError, match="nonsense"):
            prepare(connection, (*MIGRATIONS, (*step, "nonsense")))
        assert connection.execute("SELECT text FROM version").fetchall() == [("text",)]
        prepare(connection, (*MIGRATIONS, step))
        prepare(connection, (*MIGRATIONS, step))
        assert connection.execute("SELECT text FROM version").fetchall() == [("text!",)]
        assert connection.execute("SELECT stars FROM level").fetchall() == [(None,)]
