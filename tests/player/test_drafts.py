"""Drafts survive everything and belong to one session at a time."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.player.drafts import OLD_DRAFTS_KEPT, Draft, Drafts, Key, Kind
from tests.waiting import PATIENCE, until

MINE: Key = ("program", "/p/mine.l")
ANOTHER = """
import os, signal, sys, time
from pathlib import Path
from logical_robots_tui.player.drafts import Draft, Drafts
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup has its children ignore it
folder, text, how = Path(sys.argv[1]), *sys.argv[2:]
drafts = Drafts(folder)
drafts.keep(Draft("program", "mine", "/p/mine.l", text))
is_silent = how == "forks" and os.fork()
if not is_silent:
    print("kept", flush=True)
if how == "forks":
    os.close(1)
for number in range(10**9 if how == "writes" else 0):
    drafts.keep(Draft("program", "mine", "/p/mine.l", str(number) * 5000))
time.sleep(60)
"""


def draft(text: str, path: str = "/p/mine.l") -> Draft:
    return Draft("program", "mine", path, text)


def left(folder: Path, *drafts: Draft) -> None:
    """Drafts that a session kept which has ended."""
    with closing(Drafts(folder)) as session:
        for unsaved in drafts:
            session.keep(unsaved)


def offered(folder: Path, kind: Kind = "program") -> list[str]:
    with closing(Drafts(folder)) as session:
        return [kept.text for kept in session.adopt(kind)]


@contextmanager
def another_process(folder: Path, text: str, how: str = "waits") -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", ANOTHER, str(folder), text, how]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "kept\n"
        try:
            yield process
        finally:
            process.kill()


def test_what_a_session_kept_is_adopted_by_the_next(tmp_path: Path) -> None:
    left(tmp_path, draft("hello"))
    second = Drafts(tmp_path)
    [kept] = second.adopt("program")
    assert kept == Draft("program", "mine", "/p/mine.l", "hello", kept.saved)
    assert second.get(MINE) is None
    assert second.take(MINE) == kept
    assert second.take(MINE) is None
    assert second.get(MINE) == kept
    assert offered(tmp_path) == []
    second.close()


def test_kinds_of_one_path_are_kept_apart(tmp_path: Path) -> None:
    with closing(Drafts(tmp_path)) as session:
        for kind in get_args(Kind):
            session.keep(Draft(kind, "mine", "/p/same", f"a {kind}"))
        session.drop(("level", "/p/same"))
    assert offered(tmp_path, "place") == ["a place"]
    assert offered(tmp_path) == ["a program"]
    assert offered(tmp_path, "level") == []


def test_the_draft_kept_last_comes_first_whatever_the_clock_says(tmp_path: Path) -> None:
    late, early = (datetime(year, 1, 1, tzinfo=UTC) for year in (2040, 2020))
    for text, saved in (("older", late), ("newest", early)):
        mine = Draft("program", "mine", "/p/mine.l", text, saved)
        left(tmp_path, mine, Draft("program", text, f"/p/{text}.l", text, saved))
    with closing(Drafts(tmp_path)) as session:
        kept = session.adopt("program")
    assert [unsaved.text for unsaved in kept] == ["newest", "newest", "older", "older"]
    assert [unsaved.path for unsaved in kept][:2] == ["/p/newest.l", "/p/mine.l"]


def test_what_was_adopted_and_not_taken_is_there_for_the_next(tmp_path: Path) -> None:
    left(tmp_path, draft("hello"))
    with closing(Drafts(tmp_path)) as second:
        second.adopt("program")
        second.drop(MINE)
    with closing(Drafts(tmp_path)) as third:
        assert [kept.text for kept in third.adopt("program")] == ["hello"]
        third.keep(draft("typed meanwhile"))
        assert third.take(MINE) == third.get(MINE)
    assert "typed meanwhile" in "".join(p.read_text() for p in (tmp_path / "old").iterdir())


PATHS = st.text(st.characters(blacklist_characters="\0"))


@settings(deadline=None)
@given(st.builds(Draft, st.sampled_from(get_args(Kind)), st.text(), PATHS, st.text()))
def test_any_text_comes_back_whole(tmp_path_factory: pytest.TempPathFactory, kept: Draft) -> None:
    folder = tmp_path_factory.mktemp("drafts")
    left(folder, kept)
    with closing(Drafts(folder)) as session:
        assert session.adopt(kept.kind) == [kept]


def test_a_session_alive_keeps_its_own_and_a_killed_one_leaves_it(tmp_path: Path) -> None:
    with closing(Drafts(tmp_path)) as session:
        with another_process(tmp_path, "typed"):
            assert session.adopt("program") == []
        assert [kept.text for kept in session.adopt("program")] == ["typed"]


def test_a_child_that_a_session_forked_does_not_hold_its_drafts(tmp_path: Path) -> None:
    with another_process(tmp_path, "typed", "forks"):
        pass
    assert offered(tmp_path) == ["typed"]


def test_two_sessions_at_once_do_not_take_from_each_other(tmp_path: Path) -> None:
    with closing(Drafts(tmp_path)) as first, closing(Drafts(tmp_path)) as second:
        first.keep(draft("one"))
        second.keep(draft("two"))
        assert first.adopt("program") == second.adopt("program") == []
    assert offered(tmp_path) == ["two", "one"]


def test_dropped_and_put_away_drafts_are_not_offered_again(tmp_path: Path) -> None:
    with closing(Drafts(tmp_path)) as session:
        session.keep(draft("a"))
        session.drop(MINE)
    assert list(tmp_path.iterdir()) == []
    with closing(Drafts(tmp_path)) as session:
        late = session.next_turn()
        session.keep(draft("a"))
        session.drop(MINE)
        session.keep(draft("b", "/p/other.l"))
        session.keep(draft("late"), late)  # was made before the drop, written after it
    with closing(Drafts(tmp_path)) as other:
        assert [kept.text for kept in other.adopt("program")] == ["b"]
        other.put_away(draft("b", "/p/other.l"))
    assert offered(tmp_path) == []
    [old] = (tmp_path / "old").iterdir()
    assert json.loads(old.read_text())["text"] == "b"


def test_only_so_many_old_drafts_stay(tmp_path: Path) -> None:
    for number in range(OLD_DRAFTS_KEPT + 5):
        left(tmp_path, draft(f"text {number}"))
        with closing(Drafts(tmp_path)) as session:
            session.adopt("program")
            session.put_away(draft(f"text {number}"))
    texts = [json.loads(p.read_text())["text"] for p in (tmp_path / "old").iterdir()]
    assert len(texts) == OLD_DRAFTS_KEPT
    assert "text 0" not in texts
    assert f"text {OLD_DRAFTS_KEPT + 4}" in texts


def test_a_file_that_is_not_a_draft_is_put_away(tmp_path: Path) -> None:
    contents = (b"", b"{", b"[]", b'{"text": 1}', b"\xff\xfe\0", b"null", b"[" * 200_000)
    for number, rubbish in enumerate(contents):
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "2020-x.json").write_bytes(rubbish)
        assert offered(folder) == []
        assert len(list((folder / "old").iterdir())) == 1


def test_what_could_not_be_written_is_written_when_it_can_be(tmp_path: Path) -> None:
    drafts = Drafts(tmp_path / "file")
    (tmp_path / "file").write_text("in the way")
    for text in ("one", "another"):
        with pytest.raises(OSError, match="file"):
            drafts.keep(draft(text))
    [(unwritten, error)] = drafts.unwritten()
    assert unwritten.text == "another"
    assert error.strerror
    with pytest.raises(OSError, match="file"):
        drafts.keep(draft("not wanted any more", "/p/other.l"))
    drafts.drop(("program", "/p/other.l"))
    assert [lost.text for lost, _ in drafts.unwritten()] == ["another"]
    (tmp_path / "file").unlink()
    assert drafts.unwritten() == []
    drafts.close()
    assert offered(tmp_path / "file") == ["another"]


def test_a_disk_that_lets_nothing_be_moved_keeps_all_and_raises_nothing(tmp_path: Path) -> None:
    left(tmp_path, draft("first", "/p/first.l"), draft("second", "/p/second.l"))
    (tmp_path / "old").write_text("in the way")
    drafts = Drafts(tmp_path)
    assert len(drafts.adopt("program")) == 2
    drafts.put_away(draft("first", "/p/first.l"))
    second: Key = ("program", "/p/second.l")
    drafts._file(second).mkdir()  # and in the way of what is taken
    taken = drafts.take(second)
    assert taken is not None
    assert taken.text == "second"
    assert [lost.path for lost, _ in drafts.unwritten()] == ["/p/second.l"]
    drafts.close()
    drafts._file(second).rmdir()
    (tmp_path / "old").unlink()
    assert {*offered(tmp_path)} == {"first", "second"}


def test_a_session_ends_though_what_it_wrote_can_not_be_removed(tmp_path: Path) -> None:
    drafts = Drafts(tmp_path)
    drafts.keep(draft("mine"))
    for file in tmp_path.iterdir():
        file.unlink()
        file.mkdir()  # which can't be unlinked
    drafts.drop(MINE)
    drafts.close()
    assert drafts.get(MINE) is None


def test_an_earlier_text_does_not_replace_a_later_one_nor_do_many_threads(tmp_path: Path) -> None:
    session, late = Drafts(tmp_path), draft("late")
    turn = session.next_turn()
    session.keep(late)
    session.keep(draft("early"), turn)
    assert session.get(MINE) == late
    assert "late" in str([file.read_text() for file in tmp_path.glob("*.json")])
    drafts = [draft(f"text {number}") for number in range(40)]
    threads = [
        threading.Thread(target=session.keep, args=(text, session.next_turn())) for text in drafts
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    session.close()
    assert offered(tmp_path) == ["text 39"]


GENTLER = [pytest.param(kill, marks=pytest.mark.slow) for kill in (signal.SIGTERM, signal.SIGHUP)]


@pytest.mark.parametrize("kill", [signal.SIGKILL, *GENTLER])
def test_one_killed_writing_leaves_a_whole_draft(tmp_path: Path, kill: signal.Signals) -> None:
    with another_process(tmp_path, "x", "writes") as process:
        until(lambda: any(p.stat().st_size > 5000 for p in tmp_path.glob("*.json")))
        process.send_signal(kill)
        assert process.wait(PATIENCE) == -kill
    with closing(Drafts(tmp_path)) as session:
        [kept] = session.adopt("program")
        assert kept.text == kept.text[: len(kept.text) // 5000] * 5000
        assert {p.suffix for p in tmp_path.iterdir()} == {".json", ".lock"}


def test_who_has_ended_neither_holds_nor_takes_what_it_left(tmp_path: Path) -> None:
    first = Drafts(tmp_path)
    first.keep(draft("text"))
    assert first._lock is not None
    inherited = os.dup(first._lock)  # as of a process between its fork and its exec
    first.close()
    assert first.adopt("program") == []  # as a thread does that is late
    assert offered(tmp_path) == ["text"]
    os.close(inherited)
