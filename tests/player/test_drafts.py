"""Drafts survive everything and belong to one session at a time."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.player.drafts import OLD_DRAFTS_KEPT, Draft, Drafts, Kind
from tests.waiting import PATIENCE, until

HOLD = """
import sys, time
from pathlib import Path
from logical_robots_tui.player.drafts import Draft, Drafts
drafts = Drafts(Path(sys.argv[1]))
drafts.keep(Draft("program", "mine", "/p/mine.l", sys.argv[2]))
if "fork" in sys.argv:
    import os
    if os.fork() == 0:
        print("kept", flush=True)
        os.close(1)
    time.sleep(60)
print("kept", flush=True)
time.sleep(60)
"""


def draft(text: str, path: str = "/p/mine.l") -> Draft:
    return Draft("program", "mine", path, text)


def left(folder: Path, *drafts: Draft) -> None:
    """Drafts that a session kept which has ended."""
    session = Drafts(folder)
    for each in drafts:
        session.keep(each)
    session.close()


def offered(folder: Path, kind: Kind = "program") -> list[str]:
    """The texts that the next session adopts."""
    session = Drafts(folder)
    texts = [kept.text for kept in session.adopt(kind)]
    session.close()
    return texts


def held_by_another_process(folder: Path, text: str, *more: str) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(folder), text, *more], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "kept\n"
    return process


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait(PATIENCE)
    assert process.stdout is not None
    process.stdout.close()


def test_what_a_session_kept_is_adopted_by_the_next(tmp_path: Path) -> None:
    left(tmp_path, draft("hello"))
    second = Drafts(tmp_path)
    [kept] = second.adopt("program")
    assert kept == Draft("program", "mine", "/p/mine.l", "hello", kept.saved)
    assert second.get(("program", "/p/mine.l")) is None
    assert second.take(("program", "/p/mine.l")) == kept
    assert second.take(("program", "/p/mine.l")) is None
    assert second.get(("program", "/p/mine.l")) == kept
    assert offered(tmp_path) == []
    second.close()


def test_kinds_of_one_path_are_kept_apart(tmp_path: Path) -> None:
    session = Drafts(tmp_path)
    for kind in get_args(Kind):
        session.keep(Draft(kind, "mine", "/p/same", f"a {kind}"))
    session.drop(("level", "/p/same"))
    session.close()
    assert offered(tmp_path, "place") == ["a place"]
    assert offered(tmp_path) == ["a program"]
    assert offered(tmp_path, "level") == []


def test_the_draft_kept_last_is_the_newest_and_comes_first_whatever_the_clock_says(
    tmp_path: Path,
) -> None:
    late, early = (datetime(year, 1, 1, tzinfo=UTC) for year in (2040, 2020))
    for text, saved in (("older", late), ("newest", early)):
        mine = Draft("program", "mine", "/p/mine.l", text, saved)
        left(tmp_path, mine, Draft("program", text, f"/p/{text}.l", text, saved))
    session = Drafts(tmp_path)
    kept = session.adopt("program")
    session.close()
    assert [each.text for each in kept] == ["newest", "newest", "older", "older"]
    assert [each.path for each in kept][:2] == ["/p/newest.l", "/p/mine.l"]


def test_what_was_adopted_and_not_taken_is_there_for_the_next(tmp_path: Path) -> None:
    left(tmp_path, draft("hello"))
    second = Drafts(tmp_path)
    second.adopt("program")
    second.drop(("program", "/p/mine.l"))
    second.close()
    third = Drafts(tmp_path)
    assert [kept.text for kept in third.adopt("program")] == ["hello"]
    third.keep(draft("typed meanwhile"))
    assert third.take(("program", "/p/mine.l")) == third.get(("program", "/p/mine.l"))
    third.close()
    assert "typed meanwhile" in "".join(p.read_text() for p in (tmp_path / "old").iterdir())


@settings(deadline=None)
@given(
    st.sampled_from(get_args(Kind)),
    st.text(),
    st.text(),
    st.text(st.characters(blacklist_characters="\0")),
)
def test_any_text_comes_back_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, kind: Kind, text: str, name: str, path: str
) -> None:
    folder = tmp_path_factory.mktemp("drafts")
    session = Drafts(folder)
    kept = Draft(kind, name, path, text)
    session.keep(kept)
    session.close()
    other = Drafts(folder)
    assert other.adopt(kind) == [kept]
    other.close()


def test_a_session_alive_keeps_its_own_and_a_killed_one_leaves_it(tmp_path: Path) -> None:
    process = held_by_another_process(tmp_path, "typed")
    session = Drafts(tmp_path)
    try:
        assert session.adopt("program") == []
    finally:
        end(process)
    assert [found.text for found in session.adopt("program")] == ["typed"]
    session.close()


def test_a_child_that_a_session_forked_does_not_hold_its_drafts(tmp_path: Path) -> None:
    process = held_by_another_process(tmp_path, "typed", "fork")
    end(process)
    assert offered(tmp_path) == ["typed"]


def test_two_sessions_at_once_do_not_take_from_each_other(tmp_path: Path) -> None:
    first, second = Drafts(tmp_path), Drafts(tmp_path)
    first.keep(draft("one"))
    second.keep(draft("two"))
    assert first.adopt("program") == []
    assert second.adopt("program") == []
    first.close()
    second.close()
    assert offered(tmp_path) == ["two", "one"]


def test_dropped_and_put_away_drafts_are_not_offered_again(tmp_path: Path) -> None:
    session = Drafts(tmp_path)
    late = session.next_turn()
    session.keep(draft("a"))
    session.drop(("program", "/p/mine.l"))
    session.keep(draft("b", "/p/other.l"))
    session.keep(draft("late"), late)  # was made before the drop, written after it
    session.close()
    other = Drafts(tmp_path)
    assert [found.text for found in other.adopt("program")] == ["b"]
    other.put_away(draft("b", "/p/other.l"))
    other.close()
    assert offered(tmp_path) == []
    [old] = (tmp_path / "old").iterdir()
    assert json.loads(old.read_text())["text"] == "b"


def test_an_earlier_draft_does_not_replace_a_later_one(tmp_path: Path) -> None:
    session = Drafts(tmp_path)
    late = draft("late")
    turn = session.next_turn()
    session.keep(late)
    session.keep(draft("early"), turn)
    assert session.get(("program", "/p/mine.l")) == late
    session.close()
    assert offered(tmp_path) == ["late"]


def test_only_so_many_old_drafts_stay(tmp_path: Path) -> None:
    for number in range(OLD_DRAFTS_KEPT + 5):
        left(tmp_path, draft(f"text {number}"))
        session = Drafts(tmp_path)
        session.adopt("program")
        session.put_away(draft(f"text {number}"))
        session.close()
    texts = [json.loads(p.read_text())["text"] for p in (tmp_path / "old").iterdir()]
    assert len(texts) == OLD_DRAFTS_KEPT
    assert "text 0" not in texts
    assert f"text {OLD_DRAFTS_KEPT + 4}" in texts


@pytest.mark.parametrize(
    "rubbish", [b"", b"{", b"[]", b'{"text": 1}', b"\xff\xfe\0", b"null", b"[" * 200_000]
)
def test_a_file_that_is_not_a_draft_is_put_away(tmp_path: Path, rubbish: bytes) -> None:
    (tmp_path / "2020-x.json").write_bytes(rubbish)
    assert offered(tmp_path) == []
    assert len(list((tmp_path / "old").iterdir())) == 1


def test_nothing_is_left_of_a_session_without_drafts(tmp_path: Path) -> None:
    session = Drafts(tmp_path)
    session.keep(draft("a"))
    session.drop(("program", "/p/mine.l"))
    session.close()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    (tmp_path / "drafts").write_text("a file is in the way")
    with pytest.raises(OSError, match="drafts"):
        Drafts(tmp_path / "drafts").keep(draft("a"))


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


def test_a_disk_that_lets_nothing_be_moved_or_removed_keeps_all_and_raises_nothing(
    tmp_path: Path,
) -> None:
    left(tmp_path, draft("first", "/p/first.l"), draft("second", "/p/second.l"))
    (tmp_path / "old").write_text("in the way")
    drafts = Drafts(tmp_path)
    assert len(drafts.adopt("program")) == 2
    drafts.put_away(draft("first", "/p/first.l"))
    drafts._file(("program", "/p/second.l")).mkdir()  # and in the way of what is taken
    taken = drafts.take(("program", "/p/second.l"))
    assert taken is not None
    assert taken.text == "second"
    assert [lost.path for lost, _ in drafts.unwritten()] == ["/p/second.l"]
    drafts.close()
    drafts._file(("program", "/p/second.l")).rmdir()
    (tmp_path / "old").unlink()
    assert {*offered(tmp_path)} == {"first", "second"}


def test_a_session_ends_though_what_it_wrote_can_not_be_removed(tmp_path: Path) -> None:
    drafts = Drafts(tmp_path)
    drafts.keep(draft("mine"))
    for file in tmp_path.iterdir():
        file.unlink()
        file.mkdir()  # which can't be unlinked
    drafts.drop(("program", "/p/mine.l"))
    drafts.close()
    assert drafts.get(("program", "/p/mine.l")) is None


def test_many_threads_leave_the_last_text_on_disk(tmp_path: Path) -> None:
    session = Drafts(tmp_path)
    drafts = [draft(f"text {number}") for number in range(40)]
    threads = [
        threading.Thread(target=session.keep, args=(each, session.next_turn())) for each in drafts
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    session.close()
    assert offered(tmp_path) == ["text 39"]


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGKILL,
        pytest.param(signal.SIGTERM, marks=pytest.mark.slow),
        pytest.param(signal.SIGHUP, marks=pytest.mark.slow),
    ],
)
def test_a_session_killed_while_it_writes_leaves_a_whole_draft(
    tmp_path: Path, number: signal.Signals
) -> None:
    script = HOLD.split("if ")[0] + (
        "import signal\n"
        "signal.signal(signal.SIGHUP, signal.SIG_DFL)\n"  # nohup has its children ignore it
        'print("kept", flush=True)\n'
        "for n in range(10**9):\n"
        '    drafts.keep(Draft("program", "mine", "/p/mine.l", str(n) * 5000))\n'
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path), "x"], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    process.stdout.readline()
    until(lambda: any(p.stat().st_size > 5000 for p in tmp_path.glob("*.json")))
    os.kill(process.pid, number)
    process.wait(PATIENCE)
    process.stdout.close()
    session = Drafts(tmp_path)
    [found] = session.adopt("program")
    count = found.text[: len(found.text) // 5000]
    assert found.text == count * 5000
    assert {p.suffix for p in tmp_path.iterdir()} == {".json", ".lock"}
    session.close()


def test_who_has_ended_neither_holds_nor_takes_what_it_left(tmp_path: Path) -> None:
    first = Drafts(tmp_path)
    first.keep(draft("text"))
    assert first._lock is not None
    inherited = os.dup(first._lock)  # as of a process between its fork and its exec
    first.close()
    assert first.adopt("program") == []  # as a thread does that is late
    assert offered(tmp_path) == ["text"]
    os.close(inherited)
