"""Files of earlier versions are brought up to date, wholly or not at all."""

import contextlib
import sqlite3
from pathlib import Path

import pytest

from logical_robots_tui.progress import Progress
from logical_robots_tui.progress.store import MIGRATIONS, prepare
from tests.progress.test_store import execute, file

__all__ = ["file"]

VERSION_1 = Path(__file__).parent / "version-1.sql"


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
    assert progress.record("02-open-space").state == "started"
    assert progress.newest("01-first-steps") == "Robot(later);"
    assert progress.fact("tour") == "seen"
    progress.keep("02-open-space", "new")
    assert execute(file, "PRAGMA user_version") == [(len(MIGRATIONS),)]


ARENA = "/opt/levels/arenas/{}.toml"
OWN = "/home/ada/09-the-gate.toml"
MOVED_FIRST = {
    "09-the-gate": "11-the-gate",
    "11-power-line": "12-power-line",
    "12-swarm": "13-swarm",
    ARENA.format("13-high-ground"): ARENA.format("16-high-ground"),
    "10-distributed-mapping": "10-distributed-mapping",
    OWN: OWN,
}
MOVED_NEXT = {
    ARENA.format("14-high-ground"): ARENA.format("16-high-ground"),
    ARENA.format("15-four-doors"): ARENA.format("17-four-doors"),
    ARENA.format("16-low-voltage"): ARENA.format("18-low-voltage"),
    "11-the-gate": "11-the-gate",
}


@pytest.mark.parametrize(("steps", "moved"), [(5, MOVED_FIRST), (6, MOVED_NEXT)])
def test_records_follow_levels_to_new_numbers(
    file: Path, steps: int, moved: dict[str, str]
) -> None:
    last = [*moved][1]
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        prepare(connection, MIGRATIONS[:steps])
        for level in moved:
            connection.execute("INSERT INTO level (name, hints) VALUES (?, 1)", (level,))
            connection.execute(
                "INSERT INTO version (level, digest, text, turn, kept) VALUES (?, '', ?, 1, '')",
                (level, level),
            )
            connection.execute("INSERT INTO answer VALUES (?, 'Who?', ?)", (level, level))
        connection.execute("INSERT INTO fact VALUES ('level', ?)", (last,))
    progress = Progress(file, pytest.fail)
    for before, now in moved.items():
        assert progress.newest(now) == before
        assert progress.record(now).hints == 1
        assert progress.record(now).answers == (("Who?", before),)
        assert before in moved.values() or progress.newest(before) is None
    assert progress.fact("level") == moved[last]


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
