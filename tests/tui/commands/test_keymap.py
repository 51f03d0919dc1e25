"""The keys that a configuration file gives, and what is said about those it can't."""

from pathlib import Path

import pytest

from logical_robots_tui.player.settings import Settings, read_settings
from logical_robots_tui.tui.commands.command import Need
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap, key_from, with_keys
from logical_robots_tui.tui.commands.table import COMMANDS


def keys(folder: Path, text: str) -> Settings:
    path = folder / "config.toml"
    path.write_text(f"[keys]\n{text}\n", encoding="utf-8")
    return read_settings(path, KeyMap(COMMANDS).read)


def test_a_command_has_the_keys_that_it_is_given(tmp_path: Path) -> None:
    found = keys(tmp_path, 'run = ["%", "F9"]\nrestart = []\ndefinition = "^]"')
    assert not found.complaints
    assert found.keys == {
        "run": ("percent_sign", "f9"),
        "restart": (),
        "definition": ("ctrl+right_square_bracket",),
    }
    # What is printed sets the same.
    key_map = KeyMap(COMMANDS, {"step": ("percent_sign",), "restart": ()})
    read = keys(tmp_path, "\n".join(key_map.as_toml()).removeprefix("[keys]\n"))
    assert not read.complaints
    assert read.keys == {name: entry.keys for name, entry in key_map.changeable.items()}


def test_a_command_without_a_key_is_found_where_the_palette_is() -> None:
    def said(text: str, keys: dict[str, tuple[str, ...]]) -> str:
        KEY_MAP.set(KeyMap(COMMANDS, keys))
        return with_keys(text)

    wanted = {"palette": ("f9",), "hint": (), "brush": ()}
    assert said("{rename} {hint} {brush} {step}", wanted) == "F9 F9 F9 n"
    assert said("{rename} {palette}", {"palette": ()}) == "Commands Commands"
    assert said("{rename} {step}", {}) == "^P n"


def test_a_browser_is_told_keys_that_it_passes_on() -> None:
    entries = KeyMap(COMMANDS, {"apply": ("ctrl+t", "f9")}, has=["browser"]).by_id
    names = [entries[name].key_name for name in ("next_pane", "delete_word", "apply", "palette")]
    assert names == ["F10", "alt+backspace", "F9", "^P"]


@pytest.mark.parametrize(
    ("need", "names"),
    [
        ("browser", {"upload", "download", "download_level"}),
        ("board", {"board", "hand_in", "ladder", "race_player"}),
        ("class", {"ask_help"}),
    ],
)
def test_some_commands_are_there_only_where_they_can_be_used(need: Need, names: set[str]) -> None:
    everywhere = {entry.id for entry in KeyMap(COMMANDS).available}
    available = {entry.id for entry in KeyMap(COMMANDS, has=[need]).available}
    assert available - everywhere == names


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("rum = 'n'", ':2: keys: there is no command "rum". Did you mean "run"?'),
        ("run = 7", ":2: keys.run: 7 is not a key; write it as a string."),
        ("run = 'F13'", ':2: keys.run: There is no key "F13"; write n, ?, F5, ^R or'),
        ("run = '^B'", ":2: keys.run: ^B can't be used: tmux uses it."),
        ("run = 'enter'", "enter can't be used: it moves within a pane, or types."),
        ("run = 'alt+x'", "many terminals can't tell it from the key without Shift or"),
        ("run = 'ctrl+5'", "many terminals can't tell it from the key without Ctrl."),
        ("trails = '^A'", ":2: keys.trails: ^A can't be used: GNU screen"),
        ("run = 'n'", ":2: keys.run: n is the key of step. Give that another key, or"),
        ("run = 'F9'\nstep = 'f9'", ":3: keys.step: F9 is the key of run. Give that"),
    ],
)
def test_what_is_wrong_is_named_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    (complaint,) = keys(tmp_path, text).complaints
    assert complaint.startswith(str(tmp_path / "config.toml"))
    assert said in complaint


def test_editing_has_keys_of_its_own(tmp_path: Path) -> None:
    found = keys(tmp_path, 'brush = "n"\nuse = ["%", "enter"]\nundo = "r"')
    assert found.keys == {"brush": ("n",), "use": ("percent_sign", "enter"), "undo": ("u",)}
    (complaint,) = found.complaints
    assert "keys.undo: r is the key of rectangle." in complaint


def test_a_wrong_key_leaves_the_others_and_one_given_away_stays_away(tmp_path: Path) -> None:
    wrong = keys(tmp_path, 'run = ["^B", "%"]\nrestart = "^Q"')
    assert wrong.keys == {"run": ("percent_sign",), "restart": ("r",)}
    given_away = keys(tmp_path, 'run = "n"\nstep = "^B"')
    assert given_away.keys == {"run": ("n",), "step": ("full_stop", "f8")}
    assert key_from(" ") == "space"
