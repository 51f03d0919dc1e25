"""The leader of level 10 really computes distances: its map agrees with Dijkstra."""

import heapq
from functools import cache
from itertools import combinations, pairwise
from math import dist
from typing import Any

import pytest

from tests.levels.moments import moments
from tests.levels.playing import load_level, program_text

LEVEL = "10-distributed-mapping"
PATIENCE = 6000
LONGEST_ROAD = 103  # the program takes those that seem shorter than 100
FARTHEST = 250  # from a robot to both ends of a road that it believes to see
LEADER, BASE = "Atlas", "Base"


@cache
def play() -> tuple[list[Any], set[tuple[str, str]]]:
    """Return what the leader remembers after each tick, and the pairs seen at once till then."""
    pairs: set[tuple[str, str]] = set()
    told = []
    for moment in moments(LEVEL, program_text("distributed-mapping"), PATIENCE):
        told.append(moment.memories[LEADER])
        for row in moment.rows:
            nearest: dict[str, float] = {}
            for ray in sorted(row["sensor"]["radar"], key=lambda ray: -float(ray["distance"])):
                if ray["object"] == "beacon":
                    nearest[ray["label"]] = ray["distance"]
            pairs |= {
                (one, other)
                for one, other in combinations(sorted(nearest), 2)
                if nearest[one] + nearest[other] < FARTHEST
            }
    assert len(told) < PATIENCE
    return told[1:], pairs


def dijkstra(
    places: dict[str, tuple[float, float]], roads: set[tuple[str, str]]
) -> dict[str, float]:
    beside: dict[str, set[str]] = {name: set() for name in places}
    for one, other in roads:
        beside[one].add(other)
        beside[other].add(one)
    found: dict[str, float] = {}
    waiting = [(0.0, BASE)]
    while waiting:
        far, name = heapq.heappop(waiting)
        if name not in found:
            found[name] = far
            for other in beside[name]:
                heapq.heappush(waiting, (far + dist(places[name], places[other]), other))
    return found


def distances(memory: Any) -> dict[str, float]:
    return {place["label"]: place["far"] for place in memory["places"] or []}


@pytest.mark.slow
def test_the_map_agrees_with_dijkstra_over_the_pairs_that_robots_have_seen() -> None:
    level, (told, pairs) = load_level(LEVEL), play()
    places = {beacon.name: (beacon.x, beacon.y) for beacon in level.beacons}
    roads = {(a, b) for a, b in pairs if dist(places[a], places[b]) < LONGEST_ROAD}
    right, computed = dijkstra(places, roads), distances(told[-1])
    assert len(computed) >= 30
    for name, far in computed.items():
        assert far == pytest.approx(right[name], rel=0.15), name


@pytest.mark.slow
def test_the_map_grows_by_one_round_a_tick() -> None:
    told, _ = play()
    before: set[str] = {BASE}
    for memory in told:
        roads = memory["roads"] or []
        reach = before | {road["finish"] for road in roads if road["start"] in before}
        assert set(distances(memory)) <= reach
        before = {BASE} | set(distances(memory))


@pytest.mark.slow
def test_a_distance_rises_when_a_road_turns_out_longer_as_the_lesson_says() -> None:
    assert "must **rise**" in load_level(LEVEL).lesson
    told, _ = play()
    maps = [distances(memory) for memory in told]
    assert any(
        far > before.get(label, far) + 2
        for before, after in pairwise(maps)
        for label, far in after.items()
    )
