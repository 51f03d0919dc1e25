"""A file is always either the old or the new one."""

import fcntl
import os
import threading
from pathlib import Path

import pytest

from logical_robots_tui.paths import write_atomically
from tests.waiting import PATIENCE


def test_a_file_is_replaced_and_keeps_its_permissions(tmp_path: Path) -> None:
    file = tmp_path / "mine.l"
    write_atomically(file, "one\r\n")
    assert file.read_bytes() == b"one\r\n"
    file.chmod(0o600)
    write_atomically(file, b"\xff")
    assert file.read_bytes() == b"\xff"
    assert file.stat().st_mode & 0o777 == 0o600
    assert list(tmp_path.iterdir()) == [file]


def test_a_new_file_is_as_private_as_the_player_s_files_are(tmp_path: Path) -> None:
    usual = os.umask(0o077)
    try:
        write_atomically(tmp_path / "mine.l", "one")
    finally:
        os.umask(usual)
    assert (tmp_path / "mine.l").stat().st_mode & 0o777 == 0o600


def test_a_link_goes_on_leading_to_its_file(tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    file, link = tmp_path / "elsewhere" / "mine.l", tmp_path / "mine.l"
    link.symlink_to("elsewhere/mine.l")
    for text in ("one", "another"):  # the first makes the file
        write_atomically(link, text)
        assert link.is_symlink()
        assert file.read_text() == text


def test_what_is_not_a_file_is_written_to(tmp_path: Path) -> None:
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_atomically(pipe, "one")
    reader.join(PATIENCE)
    assert read == ["one"]
    assert pipe.is_fifo()


def test_a_folder_is_left_alone(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=tmp_path.name):
        write_atomically(tmp_path, "one")
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_write_left_is_swept_by_the_next(tmp_path: Path) -> None:
    file = tmp_path / "mine.l"
    write_atomically(file, "one")
    left = [tmp_path / ".mine.l.0123abcd", tmp_path / ".other.l.0123abcd"]
    held, hidden = tmp_path / ".mine.l.4567cdef", tmp_path / ".mine.l.swp"
    for each in (*left, held, hidden):
        each.write_text("half of i")
    with held.open() as somebody:
        fcntl.flock(somebody, fcntl.LOCK_EX)  # as long as it writes
        write_atomically(file, "another")
    assert not left[0].exists()
    assert {left[1], held, hidden, file} == {*tmp_path.iterdir()}
    write_atomically(tmp_path / "other.l", "one")
    assert {hidden, file, tmp_path / "other.l"} == {*tmp_path.iterdir()}
