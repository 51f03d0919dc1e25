"""Program texts: found by name or path, refused in plain words, written whole."""

import os
import threading
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program, save_program
from logical_robots_tui.game.source import target
from tests.waiting import PATIENCE


def test_a_program_is_read_from_a_path(tmp_path: Path) -> None:
    path = tmp_path / "mine.l"
    path.write_bytes("# Zoë\r\nA(1);\n".encode())
    source = load_program(path)
    assert (source.name, source.text, source.shipped) == ("mine", "# Zoë\nA(1);\n", False)
    assert load_program(list_programs()[0]).shipped


def test_own_programs_are_found_by_name_and_listed_after_the_shipped_ones(tmp_path: Path) -> None:
    save_program(tmp_path / "zz-mine.l", "A(1);")
    assert list_programs(tmp_path)[-1] == "zz-mine"
    assert load_program("zz-mine", tmp_path).text == "A(1);"


def test_what_is_not_a_program_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.l"
    for content, words in (
        (b"\x7fELF\x00\x00", "binary file"),
        (b"A(1);\nB(\xff);", "line 2 is not UTF-8"),
        (b"x" * 1_000_001, "larger than 1 MB"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=words):
            load_program(path)


@pytest.mark.parametrize(
    ("name", "words"),
    [(".", "is a folder"), ("none.l", "There is no such program"), ("x" * 300, "can't be read")],
    ids=["a folder", "missing", "out of reach"],
)
def test_a_path_that_leads_to_no_file_is_refused(tmp_path: Path, name: str, words: str) -> None:
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


def test_saving_replaces_the_file_in_one_step_and_leaves_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "new" / "mine.l"
    save_program(path, "A(1);")
    path.chmod(0o600)
    save_program(path, "A(2);")
    assert path.read_text() == "A(2);"
    assert path.stat().st_mode & 0o777 == 0o600
    assert [p.name for p in path.parent.iterdir()] == ["mine.l"]


def test_a_file_that_cannot_be_written_is_a_clear_message(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="can't be written"):
        save_program(tmp_path / "file" / "mine.l", "A(1);")
