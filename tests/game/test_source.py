"""Program texts: found by name or path, refused in plain words, written whole, as all files are."""

import fcntl
import os
import shlex
import threading
from pathlib import Path
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program, save_program
from logical_robots_tui.game.source import target
from logical_robots_tui.paths import (
    is_file,
    is_folder,
    is_there,
    pasted_path,
    real,
    typed_path,
    write_atomically,
)
from tests.waiting import PATIENCE


def test_a_program_is_found_by_its_path_or_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "mine.l"
    path.write_bytes("# Zoë\r\nA(1);\n".encode())
    source = load_program(path)
    assert (source.name, source.text, source.shipped) == ("mine", "# Zoë\nA(1);\n", False)
    assert load_program(list_programs()[0]).shipped

    save_program(tmp_path / "zz-mine.l", "A(1);")  # listed after the shipped ones
    assert list_programs(tmp_path)[-1] == "zz-mine"
    assert load_program("zz-mine", tmp_path).text == "A(1);"


def test_what_is_not_a_program_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.l"
    for content, words in (
        (b"\x7fELF\x00\x00", "binary file"),
        (b"A(1);\nB(\xff);", "line 2 is not UTF-8"),
        (b"x" * 1_000_001, "larger than 1 MB"),
        (b"\n" * 1_000_000, "1,000,000 characters, more than the 200,000"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=words):
            load_program(path)
    no_program = "There is no such program"
    for name, words in ((".", "is a folder"), ("none.l", no_program), ("x" * 300, "can't be read")):
        with pytest.raises(InputError, match=words):
            load_program(tmp_path / name)


def test_a_pipe_is_waited_for_only_by_who_says_so(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.l"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="is not a regular file"):
        load_program(pipe)
    with pytest.raises(InputError, match="There is no such program"):
        load_program("pipe", tmp_path)
    with pytest.raises(InputError, match="is not a regular file"):
        target("pipe", tmp_path)
    writer = threading.Thread(target=pipe.write_text, args=("A(1);",))
    writer.start()
    assert load_program(pipe, pipes=True).text == "A(1);"
    writer.join(PATIENCE)


def test_a_name_that_there_is_not_is_refused_with_a_suggestion(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="There is no such program"):
        load_program("none", tmp_path / ("x" * 300))
    save_program(tmp_path / "wanderer.l", "A(1);")
    with pytest.raises(InputError, match=r"Did you mean .wanderer."):
        load_program("wandrer", tmp_path)


def test_saving_replaces_the_file_in_one_step_or_says_why_it_can_not(tmp_path: Path) -> None:
    path = tmp_path / "new" / "mine.l"
    save_program(path, "A(1);")
    path.chmod(0o600)
    save_program(path, "A(2);")
    assert path.read_text() == "A(2);"
    assert path.stat().st_mode & 0o777 == 0o600
    assert [*path.parent.iterdir()] == [path]
    with pytest.raises(InputError, match="can't be written"):
        save_program(path / "mine.l", "A(1);")


OUT_OF_REACH = "x" * 300  # for root, too: longer than the name of a file can be


def test_what_is_out_of_reach_is_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / OUT_OF_REACH, tmp_path / OUT_OF_REACH / "mine.l", tmp_path / "none"):
        assert [is_there(path), is_file(path), is_folder(path)] == [False] * 3
    assert is_folder(tmp_path)
    with pytest.raises(InputError, match="is a folder"):
        target("/", tmp_path)
    (tmp_path / "mine.l").touch()
    assert is_file(tmp_path / "mine.l")
    assert is_there(tmp_path / "mine.l")


NAMES = st.text(st.characters(exclude_characters="/\0", exclude_categories=["C", "Z"]), min_size=1)


@given(st.lists(NAMES | st.just("a b"), min_size=1), st.sampled_from(["quoted", "address"]))
def test_a_pasted_path_is_read_as_what_was_dropped(names: list[str], form: str) -> None:
    path = "/" + "/".join(names)
    pasted = shlex.quote(path) if form == "quoted" else f"file://{quote(path)}"
    assert pasted_path(f"{pasted} ") == path


def test_a_file_whose_name_holds_quotes_is_opened_as_typed(tmp_path: Path) -> None:
    file = tmp_path / "'mine'.l"
    file.touch()
    assert pasted_path(str(file)) == str(file)
    assert pasted_path(str(tmp_path / "'other'.l")) == str(tmp_path / "other.l")


@given(st.text())
def test_what_is_not_a_path_is_left_alone(text: str) -> None:
    if "/" not in text:
        assert pasted_path(text) == text.strip()


def test_what_can_be_no_path_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert typed_path("~/mine.l") == tmp_path / "mine.l"
    with pytest.raises(InputError, match="no such home"):
        typed_path("~nobody-of-that-name/mine.l")
    with pytest.raises(InputError, match="is not a valid path"):
        typed_path("/tmp/mine\0.l")
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    here.rmdir()
    with pytest.raises(InputError, match="no longer exists"):
        target("./mine.l", tmp_path)


def test_a_file_keeps_its_permissions_and_a_new_one_is_as_private_as_others(tmp_path: Path) -> None:
    file, private = tmp_path / "mine.l", tmp_path / "private.l"
    write_atomically(file, "one\r\n")
    assert file.read_bytes() == b"one\r\n"
    file.chmod(0o640)
    write_atomically(file, b"\xff")
    assert file.read_bytes() == b"\xff"
    assert file.stat().st_mode & 0o777 == 0o640
    assert list(tmp_path.iterdir()) == [file]
    usual = os.umask(0o077)
    try:
        write_atomically(private, "one")
    finally:
        os.umask(usual)
    assert private.stat().st_mode & 0o777 == 0o600


def test_a_link_goes_on_leading_to_its_file_and_links_in_a_circle_somewhere(tmp_path: Path) -> None:
    (tmp_path / "round.l").symlink_to(tmp_path / "round.l")
    assert real(tmp_path / "round.l") == tmp_path / "round.l"
    assert target(f"{tmp_path}/round.l", tmp_path) == tmp_path / "round.l"
    (tmp_path / "elsewhere").mkdir()
    file, link = tmp_path / "elsewhere" / "mine.l", tmp_path / "mine.l"
    link.symlink_to("elsewhere/mine.l")
    for text in ("one", "another"):  # the first makes the file
        write_atomically(link, text)
        assert link.is_symlink()
        assert file.read_text() == text


def test_a_pipe_is_written_to_and_a_folder_left_alone(tmp_path: Path) -> None:
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_atomically(pipe, "one")
    reader.join(PATIENCE)
    assert read == ["one"]
    assert pipe.is_fifo()
    with pytest.raises(OSError, match=tmp_path.name):
        write_atomically(tmp_path, "one")
    assert list(tmp_path.iterdir()) == [pipe]


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
