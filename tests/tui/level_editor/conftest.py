"""A room to edit, with a screen to point at or without."""

import json
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

import pytest
from textual import screen
from textual.widgets import TextArea

from logical_robots_tui.editing.editor import LevelEditor
from logical_robots_tui.editing.files import save_level
from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.player.session import Session
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.level_editor.controller import LevelController
from logical_robots_tui.world import Level, load_level
from tests.player.test_session import Screen
from tests.short import AHEAD
from tests.tui.conftest import Awaited, Opened, opened, source_of
from tests.virtual_time import VirtualClock, until, virtual_loop

_BY_ID = {command.id: command for command in COMMANDS}


@dataclass(frozen=True)
class Studio:
    game: Opened

    @property
    def controller(self) -> LevelController:
        return self.game.main.editing

    @property
    def editor(self) -> LevelEditor:
        return self.controller.editor

    @property
    def level(self) -> Level:
        return self.editor.level

    @property
    def live(self) -> Level:
        return self.game.session.level

    async def press(self, *keys: str, **awaited: Unpack[Awaited]) -> None:
        await self.game.press(*keys, **awaited)

    async def do(self, *keys: str) -> None:
        await self.game.press(*keys)
        await self.game.settled()


@pytest.fixture
def web_file(room_file: Path) -> Path:
    file = room_file.with_name("garden.json")
    save_level(load_level(room_file), file)
    say(file, json.dumps(json.loads(said(file))))
    return file


@asynccontextmanager
async def studio(data_dir: Path, file: Path, **more: Any) -> AsyncIterator[Studio]:
    async with opened(data_dir, level=file, text=AHEAD, ready=True, **more) as game:
        await game.press("M", until=lambda: game.main.editing.is_on)
        yield Studio(game)


def fill(form: screen.Screen[Any], **values: str | bool) -> None:
    for name, value in values.items():
        field: Any = form.query_one(f"#{name}")
        setattr(field, "text" if isinstance(field, TextArea) else "value", value)


def said(file: Path) -> str:
    return file.read_text("utf-8")


def say(file: Path, text: str) -> None:
    file.write_text(text, "utf-8")


def replace_in(file: Path, old: str, new: str) -> None:
    say(file, said(file).replace(old, new))


class Answers(Screen):
    def __init__(self) -> None:
        super().__init__()
        self.answers: list[Any] = []

    async def ask(self, *asked: object) -> Any:
        self.said.append(str(asked[1]) if asked[1:] else type(asked[0]).__name__)
        return self.answers.pop(0) if self.answers else None

    choose = ask


@dataclass
class Bench:
    session: Session
    controller: LevelController
    ui: Answers

    @property
    def editor(self) -> LevelEditor:
        return self.controller.editor

    @property
    def level(self) -> Level:
        return self.editor.level

    def command(self, *ids: str) -> None:
        for name in ids:
            _BY_ID[name].run(self.controller, self.ui.spawn)

    async def settled(self) -> None:
        await virtual_loop().settled()

    async def until(self, condition: Callable[[], object]) -> None:
        await until(condition, lambda: repr(self.ui.said))

    async def says(self, text: str) -> None:
        await self.until(lambda: any(text in message for message in self.ui.said))
        self.ui.said.clear()

    async def save(self, answer: str) -> None:
        self.command("save_level")
        await self.says(answer)

    async def stroke(self, *points: tuple[float, float]) -> None:
        self.editor.press(*points[0], 1.0)
        for point in points[1:]:
            self.editor.drag(*point)
        self.editor.release()
        self.controller.change_game()
        await self.settled()

    async def run_to(self, tick: int) -> None:
        self.session.run_until(tick)
        await self.until(lambda: not self.session.busy and self.session.frame.tick == tick)


@asynccontextmanager
async def bench(data_dir: Path, file: Path) -> AsyncIterator[Bench]:
    ui, drafts = Answers(), Drafts(data_dir / "drafts")
    sources, clock = {"": source_of(AHEAD, data_dir / "programs")}, VirtualClock()
    session = Session(
        load_level(file), sources, spawn=ui.spawn, on_change=lambda: None, clock=clock
    )

    async def open_level(level: Level) -> None:
        session.open_level(level, sources, AHEAD)

    controller = LevelController(session, ui, data_dir / "levels", drafts, open_level, lambda: None)
    session.listeners.append(controller)
    try:
        session.apply(AHEAD)
        await until(lambda: session.state.applied == AHEAD)
        controller.open()
        yield Bench(session, controller, ui)
    finally:
        controller.close()
        drafts.close()
        await ui.close()
        await session.close()
