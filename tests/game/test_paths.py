"""A question about a path has an answer, whatever the path is."""

import shlex
from pathlib import Path
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import target
from logical_robots_tui.paths import is_file, is_folder, is_there, pasted_path, real, typed_path

OUT_OF_REACH = "x" * 300  # for root, too: longer than the name of a file can be


def test_what_is_out_of_reach_is_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / OUT_OF_REACH, tmp_path / OUT_OF_REACH / "mine.l", tmp_path / "none"):
        assert not is_there(path)
        assert not is_file(path)
        assert not is_folder(path)
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


def test_links_in_a_circle_lead_somewhere(tmp_path: Path) -> None:
    (tmp_path / "round.l").symlink_to(tmp_path / "round.l")
    assert real(tmp_path / "round.l") == tmp_path / "round.l"
    assert target(f"{tmp_path}/round.l", tmp_path) == tmp_path / "round.l"


def test_what_can_be_no_path_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert typed_path("~/mine.l") == tmp_path / "mine.l"
    with pytest.raises(InputError, match="no such home"):
        typed_path("~nobody-of-that-name/mine.l")
    with pytest.raises(InputError, match="is not a valid path"):
        typed_path("/tmp/mine\0.l")


def test_a_name_in_a_folder_that_is_gone_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    here.rmdir()
    with pytest.raises(InputError, match="no longer exists"):
        target("./mine.l", tmp_path)
