"""``logical-robots replay``: record, verify and show."""

from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import msgspec
import pytest

from logical_robots_tui.game.replay import load_replay
from tests.cli.running import Command, Told


@pytest.fixture
def record(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> Callable[..., tuple[Told, Path]]:
    def record(name: str, *options: object) -> tuple[Told, Path]:
        path = tmp_path / name
        return command("replay", "record", level, ahead, "-o", path, *options), path

    return record


@pytest.fixture
def recorded(record: Callable[..., tuple[Told, Path]]) -> Path:
    told, path = record("a.replay")
    assert (told.status, told.err) == (0, "")
    assert f"ticks in {path} (" in told.out
    return path


def test_the_same_run_makes_the_same_file_which_is_kept_unless_forced(
    record: Callable[..., tuple[Told, Path]], recorded: Path
) -> None:
    _, other = record("b.replay")
    before = other.read_bytes()
    assert before == recorded.read_bytes()
    assert len(before) < 2000
    told, _ = record("a.replay", "--ticks", 3)
    assert "already exists" in told.refusal
    assert recorded.read_bytes() == before
    assert record("a.replay", "--ticks", 3, "--force")[0].status == 0
    assert load_replay(recorded).last == 3


def test_a_replay_is_verified_or_ends_with_status_3(command: Command, recorded: Path) -> None:
    replay = load_replay(recorded)
    told = command("replay", "verify", recorded)
    assert (told.status, told.out) == (0, f"The same: {replay.last} ticks.\n")
    text = (replay.texts[0].text or "").replace("left_engine: 0.5", "left_engine: 0.4")
    texts = (msgspec.structs.replace(replay.texts[0], text=text),)
    recorded.write_bytes(msgspec.structs.replace(replay, texts=texts).to_bytes())
    told = command("replay", "verify", recorded)
    assert (told.status, told.out) == (3, "Tick 1 is different: Pip decides differently.\n")
    data = command("replay", "verify", recorded, "--json").data
    assert (data["same"], data["tick"]) == (False, 1)


def test_another_start_an_end_and_a_file_without_programs_can_be_chosen(
    command: Command, record: Callable[..., tuple[Told, Path]]
) -> None:
    _, path = record("third.replay", "--start", 3, "--ticks", 5)
    replay = load_replay(path)
    assert replay.last == 5
    assert replay.stages[0].state.robots[0].x != 12
    assert command("replay", "verify", path).status == 0
    _, path = record("hidden.replay", "--no-programs")
    assert "The programs are not in the replay." in command("replay", "verify", path).success
    assert command("replay", "show", path, "--json").data["programs"][0]["text"] is None


def test_it_is_shown(command: Command, recorded: Path, ahead: Path, tmp_path: Path) -> None:
    words = command("replay", "show", recorded).out
    last = load_replay(recorded).last
    assert words.startswith(f"A short way (short): {last} ticks, from tick 0\n")
    assert f"won       at tick {last}\n" in words
    data = command("replay", "show", recorded, "--json").data
    assert data["programs"] == [{"tick": 1, "name": "ahead", "team": "", "text": ahead.read_text()}]
    assert data["desires"] == [{"Pip": [0.5, 0.5]}] * last
    drawing = tmp_path / "a.svg"
    assert command("replay", "show", recorded, "--svg", drawing).status == 0
    (line,) = ET.fromstring(drawing.read_text()).iter("{http://www.w3.org/2000/svg}polyline")
    points = line.attrib["points"].split()
    assert (len(points), points[0]) == (last + 1, "12.0,12.5")


def test_what_is_no_replay_is_refused(
    command: Command, record: Callable[..., tuple[Told, Path]], ahead: Path
) -> None:
    told, _ = record("a", "--ticks", 100_001)
    assert "--ticks 100001: a replay has at most 100,000 ticks" in told.refusal
    for what in ("play", "verify", "show"):
        refusal = command("replay", what, ahead).refusal
        assert "Traceback" not in refusal
    assert "is not a replay file" in refusal
