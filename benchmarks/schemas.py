"""Reading a large memory by an example instead of an explicit type."""

from __future__ import annotations

from functools import partial
from random import Random
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, repeated, seconds_for, summed_up
from benchmarks.subjects import program_text, rows_for
from logical_robots_tui import Mind, Program

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from logical_robots_tui.values import Value

__all__ = ["schemas"]

BEACONS = 56
EDGES = 159
TICKS = 30  # in one measurement
EXAMPLE = "TryCast(memory, Schema())"
TYPE = (
    "TryCast(memory,"
    " {clock: Num, beacons: [{label: Str, way: Num}], edges: [{u: Str, v: Str, d: Num}]})"
)
MOST = 1.3


def schemas(effort: Effort) -> Iterator[Measurement]:
    """Measure a think of a robot with a map in memory, and the ratio of both ways to read it.

    The two ways alternate tick by tick, so that changes of the machine's speed affect both.
    """
    text = program_text("schema")
    assert EXAMPLE in text
    texts = (text.replace(EXAMPLE, TYPE), text)
    programs = [Program.compile(one) for one in texts]
    found = repeated(effort.repeats, partial(_milliseconds, programs))
    of = f"a map of {BEACONS} beacons and {EDGES} roads"
    for place, way in enumerate(("by a type", "by an example")):
        milliseconds = [times[place] for times in found]
        yield summed_up("memory read", f"{of}, {way}", "ms", milliseconds)
    ratios = [example / written for written, example in found]
    yield summed_up("memory read", "example : type", "x", ratios, target=at_most(MOST))


def _milliseconds(programs: list[Program]) -> list[float]:
    """Return the milliseconds of one think under each program, the mean of several."""
    thinkers = [_thinker(program) for program in programs]
    seconds = [0.0 for _ in programs]
    for think in thinkers:
        think()
    for _ in range(TICKS):
        for place, think in enumerate(thinkers):
            seconds[place] += seconds_for(think)
    return [1000 * each / TICKS for each in seconds]


def _thinker(program: Program) -> Callable[[], None]:
    """Return a function that thinks one tick per call; the memory changes every tick."""
    rows = rows_for("gate")
    mind = Mind(program)
    memories: dict[str, Value] = {row["robot_name"]: _the_map() for row in rows}

    def think() -> None:
        nonlocal memories
        for row in rows:
            row["sensor"]["clock"] += 1
        memories = {d.robot_name: d.memory for d in mind.think(rows, memories)}

    return think


def _the_map() -> dict[str, Value]:
    """Return a fixed map in the form that the program keeps."""
    random = Random(BEACONS)
    labels = [f"beacon {number:02}" for number in range(BEACONS)]
    pairs = random.sample([(u, v) for u in labels for v in labels if u < v], EDGES)
    return {
        "clock": 0,
        "beacons": [{"label": label, "way": random.uniform(0, 900)} for label in labels],
        "edges": [{"u": u, "v": v, "d": random.uniform(20, 200)} for u, v in sorted(pairs)],
    }
