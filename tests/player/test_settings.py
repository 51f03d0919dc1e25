"""The configuration file: what it sets, and what is said about what it can't."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.player import settings as module
from logical_robots_tui.player.settings import Settings, as_toml, read_settings, rows


def any_keys(table: Mapping[str, Any], _complain: module.Complain) -> module.Keys:
    return {name: tuple(keys) for name, keys in table.items() if isinstance(keys, list)}


def settings(folder: Path, text: str) -> Settings:
    path = folder / "config.toml"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    return read_settings(path, any_keys)


def test_everything_can_be_set(tmp_path: Path) -> None:
    off = dict.fromkeys(("cones", "trails", "completion", "wrap", "drag_robots"), False)
    lines = ['theme = "gruvbox"', 'drawing = "sextants"', "frames = 10"]
    lines += [*(f"{name} = false" for name in off), "[keys]", "run = ['%']"]
    wanted = Settings("gruvbox", "sextants", 10, keys={"run": ("%",)})
    assert settings(tmp_path, "\n".join(lines))._asdict() == wanted._asdict() | off


def test_every_setting_says_in_a_sentence_what_it_does() -> None:
    for row in rows():
        assert re.fullmatch(r"[A-Z].*\.", row.sentence), row


def test_what_is_printed_sets_the_same(tmp_path: Path) -> None:
    for printed in (Settings(), Settings("nord", "ascii", 5, False, True)):
        assert settings(tmp_path, "\n".join(as_toml(printed))) == printed


def test_what_is_wrong_is_named_with_its_place(tmp_path: Path) -> None:
    for text, words in (
        ("theme = 'nigth'", ':1: "theme" can\'t be "nigth". Did you mean "night"?'),
        ("drawing = 3", ':1: "drawing" must be "quadrants" or "halves" or "sextants" or "ascii", '),
        ("\nframes = 90", ':2: "frames" must be an integer from 1 to 60, not 90.'),
        ("frames = true", ':1: "frames" must be an integer from 1 to 60, not true.'),
        ("frames = 1.5", ':1: "frames" must be an integer from 1 to 60, not 1.5.'),
        (f"frames = 0x1{'0' * 9000}", "an integer from 1 to 60, not so large a number."),
        ("cones = 1", ':1: "cones" must be true or false, not 1.'),
        ("thema = 'night'", ':1: "thema" is not a known key. Did you mean "theme"?'),
        ("zzz = []", ':1: "zzz" is not a known key. Known keys: theme, drawing,'),
        ("keys = 3", ':1: "keys" must be a table, not 3.'),
        ("theme = x", ":1: This is not valid TOML: Invalid value. The file is ignored."),
        ("theme = [", ":1: This is not valid TOML: Invalid value. The file is ignored."),
        ("theme = " + "[" * 20_000, "it is nested too deeply. The file is ignored."),
        ("theme = '\udcff'", "it is not UTF-8 text. The file is ignored."),
        ("#" * 1_000_001, "it is larger than 1 MB. The file is ignored."),
    ):
        (complaint,) = settings(tmp_path, text).complaints
        assert complaint.startswith(str(tmp_path / "config.toml"))
        assert words in complaint
    rest = settings(tmp_path, "wrap = 3\nframes = 0\ncones = false\nframe = 3")
    assert rest[:-1] == Settings(cones=False)[:-1]
    assert [complaint.split(":")[1] for complaint in rest.complaints] == ["1", "2", "4"]


def test_no_file_and_a_byte_order_mark_are_no_mistakes(tmp_path: Path) -> None:
    assert read_settings(tmp_path / "none.toml", any_keys) == Settings()
    assert settings(tmp_path, "\ufeffframes = 10").frames == 10


VALUES = st.recursive(
    st.sampled_from(["1", "-0.5", "nan", "true", '"night"', "'a\tb'", "2026-01-31", "07:32:00"]),
    lambda inner: (
        st.lists(inner).map(lambda items: f"[{', '.join(items)}]")
        | inner.map(lambda item: f"{{theme = {item}}}")
    ),
)
KEYS = st.sampled_from([*Settings._fields, "keys.run", '"\\u0007"', "''"])


@given(st.lists(st.tuples(KEYS, VALUES), unique_by=lambda line: line[0]))
def test_whatever_a_file_says_only_what_is_allowed_is_set(
    tmp_path_factory: pytest.TempPathFactory, lines: list[tuple[str, str]]
) -> None:
    text = "\n".join(f"{key} = {value}" for key, value in lines)
    found = settings(tmp_path_factory.mktemp("any"), text)
    for row in rows():
        value = getattr(found, row.name)
        assert value == row.default or row.kind.allows(value), row
