"""Levels and edits for tests."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from logical_robots_tui.editing.entities import (
    Ref,
    add,
    change,
    duplicate,
    remove,
    resize,
    set_words,
)
from logical_robots_tui.editing.level_text import KINDS, Kind
from logical_robots_tui.editing.strokes import fill, paint, paint_rectangle
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import Area, Beacon, Level, LevelError, Robot, Visibility, list_levels
from logical_robots_tui.world.level import Cycle, LevelQuestion, SecondGoal, Sensors
from tests.world.making import make_level

CONFORMANCE = sorted((Path(__file__).parents[1] / "conformance" / "levels").glob("*.json"))
SHIPPED = [shipped_folder("levels") / f"{name}.toml" for name in list_levels()]
NAMES = st.sampled_from(["Ann", "Bob", "lamp", "gate", "机器人", "ü", "n" * 60, 'a "b" \\c', "#"])
TEXTS = st.text("ab #\n\t'\"\\.[]=", max_size=20)
PLACES = st.one_of(st.integers(-5, 130).map(float), st.floats(-200, 300))
COLORS = st.sampled_from(["orange", "#abc", "#012345"])


def room(width: int = 120, height: int = 80, **more: Any) -> Level:
    """An open room without a rim and with one robot."""
    return make_level((Robot("Ann", 20.5, 20.5),), width=width, height=height, **more)


def drawn(*rows: str) -> Level:
    """A level whose units are drawn as characters; one robot stands in the first free one."""
    walls = [(x, y) for y, row in enumerate(rows) for x, unit in enumerate(row) if unit == "#"]
    x, y = next((x, y) for y, row in enumerate(rows) for x, u in enumerate(row) if u == ".")
    robot = Robot("Ann", x + 0.5, y + 0.5)
    return make_level((robot,), width=len(rows[0]), height=len(rows), walls=walls)


def sketch(level: Level) -> list[str]:
    return ["".join("#" if wall else "." for wall in row) for row in level.walls.tolist()]


@dataclass(frozen=True)
class Edit:
    """Something to do to a level; if the level refuses it, it stays as it is."""

    what: str
    work: Callable[[Level], Level]

    def __call__(self, level: Level) -> Level:
        try:
            return self.work(level)
        except LevelError:
            return level

    def __repr__(self) -> str:
        return self.what


def _edit(what: str, work: Callable[..., Level], **arguments: Any) -> Edit:
    return Edit(f"{what} {arguments}", lambda level: work(level, **arguments))


def _edits(what: str, work: Callable[..., Level], **arguments: Any) -> st.SearchStrategy[Edit]:
    return st.builds(partial(_edit, what, work), **arguments)


def _on(level: Level, kind: Kind, index: int, work: Callable[..., Level], **values: Any) -> Level:
    things = getattr(level, kind)
    return work(level, Ref(kind, index % len(things)), **values) if things else level


def _change(level: Level, kind: Kind, index: int, values: dict[str, Any]) -> Level:
    return _on(level, kind, index, change, **values)


def _duplicate(level: Level, ref: Ref) -> Level:
    return duplicate(level, ref, 3.5, 4)[0]


_POINTS = st.tuples(PLACES, PLACES)
_BOTH = st.booleans()
_NUMBERS = st.one_of(st.integers(0, 50).map(float), st.floats(0, 1e6), st.just(-1.0))
_THINGS = st.one_of(
    st.builds(
        Robot,
        *(NAMES, PLACES, PLACES, st.floats(-20, 20), COLORS),
        *(_BOTH, _BOTH, _NUMBERS, _NUMBERS),
    ),
    st.builds(Beacon, NAMES, PLACES, PLACES, _BOTH),
    st.builds(
        Area,
        *(NAMES, PLACES, PLACES, _NUMBERS, COLORS, st.lists(NAMES, max_size=2).map(tuple)),
        *(st.one_of(st.just(""), NAMES), st.one_of(st.just(""), NAMES), _BOTH, _BOTH),
    ),
)
_VALUES: dict[Kind, dict[str, st.SearchStrategy[Any]]] = {
    "robots": {"angle": st.floats(-20, 20), "has_battery": _BOTH, "battery_capacity": _NUMBERS},
    "beacons": {"charging_station": _BOTH},
    "areas": {
        "radius": _NUMBERS,
        "on_beacon": NAMES,
        "sticky_switch": _BOTH,
        "color": COLORS,
        "cycle": st.sampled_from([None, Cycle(600, 301, 600), Cycle(2, 1, 1), Cycle(2, 2, 1)]),
    },
}
_ALL = {"name": NAMES, "x": PLACES, "y": PLACES}
GOALS = st.sampled_from(
    [SecondGoal("symbol", 1), SecondGoal("tick", 900), SecondGoal("unit", 7), SecondGoal("blocked")]
)
QUESTIONS = st.builds(
    LevelQuestion,
    *(TEXTS, TEXTS, st.sampled_from([(0,), (120, 480), (3, 4, 10_000)])),
    st.one_of(st.just(""), NAMES),
)
_WORDS = {
    "title": NAMES,
    "idea": NAMES,
    "briefing": TEXTS,
    "lesson": TEXTS,
    "hints": st.lists(TEXTS, max_size=3).map(tuple),
    "questions": st.lists(QUESTIONS, max_size=2).map(tuple),
    "shared_names": st.lists(NAMES, max_size=2).map(tuple),
    "shuffled_names": st.sampled_from([(), ("*",), ("*", "?*")]),
    "second_goals": st.lists(GOALS, max_size=2).map(tuple),
    "visibility": st.sampled_from([Visibility(), Visibility("seen", "all")]),
    "sensors": st.sampled_from([Sensors(), Sensors(7, 90.5, 60, 0.5, 0), Sensors(noise=2)]),
}
_GRIDS = st.sampled_from([1, 1, 3, 10])
_INDEX = st.integers(0, 5)
_KINDS = st.sampled_from(KINDS)
_INK = {"grid": _GRIDS, "wall": _BOTH}
_LINES = st.lists(_POINTS, min_size=1, max_size=3)
_SIZES = {"width": st.integers(0, 150), "height": st.integers(1, 150)}
_MARGINS = {"left": st.integers(-9, 9), "top": st.integers(-200, 99)}
_CORNERS = {"corner": _POINTS, "opposite": _POINTS}
EDITS = st.one_of(
    _edits("paint", paint, points=_LINES, width=st.integers(0, 9), **_INK),
    _edits("rectangle", paint_rectangle, border=st.integers(0, 4), **_CORNERS, **_INK),
    _edits("fill", fill, x=PLACES, y=PLACES, wall=_BOTH),
    _THINGS.map(lambda new: Edit(f"add {new}", lambda level: add(level, new)[0])),
    _KINDS.flatmap(
        lambda kind: _edits(
            "change",
            partial(_change, kind=kind),
            index=_INDEX,
            values=st.fixed_dictionaries({}, optional=_ALL | _VALUES[kind]),
        )
    ),
    *(
        _edits(work.__name__, partial(_on, work=work), kind=_KINDS, index=_INDEX)
        for work in (_duplicate, remove)
    ),
    st.fixed_dictionaries({}, optional=_WORDS).map(lambda it: _edit("words", set_words, **it)),
    _edits("resize", resize, **_SIZES, **_MARGINS, wall=_BOTH),
)
"""Any edit that a player can do, and some that a level refuses."""
