"""The file of progress: shared, killed, damaged, old, new, and on disks that are of no use."""

import contextlib
import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

from logical_robots_tui.progress import Progress
from logical_robots_tui.progress import store as store_module
from logical_robots_tui.progress.store import APPLICATION_ID, MIGRATIONS, PROGRESS, prepare
from tests.waiting import PATIENCE, until

WRITE_MANY = """
import sys
from pathlib import Path
from logical_robots_tui.progress import Progress
progress = Progress(Path(sys.argv[1]), sys.exit)
for number in range(int(sys.argv[3])):
    progress.keep("level", f"{sys.argv[2]} {number}")
    print(number, flush=True)
"""
DIE_HALFWAY = """
import sqlite3, sys
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute("PRAGMA cache_size = 1")
connection.execute("BEGIN IMMEDIATE")
for number in range(300):
    connection.execute(
        "INSERT INTO version (level, digest, text, turn, kept) VALUES ('half', ?, ?, 1, '')",
        (str(number), "x" * 4000),
    )
print("halfway", flush=True)
sys.stdin.read()
"""
FULL = """
import resource, sys
from pathlib import Path
from logical_robots_tui.progress import Progress
messages = []
progress = Progress(Path(sys.argv[1]), messages.append)
progress.keep("level", "before")
size = Path(sys.argv[1]).stat().st_size
resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
for number in range(4):
    progress.keep("level", str(number) * 100_000)
assert [v.text[:6] for v in progress.versions("level")] == [
    "333333", "222222", "111111", "000000", "before"]
assert not progress.is_kept
print(*messages, sep="\\n")
"""
UNSAVED = "Your progress can't be saved: {}. The game continues without saving it."


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "progress.sqlite"


@pytest.fixture
def told() -> list[str]:
    return []


@contextlib.contextmanager
def running(script: str, *arguments: object) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", script, *map(str, arguments)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def output(process: subprocess.Popen[str]) -> IO[str]:
    assert process.stdout is not None
    return process.stdout


def kept(file: Path) -> set[str]:
    with contextlib.closing(Progress(file, pytest.fail)) as progress:
        return {version.text for version in progress.versions("level")}


def execute(file: Path, statement: str) -> list[tuple[object, ...]]:
    with contextlib.closing(sqlite3.connect(file)) as connection:
        return connection.execute(statement).fetchall()


def is_whole(file: Path) -> bool:
    return execute(file, "PRAGMA integrity_check") == [("ok",)]


def aside(file: Path) -> list[Path]:
    return sorted(file.parent.glob("progress-damaged-*.sqlite"))


def test_two_games_write_at_once_and_nothing_is_lost(file: Path) -> None:
    with running(WRITE_MANY, file, "a", 40) as one, running(WRITE_MANY, file, "b", 40) as two:
        assert (one.wait(60), two.wait(60)) == (0, 0)
    assert kept(file) == {f"{who} {number}" for who in "ab" for number in range(40)}
    assert is_whole(file)


@pytest.mark.sampled
@pytest.mark.parametrize("lines", [1, 5, 11])
def test_what_was_written_before_a_kill_is_there_in_a_whole_file(file: Path, lines: int) -> None:
    with running(WRITE_MANY, file, "a", 100_000) as process:
        numbers = [output(process).readline().strip() for _ in range(lines)]
        process.kill()
        numbers += output(process).read().split()
    assert {f"a {number}" for number in numbers} <= kept(file)
    assert is_whole(file)


def test_half_a_transaction_of_a_killed_game_is_undone(file: Path) -> None:
    Progress(file, pytest.fail).keep("level", "before")
    with running(DIE_HALFWAY, file) as process:
        assert output(process).readline() == "halfway\n"
        assert file.stat().st_size > 500_000, "it was to be written to the file already"
        process.kill()
    progress = Progress(file, pytest.fail)
    progress.keep("level", "after")
    assert {version.text for version in progress.versions("level")} == {"before", "after"}
    assert progress.versions("half") == []
    assert is_whole(file)


def database(script: str) -> bytes:
    with contextlib.closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(script)
        return connection.serialize()


CONTENTS = {
    "garbage": b"garbage",
    "zeros": b"\0" * 5000,
    "header": b"SQLite format 3\0" + b"\xff" * 5000,
    "noise": os.urandom(8192),
    "of somebody else": database("CREATE TABLE version (mine)"),
}


@pytest.mark.parametrize("name", CONTENTS)
def test_a_file_that_is_not_ours_is_set_aside(file: Path, told: list[str], name: str) -> None:
    file.write_bytes(CONTENTS[name])
    progress = Progress(file, told.append)
    assert progress.newest("level") is None
    progress.keep("level", "text")
    assert kept(file) == {"text"}
    (former,) = aside(file)
    assert former.read_bytes() == CONTENTS[name]
    (message,) = told
    assert former.name in message
    assert progress.is_kept


def test_a_database_that_breaks_while_it_is_open_is_set_aside(file: Path, told: list[str]) -> None:
    progress = Progress(file, told.append)
    for number in range(50):
        progress.keep("level", f"{number}" * 2000)
    content = file.read_bytes()
    with file.open("r+b") as handle:
        handle.seek(4096)
        handle.write(b"\xee" * (len(content) - 4096))
    execute(file, "PRAGMA user_version = 1")  # so that caches are dropped
    progress.keep("level", "after")
    progress.close()
    assert kept(file) == {"after"}
    assert len(aside(file)) == len(told) == 1


def test_two_games_that_find_damage_at_once_set_it_aside_once(file: Path, told: list[str]) -> None:
    one, two = Progress(file, told.append), Progress(file, told.append)
    one.keep("level", "lost")
    assert two.newest("level") == "lost"
    file.write_bytes(b"garbage" * 1000)
    one.keep("level", "first")
    two.keep("level", "second")
    assert kept(file) == {"first", "second"}
    assert len(aside(file)) == len(told) == 1


def test_an_empty_file_is_filled_a_removed_one_made_anew_and_both_signed(file: Path) -> None:
    file.touch()
    progress = Progress(file, pytest.fail)
    progress.keep("level", "one")
    assert kept(file) == {"one"}
    assert file.read_bytes()[68:72] == APPLICATION_ID.to_bytes(4, "big") == b"LROB"
    file.unlink()
    assert progress.newest("level") is None
    progress.keep("level", "two")
    assert kept(file) == {"two"}


def test_a_file_of_a_newer_version_is_left_alone_and_told_of(file: Path, told: list[str]) -> None:
    Progress(file, pytest.fail).keep("level", "text")
    execute(file, f"PRAGMA user_version = {len(MIGRATIONS) + 1}")
    before = file.read_bytes()
    progress = Progress(file, told.append)
    progress.keep("level", "mine")
    assert progress.newest("level") == "mine"
    assert file.read_bytes() == before
    assert aside(file) == []
    (message,) = told
    assert "newer version of the game" in message


def test_a_full_disk_is_told_once_and_the_game_goes_on(file: Path) -> None:
    with running(FULL, file) as process:
        (told,) = output(process).read().splitlines()
        assert process.wait(PATIENCE) == 0
    before, after = UNSAVED.split("{}")
    assert told.startswith(before)
    assert told.endswith(after)
    assert kept(file) == {"before"}
    assert is_whole(file)


def test_a_database_that_may_not_grow_is_a_full_disk(file: Path, told: list[str]) -> None:
    progress = Progress(file, told.append)
    progress.keep("level", "before")
    assert progress._connection is not None
    progress._connection.execute("PRAGMA max_page_count = 1")  # it takes the present size for it
    for letter in "xy":
        progress.keep("level", letter * 100_000)
    assert [version.text[0] for version in progress.versions("level")] == ["y", "x", "b"]
    assert told == [UNSAVED.format("the disk is full")]
    assert kept(file) == {"before"}


def test_a_folder_that_can_not_be_made_is_told_once(told: list[str]) -> None:
    for number, folder in enumerate(("/proc/nowhere", "/dev/null"), 1):
        progress = Progress(Path(folder) / "progress.sqlite", told.append)
        assert progress.newest("level") is None
        progress.keep("level", "text")
        progress.begin("other")
        assert progress.newest("level") == "text"
        assert len(told) == number


def test_a_file_that_can_only_be_read_shows_what_it_holds(
    file: Path, told: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    Progress(file, pytest.fail).keep("level", "before")
    # For root no file is read-only, so SQLite is asked to treat it so.
    connect = store_module._connect

    def connect_to_read(name: str, uri: bool = False) -> sqlite3.Connection:
        if uri or name == ":memory:":
            return connect(name, uri=uri)
        return connect(f"{Path(name).as_uri()}?mode=ro", uri=True)

    monkeypatch.setattr(store_module, "_connect", connect_to_read)
    progress = Progress(file, told.append)
    assert progress.newest("level") == "before"
    progress.keep("level", "after")
    assert progress.newest("level") == "after"
    progress.keep("level", "again")
    assert progress.record("level").versions == 3
    assert told == [UNSAVED.format("it is read-only")]


@pytest.mark.skipif(os.geteuid() == 0, reason="for root no folder is read-only")
def test_a_folder_that_is_read_only_shows_what_its_file_holds(file: Path, told: list[str]) -> None:
    Progress(file, pytest.fail).keep("level", "before")
    file.with_suffix(".lock").unlink()
    file.parent.chmod(0o555)
    try:
        progress = Progress(file, told.append)
        progress.keep("level", "after")
        assert progress.newest("level") == "after"
        assert progress.record("level").versions == 2
    finally:
        file.parent.chmod(0o755)
    assert len(told) == 1


def test_a_file_that_another_program_will_not_let_go_is_told_once(
    file: Path, told: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store_module, "BUSY_SECONDS", 0.05)
    Progress(file, pytest.fail).keep("level", "before")
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as hog:
        hog.execute("BEGIN EXCLUSIVE")
        progress = Progress(file, told.append)
        progress.keep("level", "after")
        progress.keep("level", "again")
        assert progress.newest("level") == "again"
        assert len(told) == 1
        assert "another program is using it" in told[0]
        assert aside(file) == []


def test_a_write_waits_for_its_turn(file: Path) -> None:
    Progress(file, pytest.fail).keep("level", "before")
    with running(WRITE_MANY, file, "a", 1) as waiting:

        def has_it_open() -> bool:
            with contextlib.suppress(OSError):
                handles = Path(f"/proc/{waiting.pid}/fd").iterdir()
                return any(handle.resolve() == file.resolve() for handle in handles)
            return False

        with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE")
            until(has_it_open)
            other.execute("COMMIT")
        assert waiting.wait(30) == 0
    assert kept(file) == {"before", "a 0"}


VERSION_1 = Path(__file__).parent / "version-1.sql"


def test_a_file_of_the_first_version_is_brought_up_to_date(file: Path) -> None:
    with contextlib.closing(sqlite3.connect(file)) as connection:
        connection.executescript(VERSION_1.read_text("utf-8"))
    assert execute(file, "PRAGMA user_version") == [(1,)]
    progress = Progress(file, pytest.fail)
    record = progress.record("01-first-steps")
    assert (record.state, record.hints, record.versions) == ("won", 2, 2)
    assert (record.bests.ticks, record.bests.size, record.bests.wins) == (1255, 2, 19)
    assert (record.bests.rules, record.bests.goals) == (1, ())
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
def test_records_follow_renamed_levels(file: Path, steps: int, moved: dict[str, str]) -> None:
    last = [*moved][1]
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        prepare(connection, PROGRESS._replace(migrations=MIGRATIONS[:steps]))
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
    broken = PROGRESS._replace(migrations=(*MIGRATIONS, (*step, "nonsense")))
    longer = PROGRESS._replace(migrations=(*MIGRATIONS, step))
    with contextlib.closing(sqlite3.connect(file, isolation_level=None)) as connection:
        with pytest.raises(sqlite3.OperationalError, match="nonsense"):
            prepare(connection, broken)
        assert connection.execute("SELECT text FROM version").fetchall() == [("text",)]
        prepare(connection, longer)
        prepare(connection, longer)
        assert connection.execute("SELECT text FROM version").fetchall() == [("text!",)]
        assert connection.execute("SELECT stars FROM level").fetchall() == [(None,)]
