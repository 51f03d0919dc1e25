"""``logical-robots replay``: record, verify and show."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import msgspec
import pytest

from logical_robots_tui.game.replay import load_replay
from tests.cli.running import Command


@pytest.fixture
def recorded(command: Command, level: Path, ahead: Path, tmp_path: Path) -> Path:
    path = tmp_path / "a.replay"
    told = command("replay", "record", level, ahead, "-o", path)
    assert (told.status, told.err) == (0, "")
    assert f"ticks in {path} (" in told.out
    return path


def test_the_same_run_makes_the_same_file(
    command: Command, level: Path, ahead: Path, recorded: Path, tmp_path: Path
) -> None:
    other = tmp_path / "b.replay"
    command("replay", "record", level, ahead, "-o", other)
    assert other.read_bytes() == recorded.read_bytes()
    assert len(other.read_bytes()) < 2000


def test_a_file_is_replaced_only_if_that_is_wished(
    command: Command, level: Path, ahead: Path, recorded: Path
) -> None:
    before = recorded.read_bytes()
    short = "replay", "record", level, ahead, "-o", recorded, "--ticks", 3
    told = command(*short)
    assert told.status == 2
    assert "already exists" in told.err
    assert recorded.read_bytes() == before
    assert command(*short, "--force").status == 0
    assert load_replay(recorded).last == 3


def test_a_run_too_long_for_a_replay_is_refused_before_it_is_run(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    told = command("replay", "record", level, ahead, "-o", tmp_path / "a", "--ticks", 100_001)
    assert told.status == 2
    assert "--ticks 100001: a replay has at most 100,000 ticks" in told.err


def test_a_replay_is_verified(command: Command, recorded: Path) -> None:
    told = command("replay", "verify", recorded)
    assert (told.status, told.out) == (0, f"The same: {load_replay(recorded).last} ticks.\n")


def test_what_would_be_different_now_is_named_and_ends_with_status_3(
    command: Command, recorded: Path
) -> None:
    replay = load_replay(recorded)
    text = (replay.texts[0].text or "").replace("left_engine: 0.5", "left_engine: 0.4")
    texts = (msgspec.structs.replace(replay.texts[0], text=text),)
    recorded.write_bytes(msgspec.structs.replace(replay, texts=texts).to_bytes())
    told = command("replay", "verify", recorded)
    assert (told.status, told.out) == (3, "Tick 1 is different: Pip decides differently.\n")
    data = command("replay", "verify", recorded, "--json").data
    assert (data["same"], data["tick"]) == (False, 1)


def test_another_start_and_an_end_can_be_chosen(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    path = tmp_path / "third.replay"
    command("replay", "record", level, ahead, "-o", path, "--start", 3, "--ticks", 5)
    replay = load_replay(path)
    assert replay.last == 5
    assert replay.stages[0].state.robots[0].x != 12
    assert command("replay", "verify", path).status == 0


def test_programs_can_be_left_out(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    path = tmp_path / "hidden.replay"
    command("replay", "record", level, ahead, "-o", path, "--no-programs")
    told = command("replay", "verify", path)
    assert told.status == 0
    assert "The programs are not in the replay." in told.out
    assert command("replay", "show", path, "--json").data["programs"][0]["text"] is None


def test_it_is_shown_in_words_as_json_and_as_a_drawing(
    command: Command, recorded: Path, ahead: Path, tmp_path: Path
) -> None:
    words = command("replay", "show", recorded).out
    last = load_replay(recorded).last
    assert words.startswith(f"A short way (short): {last} ticks, from tick 0\n")
    assert f"won       at tick {last}\n" in words
    data = command("replay", "show", recorded, "--json").data
    program = {"tick": 1, "name": "ahead", "team": "", "text": ahead.read_text()}
    assert data["programs"] == [program]
    assert data["desires"] == [{"Pip": [0.5, 0.5]}] * last
    drawing = tmp_path / "a.svg"
    assert command("replay", "show", recorded, "--svg", drawing).status == 0
    root = ET.fromstring(drawing.read_text())
    (line,) = root.iter("{http://www.w3.org/2000/svg}polyline")
    points = line.attrib["points"].split()
    assert (len(points), points[0]) == (last + 1, "12.0,12.5")


def test_what_is_not_a_replay_is_refused(command: Command, ahead: Path) -> None:
    for what in ("play", "verify", "show"):
        told = command("replay", what, ahead)
        assert told.status == 2
        assert "Traceback" not in told.err
    assert "is not a replay file" in told.err
