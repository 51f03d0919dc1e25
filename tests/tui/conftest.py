"""Opening the real game on a screen in memory, and waiting for what it shows."""

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any, TypeAlias, TypedDict, Unpack

import pytest
from textual import _time, events, notifications
from textual._compositor import Compositor
from textual.css.styles import RulesMap
from textual.css.stylesheet import Stylesheet
from textual.document._history import EditHistory
from textual.dom import DOMNode
from textual.keys import _character_to_key
from textual.pilot import Pilot
from textual.widget import Widget
from textual.widgets import Input

from logical_robots_tui.game import ProgramSource, load_program, measuring
from logical_robots_tui.player.opening import Opening, Permissions
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.settings import Settings
from logical_robots_tui.tui.app.app import LogicalRobotsApp
from logical_robots_tui.tui.app.main_screen import MainScreen
from logical_robots_tui.tui.inspector import pane as inspector_pane
from logical_robots_tui.tui.inspector.pane import InspectorPane
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.layout.status_line import StatusLine
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.world import load_level
from tests.short import LEVEL
from tests.virtual_time import VirtualClock, VirtualLoop, later, until, virtual_loop

_PICTURE = 0.05  # seconds in which what has changed is laid out and drawn

CHARACTERS = {_character_to_key(sign): sign for sign in " .,+->?[](){}/"}
CHARACTERS |= {"enter": "\r", "tab": "\t"}
Size: TypeAlias = tuple[int, int]  # columns and lines
at_both_sizes = pytest.mark.parametrize(
    "size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)], ids=["80x24", "120x40"]
)
LEVELS = Path(__file__).parents[1] / "conformance" / "levels"

PAPER = """\
FreedomMotion(radar) = WeightedAverage {
  x.distance -> x.angle :- x in radar
};
Robot(robot_name:, desire:, memory: "I am a robot") :-
  Sensor(robot_name:, sensor:),
  freedom = FreedomMotion(sensor.radar),
  speed = 0.5,
  desire = {
    left_engine:  speed - freedom + 0.1,
    right_engine: speed + freedom
  };
"""

STILL = """\
Robot(robot_name:, desire: {left_engine: 0.0, right_engine: 0.0}, memory: 1) :-
  Sensor(robot_name:, sensor:);
"""

SLOW = """\
Many() += 1 :- Sensor(sensor:), a in sensor.radar, b in sensor.radar, c in sensor.radar,
  d in sensor.radar, e in sensor.radar, a.distance + b.distance > c.distance + d.distance;
Robot(robot_name:, desire: {left_engine: 0.0, right_engine: 0.0}, memory: Many()) :-
  Sensor(robot_name:, sensor:);
"""


SHORT = (
    """\
idea = "Straight on is a way."
briefing = "Bring Pip to the door."
hints = ["It is not far.", "It is straight ahead.", "Just go."]
lesson = \"\"\"
# Going on

A rule with *one* case: `Robot(...)`.

```
Robot(robot_name:, desire: 1) :- Sensor(robot_name:);
```
\"\"\"
further = "Be there in fewer ticks."
starter = "obstacle-avoider"
solution = "first-steps-starter"
"""
    + LEVEL
)


ROOM = """\
# A room that is mine.
title = "A room"
cell = 10
walls = '''
############################
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
#..........................#
############################
'''

[[robots]]
name = "Pip"
x = 40
y = 50 # in the middle

[[beacons]]
name = "Lamp"
x = 200
y = 30

[[areas]]
name = "Door"
x = 240
y = 50
radius = 15
goal_for = ["Pip"]
"""


def key_event(key: str) -> events.Key:
    """A key as a terminal reports it."""
    return events.Key(key, CHARACTERS.get(key, key if len(key) == 1 else None))


class Awaited(TypedDict, total=False):
    """What is to follow from something: a tick, words, a screen, or something else."""

    tick: int
    sees: str | tuple[str, ...]
    sees_no: str
    on: type
    until: Callable[[], object]


@dataclass(frozen=True)
class Opened:
    """The game on a screen in memory, in which time passes only while a test waits."""

    app: LogicalRobotsApp
    pilot: Pilot[None]
    data_dir: Path

    @property
    def main(self) -> MainScreen:
        return self.app.main

    @property
    def session(self) -> Session:
        return self.app.main.session

    @property
    def editor(self) -> Editor:
        return self.main.query_one(Editor)

    @property
    def inspector(self) -> InspectorPane:
        return self.main.query_one(InspectorPane)

    @property
    def tick(self) -> int:
        return self.session.frame.tick

    @property
    def status(self) -> str:
        return self.main.query_one(StatusLine).render().plain

    async def wait(
        self,
        *,
        tick: int | None = None,
        sees: str | tuple[str, ...] = (),
        sees_no: str | None = None,
        on: type | None = None,
        until: Callable[[], object] | None = None,
    ) -> None:
        texts = (sees,) if isinstance(sees, str) else sees
        if texts or any(wanted is not None for wanted in (tick, sees_no, on, until)):
            await self.until(
                lambda: (
                    (tick is None or self.tick == tick)
                    and (on is None or isinstance(self.app.screen, on))
                    and (until is None or until())
                    and all(map(self.shows, texts))
                    and (sees_no is None or not self.shows(sees_no))
                )
            )

    async def press(self, *keys: str, **awaited: Unpack[Awaited]) -> None:
        """Press keys as a terminal reports them, each after the last was answered, and wait."""
        for key in keys:
            self.app.post_message(key_event(key))
            await self.handled()
            if self.app.backlog:
                with self.impatient():
                    await self.until(lambda: not self.app.backlog)
        await self.wait(**awaited)

    async def command(self, name: str, **awaited: Unpack[Awaited]) -> None:
        self.main.action_command(name)
        await self.wait(**awaited)

    async def resize(self, columns: int, lines: int, **awaited: Unpack[Awaited]) -> None:
        await self.pilot.resize_terminal(columns, lines)
        await self.wait(**awaited)

    async def handled(self) -> None:
        """Wait until what was sent to the game is handled, but for what threads work on."""
        await virtual_loop().handled()

    async def click(
        self, *where: str | type[Widget] | Widget, offset: Size = (0, 0), **awaited: Unpack[Awaited]
    ) -> None:
        await self.later(_PICTURE)
        await self.pilot.click(where[0] if where else None, offset=offset)
        await self.wait(**awaited)

    async def mouse(
        self, kind: type[events.MouseEvent], place: tuple[float, float], button: int = 1
    ) -> None:
        """Report the mouse at a place of the map; the pilot would wait for an idle processor."""
        view = self.main.labyrinth.view
        x, y = view.region.offset + cell_of(view, place)
        button = 0 if kind is events.MouseMove else button
        self.app.post_message(kind(None, x, y, 0, 0, button, False, False, False, x, y))
        await self.handled()

    async def drag(self, *places: tuple[float, float], button: int = 1) -> None:
        """Drag along places of the map; one place is a click."""
        await self.mouse(events.MouseDown, places[0], button)
        for place in places[1:]:
            await self.mouse(events.MouseMove, place)
        await self.mouse(events.MouseUp, places[-1], button)

    async def fill(self, text: str) -> None:
        self.app.screen.query_one(Input).value = text
        await self.settled()

    async def until(self, condition: Callable[[], object]) -> None:
        """Let time pass until a condition holds, and stop it at that moment."""
        await until(
            lambda: self.app._exception is not None or condition(),
            lambda: f"the screen shows\n{self.screen()}",
        )

    async def settled(self) -> None:
        """Wait until everything is done that is to be done at this time."""
        await virtual_loop().settled()

    @contextmanager
    def impatient(self) -> Iterator[None]:
        """Let time pass although threads are at work, which a test holds or makes slow."""
        with virtual_loop().impatient():
            yield

    async def later(self, seconds: float) -> None:
        await virtual_loop().settled()
        await later(seconds)

    async def run_until(self, tick: int) -> None:
        self.session.run_until(tick)
        await self.until(lambda: self.tick == tick and not self.session.busy)

    async def ticks(self, count: int) -> None:
        there = self.tick + count
        await self.until(lambda: self.tick == there)

    async def ready(self) -> None:
        await self.until(
            lambda: (
                self.session.state.phase in ("applied", "mistake")
                and "COMPILING" not in self.status
            )
        )
        if not inspector_pane._LOADING_DELAY:
            await self.until(lambda: self.inspector.query("PredicatePage"))

    async def write(self, text: str, **awaited: Unpack[Awaited]) -> None:
        self.editor.put(text)
        await self.press("f4", **awaited)

    async def apply(self, text: str) -> None:
        await self.write(text)
        await self.until(lambda: self.session.state.applied == text)

    def screen(self) -> str:
        height = self.app.size.height
        lines = self.app.screen._compositor.render_strips()  # the only way to see all layers
        return "\n".join("".join(segment.text for segment in line) for line in lines[:height])

    def shows(self, text: str) -> bool:
        return text in self.screen()

    async def sees(self, *texts: str) -> None:
        """Wait until the screen shows all texts: what is drawn trails what is known."""
        await self.until(lambda: all(map(self.shows, texts)))

    async def sees_no(self, text: str) -> None:
        await self.until(lambda: not self.shows(text))


def cell_of(view: LabyrinthView, place: tuple[float, float]) -> tuple[int, int]:
    cell = view.view and view.view.cell(*place)
    assert cell, f"{place} is out of sight"
    return cell[1], cell[0]


def pytest_asyncio_loop_factories() -> dict[str, type[VirtualLoop]]:
    return {"virtual": VirtualLoop}


@pytest.fixture(autouse=True)
def _time_of_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Textual's timers, events, messages and undo steps go by the time of the loop, if one runs."""

    def now() -> float:
        try:
            return asyncio.get_running_loop().time()
        except RuntimeError:
            return monotonic()

    def raised(*fields: Any, **more: Any) -> notifications.Notification:
        return notifications.Notification(*fields, **(more | {"raised_at": now()}))

    monkeypatch.setattr(_time, "get_time", now)
    monkeypatch.setattr(notifications, "time", now)
    monkeypatch.setattr("textual.app.Notification", raised)
    monkeypatch.setattr(EditHistory, "_get_time", lambda _: now())
    monkeypatch.setattr("textual.pilot.wait_for_idle", lambda *_: virtual_loop().handled())


_measure = measuring.measure


@pytest.fixture(autouse=True)
def _no_trials(monkeypatch: pytest.MonkeyPatch) -> None:
    """A victory is not tried from varied starts, which takes a process; see `trials`."""

    async def never(*_: object) -> None:
        await asyncio.Event().wait()

    monkeypatch.setattr(measuring, "measure", never)


@pytest.fixture
def trials(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring, "measure", _measure)


@pytest.fixture(autouse=True)
def _loading(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The inspector loads its pages when one is used, and at once in tests of them."""
    at_once = "inspector" in request.path.parts
    monkeypatch.setattr(inspector_pane, "_LOADING_DELAY", 0.0 if at_once else 3600.0)


@pytest.fixture(autouse=True)
def _quick_run(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a quick run the screen does no more than a test asks for.

    A style is not set again, and nothing is drawn until a test looks. That changes no order in
    which things happen, because the clock stands still meanwhile. With ``--all`` all of it is done;
    `tests/snapshots` and `tests/e2e` look at what a terminal shows.
    """
    if not request.config.option.all:
        monkeypatch.setattr(Stylesheet, "replace_rules", staticmethod(_replaced_by_others))
        monkeypatch.setattr(Compositor, "render_update", _drawn_later)


_replace_rules, _render_update = Stylesheet.replace_rules, Compositor.render_update


def _replaced_by_others(node: DOMNode, rules: RulesMap, animate: bool = False) -> None:
    if animate:
        _replace_rules(node, rules, animate)
        return
    styles = node.styles.base
    for name in styles._rules.keys() | rules.keys():
        value = rules.get(name)
        if styles._rules.get(name) is not value:
            setattr(styles, name, value)
    node.notify_style_update()


def _drawn_later(self: Compositor, *_: object, **__: object) -> None:
    self._dirty_regions.clear()


@pytest.fixture
def drawn_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw all changes, for a test of how that is done."""
    monkeypatch.setattr(Compositor, "render_update", _render_update)


@pytest.fixture
def room_file(tmp_path: Path) -> Path:
    path = tmp_path / "room.toml"
    path.write_text(ROOM, "utf-8")
    return path


@pytest.fixture
def data_dir(tmp_path: Path) -> Path:
    return tmp_path / "data"


@pytest.fixture
def short(tmp_path: Path) -> Path:
    """A level with all kinds of texts, won by going straight ahead."""
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    return path


def source_of(text: str, folder: Path, name: str = "mine") -> ProgramSource:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.l"
    path.write_text(text, "utf-8")
    return load_program(path)


@asynccontextmanager
async def opened(
    data_dir: Path,
    *,
    level: str | Path = "open_room",
    text: str = PAPER,
    size: Size = (120, 40),
    name: str = "mine",
    welcome: bool = False,
    settings: Settings | None = None,
    ready: bool = False,
    permissions: Permissions = Permissions(),  # noqa: B008 - it is frozen
) -> AsyncIterator[Opened]:
    """Open the game with a program in the player's folder, and wait for that if it is wanted."""
    file = level if isinstance(level, Path) else LEVELS / f"{level}.json"
    path = data_dir / "programs" / f"{name}.l"
    source = load_program(path) if path.exists() else source_of(text, path.parent, name)
    opening = Opening(
        level=await asyncio.to_thread(load_level, file),
        sources={"": source},
        data_dir=data_dir,
        welcome=welcome,
        permissions=permissions,
        clock=VirtualClock(),
    )
    async with showing(opening, size, settings, ready=ready) as game:
        yield game


@asynccontextmanager
async def showing(
    opening: Opening,
    size: Size = (120, 40),
    settings: Settings | None = None,
    *,
    ready: bool = True,
) -> AsyncIterator[Opened]:
    app = LogicalRobotsApp(opening, settings=settings)
    async with app.run_test(size=size, notifications=True) as pilot:
        game = Opened(app, pilot, opening.data_dir)
        if ready:
            await game.ready()
        yield game
