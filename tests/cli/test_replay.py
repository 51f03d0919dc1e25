"""``logical-robots replay``: record, verify and show."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import msgspec
import pytest

from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.tui.labyrinth.svg import moving_svg
from logical_robots_tui.world import Level, WorldState, load_level
from logical_robots_tui.world.dynamics import AreaState, RobotState
from tests.cli.running import Command, Told

SVG = "{http://www.w3.org/2000/svg}"


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
    (line,) = ET.fromstring(drawing.read_text()).iter(f"{SVG}polyline")
    points = line.attrib["points"].split()
    assert (len(points), points[0]) == (last + 1, "12.0,12.5")


def test_it_is_exported_as_a_moving_picture_that_ends_where_the_run_did(
    command: Command, recorded: Path, tmp_path: Path
) -> None:
    picture, replay = tmp_path / "a.svg", load_replay(recorded)
    words = command("replay", "export", recorded, picture).success
    size = f"{replay.last} ticks, drawn every 2 ticks ({picture.stat().st_size:,} bytes)"
    assert words == f"Wrote {picture}: {size}.\n"
    (motion,) = ET.fromstring(picture.read_text()).iter(f"{SVG}animateTransform")
    places, (*_, state) = motion.attrib["values"].split(";"), replay.states()
    end = f"{state.robots[0].x:.1f} {state.robots[0].y:.1f}"
    assert (places[0], places[-1], places.index(end)) == ("12.0 12.5", end, -(-replay.last // 2))
    assert "already exists" in command("replay", "export", recorded, picture).refusal
    assert command("replay", "export", recorded, picture, "--force").status == 0
    for name, reason in (("no/a.svg", "can't be written"), ("a.gif", "a name that ends in .svg")):
        assert reason in command("replay", "export", recorded, tmp_path / name).refusal


@pytest.mark.parametrize(
    ("robots", "ticks", "step", "seconds"),
    [(1, 1, 2, 0.15), (3, 1_000, 2, 27), (100, 1_000, 2, 27), (20, 9_000, 8, 62)],
)
def test_a_moving_picture_is_small_and_shows_turns_and_switches(
    robots: int, ticks: int, step: int, seconds: float
) -> None:
    swarm = load_level("13-swarm").robots[:robots]
    level = replace(load_level("09-doors"), robots=swarm)
    text, every = moving_svg(level, turning(level, ticks), ticks)
    assert (every, len(text) < 2_000_000) == (step, True)
    root = ET.fromstring(text)
    motions = [motion.attrib for motion in root.iter(f"{SVG}animateTransform")]
    assert float(motions[0]["dur"][:-1]) == pytest.approx(seconds, 0.01)
    turns = [[*map(int, m["values"].split(";"))] for m in motions if m["type"] == "rotate"]
    largest = math.degrees(0.1 * step) + 1
    assert len(turns) == robots
    assert all(0 <= b - a <= largest for turn in turns for a, b in pairwise(turn))
    (*_, end) = root
    names = [text.text for text in end.iter(f"{SVG}text") if text.text]
    assert len(names) == len({*names})
    switches = {switch.attrib["values"] for switch in root.iter(f"{SVG}animate")}
    assert switches == {"visible;hidden", "hidden;visible"}


def turning(level: Level, ticks: int) -> Iterator[WorldState]:
    """Robots turn on the spot; the areas go on in the last tick."""
    for tick in range(ticks + 1):
        angle = 0.1 * tick % math.tau
        robots = tuple(RobotState(robot.name, robot.x, robot.y, angle, 1) for robot in level.robots)
        areas = tuple(AreaState(area.name, active=tick == ticks) for area in level.areas)
        yield WorldState(tick, robots, areas)


def test_what_is_no_replay_is_refused(
    command: Command, record: Callable[..., tuple[Told, Path]], ahead: Path
) -> None:
    told, _ = record("a", "--ticks", 100_001)
    assert "--ticks 100001: a replay has at most 100,000 ticks" in told.refusal
    for what, *out in (["play"], ["verify"], ["show"], ["export", ahead.with_name("a.svg")]):
        assert "is not a replay file" in command("replay", what, ahead, *out).refusal
