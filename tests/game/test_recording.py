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
@pytest.mark.parametrize("part", [0.0, 0.01, 0.3, 0.6, 0.9, 0.9999])
@pytest.mark.parametrize("damage", ["changed", "cut", "longer"])
async def test_a_damaged_recording_is_dropped(
    level: Level, folder: Path, part: float, damage: str
) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    content = path.read_bytes()
    at = int(part * len(content))
    if damage == "changed":
        content = content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]
    path.write_bytes(content[:at] if damage == "cut" else content + b"more" * (damage == "longer"))
    assert await frames(level, TICKS) == expected
    assert await known(level) == TICKS
    digest, index, _ = path.read_bytes().split(b"\n", 2)
    assert digest == hashlib.sha256(index).hexdigest().encode()


def forged(key: str, pieces: list[bytes], moments: int) -> bytes:
    """A file that is as it should be, but for what its pieces hold."""
    counts = [min(32, moments - first) for first in range(0, moments, 32)]
    told = [
        [len(piece), hashlib.sha256(piece).hexdigest(), count]
        for piece, count in zip(pieces, counts, strict=True)
    ]
    line = json.dumps({"key": key, "moments": moments, "pieces": told}).encode()
    return hashlib.sha256(line).hexdigest().encode() + b"\n" + line + b"\n" + b"".join(pieces)


def content_of(path: Path) -> tuple[str, list[Any], int]:
    """The key, the pieces as data, and the number of moments of a recording."""
    _, line, rest = path.read_bytes().split(b"\n", 2)
    index = json.loads(line)
    pieces = []
    for length, _, _ in index["pieces"]:
        pieces.append(json.loads(zlib.decompress(rest[:length])))
        rest = rest[length:]
    return index["key"], pieces, index["moments"]


def nested(depth: int) -> list[Any]:
    return [nested(depth - 1)] if depth else []


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("at", "value"),
    [
        ([0, 0], 99),
        ([0, 0], "tick"),
        ([0, 1, 0], "Eve"),
        ([0, 1], ["Ada"]),
        ([0, 2], []),
        ([0, 3, 5], None),
        ([0, 3, 5, 0], "won"),
        ([0, 4, 5, 0], [True, ["Eve"]]),
        ([0, 4, 5, 0], [1, []]),
        ([0, 4, 5, 0], [True, [[]]]),
        ([0, 1, 0], []),
        ([0, 5, 0, 5, 0], "12"),
        ([0, 5, 0, 5, 0], float("nan")),
        ([0, 5, 0, 5, 6], 1),
        ([0, 5, 0, 5], [1]),
        ([0, 6, 0, 5, 1], ["fast", 1]),
        ([0, 6, 0, 5, 1], [1]),
        ([0, 6, 0, 5, 2], [["no kind", "x"]]),
        ([0, 6, 0, 5, 2], 7),
        ([0, 6, 0, 5, 0], 10**6),
        ([0, 6, 0, 5, 0], {"a": "b"}),
        ([0, 6], {}),
        ([0, 7], []),
        ([0, 7, 0], nested(300)),
        ([0], None),
    ],
)
async def test_a_false_recording_is_dropped(
    level: Level, folder: Path, at: list[int], value: object
) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    key, pieces, moments = content_of(path)
    *way, last = at
    part = pieces[1]
    for step in way:
        part = part[step]
    part[last] = value
    written = [zlib.compress(json.dumps(piece).encode()) for piece in pieces]
    path.write_bytes(forged(key, written, moments))
    assert await frames(level, TICKS) == expected


PIECES = {
    "not packed": lambda: b"not packed",
    "deep": lambda: zlib.compress(b"[" * 100_000),
    "null": lambda: zlib.compress(b"null"),
    "huge": lambda: zlib.compress(b"[" + b"[]," * 20_000_000 + b"[]]", 1),
}


@pytest.mark.parametrize("make", PIECES.values(), ids=PIECES)
async def test_a_damaged_piece_is_discarded(
    level: Level, folder: Path, make: Callable[[], bytes]
) -> None:
    piece = make()
    expected = await frames(level, TICKS)
    path = entry(folder)
    key, pieces, moments = content_of(path)
    for at in (0, -1):
        written = [zlib.compress(json.dumps(each).encode()) for each in pieces]
        written[at] = piece
        path.write_bytes(forged(key, written, moments))
        assert await frames(level, TICKS) == expected


async def test_a_damaged_index_is_discarded_and_a_piece_is_text(level: Level, folder: Path) -> None:
    expected = await frames(level, TICKS)
    path = entry(folder)
    _, (first, *_), _ = content_of(path)
    assert first[0][1] == ["Ada", "Bo"]
    for index in (b"{}", b"null", b"[]", b'{"key": 1, "moments": "x", "pieces": 7}'):
        path.write_bytes(hashlib.sha256(index).hexdigest().encode() + b"\n" + index + b"\n")
        assert await frames(level, TICKS) == expected
        assert await known(level) == TICKS


HEAVY = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1},
      memory: Format("%0900000d", sensor.clock)) :- Sensor(robot_name:, sensor:);
"""


async def test_heavy_ticks_are_kept_in_small_pieces(level: Level, folder: Path) -> None:
    expected = await frames(level, 20, HEAVY)
    assert [len(str(memory)) for memory in expected[20].memories.values()] == [900_000] * 2
    _, pieces, moments = content_of(entry(folder))
    assert (len(pieces), moments) == (3, 21)
    assert await known(level, HEAVY) == 20
    assert await frames(level, 20, HEAVY) == expected


ENDLESS = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1},
      memory: {far: [1e308 * 10, sensor.clock, 1, 1.0, true], name: "a"}) :-
  Sensor(robot_name:, sensor:);
"""


async def test_an_endless_number_is_kept(level: Level, folder: Path) -> None:
    expected = await frames(level, TICKS, ENDLESS)
    assert await known(level, ENDLESS) == TICKS
    assert repr(await frames(level, TICKS, ENDLESS)) == repr(expected)
    assert "inf" in repr(expected[-1].memories)
