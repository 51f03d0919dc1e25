"""Recordings of runs on disk: what is damaged or false is dropped, and never believed."""

import hashlib
import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.world import Level
from tests.game.test_run import entry, frames, known

TICKS = 40  # a piece and some
pytestmark = pytest.mark.usefixtures("folder")


@pytest.mark.sampled
@pytest.mark.parametrize("damage", ["changed", "cut", "longer"])
async def test_a_damaged_recording_is_dropped(level: Level, folder: Path, damage: str) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    whole = path.read_bytes()
    for part in (0.0, 0.01, 0.3, 0.6, 0.9, 0.9999):
        at = int(part * len(whole))
        flipped = whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]
        damaged = {"changed": flipped, "cut": whole[:at], "longer": whole + b"more"}
        path.write_bytes(damaged[damage])
        assert await frames(level, TICKS) == expected
        assert await known(level) == TICKS
        digest, index, _ = path.read_bytes().split(b"\n", 2)
        assert digest == digest_of(index)


def digest_of(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()


def forged(key: str, pieces: list[Any], moments: int) -> bytes:
    """A file that is as it should be, but for what its pieces hold, as data or as bytes."""
    counts = [min(32, moments - first) for first in range(0, moments, 32)]
    packed = [
        piece if isinstance(piece, bytes) else zlib.compress(json.dumps(piece).encode())
        for piece in pieces
    ]
    told = [
        [len(piece), digest_of(piece).decode(), count]
        for piece, count in zip(packed, counts, strict=True)
    ]
    line = json.dumps({"key": key, "moments": moments, "pieces": told}).encode()
    return b"\n".join([digest_of(line), line, b"".join(packed)])


def content_of(path: Path) -> tuple[str, list[Any], int]:
    _, line, rest = path.read_bytes().split(b"\n", 2)
    index = json.loads(line)
    pieces = []
    for length, _, _ in index["pieces"]:
        pieces.append(json.loads(zlib.decompress(rest[:length])))
        rest = rest[length:]
    return index["key"], pieces, index["moments"]


def nested(depth: int) -> list[Any]:
    return [nested(depth - 1)] if depth else []


FALSE: dict[tuple[int, ...], list[object]] = {  # by where it stands in a piece
    (0, 0): [99, "tick"],
    (0, 1, 0): ["Eve", []],
    (0, 1): [["Ada"]],
    (0, 2): [[]],
    (0, 3, 5): [None],
    (0, 3, 5, 0): ["won"],
    (0, 4, 5, 0): [[True, ["Eve"]], [1, []], [True, [[]]]],
    (0, 5, 0, 5, 0): ["12", float("nan")],
    (0, 5, 0, 5, 6): [1],
    (0, 5, 0, 5): [[1]],
    (0, 6, 0, 5, 1): [["fast", 1], [1]],
    (0, 6, 0, 5, 2): [[["no kind", "x"]], 7],
    (0, 6, 0, 5, 0): [10**6, {"a": "b"}],
    (0, 6): [{}],
    (0, 7): [[]],
    (0, 7, 0): [nested(300)],
    (0,): [None],
}


@pytest.mark.sampled
@pytest.mark.parametrize("at", FALSE, ids=str)
async def test_a_false_recording_is_lost(level: Level, folder: Path, at: tuple[int, ...]) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    *way, last = at
    for value in FALSE[at]:
        key, pieces, moments = content_of(path)
        part = pieces[1]
        for step in way:
            part = part[step]
        part[last] = value
        path.write_bytes(forged(key, pieces, moments))
        assert await frames(level, TICKS) == expected


PIECES = {
    "empty": lambda: b"",
    "not packed": lambda: b"not packed",
    "deep": lambda: zlib.compress(b"[" * 100_000),
    "null": lambda: zlib.compress(b"null"),
    "huge": lambda: zlib.compress(b"[" + b"[]," * 20_000_000 + b"[]]", 1),
}


@pytest.mark.parametrize("make", PIECES.values(), ids=PIECES)
async def test_a_damaged_piece_is_lost(
    level: Level, folder: Path, make: Callable[[], bytes]
) -> None:
    piece = make()
    expected = await frames(level, TICKS)
    path = entry(folder)
    key, (first, *others, last), moments = content_of(path)
    for pieces in ([piece, *others, last], [first, *others, piece]):
        path.write_bytes(forged(key, pieces, moments))
        assert await frames(level, TICKS) == expected


async def test_a_damaged_index_is_discarded_and_a_piece_is_text(level: Level, folder: Path) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    _, (first, *_), _ = content_of(path)
    assert first[0][1] == ["Ada", "Bo"]
    for index in (b"{}", b"null", b"[]", b'{"key": 1, "moments": "x", "pieces": 7}'):
        path.write_bytes(b"\n".join([digest_of(index), index, b""]))
        assert await frames(level, TICKS) == expected
        assert await known(level) == TICKS


ENDLESS = """Robot(robot_name:, desire: {left_engine: 1, right_engine: 1},
  memory: {far: [1e308 * 10, sensor.clock, 1, 1.0, true], name: "a"}) :-
  Sensor(robot_name:, sensor:);"""
HEAVY = """Robot(robot_name:, desire: {left_engine: 1, right_engine: 1},
  memory: Format("%0900000d", sensor.clock)) :- Sensor(robot_name:, sensor:);"""


async def test_heavy_ticks_are_kept_in_small_pieces(level: Level, folder: Path) -> None:
    expected = await frames(level, 20, HEAVY)
    assert [len(str(memory)) for memory in expected[20].memories.values()] == [900_000] * 2
    _, pieces, moments = content_of(entry(folder))
    assert (len(pieces), moments) == (3, 21)
    assert await known(level, HEAVY) == 20
    assert await frames(level, 20, HEAVY) == expected


async def test_an_endless_number_is_kept(level: Level, folder: Path) -> None:
    expected = await frames(level, TICKS, ENDLESS)
    assert await known(level, ENDLESS) == TICKS
    assert repr(await frames(level, TICKS, ENDLESS)) == repr(expected)
    assert "inf" in repr(expected[-1].memories)
